//! Paints a sketch as pixels. Edges are smooth: a pixel gets the share of ink by its distance from the edge.

use super::{
    super::picture::picture_error,
    glyphs,
    sketch::{InkColour, MapMark, MapSketch, SheetPoint},
};
use image::{
    ImageError, RgbImage,
    error::{ParameterError, ParameterErrorKind},
    imageops::{self, FilterType},
};
use wayword_core::Image;
use wayword_run::error::CommandError;

/// Pixels per unit of the sheet.
const PIXELS_PER_UNIT: f64 = 2.0;

/// Paints the drawing.
///
/// # Errors
/// When a picture in it does not fill its size.
pub(super) fn paint_sketch(sketch: &MapSketch) -> Result<Image, CommandError> {
    let [width, height] = sketch.size.map(|side| (side * PIXELS_PER_UNIT).ceil().max(1.0) as u32);
    let mut canvas = PixelCanvas(RgbImage::from_pixel(width, height, image::Rgb([255; 3])));
    if let Some((picture, [low, high])) = &sketch.picture {
        let [left, top] = low.map(|at| (at * PIXELS_PER_UNIT).round() as i64);
        let size = [0, 1].map(|axis| ((high[axis] - low[axis]) * PIXELS_PER_UNIT).round().max(1.0) as u32);
        let given = RgbImage::from_raw(picture.width_px(), picture.height_px(), picture.rgb_bytes().to_vec());
        let scaled = imageops::resize(&given.ok_or_else(wrong_size)?, size[0], size[1], FilterType::Triangle);
        imageops::replace(&mut canvas.0, &scaled, left, top);
    }
    for mark in &sketch.marks {
        canvas.draw_mark(mark);
    }
    Image::new(width, height, canvas.0.into_raw()).map_err(|_| wrong_size())
}

fn wrong_size() -> CommandError {
    picture_error(ImageError::Parameter(ParameterError::from_kind(ParameterErrorKind::DimensionMismatch)))
}

/// The picture that is painted.
struct PixelCanvas(RgbImage);

impl PixelCanvas {
    fn draw_mark(&mut self, mark: &MapMark) {
        match mark {
            MapMark::Line { points, width, ink, dash: None } => self.draw_lines(points, *width, *ink),
            MapMark::Line { points, width, ink, dash: Some(dash) } => {
                for piece in dash_pieces(points, *dash) {
                    self.draw_stroke(piece, *width, *ink);
                }
            }
            MapMark::Disc { at, radius, ink, .. } => self.draw_stroke([*at, *at], 2.0 * radius, *ink),
            MapMark::Triangle { corners, ink } => self.fill_triangle(*corners, *ink),
            MapMark::Text { at, size, text, ink, is_centred } => {
                let (lines, width) = glyphs::text_strokes(text, *at, *size, *is_centred);
                for line in lines {
                    self.draw_lines(&line, width, *ink);
                }
            }
        }
    }

    fn draw_lines(&mut self, points: &[SheetPoint], width: f64, ink: InkColour) {
        for pair in points.windows(2) {
            self.draw_stroke([pair[0], pair[1]], width, ink);
        }
    }

    /// A straight line with round ends.
    fn draw_stroke(&mut self, ends: [SheetPoint; 2], width: f64, ink: InkColour) {
        let ([from, to], radius) = (ends.map(|end| end.map(|at| at * PIXELS_PER_UNIT)), 0.5 * width * PIXELS_PER_UNIT);
        let way = [to[0] - from[0], to[1] - from[1]];
        let length2 = way[0] * way[0] + way[1] * way[1];
        let reach = radius + 1.0;
        for y in self.pixel_span(1, from[1].min(to[1]) - reach, from[1].max(to[1]) + reach) {
            let middle = f64::from(y) + 0.5;
            // Only the part of the line that is near the row, because its whole box can be large.
            let along = |at: f64| if way[1].abs() > 1e-9 { ((at - from[1]) / way[1]).clamp(0.0, 1.0) } else { 0.0 };
            let shares = if way[1].abs() > 1e-9 { [along(middle - reach), along(middle + reach)] } else { [0.0, 1.0] };
            let xs = shares.map(|share| from[0] + share * way[0]);
            for x in self.pixel_span(0, xs[0].min(xs[1]) - reach, xs[0].max(xs[1]) + reach) {
                let off = [f64::from(x) + 0.5 - from[0], middle - from[1]];
                let dot = off[0] * way[0] + off[1] * way[1];
                let share = if length2 > 0.0 { (dot / length2).clamp(0.0, 1.0) } else { 0.0 };
                let distance = (off[0] - share * way[0]).hypot(off[1] - share * way[1]);
                self.blend_pixel(x, y, ink, radius + 0.5 - distance);
            }
        }
    }

    /// A filled triangle.
    fn fill_triangle(&mut self, corners: [SheetPoint; 3], ink: InkColour) {
        let corners = corners.map(|corner| corner.map(|at| at * PIXELS_PER_UNIT));
        let ends = |axis: usize| {
            let along = corners.map(|corner| corner[axis]);
            (
                along.into_iter().fold(f64::INFINITY, f64::min) - 1.0,
                along.into_iter().fold(f64::NEG_INFINITY, f64::max) + 1.0,
            )
        };
        let cross =
            |a: SheetPoint, b: SheetPoint, p: SheetPoint| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
        let sign = cross(corners[0], corners[1], corners[2]).signum();
        let ((left, right), (top, bottom)) = (ends(0), ends(1));
        for y in self.pixel_span(1, top, bottom) {
            for x in self.pixel_span(0, left, right) {
                let at = [f64::from(x) + 0.5, f64::from(y) + 0.5];
                // The distance from each side, positive on the inner side; the smallest decides.
                let inside = (0..3).map(|side| {
                    let (a, b) = (corners[side], corners[(side + 1) % 3]);
                    sign * cross(a, b, at) / (b[0] - a[0]).hypot(b[1] - a[1]).max(1e-9)
                });
                self.blend_pixel(x, y, ink, inside.fold(f64::INFINITY, f64::min) + 0.5);
            }
        }
    }

    /// The rows or columns of the canvas between two places.
    fn pixel_span(&self, axis: usize, from: f64, to: f64) -> std::ops::Range<u32> {
        let most = f64::from([self.0.width(), self.0.height()][axis]);
        from.floor().clamp(0.0, most) as u32..to.ceil().clamp(0.0, most) as u32
    }

    /// Mixes ink into a pixel; `share` is the part of the pixel that the ink covers, cut to 0 to 1.
    fn blend_pixel(&mut self, x: u32, y: u32, ink: InkColour, share: f64) {
        let share = share.clamp(0.0, 1.0);
        if share > 0.0 {
            let below = self.0.get_pixel_mut(x, y);
            for (channel, ink) in below.0.iter_mut().zip(ink) {
                *channel = (f64::from(*channel) + (f64::from(ink) - f64::from(*channel)) * share).round() as u8;
            }
        }
    }
}

/// Divides lines into dashes as SVG's `stroke-dasharray` does: `on` units drawn, `off` units left out, across corners.
fn dash_pieces(points: &[SheetPoint], [on, off]: [f64; 2]) -> Vec<[SheetPoint; 2]> {
    let mut pieces = Vec::new();
    let mut done = 0.0;
    for pair in points.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let at = |along: f64| [0, 1].map(|axis| from[axis] + (to[axis] - from[axis]) * (along / length));
        let mut start = -(done % (on + off));
        while start < length && length > 0.0 {
            if start + on > 0.0 {
                pieces.push([at(start.max(0.0)), at((start + on).min(length))]);
            }
            start += on + off;
        }
        done += length;
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    fn painted(picture: Option<(Arc<Image>, [SheetPoint; 2])>, marks: Vec<MapMark>) -> RgbImage {
        let image = paint_sketch(&MapSketch { size: [40.0, 20.0], picture, marks }).unwrap();
        RgbImage::from_raw(image.width_px(), image.height_px(), image.rgb_bytes().to_vec()).unwrap()
    }

    fn dark(image: &RgbImage) -> f64 {
        image.pixels().map(|pixel| 1.0 - f64::from(pixel[0]) / 255.0).sum::<f64>() / (PIXELS_PER_UNIT * PIXELS_PER_UNIT)
    }

    #[test]
    fn painted_shapes_cover_their_areas() {
        let ink = [0; 3];
        let disc = MapMark::Disc { at: [20.3, 9.7], radius: 6.0, ink, title: None };
        assert!((dark(&painted(None, vec![disc])) - std::f64::consts::PI * 36.0).abs() < 0.8);
        for to in [[30.0, 9.0], [9.0, 17.0], [33.0, 16.0]] {
            let line = MapMark::Line { points: vec![[9.0, 5.0], to], width: 2.0, ink, dash: None };
            let area = 2.0 * (to[0] - 9.0).hypot(to[1] - 5.0) + std::f64::consts::PI;
            assert!((dark(&painted(None, vec![line])) - area).abs() < 0.8, "{to:?}");
        }
        let triangle = MapMark::Triangle { corners: [[5.0, 2.0], [35.0, 3.0], [11.0, 18.0]], ink };
        let area = (30.0 * 16.0 - 1.0 * 6.0) / 2.0;
        assert!((dark(&painted(None, vec![triangle])) - area).abs() < 1.5);
    }

    #[test]
    fn paint_cuts_lines_at_the_edge_of_the_paper() {
        let far = MapMark::Line { points: vec![[-1e7, -1e7], [1e7, 1e7]], width: 1.0, ink: [0; 3], dash: None };
        let lines = dark(&painted(None, vec![far]));
        assert!((20.0..32.0).contains(&lines), "{lines}");
    }

    #[test]
    fn dashes_go_on_around_corners() {
        let pieces = dash_pieces(&[[0.0, 0.0], [5.0, 0.0], [5.0, 5.0]], [2.0, 2.0]);
        assert_eq!(
            pieces,
            [[[0.0, 0.0], [2.0, 0.0]], [[4.0, 0.0], [5.0, 0.0]], [[5.0, 0.0], [5.0, 1.0]], [[5.0, 3.0], [5.0, 5.0]]]
        );
    }

    #[test]
    fn a_picture_lies_where_its_corners_are() {
        let picture = Arc::new(Image::new(1, 1, vec![10, 20, 30]).unwrap());
        let image = painted(Some((picture, [[10.0, 5.0], [30.0, 15.0]])), vec![]);
        let inside = |x: u32, y: u32| image.get_pixel(x, y).0 == [10, 20, 30];
        assert!(inside(20, 10) && inside(59, 29) && !inside(19, 10) && !inside(60, 29) && !inside(59, 30));
    }
}
