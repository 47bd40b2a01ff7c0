//! A camera that is pitched up or down, or rolled.

mod resample;

use super::{WorldAlteration, altered_platform::AlteredLook};
use resample::{TiltWarp, UNREACHED_GREY_LEVEL};
use std::sync::Arc;
use wayword_core::{
    DMat3, DVec3, DepthImage, Frame, GroundTruth, Image, ObjectLabel, PlatformError, SceneId, View, ViewGaze,
};

/// Largest pitch of a camera, up or down, degrees.
const MAX_PITCH_DEG: f64 = 30.0;
/// Largest roll of a camera, to either side, degrees.
const MAX_ROLL_DEG: f64 = 45.0;

/// The widest level view that is requested, radians. Platforms cannot render wider ones.
const MAX_LEVEL_VIEW_RAD: f64 = 2.6;

/// Height over width of the pictures of all platforms that render. It is needed to choose the width of the level view before the
/// picture exists. If a picture has another shape, its corners may be grey.
const PICTURE_ASPECT_RATIO: f64 = 0.75;

/// A tilted pinhole camera. Its picture is resampled from a wider level view by the homography of the rotation, so it is exact except
/// for its sharpness. Parts that the wider view does not cover are grey.
///
/// A label is kept if the centre of its box lies within the tilted view's width, and part of the box in the picture. Without a box,
/// its direction has to lie within the height too. The wider view shows things smaller, so a thing that is barely large enough for a
/// label may lose it. A tilted view has no depth.
///
/// A [`FieldOfView`](super::FieldOfView) wraps it from outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraTilt {
    pitch_rad: f64,
    roll_rad: f64,
}

/// A tilt that is too large.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum TiltError {
    /// Too far up or down.
    #[error("a pitch of {0} degrees is not between -30 and 30: a level view does not reach so far")]
    Pitch(f64),
    /// Rolled too far.
    #[error("a roll of {0} degrees is not between -45 and 45")]
    Roll(f64),
}

impl CameraTilt {
    /// A camera that looks up by `pitch_deg` degrees and is then rolled clockwise by `roll_deg` degrees around the
    /// direction in which it looks.
    ///
    /// # Errors
    /// When the pitch is more than 30 degrees or the roll more than 45, in either direction, or one is no finite
    /// number.
    pub fn new(pitch_deg: f64, roll_deg: f64) -> Result<Self, TiltError> {
        let within = |deg: f64, limit: f64| (-limit..=limit).contains(&deg);
        if !within(pitch_deg, MAX_PITCH_DEG) {
            return Err(TiltError::Pitch(pitch_deg));
        }
        if !within(roll_deg, MAX_ROLL_DEG) {
            return Err(TiltError::Roll(roll_deg));
        }
        Ok(Self { pitch_rad: pitch_deg.to_radians(), roll_rad: roll_deg.to_radians() })
    }

    /// The rotation from the tilted camera's frame to that of the level one. Both are right, up, backward.
    fn level_from_tilted(self) -> DMat3 {
        let (sin_p, cos_p) = libm::sincos(self.pitch_rad);
        let (sin_r, cos_r) = libm::sincos(self.roll_rad);
        let pitch = DMat3::from_cols(DVec3::X, DVec3::new(0.0, cos_p, sin_p), DVec3::new(0.0, -sin_p, cos_p));
        let roll = DMat3::from_cols(DVec3::new(cos_r, -sin_r, 0.0), DVec3::new(sin_r, cos_r, 0.0), DVec3::Z);
        pitch * roll
    }

    fn is_level(self) -> bool {
        self.pitch_rad == 0.0 && self.roll_rad == 0.0
    }

    /// Width of the level view that covers a tilted one, radians, at most the widest possible.
    fn covering_rad(self, fov_rad: f64) -> f64 {
        if self.is_level() {
            return fov_rad;
        }
        let half = libm::tan(fov_rad.min(MAX_LEVEL_VIEW_RAD) / 2.0);
        let level_from_tilted = self.level_from_tilted();
        // The level view has to reach each corner of the tilted picture: tangent of half the width that this needs.
        let mut reach = half;
        for (right, up) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let ray = level_from_tilted * DVec3::new(right * half, up * half * PICTURE_ASPECT_RATIO, -1.0);
            let ahead = (-ray.z).max(1e-6);
            reach = reach.max(ray.x.abs() / ahead).max(ray.y.abs() / ahead / PICTURE_ASPECT_RATIO);
        }
        (2.0 * libm::atan(reach)).min(MAX_LEVEL_VIEW_RAD)
    }
}

impl WorldAlteration for CameraTilt {
    fn look_before(&self, _: &SceneId, from: &Frame, gaze: ViewGaze) -> (Frame, ViewGaze) {
        (from.clone(), ViewGaze { horizontal_fov_rad: self.covering_rad(gaze.horizontal_fov_rad), ..gaze })
    }

    fn view_after(&self, look: AlteredLook<'_>, before: View) -> Result<View, PlatformError> {
        if self.is_level() {
            return Ok(before);
        }
        let fov_rad = look.gaze.horizontal_fov_rad.min(before.horizontal_fov_rad);
        let size = before.image.as_ref().map(|image| [f64::from(image.width_px()), f64::from(image.height_px())]);
        let warp = TiltWarp {
            level_from_tilted: self.level_from_tilted(),
            level_tan: libm::tan(before.horizontal_fov_rad / 2.0),
            tilted_tan: libm::tan(fov_rad / 2.0),
            size: size.unwrap_or([1.0, PICTURE_ASPECT_RATIO]),
        };
        let tilted = |label: ObjectLabel| warp.tilt_label(label, look.gaze.heading, size.is_some());
        let truth = before
            .ground_truth()
            .cloned()
            .map(|truth| GroundTruth { labels: truth.labels.into_iter().filter_map(tilted).collect(), ..truth });
        let image = before.image.as_deref().map(|image| redraw_tilted(&warp, image)).map(Arc::new);
        let mut pose = before.pose;
        pose.elevation_rad += self.pitch_rad;
        Ok(View::new(pose, fov_rad, image, truth))
    }

    fn depth_after(&self, before: DepthImage) -> Option<DepthImage> {
        self.is_level().then_some(before)
    }
}

/// Resamples the tilted camera's picture, in the size of the level one.
fn redraw_tilted(warp: &TiltWarp, level: &Image) -> Image {
    let mut rgb = Vec::with_capacity(level.rgb_bytes().len());
    for y in 0..level.height_px() {
        for x in 0..level.width_px() {
            let place = warp.level_px([f64::from(x) + 0.5, f64::from(y) + 0.5]);
            rgb.extend(place.map_or([UNREACHED_GREY_LEVEL; 3], |place| resample::sample_bilinear(level, place)));
        }
    }
    Image::new(level.width_px(), level.height_px(), rgb).unwrap_or_else(|_| level.clone())
}

#[cfg(test)]
mod tests;
