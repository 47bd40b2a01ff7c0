//! Finds the objects that are visible enough in a picture for a person to name them.

use crate::{PinholeCamera, RenderedPicture, VisibleObject, visible_objects};
use glam::DVec3;
use std::cmp::Reverse;

/// An id must cover at least this share of the picture's pixels: at 640 x 480, a patch of 21 x 21.
const MIN_PICTURE_SHARE: f64 = 0.0015;
/// The box of its pixels must cover at least this share of the object's own box, as far as that lies within the
/// picture.
const MIN_SHOWN_SHARE: f64 = 0.22;

/// The ids on enough pixels to be named, the largest first.
#[must_use]
pub fn evident_objects(picture: &RenderedPicture) -> Vec<VisibleObject> {
    let least = f64::from(picture.width) * f64::from(picture.height) * MIN_PICTURE_SHARE;
    let mut seen: Vec<VisibleObject> =
        visible_objects(picture).into_iter().filter(|each| f64::from(each.pixels) >= least).collect();
    seen.sort_by_key(|each| (Reverse(each.pixels), each.id));
    seen
}

impl VisibleObject {
    /// Whether only a sliver of an object is visible. `corners` are those of the object's box (metres, world frame). An object
    /// that reaches behind the eye never counts as a sliver, because its box cannot be projected.
    #[must_use]
    pub fn is_sliver(&self, camera: &PinholeCamera, corners: &[DVec3; 8]) -> bool {
        self.shown_share(camera, corners).is_some_and(|share| share < MIN_SHOWN_SHARE)
    }

    /// Share of a box, as far as it lies in the picture, that the box of the visible pixels covers.
    fn shown_share(&self, camera: &PinholeCamera, corners: &[DVec3; 8]) -> Option<f64> {
        let corners = corners.iter().map(|corner| camera.project_point(*corner)).collect::<Option<Vec<_>>>()?;
        let side = |value: fn(&(f64, f64, f64)) -> f64, end: u32| {
            let values = corners.iter().map(value);
            let (low, high) =
                values.fold((f64::INFINITY, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
            (high.min(f64::from(end)) - low.max(0.0)).max(1.0)
        };
        let (width, height) = (side(|corner| corner.0, camera.width), side(|corner| corner.1, camera.height));
        Some(f64::from(self.bbox[2]) * f64::from(self.bbox[3]) / (width * height))
    }
}

/// The corners of a box along the axes.
#[must_use]
pub fn box_corners(low: DVec3, high: DVec3) -> [DVec3; 8] {
    std::array::from_fn(|n| {
        DVec3::new([low.x, high.x][n & 1], [low.y, high.y][n >> 1 & 1], [low.z, high.z][n >> 2 & 1])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks a box half a metre wide, `ahead_m` metres ahead, with pixels in `columns` of 160 columns.
    fn is_sliver(ahead_m: f64, columns: u32) -> bool {
        let camera = PinholeCamera {
            position: DVec3::ZERO,
            heading_rad: 0.0,
            elevation_rad: 0.0,
            vertical_fov_rad: 2.0 * libm::atan(0.75),
            width: 160,
            height: 120,
        };
        let (centre, half) = (DVec3::Y * ahead_m, DVec3::splat(0.25));
        let seen = VisibleObject { id: 5, pixels: columns * 20, bbox: [70, 50, columns, 20] };
        seen.is_sliver(&camera, &box_corners(centre - half, centre + half))
    }

    #[test]
    fn is_sliver_needs_a_small_share_of_a_box_before_the_eye() {
        assert!(!is_sliver(2.0, 20) && is_sliver(2.0, 4));
        assert!(!is_sliver(0.1, 4));
    }

    #[test]
    fn evident_objects_skips_small_patches_and_sorts_by_size() {
        // 0.0015 of 40 x 50 pixels are three.
        let ids: Vec<u32> = (0..2000).map(|n| [7, 7, 0, 8, 8, 8, 0, 9, 9, 9, 9].get(n).copied().unwrap_or(0)).collect();
        let picture = RenderedPicture { width: 40, height: 50, rgb: Vec::new(), depth_m: vec![1.0; 2000], ids };
        let found: Vec<u32> = evident_objects(&picture).iter().map(|seen| seen.id).collect();
        assert_eq!(found, [9, 8]);
    }
}
