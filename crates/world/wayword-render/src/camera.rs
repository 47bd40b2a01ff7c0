//! The pinhole camera: where an eye is, in which direction it looks, and how wide its view is.

use crate::picture::{RenderError, check_finite, check_size};
use glam::{DMat3, DVec3};
use wayword_core::ViewGaze;

/// Narrowest horizontal field of view of one flat picture, radians.
const MIN_FLAT_FOV_RAD: f64 = 0.05;
/// Widest horizontal field of view of one flat picture, radians.
const MAX_FLAT_FOV_RAD: f64 = 2.6;

/// The gaze with its width limited to a field of view that one flat picture can show.
#[must_use]
pub fn to_flat_gaze(gaze: ViewGaze) -> ViewGaze {
    ViewGaze { horizontal_fov_rad: gaze.horizontal_fov_rad.clamp(MIN_FLAT_FOV_RAD, MAX_FLAT_FOV_RAD), ..gaze }
}

/// A pinhole camera without roll. Its axes in the world are forward = (sin h cos e, cos h cos e, sin e),
/// right = (cos h, -sin h, 0) and up = right x forward (Matterport3D's and the world frame's conventions).
///
/// Pixel coordinates are continuous, x to the right and y down, (0, 0) the top left corner of the picture: the centre
/// of the top left pixel is (0.5, 0.5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinholeCamera {
    /// Eye, metres, world frame.
    pub position: DVec3,
    /// 0 along +y, clockwise seen from above.
    pub heading_rad: f64,
    /// 0 at the horizon, up positive.
    pub elevation_rad: f64,
    /// Angle between the top and the bottom of the picture, in (0, pi).
    pub vertical_fov_rad: f64,
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl PinholeCamera {
    /// The camera at `position` that looks along `forward` (any length). Use it for poses given as quaternions
    /// (Habitat's): their roll is zero.
    #[must_use]
    pub fn looking_along(position: DVec3, forward: DVec3, vertical_fov_rad: f64, width: u32, height: u32) -> Self {
        let level = libm::sqrt(forward.x * forward.x + forward.y * forward.y);
        Self {
            position,
            heading_rad: libm::atan2(forward.x, forward.y),
            elevation_rad: libm::atan2(forward.z, level),
            vertical_fov_rad,
            width,
            height,
        }
    }

    /// The level camera of a gaze, for a picture of `width` and `height` pixels.
    #[must_use]
    pub fn for_level_gaze(position: DVec3, gaze: ViewGaze, [width, height]: [u32; 2]) -> Self {
        let aspect = f64::from(height) / f64::from(width.max(1));
        let vertical_fov_rad = 2.0 * libm::atan(libm::tan(gaze.horizontal_fov_rad / 2.0) * aspect);
        Self { position, heading_rad: gaze.heading.rad(), elevation_rad: 0.0, vertical_fov_rad, width, height }
    }

    /// The rotation from the camera's axes to the world's. Its columns are right, up and backward (-forward) in the world: the
    /// camera frame is GL's.
    #[must_use]
    pub fn world_from_camera(&self) -> DMat3 {
        let (sin_h, cos_h) = libm::sincos(self.heading_rad);
        let (sin_e, cos_e) = libm::sincos(self.elevation_rad);
        let forward = DVec3::new(sin_h * cos_e, cos_h * cos_e, sin_e);
        let right = DVec3::new(cos_h, -sin_h, 0.0);
        DMat3::from_cols(right, right.cross(forward), -forward)
    }

    /// The pixel position and the depth of a world point: (x_px, y_px, depth_m), depth along forward; `None` for points not in
    /// front of the eye. The position may lie outside the picture.
    #[must_use]
    pub fn project_point(&self, point: DVec3) -> Option<(f64, f64, f64)> {
        let axes = self.world_from_camera();
        let offset = point - self.position;
        let depth_m = -offset.dot(axes.z_axis);
        if depth_m <= 0.0 || depth_m.is_nan() {
            return None;
        }
        let scale = self.focal_px() / depth_m;
        let x_px = 0.5 * f64::from(self.width) + scale * offset.dot(axes.x_axis);
        let y_px = 0.5 * f64::from(self.height) - scale * offset.dot(axes.y_axis);
        Some((x_px, y_px, depth_m))
    }

    /// Unit direction in the world of the ray through a pixel position.
    #[must_use]
    pub fn ray_through(&self, x_px: f64, y_px: f64) -> DVec3 {
        let focal_px = self.focal_px();
        let right = (x_px - 0.5 * f64::from(self.width)) / focal_px;
        let up = (0.5 * f64::from(self.height) - y_px) / focal_px;
        (self.world_from_camera() * DVec3::new(right, up, -1.0)).normalize()
    }

    /// Pixels per unit of tangent, the same in both directions.
    pub(crate) fn focal_px(&self) -> f64 {
        0.5 * f64::from(self.height) / libm::tan(0.5 * self.vertical_fov_rad)
    }

    /// Refuses a camera with an unusable number: not finite, or out of range.
    pub(crate) fn check_numbers(&self) -> Result<(), RenderError> {
        check_size(self.width.into(), self.height.into())?;
        check_finite("position.x", self.position.x)?;
        check_finite("position.y", self.position.y)?;
        check_finite("position.z", self.position.z)?;
        check_finite("heading_rad", self.heading_rad)?;
        check_finite("elevation_rad", self.elevation_rad)?;
        check_fov(self.vertical_fov_rad)
    }
}

/// Refuses angles that no flat picture can have.
pub(crate) fn check_fov(value: f64) -> Result<(), RenderError> {
    // The bounds keep the tangent and its inverse within what single precision can hold.
    if (1e-4..=3.1).contains(&value) {
        return Ok(());
    }
    Err(RenderError::Number { field: "vertical_fov_rad", value, wanted: "between 0.0001 and 3.1" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn camera(heading_rad: f64, elevation_rad: f64) -> PinholeCamera {
        let position = DVec3::new(1.0, -2.0, 1.5);
        PinholeCamera { position, heading_rad, elevation_rad, vertical_fov_rad: 1.0, width: 640, height: 480 }
    }

    #[test]
    fn east_is_right_of_north() {
        let (x, y, depth) = camera(0.0, 0.0).project_point(DVec3::new(2.0, 8.0, 1.5)).unwrap();
        assert!(x > 320.0 && (y - 240.0).abs() < 1e-9 && (depth - 10.0).abs() < 1e-12);
        let (_, y, _) = camera(0.0, 0.0).project_point(DVec3::new(1.0, 8.0, 2.5)).unwrap();
        assert!(y < 240.0, "a higher point is further up in the picture");
        assert_eq!(camera(0.0, 0.0).project_point(DVec3::new(1.0, -3.0, 1.5)), None);
    }

    #[test]
    fn axes_are_a_right_handed_rotation() {
        let axes = camera(0.7, -0.4).world_from_camera();
        assert!((axes.determinant() - 1.0).abs() < 1e-12);
        assert!(axes.y_axis.z > 0.0);
    }

    #[test]
    fn check_numbers_refuses_impossible_cameras() {
        assert!(PinholeCamera { width: 0, ..camera(0.0, 0.0) }.check_numbers().is_err());
        assert!(PinholeCamera { height: MAX + 1, ..camera(0.0, 0.0) }.check_numbers().is_err());
        assert!(PinholeCamera { vertical_fov_rad: f64::NAN, ..camera(0.0, 0.0) }.check_numbers().is_err());
        assert!(camera(f64::INFINITY, 0.0).check_numbers().is_err());
        assert!(camera(0.0, 0.0).check_numbers().is_ok());
    }
    const MAX: u32 = crate::MAX_SIDE_PX;

    proptest! {
        #[test]
        fn a_point_on_a_pixels_ray_projects_to_that_pixel(
            heading in -7.0..7.0f64, elevation in -1.5..1.5f64,
            x in 0.0..640.0f64, y in 0.0..480.0f64, distance in 0.1..50.0f64,
        ) {
            let camera = camera(heading, elevation);
            let (back_x, back_y, depth) = camera.project_point(camera.position + camera.ray_through(x, y) * distance).unwrap();
            prop_assert!((back_x - x).abs() < 1e-6 && (back_y - y).abs() < 1e-6);
            prop_assert!(depth <= distance + 1e-9);
        }

        #[test]
        fn looking_along_a_cameras_forward_gives_that_camera(heading in -3.1..3.1f64, elevation in -1.5..1.5f64) {
            let camera = camera(heading, elevation);
            let forward = camera.ray_through(320.0, 240.0) * 3.0;
            let back = PinholeCamera::looking_along(camera.position, forward, 1.0, 640, 480);
            prop_assert!((back.heading_rad - heading).abs() < 1e-9);
            prop_assert!((back.elevation_rad - elevation).abs() < 1e-9);
        }
    }
}
