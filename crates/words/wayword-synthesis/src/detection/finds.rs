//! Asks the detector: the pictures of the views along a path, and where it finds each name in them.

use super::Seeker;
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::{ModelError, Observation, Path, Platform, PlatformError, Spot, View, apart};

/// Boxes that share more of what they cover together are of the same thing.
const SAME: f64 = 0.5;

/// A view of an observation's look: the number of the frame, that of the look, and what it shows.
pub(super) struct Seen {
    pub(super) frame: usize,
    pub(super) look: usize,
    pub(super) view: View,
}

/// The frame and the number of a look.
pub(super) type Place = (usize, usize);

/// The finds of one name, look by look.
pub(super) type Finds = BTreeMap<Place, Vec<Spot>>;

/// The pictures of all looks. A look without one is left out: the detector cannot have missed anything there.
pub(super) fn views(
    platform: &dyn Platform,
    path: &Path,
    observations: &[Observation],
) -> Result<Vec<Seen>, PlatformError> {
    let mut seen = Vec::new();
    for (frame, (at, observation)) in path.frames.iter().zip(observations).enumerate() {
        for (look, gaze) in observation.looks.iter().map(|look| look.gaze).enumerate() {
            let view = platform.look(&path.scene, at, gaze)?;
            seen.extend(view.image.is_some().then_some(Seen { frame, look, view }));
        }
    }
    Ok(seen)
}

/// The finds of each name.
pub(super) fn finds(seen: &[Seen], names: &[&str], seeker: Seeker<'_>) -> Result<Vec<Finds>, ModelError> {
    let views: Vec<&View> = seen.iter().map(|seen| &seen.view).collect();
    let mut found: Vec<Finds> = vec![Finds::new(); names.len()];
    let answers = seeker.detector.detect(&views, names);
    if answers.len() != views.len() {
        let model = seeker.detector.name().to_owned();
        return Err(ModelError::Failed { model, reason: "it gave no answer".to_owned() });
    }
    for (seen, answer) in seen.iter().zip(answers) {
        let width_px = seen.view.image.as_ref().map_or(0, |image| image.width_px());
        for (finds, boxes) in found.iter_mut().zip(answer?) {
            let sure = boxes.into_iter().filter(|found| found.score >= seeker.figures.found_from);
            let spots: Vec<Spot> =
                apart(sure, SAME).map(|found| Spot::new(found, width_px, seen.view.horizontal_fov_rad)).collect();
            if !spots.is_empty() {
                finds.insert((seen.frame, seen.look), spots);
            }
        }
    }
    Ok(found)
}

/// For each frame that was looked at, whether the name was found from it.
pub(super) fn frames(seen: &[Seen], finds: &Finds) -> Vec<bool> {
    let looked_at: BTreeSet<usize> = seen.iter().map(|seen| seen.frame).collect();
    looked_at.iter().map(|frame| finds.keys().any(|(of, _)| of == frame)).collect()
}
