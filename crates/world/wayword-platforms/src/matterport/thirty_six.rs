//! Makes views from a panorama in the form of the simulator's 36 pictures: `VIEWPOINT/0.jpg` to `35.jpg`.
//!
//! The pictures look in 12 directions at 3 elevations each. A pixel of a view is taken from the picture that looks most
//! nearly in the pixel's direction.

use super::{boxes::SIMULATOR_VIEW_COUNT, file_reading};
use glam::{DVec2, DVec3, UVec2};
use rayon::prelude::*;
use std::{f64::consts::FRAC_PI_6, path::Path};
use wayword_core::{Image, PlatformError, ViewGaze};

const VIEWS_HINT: &str = "render the views again, all of the same size and with a vertical field of view of 60 degrees";
/// Half of the pictures' vertical field of view.
const HALF_FOV_RAD: f64 = FRAC_PI_6;
/// Elevations at which the pictures look: -30, 0 and 30 degrees.
const VIEW_ROWS: usize = 3;
/// Headings at which the pictures look, 30 degrees apart.
const VIEW_COLUMNS: usize = 12;
/// Most pixels of one view; 36 views are in memory at a time.
const MAX_PIXELS: u64 = 1280 * 960;

/// The pictures of a panorama, by view index: rows at -30, 0 and 30 degrees of elevation, columns every 30 degrees.
pub(crate) struct ThirtySixViews {
    views: Vec<Image>,
}

/// Where a ray meets a view: its component along the view's axis, and the pixel (continuous, from the top left corner).
struct ViewHit {
    along: f64,
    x_px: f64,
    y_px: f64,
}

impl ThirtySixViews {
    /// Reads the views of a folder.
    ///
    /// # Errors
    /// If a view is missing or broken, or the views differ in size.
    pub(crate) fn read_views(folder: &Path) -> Result<Self, PlatformError> {
        let mut views: Vec<Image> = Vec::with_capacity(SIMULATOR_VIEW_COUNT);
        for index in 0..SIMULATOR_VIEW_COUNT {
            let file = folder.join(format!("{index}.jpg"));
            let view = file_reading::read_picture(&file)?;
            let size = (view.width_px(), view.height_px());
            if u64::from(size.0) * u64::from(size.1) > MAX_PIXELS {
                return Err(file_reading::file_error(
                    &file,
                    format!("has {} x {} pixels, more than 1280 x 960", size.0, size.1),
                    VIEWS_HINT,
                ));
            }
            if views.first().is_some_and(|first| (first.width_px(), first.height_px()) != size) {
                return Err(file_reading::file_error(
                    &file,
                    format!("has {} x {} pixels, but 0.jpg has another size", size.0, size.1),
                    VIEWS_HINT,
                ));
            }
            views.push(view);
        }
        Ok(Self { views })
    }

    /// The view along a gaze: RGB, from the top left. Each pixel comes from the picture with the nearest axis, with bilinear
    /// interpolation.
    pub(crate) fn sample_gaze(&self, gaze: ViewGaze, width: u32, height: u32) -> Vec<u8> {
        // The distance between two pixels on the image plane at distance 1.
        let pixel = 2.0 * libm::tan(gaze.horizontal_fov_rad / 2.0) / f64::from(width);
        let columns: Vec<(usize, f64, f64)> = (0..width)
            .map(|x| nearest_column(gaze.heading.rad(), (f64::from(x) + 0.5 - f64::from(width) / 2.0) * pixel))
            .collect();
        let mut rgb = vec![0; 3 * width as usize * height as usize];
        rgb.par_chunks_exact_mut(3 * width as usize).enumerate().for_each(|(y, row)| {
            let up = (f64::from(height) / 2.0 - (y as f64 + 0.5)) * pixel;
            for (out, (column, right, ahead)) in row.chunks_exact_mut(3).zip(&columns) {
                out.copy_from_slice(&self.colour_along(*column, *right, *ahead, up));
            }
        });
        rgb
    }

    /// The colour along a ray, given as (right, ahead, up) in a column's axes, from the row with the nearest axis.
    fn colour_along(&self, column: usize, right: f64, ahead: f64, up: f64) -> [u8; 3] {
        let rows = self.views.iter().skip(column).step_by(VIEW_COLUMNS).zip(ROW_TILTS_SIN_COS);
        let hits = rows.map(|(view, tilt)| (view, ViewHit::in_view(view, tilt, right, ahead, up)));
        let nearest = hits.reduce(|best, hit| if hit.1.along > best.1.along { hit } else { best });
        nearest.map_or([0; 3], |(view, hit)| sample_bilinear(view, hit.x_px, hit.y_px))
    }
}

impl ViewHit {
    /// Where a ray, given as (right, ahead, up) in the axes of a view's column, meets the view, which has this sine and cosine
    /// of its elevation.
    fn in_view(view: &Image, (sin, cos): (f64, f64), right: f64, ahead: f64, up: f64) -> Self {
        let (along, above) = (ahead * cos + up * sin, up * cos - ahead * sin);
        let (width, height) = (f64::from(view.width_px()), f64::from(view.height_px()));
        let focal_px = height / 2.0 / libm::tan(HALF_FOV_RAD);
        Self { along, x_px: width / 2.0 + focal_px * right / along, y_px: height / 2.0 - focal_px * above / along }
    }
}

/// Sine and cosine of the rows' elevations: -30, 0 and 30 degrees.
const ROW_TILTS_SIN_COS: [(f64, f64); VIEW_ROWS] = [(-0.5, COS_30), (0.0, 1.0), (0.5, COS_30)];
const COS_30: f64 = 0.866_025_403_784_438_6;

/// The column with the axis nearest to a direction. The direction lies at the tangent `off` to the right of a heading. The
/// other two numbers are the components of the ray (off, 1) to the right of that axis and along it.
fn nearest_column(heading_rad: f64, off: f64) -> (usize, f64, f64) {
    let steps = libm::round((heading_rad + libm::atan(off)) / FRAC_PI_6);
    let turn = heading_rad - steps * FRAC_PI_6;
    let (sin, cos) = (libm::sin(turn), libm::cos(turn));
    let around = steps.rem_euclid(VIEW_COLUMNS as f64);
    // The remainder is rounded, and can be a whole turn, which is column 0 again.
    let column = (0..VIEW_COLUMNS).find(|column| *column as f64 == around).unwrap_or(0);
    (column, sin + cos * off, cos - sin * off)
}

/// Bilinear interpolation between pixel centres, clamped at the edges.
fn sample_bilinear(picture: &Image, x_px: f64, y_px: f64) -> [u8; 3] {
    let last = UVec2::new(picture.width_px(), picture.height_px()).saturating_sub(UVec2::ONE);
    let place = (DVec2::new(x_px, y_px) - 0.5).clamp(DVec2::ZERO, last.as_dvec2());
    let low = place.as_uvec2();
    let high = (low + 1).min(last);
    let DVec2 { x: across, y: down } = place - low.as_dvec2();
    let pixels = picture.rgb_bytes().as_chunks::<3>().0;
    let at = |x: u32, y: u32| {
        let index = y as usize * picture.width_px() as usize + x as usize;
        DVec3::from_array(pixels.get(index).copied().unwrap_or_default().map(f64::from))
    };
    let top = at(low.x, low.y) * (1.0 - across) + at(high.x, low.y) * across;
    let bottom = at(low.x, high.y) * (1.0 - across) + at(high.x, high.y) * across;
    (top * (1.0 - down) + bottom * down + 0.5).as_u8vec3().to_array()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::FRAC_PI_3;
    use wayword_core::Heading;

    const WIDTH: u32 = 80;
    const HEIGHT: u32 = 60;
    /// Horizontal field of view of a 4:3 view that is 60 degrees high.
    fn own_fov_rad() -> f64 {
        2.0 * (FRAC_PI_6.tan() * 4.0 / 3.0).atan()
    }

    /// A world with colours that are a smooth function of the direction.
    fn world_colour(heading: f64, elevation: f64) -> [u8; 3] {
        let wave = |angle: f64| (127.5 + 110.0 * angle.sin()) as u8;
        [wave(heading), wave(heading + FRAC_PI_3), wave(2.0 * elevation)]
    }

    fn drawn(heading: f64, elevation: f64) -> Image {
        let focal = f64::from(HEIGHT) / 2.0 / HALF_FOV_RAD.tan();
        let mut rgb = Vec::new();
        for y in 0..HEIGHT {
            for x in 0..WIDTH {
                let right = (f64::from(x) + 0.5 - f64::from(WIDTH) / 2.0) / focal;
                let up = (f64::from(HEIGHT) / 2.0 - f64::from(y) - 0.5) / focal;
                let (ahead, above) = (elevation.cos() - up * elevation.sin(), elevation.sin() + up * elevation.cos());
                rgb.extend(world_colour(heading + right.atan2(ahead), above.atan2(right.hypot(ahead))));
            }
        }
        Image::new(WIDTH, HEIGHT, rgb).unwrap()
    }

    fn panorama() -> ThirtySixViews {
        let view = |index: usize| drawn((index % 12) as f64 * FRAC_PI_6, ((index / 12) as f64 - 1.0) * FRAC_PI_6);
        ThirtySixViews { views: (0..SIMULATOR_VIEW_COUNT).map(view).collect() }
    }

    #[test]
    fn along_a_views_own_axis_its_middle_comes_back_unchanged() {
        let panorama = panorama();
        for step in 0..12 {
            let heading = Heading::new(f64::from(step) * FRAC_PI_6).unwrap();
            let rgb = panorama.sample_gaze(ViewGaze { heading, horizontal_fov_rad: own_fov_rad() }, WIDTH, HEIGHT);
            let own = panorama.views[12 + step as usize].rgb_bytes();
            let middle = 3 * ((HEIGHT / 2) * WIDTH + WIDTH / 2) as usize;
            assert_eq!(rgb[middle..middle + 3], own[middle..middle + 3]);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn every_gaze_shows_the_world_without_seams(heading in 0.0..std::f64::consts::TAU) {
            let heading = Heading::new(heading).unwrap();
            let rgb = panorama().sample_gaze(ViewGaze::quarter_view(heading), WIDTH, HEIGHT);
            for (index, pixel) in rgb.chunks_exact(3).enumerate() {
                let (x, y) = ((index as u32 % WIDTH) as f64 + 0.5, (index as u32 / WIDTH) as f64 + 0.5);
                let pixel_size = 2.0 / f64::from(WIDTH);
                let right = (x - f64::from(WIDTH) / 2.0) * pixel_size;
                let up = (f64::from(HEIGHT) / 2.0 - y) * pixel_size;
                let expected = world_colour(heading.rad() + right.atan(), up.atan2(right.hypot(1.0)));
                for (shown, expected) in pixel.iter().zip(expected) {
                    prop_assert!(shown.abs_diff(expected) <= 3, "pixel {index}: {shown} for {expected}");
                }
            }
        }
    }
}
