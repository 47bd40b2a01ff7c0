//! The drawing of a map as a list of shapes, from which both an SVG and pixels are made. Units are those of the sheet; (0, 0) is the
//! upper left corner.

use std::sync::Arc;
use wayword_core::Image;

/// A point.
pub(super) type Point = [f64; 2];
/// A colour: RGB.
pub(super) type Ink = [u8; 3];

/// A drawing on white paper.
pub(super) struct Sketch {
    pub(super) size: Point,
    /// A picture below everything, with its upper left and lower right corners.
    pub(super) picture: Option<(Arc<Image>, [Point; 2])>,
    /// From the lowest to the topmost.
    pub(super) marks: Vec<Mark>,
}

/// A shape of the drawing.
pub(super) enum Mark {
    /// Straight lines with round ends.
    Line { points: Vec<Point>, width: f64, ink: Ink, dash: Option<[f64; 2]> },
    /// A disc; its title is shown when the user points at it.
    Disc { at: Point, radius: f64, ink: Ink, title: Option<String> },
    /// A filled triangle.
    Triangle { corners: [Point; 3], ink: Ink },
    /// Digits and a few letters around a point, or to the right of it.
    Text { at: Point, size: f64, text: String, ink: Ink, is_centred: bool },
}

/// The colour of a CSS text, `#rgb` or `#rrggbb`; black for any other.
pub(super) fn ink(css: &str) -> Ink {
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
        assert_eq!([ink("#fff"), ink("#0a10ff"), ink("red")], [[255; 3], [10, 16, 255], [0; 3]]);
    }
}
