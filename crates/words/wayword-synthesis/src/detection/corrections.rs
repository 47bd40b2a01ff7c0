//! Applies the detector's finds and misses to captions and claims: each name becomes seen, denied or unsure.

use super::{
    CaptionDetector, NamePriors, PROPOSED_PRIOR,
    spots::{LookIndex, LookPicture, LookSpots, PlatformPath, find_spots, found_by_frame, measure_distances},
};
use crate::{
    dialogue::{CaptionSummariser, RulesSummariser},
    observe::{CONDENSED_WORD_LIMIT, ObserveError},
    seeing::{FAR_M, caption_text},
};
use std::collections::BTreeSet;
use wayword_checks::detection::{DetectionVerdict, judge_finds};
use wayword_core::{
    Caption, CaptionedView, DetectionSpot, FrameObservation, ModelError, ObjectSighting, ViewThird, WitnessAnswer,
};
use wayword_language::lexicon::{ThingClass, find_thing, names_agree, normalise_name};

/// What the detector's results are used for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum DetectionPurpose {
    /// Captions are corrected and completed.
    Captions,
    /// Claims that no caption mentions are judged.
    Claims,
}

/// The looks at which the detector looked.
type LookIndexSet = BTreeSet<LookIndex>;

/// Looks for the wanted names in the views, and records what it finds and misses in the captions. Where the path of the
/// views is known, the finds get distances.
///
/// # Errors
/// When there is no view for captions, or the detector fails.
pub(super) fn apply_detections(
    (seen, walk): (&[LookPicture], Option<PlatformPath<'_>>),
    observations: &mut [FrameObservation],
    seeker: CaptionDetector<'_>,
    wanted: &NamePriors,
    purpose: DetectionPurpose,
) -> Result<(), ObserveError> {
    if seen.is_empty() && purpose == DetectionPurpose::Captions {
        return Err(ModelError::NothingToSee {
            name: seeker.detector.name().to_owned(),
            needs: "a picture",
            hint: "use a platform or data folder with pictures, or leave --detector out",
        }
        .into());
    }
    if seen.is_empty() || wanted.is_empty() {
        return Ok(());
    }
    let names: Vec<&str> = wanted.keys().map(String::as_str).collect();
    let mut finds = find_spots(seen, &names, seeker)?;
    if let Some(walk) = walk {
        measure_distances(walk, seen, &mut finds)?;
    }
    let (by, looked_at) = (seeker.detector.name(), seen.iter().map(|seen| (seen.frame, seen.look)).collect());
    let earlier: Vec<Vec<ObjectSighting>> =
        all_looks(observations).map(|look| look.caption.sightings.clone()).collect();
    for ((name, prior), finds) in wanted.iter().zip(finds) {
        let verdict = judge_finds(seeker.figures.rates_for(name), &found_by_frame(seen, &finds), *prior);
        let is_proposal = *prior <= PROPOSED_PRIOR;
        match (verdict, purpose) {
            (DetectionVerdict::There, _) => mark_as_seen(observations, name, &finds, &looked_at, by),
            _ if is_proposal => {}
            (DetectionVerdict::Absent, DetectionPurpose::Captions) => deny_in_all_looks(observations, name, by),
            (DetectionVerdict::Open, DetectionPurpose::Captions) => {
                mark_missed_as_unsure(observations, name, &finds, &looked_at, by);
            }
            (DetectionVerdict::Absent, DetectionPurpose::Claims) => {
                add_to_all_looks(observations, name, WitnessAnswer::Denied, by);
            }
            (DetectionVerdict::Open, DetectionPurpose::Claims) => {
                add_to_all_looks(observations, name, WitnessAnswer::Unsure, by);
            }
        }
    }
    if purpose == DetectionPurpose::Captions {
        let mut earlier = earlier.into_iter();
        observations.iter_mut().try_for_each(|observation| reword_changed_captions(observation, &mut earlier))?;
    }
    Ok(())
}

fn all_looks(observations: &mut [FrameObservation]) -> impl Iterator<Item = &mut CaptionedView> {
    observations.iter_mut().flat_map(|seen| &mut seen.looks)
}

/// The sightings of that name.
fn sightings_named<'a>(caption: &'a mut Caption, name: &'a str) -> impl Iterator<Item = &'a mut ObjectSighting> {
    caption.sightings.iter_mut().filter(move |sighting| normalise_name(&sighting.name) == name)
}

/// The thing is somewhere along the path: it becomes seen in each look in which it was found, and a guess in the
/// others.
fn mark_as_seen(
    observations: &mut [FrameObservation],
    name: &str,
    finds: &LookSpots,
    looked_at: &LookIndexSet,
    by: &str,
) {
    for_each_look(observations, looked_at, |at, look| {
        let Some(spots) = finds.get(&at) else {
            // It is somewhere along the path, but the caption that names it in this look may still be wrong.
            make_unsure(look, name, by);
            return;
        };
        let best = nearest_spot(spots, name);
        let is_far = best.distance_m.map(|distance_m| distance_m > FAR_M);
        let place = Some(ViewThird::from_offset(best.off_rad, look.gaze.horizontal_fov_rad));
        let mut is_named = false;
        for sighting in sightings_named(&mut look.caption, name) {
            is_named = true;
            (sighting.witness, sighting.place, sighting.spot) = (WitnessAnswer::Seen, place, Some(best));
            sighting.is_far = is_far.unwrap_or(sighting.is_far);
        }
        // The caption may already have a more exact name ("dining table"): that one stays, and the thing is not named
        // twice.
        let is_named_already =
            |sighting: &ObjectSighting| sighting.witness == WitnessAnswer::Seen && names_agree(&sighting.name, name);
        if !is_named && !look.caption.sightings.iter().any(is_named_already) {
            let several = spots.len() > 1;
            let spot = Some(best);
            let is_far = is_far.unwrap_or_default();
            let new = ObjectSighting::new(name, WitnessAnswer::Seen, by);
            look.caption.sightings.push(ObjectSighting { place, spot, several, is_far, ..new });
        }
    });
}

/// The find that represents a look: the nearest one, or the best-scored where a distance is unknown. A door gets no
/// distance, because the depth there would be that of the room behind an open door.
pub(super) fn nearest_spot(spots: &[DetectionSpot], name: &str) -> DetectionSpot {
    if find_thing(name).is_some_and(|thing| thing.class == ThingClass::Door) {
        return DetectionSpot { distance_m: None, ..spots[0] };
    }
    let far_m = |spot: &DetectionSpot| spot.distance_m.unwrap_or(0.0);
    // Of several with the least distance, and so of all where none is known, the first is the best.
    let nearer =
        |nearest: DetectionSpot, other: &DetectionSpot| if far_m(other) < far_m(&nearest) { *other } else { nearest };
    spots[1..].iter().fold(spots[0], nearer)
}

/// The thing is nowhere along the path: every caption that names it is wrong, so the sighting becomes denied.
fn deny_in_all_looks(observations: &mut [FrameObservation], name: &str, by: &str) {
    for look in all_looks(observations) {
        for sighting in sightings_named(&mut look.caption, name) {
            *sighting = ObjectSighting::new(name, WitnessAnswer::Denied, by);
        }
    }
}

/// It is open whether the thing is there: where a caption saw it and the detector did not, the sighting becomes a
/// guess.
fn mark_missed_as_unsure(
    observations: &mut [FrameObservation],
    name: &str,
    finds: &LookSpots,
    looked_at: &LookIndexSet,
    by: &str,
) {
    for_each_look(observations, looked_at, |at, look| {
        if !finds.contains_key(&at) {
            make_unsure(look, name, by);
        }
    });
}

/// Adds the detector's result for a claimed thing to every look: denied or unsure.
fn add_to_all_looks(observations: &mut [FrameObservation], name: &str, witness: WitnessAnswer, by: &str) {
    all_looks(observations).for_each(|look| look.caption.sightings.push(ObjectSighting::new(name, witness, by)));
}

/// Turns the seen things of that name in a look into guesses of the detector, which is called `by`.
fn make_unsure(look: &mut CaptionedView, name: &str, by: &str) {
    for sighting in sightings_named(&mut look.caption, name).filter(|sighting| sighting.witness == WitnessAnswer::Seen)
    {
        sighting.witness = WitnessAnswer::Unsure;
        by.clone_into(&mut sighting.by);
    }
}

/// Calls `change` for each look at which the detector looked.
fn for_each_look(
    observations: &mut [FrameObservation],
    looked_at: &LookIndexSet,
    mut change: impl FnMut(LookIndex, &mut CaptionedView),
) {
    for (frame, look) in looked_at {
        if let Some(captioned) = observations.get_mut(*frame).and_then(|seen| seen.looks.get_mut(*look)) {
            change((*frame, *look), captioned);
        }
    }
}

/// Writes the text of changed captions anew by rules, so that no words name a thing that the sightings no longer
/// contain. `earlier` yields the sightings of each look before the change.
fn reword_changed_captions(
    observation: &mut FrameObservation,
    earlier: &mut impl Iterator<Item = Vec<ObjectSighting>>,
) -> Result<(), ModelError> {
    let mut is_changed = false;
    for (look, sightings_before) in observation.looks.iter_mut().zip(earlier) {
        let caption = &mut look.caption;
        if caption.sightings == sightings_before {
            continue;
        }
        is_changed = true;
        caption.text = caption_text(caption.room.as_deref(), &caption.perhaps_rooms, &caption.sightings, &caption.ways);
        if !caption.is_structured {
            caption.by = Some(RulesSummariser.name().to_owned());
        }
    }
    if !is_changed {
        return Ok(());
    }
    if let [only] = &observation.looks[..] {
        observation.summary.clone_from(&only.caption.text);
        return Ok(());
    }
    let captions: Vec<(&str, &Caption)> = observation.looks.iter().map(|look| ("", &look.caption)).collect();
    observation.summary = RulesSummariser.condense(&captions, CONDENSED_WORD_LIMIT)?.text;
    observation.by = Some(RulesSummariser.name().to_owned());
    Ok(())
}
