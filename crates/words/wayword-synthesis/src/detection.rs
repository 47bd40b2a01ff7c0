//! A detector as a witness: it looks for names in the views along a path, and its finds and misses go into the captions.
//!
//! What it found is seen, with its box. What captions named and it did not find becomes doubtful or is struck out, by what is
//! known of its recall ([`DetectorFigures`]). What was proposed and not found is left out.

mod finds;
mod nouns;
mod testimony;

pub use nouns::{listed, usual};

use crate::observe::{ObserveError, gazes_around};
use finds::{Seen, Walk, views};
use std::collections::{BTreeMap, BTreeSet};
use testimony::{Purpose, testify};
use wayword_checks::detected::DetectorFigures;
use wayword_core::{Caption, Detector, Gaze, Look, Observation, Path, Platform, Sighting, View, Witness};
use wayword_language::lexicon::{normal, thing};

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

/// What is looked for: how it is called, and how probable it is beforehand.
type Wanted = BTreeMap<String, f64>;

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
    correct(&seen, Some(Walk { platform, path }), observations, seeker)
}

/// The same for the caption of one view that is at hand.
///
/// # Errors
/// When it has no picture, or the detector fails.
pub fn seek_in(view: &View, caption: Caption, seeker: Seeker<'_>) -> Result<Caption, ObserveError> {
    let gaze = Gaze { heading: view.pose.heading, horizontal_fov_rad: view.horizontal_fov_rad };
    let mut observation = Observation { looks: vec![Look { gaze, caption }], ..Observation::default() };
    let seen = view.image.is_some().then(|| Seen { frame: 0, look: 0, view: view.clone() });
    correct(seen.as_slice(), None, std::slice::from_mut(&mut observation), seeker)?;
    Ok(observation.looks.pop().map(|look| look.caption).unwrap_or_default())
}

fn correct(
    seen: &[Seen],
    walk: Option<Walk<'_>>,
    observations: &mut [Observation],
    seeker: Seeker<'_>,
) -> Result<usize, ObserveError> {
    let mut wanted: Wanted = seeker.nouns.iter().map(|noun| (normal(noun), PROPOSED)).collect();
    wanted.extend(named(observations));
    testify((seen, walk), observations, seeker, &wanted, Purpose::Captions)?;
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
    let walk = Some(Walk { platform, path });
    testify((&seen, walk), &mut observations, seeker, &wanted, Purpose::Claims)?;
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

#[cfg(test)]
mod tests;
