//! Bayes' rule for finds along a path: how probable it is that a thing is there, after the detector looked from every
//! frame.

use super::DetectorRates;

/// The conclusion from the finds of a name along a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DetectionVerdict {
    /// It is there.
    There,
    /// It is nowhere along the path.
    Absent,
    /// Neither its presence nor its absence is sure enough.
    Open,
}

/// The probability from which a thing is taken to be there: nine of ten such conclusions are right. A thing is absent
/// only if it would have been found with the same probability, and its finds are as much likelier without it.
const SURE_PROBABILITY: f64 = 0.9;

/// Whether a thing is there, by the frames of a path in which it was found. `before` is the probability before the
/// detector looked; an absence does not depend on it.
#[must_use]
pub fn judge_finds(rates: &DetectorRates, found: &[bool], before: f64) -> DetectionVerdict {
    if found.is_empty() {
        return DetectionVerdict::Open;
    }
    let (there, absent) = (chance_if_there(rates, found), chance_if_absent(rates, found));
    let after = before * there / (before * there + (1.0 - before) * absent);
    let would_be_found = 1.0 - chance_if_there(&without_alarms(rates), &vec![false; found.len()]);
    if after >= SURE_PROBABILITY {
        DetectionVerdict::There
    } else if there <= absent * (1.0 - SURE_PROBABILITY) && would_be_found >= SURE_PROBABILITY {
        DetectionVerdict::Absent
    } else {
        DetectionVerdict::Open
    }
}

/// The same detector without false alarms: every find of it is real.
fn without_alarms(rates: &DetectorRates) -> DetectorRates {
    DetectorRates { alarms: 0, absent: u32::MAX, ..rates.clone() }
}

/// How probable the finds are where the thing is nowhere.
fn chance_if_absent(rates: &DetectorRates, found: &[bool]) -> f64 {
    let alarm = rates.alarm();
    found.iter().map(|found| if *found { alarm } else { 1.0 - alarm }).product()
}

/// How probable the finds are where some run of frames shows the thing. Each run of a length is as probable as any other.
/// A share of all things is never found, and the others are found independently from each frame that shows them.
fn chance_if_there(rates: &DetectorRates, found: &[bool]) -> f64 {
    let (alarm, blind) = (rates.alarm(), rates.blind_share());
    // Of the things to which the detector is not blind: the recall, and their share of all things.
    let (recall, seen_share) = ((rates.recall() / (1.0 - blind).max(f64::EPSILON)).min(1.0), 1.0 - blind);
    // A thing in view may also be "found" by a false alarm.
    let hit = recall + (1.0 - recall) * alarm;
    let chance = |found: bool, hit: f64| if found { hit } else { 1.0 - hit };
    // How probable the finds are if exactly the frames of this run show the thing.
    let within = |from: usize, to: usize| -> f64 {
        let frame_chance = |at: usize| chance(found[at], if (from..to).contains(&at) { hit } else { alarm });
        (0..found.len()).map(frame_chance).product()
    };
    let seen: f64 = rates
        .run_shares(found.len())
        .iter()
        .enumerate()
        .map(|(at, share)| {
            let (length, places) = (at + 1, found.len() - at);
            share * (0..places).map(|from| within(from, from + length)).sum::<f64>() / places as f64
        })
        .sum();
    blind * chance_if_absent(rates, found) + seen_share * seen
}
