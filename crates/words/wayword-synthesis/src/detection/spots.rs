//! Runs the detector on the views along a path and collects where it found each name.
//!
//! A look is one view of a frame with its caption; a frame of a panorama has four looks.

use super::CaptionDetector;
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::{
    DetectionSpot, FrameObservation, ModelError, Path, Platform, PlatformError, View, ViewGaze, without_overlaps,
};

/// Two boxes are taken for the same thing if their overlap is more than this share of their union.
const SAME_THING_OVERLAP_SHARE: f64 = 0.5;

/// The view of one look of an observation, with the numbers of its frame and look.
pub(super) struct LookPicture {
    pub(super) frame: usize,
    pub(super) look: usize,
    pub(super) view: View,
}

/// The path along which views were seen, and the platform that showed them.
#[derive(Clone, Copy)]
pub(super) struct PlatformPath<'a> {
    pub(super) platform: &'a dyn Platform,
    pub(super) path: &'a Path,
}

/// A look of a path: the number of its frame, and its own number within the frame.
pub(super) type LookIndex = (usize, usize);

/// The boxes that were found for one name, by look.
pub(super) type LookSpots = BTreeMap<LookIndex, Vec<DetectionSpot>>;

/// The views of all looks that have a picture. A look without a picture is left out, because the detector cannot have
/// missed anything there.
pub(super) fn look_views(
    platform: &dyn Platform,
    path: &Path,
    observations: &[FrameObservation],
) -> Result<Vec<LookPicture>, PlatformError> {
    let mut pictures = Vec::new();
    for (frame, (at, observation)) in path.frames.iter().zip(observations).enumerate() {
        for (look, gaze) in observation.looks.iter().map(|look| look.gaze).enumerate() {
            let view = platform.look_from(&path.scene, at, gaze)?;
            pictures.extend(view.image.is_some().then_some(LookPicture { frame, look, view }));
        }
    }
    Ok(pictures)
}

/// Runs the detector once over all views and returns, for each name, the boxes that pass its score threshold.
pub(super) fn find_spots(
    seen: &[LookPicture],
    names: &[&str],
    seeker: CaptionDetector<'_>,
) -> Result<Vec<LookSpots>, ModelError> {
    let views: Vec<&View> = seen.iter().map(|seen| &seen.view).collect();
    let mut spots_by_name: Vec<LookSpots> = vec![LookSpots::new(); names.len()];
    let answers = seeker.detector.detect_phrases(&views, names);
    if answers.len() != views.len() {
        let model = seeker.detector.name().to_owned();
        return Err(ModelError::Failed { model, reason: "it gave no answer".to_owned() });
    }
    for (seen, answer) in seen.iter().zip(answers) {
        let width_px = seen.view.image.as_ref().map_or(0, |image| image.width_px());
        for (finds, boxes) in spots_by_name.iter_mut().zip(answer?) {
            let sure = boxes.into_iter().filter(|found| found.score >= seeker.figures.found_from);
            let spots: Vec<DetectionSpot> = without_overlaps(sure, SAME_THING_OVERLAP_SHARE)
                .map(|found| DetectionSpot::new(found, width_px, seen.view.horizontal_fov_rad))
                .collect();
            if !spots.is_empty() {
                finds.insert((seen.frame, seen.look), spots);
            }
        }
    }
    Ok(spots_by_name)
}

/// Fills in the distance of each find, metres, where the platform has depth. Depth is asked for once per view, and only
/// for views with finds.
pub(super) fn measure_distances(
    walk: PlatformPath<'_>,
    seen: &[LookPicture],
    finds: &mut [LookSpots],
) -> Result<(), PlatformError> {
    for LookPicture { frame, look, view } in seen {
        let place = (*frame, *look);
        let size_px = view.image.as_ref().map_or([0; 2], |image| [image.width_px(), image.height_px()]);
        let is_found = finds.iter().any(|finds| finds.contains_key(&place));
        if !is_found || size_px.contains(&0) {
            continue;
        }
        let gaze = ViewGaze { heading: view.pose.heading, horizontal_fov_rad: view.horizontal_fov_rad };
        let from = &walk.path.frames[*frame];
        let Some(depth) = walk.platform.ground().view_depth(&walk.path.scene, from, gaze)? else { continue };
        let [width, height] = size_px.map(f64::from);
        for spot in finds.iter_mut().filter_map(|finds| finds.get_mut(&place)).flatten() {
            let [left, top, right, bottom] = spot.found.box_px.map(f64::from);
            let edges = [left / width, top / height, right / width, bottom / height];
            spot.distance_m = depth.level_m(edges, view.horizontal_fov_rad);
        }
    }
    Ok(())
}

/// For each frame with a look that has a picture, in order: whether the name was found from it.
pub(super) fn found_by_frame(seen: &[LookPicture], finds: &LookSpots) -> Vec<bool> {
    let looked_at: BTreeSet<usize> = seen.iter().map(|seen| seen.frame).collect();
    looked_at.iter().map(|frame| finds.keys().any(|(found_from, _)| found_from == frame)).collect()
}
