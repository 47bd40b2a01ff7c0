//! Depth images: how far away each pixel of a view's picture is.

/// For each pixel of a view's picture, the distance along the view's axis.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthImage {
    width_px: u32,
    height_px: u32,
    metres: Vec<f32>,
}

/// The buffer does not fit the size that was given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the depth of {width_px} x {height_px} pixels needs {} values, not {actual}", u64::from(*width_px) * u64::from(*height_px))]
pub struct WrongDepthCount {
    width_px: u32,
    height_px: u32,
    actual: usize,
}

/// The distance that counts for a box, as a share of its pixels, sorted with the nearest first: at 0.25 a quarter of
/// them are nearer. It is not the middle one, because a thing hardly fills its box: between its legs and over its back
/// one sees the background.
const NEAREST_PIXEL_SHARE: f64 = 0.25;

impl DepthImage {
    /// `metres` holds one value per pixel, rows from the top: the distance along the view's axis, in front of the eye.
    /// A value that is 0, negative or not finite means that the distance is not known.
    ///
    /// # Errors
    /// When the buffer has another length.
    pub fn new(width_px: u32, height_px: u32, metres: Vec<f32>) -> Result<Self, WrongDepthCount> {
        if metres.len() as u64 == u64::from(width_px) * u64::from(height_px) {
            Ok(Self { width_px, height_px, metres })
        } else {
            Err(WrongDepthCount { width_px, height_px, actual: metres.len() })
        }
    }

    /// The horizontal distance from the eye to a thing, metres, in a level view: the lower quartile over the middle of
    /// its box, half as wide and half as high. `edges` are the box's left, top, right and bottom edge as shares of the
    /// picture's width and height. `None` if no distance is known there.
    #[must_use]
    pub fn level_m(&self, edges: [f64; 4], horizontal_fov_rad: f64) -> Option<f64> {
        let [left, top, right, bottom] = edges;
        let columns = middle_pixels([left, right], self.width_px)?;
        let rows = middle_pixels([top, bottom], self.height_px)?;
        let half_px = f64::from(self.width_px) / 2.0;
        let half_width = libm::tan(horizontal_fov_rad / 2.0);
        // From the distance along the view's axis to the distance along the ray of a column.
        let ray_factor = |column: usize| {
            let across = (column as f64 + 0.5 - half_px) / half_px * half_width;
            libm::sqrt(1.0 + across * across)
        };
        let axis_m = |row: usize, column: usize| f64::from(self.metres[row * self.width_px as usize + column]);
        let pixels = rows.flat_map(|row| columns.clone().map(move |column| axis_m(row, column) * ray_factor(column)));
        let mut known: Vec<f64> = pixels.filter(|metres| metres.is_finite() && *metres > 0.0).collect();
        let quartile = (known.len() as f64 * NEAREST_PIXEL_SHARE) as usize;
        (!known.is_empty()).then(|| *known.select_nth_unstable_by(quartile, f64::total_cmp).1)
    }
}

/// The pixels of the middle half of a span, at least one. The span's two bounds are shares of the picture's side and are
/// cut to the picture. `None` where they are in the wrong order or no numbers, or the side has no pixel.
fn middle_pixels([from, to]: [f64; 2], side_px: u32) -> Option<std::ops::Range<usize>> {
    let (from, to) = (from.clamp(0.0, 1.0), to.clamp(0.0, 1.0));
    let quarter = (to - from) / 4.0;
    let side = f64::from(side_px);
    let first = ((from + quarter) * side).floor().min(side - 1.0);
    let end = ((to - quarter) * side).ceil().max(first + 1.0).min(side);
    // A NaN compares as false here.
    (quarter >= 0.0 && side_px > 0).then_some(first as usize..end as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// A wall at 4 m along the axis, with a post of 2 m in the columns 4 and 5 of 10.
    fn post() -> DepthImage {
        let metres = (0..60).map(|at| if (4..6).contains(&(at % 10)) { 2.0 } else { 4.0 });
        DepthImage::new(10, 6, metres.collect()).unwrap()
    }

    #[test]
    fn level_m_measures_the_post_before_the_wall() {
        let far_m = post().level_m([0.3, 0.0, 0.7, 1.0], FRAC_PI_2).unwrap();
        // The columns next to the axis: their rays are a little longer than the axis.
        assert!((far_m - 2.0 * f64::hypot(1.0, 0.1)).abs() < 1e-6, "{far_m}");
    }

    #[test]
    fn a_wall_at_the_side_is_farther_than_along_the_axis() {
        let far_m = post().level_m([0.9, 0.0, 1.0, 1.0], FRAC_PI_2).unwrap();
        assert!((far_m - 4.0 * f64::hypot(1.0, 0.9)).abs() < 1e-6, "{far_m}");
    }

    #[test]
    fn level_m_leaves_out_unknown_distances() {
        let mut metres = vec![0.0, f32::NAN, f32::INFINITY, -1.0, 3.0];
        let of = |metres: Vec<f32>| DepthImage::new(5, 1, metres).unwrap().level_m([-1.0, 0.0, 3.0, 1.0], 1e-3);
        assert_eq!(of(metres.clone()), None, "the middle half holds nothing that is known");
        metres[3] = 7.0;
        assert!((of(metres).unwrap() - 7.0).abs() < 1e-3);
        let depth = post();
        assert_eq!(depth.level_m([0.7, 0.0, 0.3, 1.0], 1.0), None, "edges in the wrong order");
        assert_eq!(depth.level_m([f64::NAN, 0.0, 0.3, 1.0], 1.0), None);
        assert!(depth.level_m([1.0, 1.0, 1.0, 1.0], 1.0).is_some(), "a box without width lies in a pixel");
        assert_eq!(DepthImage::new(0, 0, Vec::new()).unwrap().level_m([0.0, 0.0, 1.0, 1.0], 1.0), None);
    }

    #[test]
    fn the_buffer_must_fit_the_size() {
        let error = DepthImage::new(2, 2, vec![1.0; 3]).unwrap_err().to_string();
        assert_eq!(error, "the depth of 2 x 2 pixels needs 4 values, not 3");
    }
}
