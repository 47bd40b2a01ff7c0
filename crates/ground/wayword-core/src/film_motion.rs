//! How the camera of a film moves from picture to picture: by poses, or by an estimate from the pictures themselves.

use crate::ViewpointId;
use std::collections::BTreeMap;

/// What the motion of a film is known from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotionSource {
    /// Poses of the camera or of what carries it.
    Poses,
    /// The pictures alone. Turns are estimates, lengths and heights are not known.
    Pictures,
}

/// The motion of a camera over a film.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraMotion {
    /// What it is known from.
    pub source: MotionSource,
    /// The pictures that were looked at, by their numbers in the film, ascending.
    pub pictures: Vec<usize>,
    /// When each of these was taken, seconds.
    pub times_s: Vec<f64>,
    /// The way from each of these to the next.
    pub steps: Vec<CameraStep>,
    /// Which of these is nearest to each frame of the walk: its index in `pictures`.
    pub frames: BTreeMap<ViewpointId, usize>,
}

/// The way from a picture to the next.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CameraStep {
    /// The camera's turn, radians, positive right; `None` where it is not known.
    pub turn_rad: Option<f64>,
    /// How far it goes, metres along the ground; `None` where that is not known.
    pub length_m: Option<f64>,
    /// How far it goes up, metres; `None` where that is not known.
    pub rise_m: Option<f64>,
    /// Whether it certainly stands still.
    pub is_still: bool,
}

impl CameraMotion {
    /// How many of its pictures were looked at for each second; 1 where that is not known.
    #[must_use]
    pub fn pictures_per_s(&self) -> f64 {
        let span_s = self.times_s.last().zip(self.times_s.first()).map_or(0.0, |(last, first)| last - first);
        if span_s > 0.0 { (self.times_s.len() - 1) as f64 / span_s } else { 1.0 }
    }

    /// The turns of all steps.
    #[must_use]
    pub fn turns_rad(&self) -> Vec<Option<f64>> {
        self.steps.iter().map(|step| step.turn_rad).collect()
    }

    /// Whether the camera never moves: nine of ten known steps are still, and at least half are known.
    #[must_use]
    pub fn stands_still(&self) -> bool {
        let known = self.steps.iter().filter(|step| step.turn_rad.is_some() || step.is_still).count();
        let still = self.steps.iter().filter(|step| step.is_still).count();
        still > 0 && 2 * known >= self.steps.len() && 10 * still >= 9 * known
    }
}
