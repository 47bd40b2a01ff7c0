//! Corrects captions with a detector: it looks for names in the views along a path, and its finds and misses change the
//! captions.
//!
//! A name that the detector finds counts as seen and gets its box. A name that a caption gave and the detector missed
//! becomes doubtful or is denied, depending on how often the detector misses real things ([`DetectorFigures`]). A name
//! that was only proposed and not found leaves no trace.

mod corrections;
mod nouns;
mod spots;

pub use nouns::{parse_noun_list, usual_nouns};

use crate::observe::{ObserveError, gazes_around};
use corrections::{DetectionPurpose, apply_detections};
use spots::{LookPicture, PlatformPath, look_views};
use std::collections::{BTreeMap, BTreeSet};
use wayword_checks::detection::DetectorFigures;
use wayword_core::{
    Caption, CaptionedView, FrameObservation, ObjectDetector, ObjectSighting, Path, Platform, View, ViewGaze,
    WitnessAnswer,
};
use wayword_language::lexicon::{find_thing, normalise_name};

/// A detector, its measured reliability, and the names that it looks for on its own.
#[derive(Clone, Copy)]
pub struct CaptionDetector<'a> {
    /// The detector itself.
    pub detector: &'a dyn ObjectDetector,
    /// How often its finds and misses are right.
    pub figures: &'a DetectorFigures,
    /// Names that it looks for in every view, even where no caption mentions them.
    pub nouns: &'a [String],
}

/// Probability that a thing is there before the detector looks, where a caption names it for sure.
const NAMED_PRIOR: f64 = 0.7;
/// The same where a caption guesses it, or where a text claims it.
const CLAIMED_PRIOR: f64 = 0.5;
/// The same where it is only a proposal from a list.
const PROPOSED_PRIOR: f64 = 0.01;

/// The names to look for, each with the probability that the thing is there before the detector looks.
type NamePriors = BTreeMap<String, f64>;

/// Looks for the names that captions mention and for the proposed ones in every captioned view, and corrects the
/// captions. Returns the number of views that the detector looked at.
///
/// # Errors
/// When a view cannot be had, or the detector fails.
pub fn seek_along_path(
    platform: &dyn Platform,
    path: &Path,
    observations: &mut [FrameObservation],
    seeker: CaptionDetector<'_>,
) -> Result<usize, ObserveError> {
    let seen = look_views(platform, path, observations)?;
    correct_captions(&seen, Some(PlatformPath { platform, path }), observations, seeker)
}

/// Like [`seek_along_path`], for the caption of a single view.
///
/// # Errors
/// When the view has no picture, or the detector fails.
pub fn seek_in_view(view: &View, caption: Caption, seeker: CaptionDetector<'_>) -> Result<Caption, ObserveError> {
    let gaze = ViewGaze { heading: view.pose.heading, horizontal_fov_rad: view.horizontal_fov_rad };
    let mut observation =
        FrameObservation { looks: vec![CaptionedView { gaze, caption }], ..FrameObservation::default() };
    let seen = view.image.is_some().then(|| LookPicture { frame: 0, look: 0, view: view.clone() });
    correct_captions(seen.as_slice(), None, std::slice::from_mut(&mut observation), seeker)?;
    Ok(observation.looks.pop().map(|look| look.caption).unwrap_or_default())
}

/// Gathers the names to look for, and corrects the captions by the finds and misses for them. Returns the number of
/// views that the detector looked at. `walk` is `None` for a single view without a path.
fn correct_captions(
    seen: &[LookPicture],
    walk: Option<PlatformPath<'_>>,
    observations: &mut [FrameObservation],
    seeker: CaptionDetector<'_>,
) -> Result<usize, ObserveError> {
    let mut wanted: NamePriors = seeker.nouns.iter().map(|noun| (normalise_name(noun), PROPOSED_PRIOR)).collect();
    wanted.extend(caption_name_priors(observations));
    apply_detections((seen, walk), observations, seeker, &wanted, DetectionPurpose::Captions)?;
    Ok(if wanted.is_empty() { 0 } else { seen.len() })
}

/// Looks all around each frame of a path for the things that texts claim, where no captions exist. The observations
/// that it returns have captions without words, only with sightings.
///
/// # Errors
/// When a view cannot be had, or the detector fails.
pub fn seek_claims(
    platform: &dyn Platform,
    path: &Path,
    claims: &BTreeSet<String>,
    seeker: CaptionDetector<'_>,
) -> Result<Vec<FrameObservation>, ObserveError> {
    let look = |gaze| CaptionedView { gaze, caption: Caption::default() };
    let around = |frame| FrameObservation {
        looks: gazes_around(path, frame).into_iter().map(look).collect(),
        ..FrameObservation::default()
    };
    let mut observations: Vec<FrameObservation> = path.frames.iter().map(around).collect();
    let wanted = claims.iter().map(|claim| (normalise_name(claim), CLAIMED_PRIOR)).collect();
    let seen = look_views(platform, path, &observations)?;
    let walk = Some(PlatformPath { platform, path });
    apply_detections((&seen, walk), &mut observations, seeker, &wanted, DetectionPurpose::Claims)?;
    Ok(observations)
}

/// The detector's own evidence: captions without words, with only the sightings that it found, denied or left unsure.
#[must_use]
pub fn detector_evidence(observations: &[FrameObservation], detector: &str) -> Vec<FrameObservation> {
    let is_from_detector = |sighting: &&ObjectSighting| sighting.spot.is_some() || sighting.by == detector;
    let look = |look: &CaptionedView| {
        let sightings = look.caption.sightings.iter().filter(is_from_detector).cloned().collect();
        CaptionedView { gaze: look.gaze, caption: Caption { sightings, ..Caption::default() } }
    };
    let observation = |seen: &FrameObservation| FrameObservation {
        looks: seen.looks.iter().map(look).collect(),
        ..FrameObservation::default()
    };
    observations.iter().map(observation).collect()
}

/// The names in the captions that the lexicon has, with their prior probability.
fn caption_name_priors(observations: &[FrameObservation]) -> NamePriors {
    let mut wanted = NamePriors::new();
    let captions = observations.iter().flat_map(|seen| &seen.looks).map(|look| &look.caption);
    for sighting in captions.flat_map(|caption| &caption.sightings) {
        let prior = match sighting.witness {
            WitnessAnswer::Seen => NAMED_PRIOR,
            WitnessAnswer::Unsure => CLAIMED_PRIOR,
            WitnessAnswer::Denied => continue,
        };
        if find_thing(&sighting.name).is_some() {
            let highest = wanted.entry(normalise_name(&sighting.name)).or_insert(prior);
            *highest = highest.max(prior);
        }
    }
    wanted
}

#[cfg(test)]
mod tests;
