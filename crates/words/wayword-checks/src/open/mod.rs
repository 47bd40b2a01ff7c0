//! Checks texts of other authors: an absence counts only if the evidence would have shown the thing.
//!
//! A claim fails where the evidence is many times likelier if the claim is wrong than if it is true. The weights for
//! that likelihood were fitted on texts of people, by class of object and group of rooms ([`SilenceWeights`]); they hold no
//! text and no rate by the name of an object or a building.

mod calibration;
mod claim_sight;
mod claims;
mod climbs;
mod distances;
mod expected;
mod features;
mod motions;
mod phrase;
mod places;
mod relation;
pub(crate) mod repeats;
mod sides;
mod stretches;
#[cfg(test)]
mod tests;
mod unjudged;
mod weights;

use crate::{CheckSubject, TurnJudge};
use wayword_core::{CheckFinding, CheckKind, Verdict};
use wayword_language::reading::{EventContent, TextReading};

pub use calibration::{Calibration, ClaimObservation, NameOffsets};
pub use claim_sight::{ClaimCase, ClaimSight, MissedClaim, class_name};
pub use claims::{PlaceClaim, read_claims};
pub use expected::is_expected;
pub use features::sight_of_claim;
pub use relation::WalkerRelation;
pub use weights::{SilenceWeights, WeightTable};

/// The mistakes in the places, the order, the turns and the storeys of another author's text. `whole` is the reading
/// with its denied events, and `reading` the one without.
pub(super) fn check_open(whole: &TextReading, reading: &TextReading, subject: CheckSubject<'_>) -> Vec<CheckFinding> {
    let mut findings = places::check_places(reading, subject);
    findings.extend(climbs::check_climbs(reading, subject));
    findings.extend(repeats::check_repeats(reading, subject));
    findings.extend(distances::check_distances(reading, subject.evidence));
    findings.extend(unjudged_turns(reading, subject));
    findings.extend(unjudged::find_unjudged(whole, subject));
    for check in [CheckKind::Landmarks, CheckKind::Order, CheckKind::Turns, CheckKind::Floors] {
        if findings.iter().all(|finding| finding.check != check) {
            findings.push(crate::pass_finding(check));
        }
    }
    findings
}

/// Turns are judged where whole walks are compared, and not here. If no walks are compared, each turn is unverified.
fn unjudged_turns(reading: &TextReading, subject: CheckSubject<'_>) -> Vec<CheckFinding> {
    let reason = match subject.turns {
        _ if !subject.evidence.motion.is_known() => "the program cannot check how the path turns".to_owned(),
        TurnJudge::NotJudged(why) => format!("the program cannot check how the path turns: {why}"),
        TurnJudge::JudgedElsewhere => return Vec::new(),
    };
    let stated = reading.events.iter().filter(|event| matches!(event.what, EventContent::Turn(_)));
    stated
        .map(|event| crate::new_finding(CheckKind::Turns, Verdict::Unverified, reason.clone(), Some(event.span)))
        .collect()
}
