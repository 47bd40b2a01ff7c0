//! Which of the things that were seen are worth naming.

use super::Brief;
use crate::walk::Seen;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use wayword_core::{Side, Verdict};
use wayword_language::lexicon::{agree, is_room, normal, plural, thing};

/// Chooses landmarks, each kind of thing once in a text.
pub(super) struct Landmarks<'a> {
    brief: &'a Brief<'a>,
    used: Vec<String>,
    avoided: Vec<String>,
}

/// A landmark in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Landmark {
    /// "the sofa", "the two lamps".
    pub(super) phrase: String,
    /// The side of the walker on which it was seen.
    pub(super) side: Option<Side>,
}

impl<'a> Landmarks<'a> {
    /// Nothing chosen yet. It avoids names about which checks complained in earlier texts, and the target, which the
    /// task names.
    pub(super) fn new(brief: &'a Brief<'a>) -> Self {
        let blamed = brief.complaints.iter().flat_map(|complaint| {
            let failed = complaint.findings.iter().filter(|finding| finding.verdict != Verdict::Pass);
            failed.filter_map(|finding| complaint.text.get(finding.span?[0]..finding.span?[1])).map(normal)
        });
        let target = brief.walk.path.target.as_ref().map(|target| normal(&target.name));
        Self { brief, used: target.into_iter().collect(), avoided: blamed.collect() }
    }

    /// Whether a name may still be used.
    fn is_free(&self, name: &str) -> bool {
        let known = |names: &[String]| names.iter().any(|other| agree(other, name));
        !known(&self.used)
            && !self.avoided.iter().any(|blamed| *blamed == normal(name) || blamed.ends_with(&normal(name)))
    }

    /// Keeps a name from being used as a landmark.
    pub(super) fn reserve(&mut self, name: &str) {
        self.used.push(normal(name));
    }

    /// The landmark of at least that salience that identifies a frame best, if there is one.
    pub(super) fn choose(&mut self, frame: usize, salience: u8, rng: &mut ChaCha8Rng) -> Option<Landmark> {
        let walk = self.brief.walk;
        let told = walk
            .seen(frame)
            .filter(|seen| is_tellable(&seen.sighting.name, salience) && self.is_free(&seen.sighting.name));
        let scored = told.map(|seen| {
            let salience = thing(&seen.sighting.name).map_or(0.0, |thing| f64::from(thing.salience));
            let elsewhere = (0..walk.path.frames.len()).filter(|at| {
                *at != frame && walk.seen(*at).any(|other| agree(&other.sighting.name, &seen.sighting.name))
            });
            (salience * 2.0 - elsewhere.count() as f64 + rng.random_range(0.0..1.5), seen)
        });
        let (_, best) = scored.max_by(|a, b| a.0.total_cmp(&b.0))?;
        self.used.push(normal(&best.sighting.name));
        Some(landmark(&best))
    }
}

/// Whether a name reads as a landmark: known as one, and not a room's or a list's name.
fn is_tellable(name: &str, salience: u8) -> bool {
    let plain =
        name.len() <= 30 && name.chars().all(|c| c.is_alphabetic() || c == ' ' || c == '-') && !name.contains(" and ");
    plain && !is_room(&normal(name)) && thing(name).is_some_and(|thing| thing.salience >= salience)
}

fn landmark(seen: &Seen<'_>) -> Landmark {
    let sighting = seen.sighting;
    let name = if sighting.several { plural(&sighting.name) } else { sighting.name.clone() };
    let phrase = match sighting.colour.as_ref().filter(|_| !sighting.several) {
        Some(colour) => format!("the {colour} {name}"),
        None => format!("the {name}"),
    };
    Landmark { phrase, side: seen.side }
}
