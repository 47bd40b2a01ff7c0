//! Corrects captions with a detector: it looks for names in the views along a path, and its finds and misses change the
//! captions.
//!
//! A name that the detector finds counts as seen and gets its box. A name that a caption gave and the detector missed
//! becomes doubtful or is denied, depending on how often the detector misses real things ([`DetectorFigures`]). A name
//! that was only proposed and not found leaves no trace.

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

/// A detector, its measured reliability, and the names that it looks for on its own.
#[derive(Clone, Copy)]
pub struct Seeker<'a> {
    /// The detector itself.
    pub detector: &'a dyn Detector,
    /// How often its finds and misses are right.
    pub figures: &'a DetectorFigures,
    /// Names that it looks for in every view, even where no caption mentions them.
    pub nouns: &'a [String],
}

/// Probability that a thing is there before the detector looks: where a caption names it for sure, where a caption
/// guesses it or a text claims it, and where it is only a proposal from a list.
const NAMED: f64 = 0.7;
const CLAIMED: f64 = 0.5;
const PROPOSED: f64 = 0.01;

/// The names to look for, each with the probability that the thing is there before the detector looks.
type Wanted = BTreeMap<String, f64>;

/// Looks for the names that captions mention and for the proposed ones in every captioned view, and corrects the
/// captions. Returns the number of views that the detector looked at.
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

/// Like [`seek`], for the caption of a single view.
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

/// Looks all around each frame of a path for the things that texts claim, where no captions exist. The observations
/// that it returns have captions without words, only with sightings.
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

/// The detector's own evidence: captions without words, with only the sightings that it found, denied or left unsure.
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

/// The names in the captions that the lexicon has, with their prior probability.
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
