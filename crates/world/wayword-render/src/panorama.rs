//! Joins four level views of 90 degrees into one cylinder around the eye.

use crate::bilinear::sample_bilinear;
use crate::picture::{MAX_SIDE_PX, RenderError, check_size};
use glam::Vec3;
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// A level view of 90 degrees with square pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuarterView<'a> {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Gamma-encoded sRGB, three bytes per pixel, from the top left.
    pub rgb: &'a [u8],
}

/// The view all around, unrolled: columns are evenly spaced directions, rows are heights on the cylinder.
#[derive(Clone, Debug, PartialEq)]
pub struct Panorama {
    /// Pixels per row: the whole circle. The first view's middle is in the middle.
    pub width: u32,
    /// Rows; the horizon is in the middle.
    pub height: u32,
    /// Gamma-encoded sRGB, three bytes per pixel, from the top left.
    pub rgb: Vec<u8>,
}

/// Why views do not make a panorama.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PanoramaError {
    /// None of the four views is given.
    #[error("none of the four views has a picture")]
    Empty,
    /// A view's bytes do not fill it.
    #[error("view {view} has {bytes} bytes for {width}x{height} pixels: give three per pixel")]
    Bytes {
        /// Index of the view.
        view: usize,
        /// Pixels per row.
        width: u32,
        /// Rows.
        height: u32,
        /// Its bytes.
        bytes: usize,
    },
    /// A view or the panorama has no usable size.
    #[error(transparent)]
    Size(#[from] RenderError),
}

/// Joins the views ahead, right, behind and left into a panorama, `width` pixels wide. Without a `width`, the panorama is
/// wide enough for all detail in the middle of the views. Each pixel is a ray through the cylinder, and its colour is
/// interpolated in the view that contains the ray. The height is limited by the seams, where views cover the least of the
/// cylinder. A missing view has the colour `blank`.
///
/// # Errors
/// [`PanoramaError`] where no view is given, a view's bytes do not fill it, or a size is not allowed.
pub fn join_panorama(
    views: [Option<QuarterView<'_>>; 4],
    width: Option<u32>,
    blank: [u8; 3],
) -> Result<Panorama, PanoramaError> {
    for (index, view) in views.iter().enumerate() {
        if let Some(view) = view {
            check_view(index, view)?;
        }
    }
    let given_views = || views.iter().flatten();
    let widest = given_views().map(|view| view.width).max().ok_or(PanoramaError::Empty)?;
    let lowest = given_views().map(|view| f64::from(view.height) / f64::from(view.width)).fold(f64::INFINITY, f64::min);
    // A view of 90 degrees has half its width in pixels for each radian in its middle.
    let natural = (PI * f64::from(widest)).round() as u32;
    let width = width.unwrap_or(natural.min(MAX_SIDE_PX));
    let step_rad = TAU / f64::from(width.max(1));
    // A view covers the least height of the cylinder at its sides, the seams.
    let height = (2.0 * lowest * FRAC_1_SQRT_2 / step_rad).floor().max(1.0);
    check_size(width.into(), height as u64)?;
    let height = height as u32;
    let columns: Vec<PanoramaColumn> =
        (0..width).map(|x| PanoramaColumn::at((f64::from(x) + 0.5) * step_rad - PI)).collect();
    let mut rgb = vec![0; 3 * width as usize * height as usize];
    rgb.par_chunks_exact_mut(3 * width as usize).enumerate().for_each(|(y, row)| {
        let up = (0.5 * f64::from(height) - (y as f64 + 0.5)) * step_rad;
        for (column, out) in columns.iter().zip(row.chunks_exact_mut(3)) {
            let colour = column.colour_at(&views, up);
            out.copy_from_slice(&colour.unwrap_or(blank));
        }
    });
    Ok(Panorama { width, height, rgb })
}

fn check_view(index: usize, view: &QuarterView<'_>) -> Result<(), PanoramaError> {
    check_size(view.width.into(), view.height.into())?;
    if view.rgb.len() == 3 * view.width as usize * view.height as usize {
        return Ok(());
    }
    let (width, height, bytes) = (view.width, view.height, view.rgb.len());
    Err(PanoramaError::Bytes { view: index, width, height, bytes })
}

/// A direction of the panorama, as its view has it.
struct PanoramaColumn {
    /// The index of the view.
    side: usize,
    /// Tangent and cosine of the turn from the middle of the view.
    tan: f64,
    cos: f64,
}

impl PanoramaColumn {
    /// The direction `turn_rad` to the right of the first view's middle.
    fn at(turn_rad: f64) -> Self {
        let side = ((turn_rad + FRAC_PI_4) / FRAC_PI_2).floor();
        let off_rad = turn_rad - side * FRAC_PI_2;
        Self { side: side.rem_euclid(4.0) as usize % 4, tan: libm::tan(off_rad), cos: libm::cos(off_rad) }
    }

    /// The colour along a ray in this direction, `up` above the horizon on a cylinder of radius 1.
    fn colour_at(&self, views: &[Option<QuarterView<'_>>; 4], up: f64) -> Option<[u8; 3]> {
        let view = views[self.side]?;
        let focal_px = 0.5 * f64::from(view.width);
        let x_px = focal_px * (1.0 + self.tan);
        let y_px = 0.5 * f64::from(view.height) - focal_px * up / self.cos;
        let size = [view.width as usize, view.height as usize];
        let colour = sample_bilinear(view.rgb, size, [x_px as f32, y_px as f32]) + Vec3::splat(0.5);
        Some(colour.to_array().map(|value| value as u8))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PinholeCamera;
    use glam::DVec3;
    use proptest::prelude::*;

    /// The colours of a scene that is infinitely far away: a smooth function of the direction.
    fn colour(ray: DVec3) -> [f64; 3] {
        let wave = |a: f64, b: f64| 128.0 + 50.0 * libm::sin(3.0 * a + 0.3) + 50.0 * libm::cos(2.0 * b);
        let ray = ray.normalize();
        [wave(ray.x, ray.z), wave(ray.y, ray.x), wave(ray.z, ray.y)]
    }

    fn camera(heading_rad: f64, width: u32, height: u32) -> PinholeCamera {
        let vertical_fov_rad = 2.0 * libm::atan(f64::from(height) / f64::from(width));
        PinholeCamera { position: DVec3::ZERO, heading_rad, elevation_rad: 0.0, vertical_fov_rad, width, height }
    }

    /// What a camera sees of that scene, rounded to bytes.
    fn seen(camera: &PinholeCamera) -> Vec<u8> {
        let pixels = (0..camera.height).flat_map(|y| (0..camera.width).map(move |x| (x, y)));
        pixels
            .flat_map(|(x, y)| colour(camera.ray_through(f64::from(x) + 0.5, f64::from(y) + 0.5)))
            .map(|value| value.round() as u8)
            .collect()
    }

    fn quarters(heading_rad: f64, width: u32, height: u32) -> [Vec<u8>; 4] {
        std::array::from_fn(|side| seen(&camera(heading_rad + side as f64 * FRAC_PI_2, width, height)))
    }

    fn views(pictures: &[Vec<u8>; 4], width: u32, height: u32) -> [Option<QuarterView<'_>>; 4] {
        std::array::from_fn(|side| Some(QuarterView { width, height, rgb: &pictures[side] }))
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

        #[test]
        fn every_pixel_has_the_colour_of_its_direction(
            heading in 0.0..TAU, width in 64u32..160, height in 40u32..200, asked in prop::option::of(50u32..700),
        ) {
            let pictures = quarters(heading, width, height);
            let whole = join_panorama(views(&pictures, width, height), asked, [0; 3]).unwrap();
            prop_assert_eq!(whole.width, asked.unwrap_or((PI * f64::from(width)).round() as u32));
            // Half a pixel is lost where a view ends; elsewhere bilinear lookup is as exact as the views are fine.
            let pixel_rad = 2.0 / f64::from(width);
            for y in 0..whole.height {
                for x in 0..whole.width {
                    let turn = (f64::from(x) + 0.5) / f64::from(whole.width) * TAU - PI + heading;
                    let up = (0.5 * f64::from(whole.height) - f64::from(y) - 0.5) * TAU / f64::from(whole.width);
                    let wanted = colour(DVec3::new(libm::sin(turn), libm::cos(turn), up));
                    let at = 3 * (y * whole.width + x) as usize;
                    for (got, wanted) in whole.rgb[at..at + 3].iter().zip(wanted) {
                        let off = (f64::from(*got) - wanted).abs();
                        // The colour changes by at most 250 for each radian.
                        prop_assert!(off <= 1.5 + 0.5 * 250.0 * pixel_rad, "{off} at {x}, {y}");
                    }
                }
            }
        }

        #[test]
        fn panorama_is_as_high_as_all_views_reach(width in 8u32..900, heights in prop::array::uniform4(8u32..900)) {
            let pictures = heights.map(|height| vec![9; 3 * (width * height) as usize]);
            let views = std::array::from_fn(|side| Some(QuarterView { width, height: heights[side], rgb: &pictures[side] }));
            let whole = join_panorama(views, None, [0; 3]).unwrap();
            let lowest = f64::from(*heights.iter().min().unwrap());
            // A row on the cylinder at a seam is farther from the eye than in the middle of a view.
            let reach = |rows: f64| rows * TAU / f64::from(whole.width) * 0.5 * f64::from(width) / FRAC_1_SQRT_2;
            prop_assert!(reach(f64::from(whole.height)) <= lowest + 1e-6 || whole.height == 1);
            prop_assert!(reach(f64::from(whole.height) + 1.0) > lowest - 1e-6);
        }
    }

    #[test]
    fn panorama_shows_the_right_side_right_of_the_middle() {
        let pictures = [[10; 3], [20; 3], [30; 3], [40; 3]].map(|colour| colour.repeat(64 * 48));
        let whole = join_panorama(views(&pictures, 64, 48), Some(80), [0; 3]).unwrap();
        let column = |x: usize| whole.rgb[3 * x];
        assert_eq!([column(0), column(15), column(40), column(60), column(79)], [30, 40, 10, 20, 30]);
    }

    #[test]
    fn panorama_is_blank_only_where_a_view_is_missing() {
        let pictures = [[10; 3], [20; 3], [30; 3], [40; 3]].map(|colour| colour.repeat(64 * 48));
        let mut views = views(&pictures, 64, 48);
        views[1] = None;
        let whole = join_panorama(views, Some(80), [1, 2, 3]).unwrap();
        let blank = whole.rgb.chunks_exact(3).filter(|pixel| **pixel == [1, 2, 3]).count();
        assert_eq!(blank, 20 * whole.height as usize);
        assert_eq!(whole.rgb[3 * 50..3 * 51], [1, 2, 3]);
    }

    #[test]
    fn panorama_refuses_missing_and_torn_views() {
        assert_eq!(join_panorama([None; 4], None, [0; 3]), Err(PanoramaError::Empty));
        let short = QuarterView { width: 4, height: 4, rgb: &[0; 47] };
        assert!(matches!(join_panorama([Some(short); 4], None, [0; 3]), Err(PanoramaError::Bytes { view: 0, .. })));
        let empty = QuarterView { width: 0, height: 4, rgb: &[] };
        assert!(matches!(join_panorama([Some(empty); 4], None, [0; 3]), Err(PanoramaError::Size(_))));
        let fine = QuarterView { width: 4, height: 4, rgb: &[0; 48] };
        for width in [0, MAX_SIDE_PX + 1, u32::MAX] {
            assert!(
                matches!(join_panorama([Some(fine); 4], Some(width), [0; 3]), Err(PanoramaError::Size(_))),
                "{width}"
            );
        }
    }
}
