//! How often a detector finds things that are there, and things that are not, as measured on worlds with labels.

use crate::open::class_name;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use wayword_language::lexicon::{find_thing, normalise_name};

/// A detector's measured rates. They may come from an untrusted file, so every share is kept within bounds where it is
/// used.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DetectorFigures {
    /// The detector: `provider/model`.
    pub detector: String,
    /// The platforms on which it was measured.
    pub platforms: Vec<String>,
    /// The score from which a box counts as a find.
    pub found_from: f32,
    /// The rates of all names together.
    pub all: DetectorRates,
    /// The rates of classes of things, where enough was seen of one: beds are seen from more frames than vases.
    #[serde(default)]
    pub classes: BTreeMap<String, DetectorRates>,
    /// The rates of single names in normal spelling, where enough was seen.
    #[serde(default)]
    pub names: BTreeMap<String, DetectorRates>,
}

/// How often things were found from frames that show them, and from frames that do not. A frame means all views
/// from one place.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DetectorRates {
    /// Pairs of a frame and a name that it shows.
    pub shown: u32,
    /// Those among them that were found.
    pub found: u32,
    /// Pairs of a frame and a name that it does not show.
    pub absent: u32,
    /// Those among them that were found all the same.
    pub alarms: u32,
    /// Pairs of consecutive frames of a path that both show a name, where the detector missed it in the first.
    pub missed_before: u32,
    /// Those among them in which it missed the second too.
    pub missed_again: u32,
    /// How many names of a path were shown by one frame of it, by two, and so on; the last counts longer runs too.
    pub runs: Vec<u32>,
}

/// The longest run of frames that is counted by itself; a longer one counts as this long.
const LONGEST_RUN: usize = 8;

/// A single name has rates of its own from this many frames that show it, and as many that do not.
const MIN_FRAMES_PER_NAME: u32 = 30;

/// Added to both parts of every share: half a find and half a miss. It keeps shares of few measurements away from 0
/// and 1.
const PRIOR_COUNT: f64 = 0.5;

impl DetectorFigures {
    /// Cautious figures for a detector that was never measured: it finds three of five things and is wrong about one
    /// in fifty, and a thing that it misses once it misses always. So a miss never makes a thing absent.
    #[must_use]
    pub fn for_unmeasured(detector: &str, found_from: f32) -> Self {
        let all = DetectorRates {
            shown: 100,
            found: 60,
            absent: 100,
            alarms: 2,
            missed_before: 10,
            missed_again: 10,
            runs: vec![1, 1, 1, 1],
        };
        Self { detector: detector.to_owned(), found_from, all, ..Self::default() }
    }

    /// The rates of a name: its own where enough was seen of it, or else those of its class, or else those of all names.
    #[must_use]
    pub fn rates_for(&self, name: &str) -> &DetectorRates {
        let of_class = || self.classes.get(&class_for_name(name)?);
        self.names.get(&normalise_name(name)).or_else(of_class).unwrap_or(&self.all)
    }

    /// Counts one name along one path: for each frame, whether the labels show it, and whether the detector found it.
    pub fn count_name(&mut self, name: &str, frames: &[(bool, bool)]) {
        self.all.count_frames(frames);
        if let Some(class) = class_for_name(name) {
            self.classes.entry(class).or_default().count_frames(frames);
        }
        self.names.entry(normalise_name(name)).or_default().count_frames(frames);
    }

    /// Drops names with too few measurements, and names that the lexicon does not have.
    pub fn drop_rare_names(&mut self) {
        let is_enough =
            |rates: &DetectorRates| rates.shown >= MIN_FRAMES_PER_NAME && rates.absent >= MIN_FRAMES_PER_NAME;
        self.classes.retain(|_, rates| is_enough(rates));
        self.names.retain(|name, rates| find_thing(name).is_some() && is_enough(rates));
    }
}

/// The class of a name that the lexicon has.
fn class_for_name(name: &str) -> Option<String> {
    find_thing(name).map(|thing| class_name(thing.class))
}

impl DetectorRates {
    /// Counts the frames of one name along one path: whether the labels show it, and whether the detector found it.
    fn count_frames(&mut self, frames: &[(bool, bool)]) {
        for (shown, found) in frames {
            let (all, hits) = match shown {
                true => (&mut self.shown, &mut self.found),
                false => (&mut self.absent, &mut self.alarms),
            };
            *all += 1;
            *hits += u32::from(*found);
        }
        let shown: Vec<bool> = frames.iter().filter(|(shown, _)| *shown).map(|(_, found)| *found).collect();
        for pair in shown.windows(2).filter(|pair| !pair[0]) {
            self.missed_before += 1;
            self.missed_again += u32::from(!pair[1]);
        }
        if !shown.is_empty() {
            self.runs.resize(LONGEST_RUN, 0);
            self.runs[shown.len().min(LONGEST_RUN) - 1] += 1;
        }
    }

    /// Of the things that a frame shows, the share that is found.
    #[must_use]
    pub fn recall(&self) -> f64 {
        measured_share(self.found, self.shown)
    }

    /// Of the things that a frame does not show, the share that is found all the same.
    #[must_use]
    pub fn alarm(&self) -> f64 {
        measured_share(self.alarms, self.absent)
    }

    /// The share of things to which the detector is blind: it misses them from every frame. Repeated misses beyond
    /// those that independent misses would give are attributed to blindness.
    #[must_use]
    pub fn blind_share(&self) -> f64 {
        let (miss, again) = (1.0 - self.recall(), measured_share(self.missed_again, self.missed_before));
        if self.missed_before == 0 || miss >= 1.0 {
            return miss;
        }
        // With a share b of blind things and misses q of the others: miss = b + (1 - b) q, and again miss = b + (1 - b) q².
        let both = miss * again;
        let blind = (both - miss * miss) / (1.0 + both - 2.0 * miss).max(f64::EPSILON);
        blind.clamp(0.0, miss)
    }

    /// The shares of names of a path that are shown by a run of 1, 2, ... frames, up to `most`. Longer runs count as the
    /// longest.
    pub(super) fn run_shares(&self, most: usize) -> Vec<f64> {
        let mut runs = vec![0.0; most];
        let all: u64 = self.runs.iter().map(|count| u64::from(*count)).sum();
        if all == 0 {
            runs.iter_mut().take(1).for_each(|run| *run = 1.0);
            return runs;
        }
        for (at, count) in self.runs.iter().enumerate() {
            runs[at.min(most - 1)] += f64::from(*count) / all as f64;
        }
        runs
    }
}

/// A share that is neither 0 nor 1, because no measurement is certain.
fn measured_share(part: u32, whole: u32) -> f64 {
    (f64::from(part.min(whole)) + PRIOR_COUNT) / (f64::from(whole) + 2.0 * PRIOR_COUNT)
}
