//! The drawing of a map as a list of shapes, from which both an SVG and pixels are made. Units are those of the sheet; (0, 0) is the
//! upper left corner.

use std::sync::Arc;
use wayword_core::Image;

/// A point.
pub(super) type SheetPoint = [f64; 2];
/// A colour: RGB.
pub(super) type InkColour = [u8; 3];

/// A drawing on white paper.
pub(super) struct MapSketch {
    pub(super) size: SheetPoint,
    /// A picture below everything, with its upper left and lower right corners.
    pub(super) picture: Option<(Arc<Image>, [SheetPoint; 2])>,
    /// From the lowest to the topmost.
    pub(super) marks: Vec<MapMark>,
}

/// A shape of the drawing.
pub(super) enum MapMark {
    /// Straight lines with round ends.
    Line { points: Vec<SheetPoint>, width: f64, ink: InkColour, dash: Option<[f64; 2]> },
    /// A disc; its title is shown when the user points at it.
    Disc { at: SheetPoint, radius: f64, ink: InkColour, title: Option<String> },
    /// A filled triangle.
    Triangle { corners: [SheetPoint; 3], ink: InkColour },
    /// Digits and a few letters around a point, or to the right of it.
    Text { at: SheetPoint, size: f64, text: String, ink: InkColour, is_centred: bool },
}

/// The colour of a CSS text, `#rgb` or `#rrggbb`; black for any other.
pub(super) fn ink_from_css(css: &str) -> InkColour {
    let digits: Vec<u8> = css.trim_start_matches('#').chars().filter_map(|c| Some(c.to_digit(16)? as u8)).collect();
    match digits[..] {
        [r, g, b] => [17 * r, 17 * g, 17 * b],
        [r, s, g, h, b, c] => [16 * r + s, 16 * g + h, 16 * b + c],
        _ => [0; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_read() {
        assert_eq!(
            [ink_from_css("#fff"), ink_from_css("#0a10ff"), ink_from_css("red")],
            [[255; 3], [10, 16, 255], [0; 3]]
        );
    }
}
