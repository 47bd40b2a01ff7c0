//! Applies the detector's finds and misses to captions and claims: each name becomes seen, denied or unsure.

use super::{
    PROPOSED, Seeker, Wanted,
    finds::{Finds, Place, Seen, Walk, finds, frames, measure},
};
use crate::{
    dialogue::{RulesSummariser, Summariser},
    observe::{CONDENSED_WORDS, ObserveError},
    seeing::{FAR_M, caption_text},
};
use std::collections::BTreeSet;
use wayword_checks::detected::{Judged, judge};
use wayword_core::{Caption, Look, ModelError, Observation, Sighting, Spot, Where, Witness};
use wayword_language::lexicon::{Class, agree, normal, thing};

/// What the detector's results are used for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// Captions are corrected and completed.
    Captions,
    /// Claims that no caption mentions are judged.
    Claims,
}

/// The looks at which the detector looked.
type Places = BTreeSet<Place>;

/// Looks for the wanted names in the views, and records what it finds and misses in the captions. Where the path of the
/// views is known, the finds get distances.
///
/// # Errors
/// When there is no view for captions, or the detector fails.
pub(super) fn testify(
    (seen, walk): (&[Seen], Option<Walk<'_>>),
    observations: &mut [Observation],
    seeker: Seeker<'_>,
    wanted: &Wanted,
    purpose: Purpose,
) -> Result<(), ObserveError> {
    if seen.is_empty() && purpose == Purpose::Captions {
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
    let mut finds = finds(seen, &names, seeker)?;
    if let Some(walk) = walk {
        measure(walk, seen, &mut finds)?;
    }
    let (by, looked_at) = (seeker.detector.name(), seen.iter().map(|seen| (seen.frame, seen.look)).collect());
    let was: Vec<Vec<Sighting>> = looks(observations).map(|look| look.caption.sightings.clone()).collect();
    for ((name, before), finds) in wanted.iter().zip(finds) {
        let judged = judge(seeker.figures.of(name), &frames(seen, &finds), *before);
        let is_proposal = *before <= PROPOSED;
        match (judged, purpose) {
            (Judged::There, _) => found(observations, name, &finds, &looked_at, by),
            _ if is_proposal => {}
            (Judged::Absent, Purpose::Captions) => struck_out(observations, name, by),
            (Judged::Open, Purpose::Captions) => doubted(observations, name, &finds, &looked_at, by),
            (Judged::Absent, Purpose::Claims) => said_of_all(observations, name, Witness::Denied, by),
            (Judged::Open, Purpose::Claims) => said_of_all(observations, name, Witness::Unsure, by),
        }
    }
    if purpose == Purpose::Captions {
        let mut was = was.into_iter();
        observations.iter_mut().try_for_each(|observation| retell(observation, &mut was))?;
    }
    Ok(())
}

fn looks(observations: &mut [Observation]) -> impl Iterator<Item = &mut Look> {
    observations.iter_mut().flat_map(|seen| &mut seen.looks)
}

/// The sightings of that name.
fn of<'a>(caption: &'a mut Caption, name: &'a str) -> impl Iterator<Item = &'a mut Sighting> {
    caption.sightings.iter_mut().filter(move |sighting| normal(&sighting.name) == name)
}

/// The thing is somewhere along the path: it becomes seen in each look in which it was found, and a guess in the
/// others.
fn found(observations: &mut [Observation], name: &str, finds: &Finds, looked_at: &Places, by: &str) {
    each(observations, looked_at, |at, look| {
        let Some(spots) = finds.get(&at) else {
            // It is somewhere along the path, but the caption that names it in this look may still be wrong.
            doubt(look, name, by);
            return;
        };
        let best = nearest(spots, name);
        let is_far = best.distance_m.map(|distance_m| distance_m > FAR_M);
        let place = Some(Where::at(best.off_rad, look.gaze.horizontal_fov_rad));
        let mut is_named = false;
        for sighting in of(&mut look.caption, name) {
            is_named = true;
            (sighting.witness, sighting.place, sighting.spot) = (Witness::Seen, place, Some(best));
            sighting.is_far = is_far.unwrap_or(sighting.is_far);
        }
        // The caption may already have a more exact name ("dining table"): that one stays, and the thing is not named
        // twice.
        let is_said = |sighting: &Sighting| sighting.witness == Witness::Seen && agree(&sighting.name, name);
        if !is_named && !look.caption.sightings.iter().any(is_said) {
            let several = spots.len() > 1;
            let spot = Some(best);
            let is_far = is_far.unwrap_or_default();
            let new = Sighting::new(name, Witness::Seen, by);
            look.caption.sightings.push(Sighting { place, spot, several, is_far, ..new });
        }
    });
}

/// The find that represents a look: the nearest one, or the best-scored where a distance is unknown. A door gets no
/// distance, because the depth there would be that of the room behind an open door.
pub(super) fn nearest(spots: &[Spot], name: &str) -> Spot {
    if thing(name).is_some_and(|thing| thing.class == Class::Door) {
        return Spot { distance_m: None, ..spots[0] };
    }
    let far_m = |spot: &Spot| spot.distance_m.unwrap_or(0.0);
    // Of several with the least distance, and so of all where none is known, the first is the best.
    let nearer = |nearest: Spot, other: &Spot| if far_m(other) < far_m(&nearest) { *other } else { nearest };
    spots[1..].iter().fold(spots[0], nearer)
}

/// The thing is nowhere along the path: every caption that names it is wrong, so the sighting becomes denied.
fn struck_out(observations: &mut [Observation], name: &str, by: &str) {
    for look in looks(observations) {
        for sighting in of(&mut look.caption, name) {
            *sighting = Sighting::new(name, Witness::Denied, by);
        }
    }
}

/// It is open whether the thing is there: where a caption saw it and the detector did not, the sighting becomes a
/// guess.
fn doubted(observations: &mut [Observation], name: &str, finds: &Finds, looked_at: &Places, by: &str) {
    each(observations, looked_at, |at, look| {
        if !finds.contains_key(&at) {
            doubt(look, name, by);
        }
    });
}

/// Adds the detector's result for a claim to every look.
fn said_of_all(observations: &mut [Observation], name: &str, witness: Witness, by: &str) {
    looks(observations).for_each(|look| look.caption.sightings.push(Sighting::new(name, witness, by)));
}

fn doubt(look: &mut Look, name: &str, by: &str) {
    for sighting in of(&mut look.caption, name).filter(|sighting| sighting.witness == Witness::Seen) {
        sighting.witness = Witness::Unsure;
        by.clone_into(&mut sighting.by);
    }
}

/// Changes the looks at which the detector looked.
fn each(observations: &mut [Observation], looked_at: &Places, mut change: impl FnMut(Place, &mut Look)) {
    for (frame, look) in looked_at {
        if let Some(found) = observations.get_mut(*frame).and_then(|seen| seen.looks.get_mut(*look)) {
            change((*frame, *look), found);
        }
    }
}

/// Writes the text of changed captions anew by rules, so that no words name a thing that the sightings no longer
/// contain. `was` yields the sightings of each look before the change.
fn retell(observation: &mut Observation, was: &mut impl Iterator<Item = Vec<Sighting>>) -> Result<(), ModelError> {
    let mut is_changed = false;
    for (look, was) in observation.looks.iter_mut().zip(was) {
        let caption = &mut look.caption;
        if caption.sightings == was {
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
    observation.summary = RulesSummariser.condense(&captions, CONDENSED_WORDS)?.text;
    observation.by = Some(RulesSummariser.name().to_owned());
    Ok(())
}
