//! A picture as grey values on a cylinder around the camera: columns are equal angles, rows equal slopes. There a turn of
//! a level camera moves all columns by the same number, whatever the depth.
#![expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "counts and places of pictures; grey values need no more than f32"
)]

use wayword_core::Image;

/// Columns of every panorama. More would be slower and, with blur and shake, no surer.
pub(super) const PANORAMA_COLUMNS: usize = 96;
/// Most rows of a panorama; a portrait picture loses its top and bottom.
const MOST_ROWS: usize = 96;
/// Width to which a picture is shrunk first, so that unrolling skips no pixels.
const SHRUNK_WIDTH: u32 = 2 * 96;

/// The camera, as far as it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PanoramaLens {
    /// The horizontal field of view. A guess will do: a wrong one scales the angles.
    pub(super) horizontal_fov_rad: f64,
    /// How far the camera looks up; negative looks down.
    pub(super) pitch_rad: f64,
}

/// A grey picture on a cylinder.
#[derive(Debug, Clone)]
pub(super) struct PicturePanorama {
    /// GreyPicture values, row by row, 0 to 255.
    pub(super) values: Vec<f32>,
    /// Whether the picture shows this pixel of the cylinder.
    pub(super) is_seen: Vec<bool>,
    /// Number of rows.
    pub(super) rows: usize,
    /// Angle between two columns.
    pub(super) column_rad: f64,
}

impl PanoramaLens {
    /// A level lens of this horizontal field of view, radians.
    pub(super) fn with_fov(horizontal_fov_rad: f64) -> Self {
        Self { horizontal_fov_rad, pitch_rad: 0.0 }
    }
}

impl PicturePanorama {
    /// Unrolls a picture.
    pub(super) fn unroll(picture: &Image, lens: PanoramaLens) -> Self {
        let grey = GreyPicture::shrink(picture);
        let fov_rad = lens.horizontal_fov_rad.clamp(0.2, 2.6);
        let focal_px = grey.width as f64 / 2.0 / libm::tan(fov_rad / 2.0);
        let column_rad = fov_rad / PANORAMA_COLUMNS as f64;
        let rows = wanted_rows(grey.height as f64 / focal_px / column_rad);
        let mut panorama = Self { values: Vec::new(), is_seen: Vec::new(), rows, column_rad };
        let (pitch_sin, pitch_cos) = (libm::sin(lens.pitch_rad), libm::cos(lens.pitch_rad));
        // The rows lie around the middle of the picture, also when that looks down.
        let middle_slope = libm::tan(lens.pitch_rad);
        for row in 0..rows {
            for column in 0..PANORAMA_COLUMNS {
                let (mut sum, mut seen) = (0.0, 0);
                for part in 0..4 {
                    let (right, down) = (f64::from(part % 2) * 0.5 + 0.25, f64::from(part / 2) * 0.5 + 0.25);
                    let angle = (column as f64 + right - PANORAMA_COLUMNS as f64 / 2.0) * column_rad;
                    let rise = middle_slope - (row as f64 + down - rows as f64 / 2.0) * column_rad;
                    let (side, ahead) = (libm::sin(angle), libm::cos(angle));
                    let (up, ahead) = (rise * pitch_cos - ahead * pitch_sin, ahead * pitch_cos + rise * pitch_sin);
                    if let Some(value) = grey.at(side / ahead * focal_px, -up / ahead * focal_px, ahead) {
                        sum += value;
                        seen += 1;
                    }
                }
                panorama.values.push(if seen == 0 { 0.0 } else { sum / seen as f32 });
                panorama.is_seen.push(seen == 4);
            }
        }
        panorama
    }
}

/// How many rows a panorama has whose picture is that high, in columns.
#[expect(clippy::cast_sign_loss, reason = "between 9 and MOST_ROWS")]
fn wanted_rows(height: f64) -> usize {
    height.clamp(9.0, MOST_ROWS as f64) as usize
}

/// A grey picture, shrunk.
struct GreyPicture {
    values: Vec<f32>,
    width: usize,
    height: usize,
}

impl GreyPicture {
    /// The mean of the three colours over boxes of whole pixels. An equal mean keeps edges between colours of the same
    /// brightness to the eye better than luma does.
    fn shrink(picture: &Image) -> Self {
        let factor = (picture.width_px() / SHRUNK_WIDTH).max(1);
        let (width, height) = ((picture.width_px() / factor).max(1), (picture.height_px() / factor).max(1));
        let mut values = Vec::with_capacity((width * height) as usize);
        for row in 0..height {
            for column in 0..width {
                let mut sum = 0_u32;
                for part in 0..factor * factor {
                    let (x, y) = (column * factor + part % factor, row * factor + part / factor);
                    let at = 3 * (y as usize * picture.width_px() as usize + x as usize);
                    let pixel = picture.rgb_bytes().get(at..at + 3).unwrap_or_default();
                    sum += pixel.iter().map(|channel| u32::from(*channel)).sum::<u32>();
                }
                values.push(sum as f32 / (3 * factor * factor) as f32);
            }
        }
        Self { values, width: width as usize, height: height as usize }
    }

    /// The value at a place measured from the middle, between pixels; none outside, or behind the camera.
    #[expect(clippy::cast_sign_loss, reason = "checked to lie in the picture")]
    fn at(&self, right_px: f64, down_px: f64, ahead: f64) -> Option<f32> {
        let (x, y) = (right_px + (self.width as f64 - 1.0) / 2.0, down_px + (self.height as f64 - 1.0) / 2.0);
        let (far_x, far_y) = (self.width as f64 - 1.0, self.height as f64 - 1.0);
        if ahead <= 0.0 || x < -0.5 || y < -0.5 || x > far_x + 0.5 || y > far_y + 0.5 {
            return None;
        }
        let (x, y) = (x.clamp(0.0, far_x), y.clamp(0.0, far_y));
        let (column, row) = (x as usize, y as usize);
        let (share_x, share_y) = ((x - column as f64) as f32, (y - row as f64) as f32);
        let pixel = |column: usize, row: usize| {
            self.values.get(row.min(self.height - 1) * self.width + column.min(self.width - 1)).copied()
        };
        let upper = pixel(column, row)? * (1.0 - share_x) + pixel(column + 1, row)? * share_x;
        let lower = pixel(column, row + 1)? * (1.0 - share_x) + pixel(column + 1, row + 1)? * share_x;
        Some(upper * (1.0 - share_y) + lower * share_y)
    }
}
