//! Computes the features of a step over a stretch of a walk, and of the end of a walk. A feature is a yes-or-no
//! statement such as "a step with a left turn bends 75 to 90 degrees to the left"; each has a weight.
//!
//! Left and right share their weights: a right turn counts like a left turn in the mirror.

mod ending;
mod places;
mod stretch;
pub(crate) mod tables;

pub(crate) use ending::ending_features;
pub(crate) use stretch::{MAX_STEP_HOPS, WalkStretch};

use crate::guide::GuideTrial;

/// The number of a feature, by which its weight is found.
pub(crate) type FeatureNumber = u32;

/// Adds to `found` the numbers of the features that hold for a step of the text over a stretch.
pub(crate) fn stretch_features(
    trial: &GuideTrial<'_>,
    step: usize,
    stretch: &WalkStretch<'_>,
    found: &mut Vec<FeatureNumber>,
) {
    stretch::motion_features(trial, step, stretch, found);
    places::place_features(trial, step, stretch, found);
}

/// Which of twelve classes of 30 degrees an angle (radians) falls into, half of them negative.
fn angle_twelfth(rad: f64) -> usize {
    angle_class(rad) / 2
}

/// Which of 24 classes of 15 degrees an angle (radians) falls into, half of them negative.
fn angle_class(rad: f64) -> usize {
    ((rad.to_degrees() + 180.0) / 15.0).floor().rem_euclid(24.0) as usize
}

/// Which class a value falls into: the number of limits that it reaches.
pub(crate) fn limit_class(value: f64, limits: &[f64]) -> usize {
    limits.iter().filter(|limit| value >= **limit).count()
}

#[cfg(test)]
mod tests;
