//! Colours of frames, from dark to light in their order, so that the order is visible in grey and to colour-blind
//! readers too.

use serde::Serialize;

/// A colour and the colour of a number on it, in CSS.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(crate) struct FrameColour {
    pub(crate) fill: String,
    pub(crate) ink: &'static str,
}

/// Viridis (CC0, Smith and van der Walt) at eighths, without the last, because that yellow is hard to see on white
/// paper.
const VIRIDIS_STEPS: [[u8; 3]; 8] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
];
/// Up to this many thousandths of the scale a white number is easier to read than a black one.
const WHITE_INK_MAX_THOUSANDTHS: usize = 498;

/// The colour of frame `at` (from 0) of `frames`.
pub(crate) fn frame_colour(at: usize, frames: usize) -> FrameColour {
    let last = frames.saturating_sub(1).max(1);
    let thousandths = at.min(last) * 1000 / last;
    let along = thousandths * (VIRIDIS_STEPS.len() - 1);
    let (step, rest) = ((along / 1000).min(VIRIDIS_STEPS.len() - 2), along);
    let rest = rest - step * 1000;
    let mix = |channel: usize| {
        let (from, to) = (usize::from(VIRIDIS_STEPS[step][channel]), usize::from(VIRIDIS_STEPS[step + 1][channel]));
        (from * (1000 - rest) + to * rest + 500) / 1000
    };
    let fill = format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2));
    FrameColour { fill, ink: if thousandths <= WHITE_INK_MAX_THOUSANDTHS { "#fff" } else { "#000" } }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance (WCAG 2.1).
    fn luminance(css: &str) -> f64 {
        let css = if css.len() == 4 {
            css.chars().skip(1).flat_map(|digit| [digit; 2]).collect()
        } else {
            css[1..].to_owned()
        };
        let channel = |at: usize| {
            let value = f64::from(u8::from_str_radix(&css[at..at + 2], 16).unwrap()) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * channel(0) + 0.7152 * channel(2) + 0.0722 * channel(4)
    }

    #[test]
    fn later_frames_are_lighter() {
        let lights: Vec<f64> = (0..8).map(|at| luminance(&frame_colour(at, 8).fill)).collect();
        assert!(lights.windows(2).all(|pair| pair[0] + 0.01 < pair[1]), "{lights:?}");
    }

    #[test]
    fn numbers_can_be_read_on_every_colour() {
        for at in 0..=1000 {
            let colour = frame_colour(at, 1001);
            let (fill, ink) = (luminance(&colour.fill), luminance(colour.ink));
            let contrast = (fill.max(ink) + 0.05) / (fill.min(ink) + 0.05);
            assert!(contrast >= 4.5, "{colour:?}: {contrast}");
        }
    }

    #[test]
    fn a_path_of_one_frame_has_a_colour() {
        assert_eq!(frame_colour(0, 1).fill, "#440154");
    }
}
