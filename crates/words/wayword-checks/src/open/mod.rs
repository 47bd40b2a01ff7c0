//! Checks texts of other authors: an absence counts only if the evidence would have shown the thing.
//!
//! A claim fails where the evidence is many times likelier if the claim is wrong than if it is true. The weights for
//! that likelihood were fitted on texts of people, by class of object and group of rooms ([`Weights`]); they hold no
//! text and no rate by the name of an object or a building.

mod calibration;
mod claims;
mod climbs;
mod distances;
mod expected;
mod features;
mod motions;
mod phrase;
mod places;
mod relation;
mod repeats;
mod sides;
mod sight;
mod stretches;
#[cfg(test)]
mod tests;
mod unjudged;
mod weights;

use crate::{Subject, Turns};
use wayword_core::{Check, Finding, Verdict};
use wayword_language::reading::{Reading, What};

pub use calibration::{Calibration, Observed, Offsets};
pub use claims::{Claim, claims};
pub use expected::is_expected;
pub use features::sight;
pub use relation::Relation;
pub use sight::{Case, Missed, Sight, class_name};
pub use weights::{Table, Weights};

/// The mistakes in the places, the order, the turns and the storeys of another author's text. `whole` is the reading
/// with its denied events, and `reading` the one without.
pub(super) fn open(text: &str, whole: &Reading, reading: &Reading, subject: Subject<'_>) -> Vec<Finding> {
    let mut findings = places::places(reading, subject);
    findings.extend(climbs::climbs(text, reading, subject));
    findings.extend(repeats::repeats(text, reading, subject));
    findings.extend(distances::distances(reading, subject.evidence));
    findings.extend(turns(reading, subject));
    findings.extend(unjudged::unjudged(text, whole, subject));
    for check in [Check::Landmarks, Check::Order, Check::Turns, Check::Floors] {
        if findings.iter().all(|finding| finding.check != check) {
            findings.push(crate::pass(check));
        }
    }
    findings
}

/// Turns are judged where whole walks are compared, and not here. If no walks are compared, each turn is unverified.
fn turns(reading: &Reading, subject: Subject<'_>) -> Vec<Finding> {
    let reason = match subject.turns {
        _ if !subject.evidence.motion.is_known() => "the program cannot check how the path turns".to_owned(),
        Turns::NotJudged(why) => format!("the program cannot check how the path turns: {why}"),
        Turns::JudgedElsewhere => return Vec::new(),
    };
    let told = reading.events.iter().filter(|event| matches!(event.what, What::Turn(_)));
    told.map(|event| crate::finding(Check::Turns, Verdict::Unverified, reason.clone(), Some(event.span))).collect()
}
