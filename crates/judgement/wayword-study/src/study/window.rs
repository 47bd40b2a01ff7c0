//! The window in which a participant walked: what a person sees depends on it. It is coarse, so that it tells no person from others.

use serde::{Deserialize, Serialize};

/// Sizes are rounded to multiples of this, CSS pixels.
const STEP_PX: u32 = 50;
/// Largest side that is kept; a larger one counts as this. CSS pixels.
const MAX_SIDE_PX: u32 = 10_000;

/// The size of a window and its kind of screen, as the page measured them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct WindowSize {
    /// Width, CSS pixels, to the nearest 50.
    pub width_px: u32,
    /// Height, CSS pixels, to the nearest 50.
    pub height_px: u32,
    /// Pixels of the screen for each CSS pixel: 1 to 4.
    pub pixel_ratio: u32,
    /// Whether it is used by touch, as a phone is.
    pub has_touch: bool,
}

impl WindowSize {
    /// Reads a window as the page writes it: width, height, pixel ratio and `touch` or `mouse`, with spaces between. `None` where it is
    /// anything else, as without the script.
    pub(crate) fn from_form(text: &str) -> Option<Self> {
        let mut parts = text.split(' ');
        let mut number = || parts.next()?.parse::<f64>().ok().filter(|number| *number > 0.0);
        let (width, height, ratio) = (number()?, number()?, number()?);
        let has_touch = match parts.next()? {
            "touch" => true,
            "mouse" => false,
            _ => return None,
        };
        let side_px = |side: f64| (side.min(f64::from(MAX_SIDE_PX)) as u32 + STEP_PX / 2) / STEP_PX * STEP_PX;
        let pixel_ratio = ratio.round().clamp(1.0, 4.0) as u32;
        Some(Self { width_px: side_px(width), height_px: side_px(height), pixel_ratio, has_touch })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_are_kept_coarsely() {
        let phone = WindowSize { width_px: 400, height_px: 850, pixel_ratio: 3, has_touch: true };
        assert_eq!(WindowSize::from_form("390 844 2.75 touch"), Some(phone));
        let huge = WindowSize::from_form("1e300 20 0.1 mouse").unwrap();
        assert_eq!((huge.width_px, huge.height_px, huge.pixel_ratio), (10_000, 0, 1));
    }

    #[test]
    fn anything_else_is_no_window() {
        for text in ["", "390", "390 844 2", "390 844 2 pen", "-1 844 2 touch", "NaN 844 2 touch", "a b c d"] {
            assert_eq!(WindowSize::from_form(text), None, "{text}");
        }
    }
}
