//! Takes the pictures of a film one by one, and keeps only the last two.

use super::{
    pair::{MOST_STILL, PicturePairMotion, motion_between},
    panorama::{PanoramaLens, PicturePanorama},
};
use wayword_core::{CameraStep, Image};

/// Largest turn of a pair that is known only from the pictures around it, radians.
const MOST_BRIDGED_RAD: f64 = 0.45;

/// The motion of a film up to the last picture that was added.
pub(super) struct FilmFollower {
    lens: PanoramaLens,
    before: Option<PicturePanorama>,
    last: Option<PicturePanorama>,
    motions: Vec<PicturePairMotion>,
}

impl FilmFollower {
    /// For a level camera of this horizontal field of view, radians.
    pub(super) fn new(horizontal_fov_rad: f64) -> Self {
        Self { lens: PanoramaLens::with_fov(horizontal_fov_rad), before: None, last: None, motions: Vec::new() }
    }

    /// Adds the next picture.
    pub(super) fn add_picture(&mut self, picture: &Image) {
        let next = PicturePanorama::unroll(picture, self.lens);
        if let Some(last) = &self.last {
            self.motions.push(motion_between(last, &next));
            if let Some(before) = &self.before {
                bridge(&mut self.motions, before, &next);
            }
        }
        self.before = self.last.replace(next);
    }

    /// The way from each picture to the next.
    pub(super) fn into_steps(self) -> Vec<CameraStep> {
        let step = |motion: PicturePairMotion| CameraStep {
            turn_rad: motion.yaw_rad,
            is_still: motion.is_still,
            ..CameraStep::default()
        };
        self.motions.into_iter().map(step).collect()
    }
}

/// Makes up for a bad picture: where one of the last two pairs is undecided, the pictures before and after the middle one may tell. Of
/// two undecided pairs each gets half.
fn bridge(motions: &mut [PicturePairMotion], before: &PicturePanorama, next: &PicturePanorama) {
    let [.., first, second] = motions else { return };
    if first.yaw_rad.is_some() && second.yaw_rad.is_some() {
        return;
    }
    // Where much has not moved, something passes before the camera, and does so for the longer too.
    if first.scores.still.max(second.scores.still) >= MOST_STILL.0 {
        return;
    }
    let Some(both_rad) = motion_between(before, next).yaw_rad else { return };
    let (first_rad, second_rad) = match (first.yaw_rad, second.yaw_rad) {
        (Some(known), _) => (known, both_rad - known),
        (None, Some(known)) => (both_rad - known, known),
        (None, None) => (both_rad / 2.0, both_rad / 2.0),
    };
    if first_rad.abs().max(second_rad.abs()) > MOST_BRIDGED_RAD {
        return;
    }
    (first.yaw_rad, second.yaw_rad) = (Some(first_rad), Some(second_rad));
}
