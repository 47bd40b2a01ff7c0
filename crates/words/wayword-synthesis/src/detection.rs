//! A detector as a witness: it looks for names in the views along a path, and its finds and misses go into the captions.
//!
//! What it found is seen, with its box. What captions named and it did not find becomes doubtful or is struck out, by what is
//! known of its recall ([`DetectorFigures`]). What was proposed and not found is left out.

mod nouns;

pub use nouns::{listed, usual};

use crate::{
    dialogue::{RulesSummariser, Summariser},
    observe::{CONDENSED_WORDS, ObserveError, gazes_around},
    seeing::caption_text,
};
use std::collections::{BTreeMap, BTreeSet};
use wayword_checks::detected::{DetectorFigures, Judged, judge};
use wayword_core::{
    Caption, Detector, Found, Gaze, Look, ModelError, Observation, Path, Platform, PlatformError, Sighting, Spot, View,
    Where, Witness,
};
use wayword_language::lexicon::{agree, normal, thing};

/// What looks for things, and what is known of it.
#[derive(Clone, Copy)]
pub struct Seeker<'a> {
    /// Looks for them.
    pub detector: &'a dyn Detector,
    /// How often it is right.
    pub figures: &'a DetectorFigures,
    /// Names that it looks for in every view, whatever was said of it.
    pub nouns: &'a [String],
}

/// How probable a thing is before the detector looks, where a caption names it for sure, where it names it as a guess or a
/// text claims it, and where it is only a proposal.
const NAMED: f64 = 0.7;
const CLAIMED: f64 = 0.5;
const PROPOSED: f64 = 0.01;

/// Boxes that share more of what they cover together are of the same thing.
const SAME: f64 = 0.5;

/// A view of an observation's look.
struct Seen {
    frame: usize,
    look: usize,
    view: View,
}

/// What is looked for: how it is called, and how probable it is beforehand.
type Wanted = BTreeMap<String, f64>;

/// What the finds are for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Purpose {
    /// Captions are corrected and completed.
    Captions,
    /// Claims are judged of which no caption tells.
    Claims,
}

/// The frame and the number of a look.
type Place = (usize, usize);
type Places = BTreeSet<Place>;

/// The finds of one name, look by look.
type Finds = BTreeMap<Place, Vec<Spot>>;

/// Looks for what captions named and for what is proposed, in every view that was captioned, and corrects the captions. Gives
/// the number of views that the detector looked at.
///
/// # Errors
/// When a view cannot be had, or the detector fails.
pub fn seek(
    platform: &dyn Platform,
    path: &Path,
    observations: &mut [Observation],
    seeker: Seeker<'_>,
) -> Result<usize, ObserveError> {
    let seen = views(platform, path, observations)?;
    correct(&seen, observations, seeker)
}

/// The same for the caption of one view that is at hand.
///
/// # Errors
/// When it has no picture, or the detector fails.
pub fn seek_in(view: &View, caption: Caption, seeker: Seeker<'_>) -> Result<Caption, ObserveError> {
    let gaze = Gaze { heading: view.pose.heading, horizontal_fov_rad: view.horizontal_fov_rad };
    let mut observation = Observation { looks: vec![Look { gaze, caption }], ..Observation::default() };
    let seen = view.image.is_some().then(|| Seen { frame: 0, look: 0, view: view.clone() });
    correct(seen.as_slice(), std::slice::from_mut(&mut observation), seeker)?;
    Ok(observation.looks.pop().map(|look| look.caption).unwrap_or_default())
}

fn correct(seen: &[Seen], observations: &mut [Observation], seeker: Seeker<'_>) -> Result<usize, ObserveError> {
    let mut wanted: Wanted = seeker.nouns.iter().map(|noun| (normal(noun), PROPOSED)).collect();
    wanted.extend(named(observations));
    testify(seen, observations, seeker, &wanted, Purpose::Captions)?;
    Ok(if wanted.is_empty() { 0 } else { seen.len() })
}

/// Looks for what texts claim all around the frames of a path of which nothing else is known: captions without words.
///
/// # Errors
/// When a view cannot be had, or the detector fails.
pub fn seek_claims(
    platform: &dyn Platform,
    path: &Path,
    claims: &BTreeSet<String>,
    seeker: Seeker<'_>,
) -> Result<Vec<Observation>, ObserveError> {
    let look = |gaze| Look { gaze, caption: Caption::default() };
    let around = |frame| Observation {
        looks: gazes_around(path, frame).into_iter().map(look).collect(),
        ..Observation::default()
    };
    let mut observations: Vec<Observation> = path.frames.iter().map(around).collect();
    let wanted = claims.iter().map(|claim| (normal(claim), CLAIMED)).collect();
    let seen = views(platform, path, &observations)?;
    testify(&seen, &mut observations, seeker, &wanted, Purpose::Claims)?;
    Ok(observations)
}

/// What a detector alone says of the frames: captions without words, with what it found, denied and was not sure of.
#[must_use]
pub fn alone(observations: &[Observation], detector: &str) -> Vec<Observation> {
    let is_its = |sighting: &&Sighting| sighting.spot.is_some() || sighting.by == detector;
    let look = |look: &Look| {
        let sightings = look.caption.sightings.iter().filter(is_its).cloned().collect();
        Look { gaze: look.gaze, caption: Caption { sightings, ..Caption::default() } }
    };
    let observation =
        |seen: &Observation| Observation { looks: seen.looks.iter().map(look).collect(), ..Observation::default() };
    observations.iter().map(observation).collect()
}

/// What the captions name, as far as the lexicon has it.
fn named(observations: &[Observation]) -> Wanted {
    let mut wanted = Wanted::new();
    let captions = observations.iter().flat_map(|seen| &seen.looks).map(|look| &look.caption);
    for sighting in captions.flat_map(|caption| &caption.sightings) {
        let before = match sighting.witness {
            Witness::Seen => NAMED,
            Witness::Unsure => CLAIMED,
            Witness::Denied => continue,
        };
        if thing(&sighting.name).is_some() {
            let known = wanted.entry(normal(&sighting.name)).or_insert(before);
            *known = known.max(before);
        }
    }
    wanted
}

fn testify(
    seen: &[Seen],
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
    let finds = finds(seen, &names, seeker)?;
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

/// The pictures of all looks. A look without one is left out: the detector cannot have missed anything there.
fn views(platform: &dyn Platform, path: &Path, observations: &[Observation]) -> Result<Vec<Seen>, PlatformError> {
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
fn finds(seen: &[Seen], names: &[&str], seeker: Seeker<'_>) -> Result<Vec<Finds>, ModelError> {
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
                apart(sure).map(|found| Spot::new(found, width_px, seen.view.horizontal_fov_rad)).collect();
            if !spots.is_empty() {
                finds.insert((seen.frame, seen.look), spots);
            }
        }
    }
    Ok(found)
}

/// The boxes of different things, the best first.
fn apart(found: impl Iterator<Item = Found>) -> impl Iterator<Item = Found> {
    let mut kept: Vec<Found> = Vec::new();
    for found in found {
        if !kept.iter().any(|other| other.overlap(&found) > SAME) {
            kept.push(found);
        }
    }
    kept.into_iter()
}

/// For each frame that was looked at, whether the name was found from it.
fn frames(seen: &[Seen], finds: &Finds) -> Vec<bool> {
    let looked_at: BTreeSet<usize> = seen.iter().map(|seen| seen.frame).collect();
    looked_at.iter().map(|frame| finds.keys().any(|(of, _)| of == frame)).collect()
}

/// The sightings of that name.
fn of<'a>(caption: &'a mut Caption, name: &'a str) -> impl Iterator<Item = &'a mut Sighting> {
    caption.sightings.iter_mut().filter(move |sighting| normal(&sighting.name) == name)
}

/// It is there: it is seen wherever it was found.
fn found(observations: &mut [Observation], name: &str, finds: &Finds, looked_at: &Places, by: &str) {
    each(observations, looked_at, |at, look| {
        let Some(spots) = finds.get(&at) else {
            // It is somewhere along the path; who saw it here may be wrong all the same.
            doubt(look, name, by);
            return;
        };
        let best = spots[0];
        let place = Some(Where::at(best.off_rad, look.gaze.horizontal_fov_rad));
        let mut is_named = false;
        for sighting in of(&mut look.caption, name) {
            is_named = true;
            (sighting.witness, sighting.place, sighting.spot) = (Witness::Seen, place, Some(best));
        }
        // A more exact name for it was perhaps said ("dining table"): it stays, and nothing is said twice.
        let is_said = |sighting: &Sighting| sighting.witness == Witness::Seen && agree(&sighting.name, name);
        if !is_named && !look.caption.sightings.iter().any(is_said) {
            let several = spots.len() > 1;
            let spot = Some(best);
            look.caption.sightings.push(Sighting { place, spot, several, ..Sighting::new(name, Witness::Seen, by) });
        }
    });
}

/// It is nowhere: whoever named it was wrong.
fn struck_out(observations: &mut [Observation], name: &str, by: &str) {
    for look in looks(observations) {
        for sighting in of(&mut look.caption, name) {
            *sighting = Sighting::new(name, Witness::Denied, by);
        }
    }
}

/// It may be there: where a caption saw it and the detector did not, that is a guess.
fn doubted(observations: &mut [Observation], name: &str, finds: &Finds, looked_at: &Places, by: &str) {
    each(observations, looked_at, |at, look| {
        if !finds.contains_key(&at) {
            doubt(look, name, by);
        }
    });
}

/// What the detector says of a claim, in every look.
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

/// What a detector changed is told again by rules, so that no words name what the caption does not hold. `was` gives the
/// sightings of each look as they were.
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

#[cfg(test)]
mod tests;
