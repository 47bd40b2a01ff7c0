//! Checks the distances of a text by the path's length.

use crate::{evidence::Evidence, new_finding};
use wayword_core::{CheckFinding, CheckKind, Verdict};
use wayword_language::reading::{EventContent, TextReading};

/// People guess distances badly: a distance in a text may be longer than the whole path by this factor.
const LENGTH_FACTOR: f64 = 1.5;
/// On top of that factor, it may be longer by this, metres. Beyond both it fails.
const SLACK_M: f64 = 3.0;

/// The distances of a text that are longer than the whole path. A shorter one may be any stretch of it.
pub(super) fn check_distances(reading: &TextReading, evidence: &Evidence) -> Vec<CheckFinding> {
    let length_m: f64 = evidence.moves.iter().map(|step| step.distance_m).sum();
    let stated = reading.events.iter().filter_map(|event| match event.what {
        EventContent::Distance { metres_low, .. } => Some((event.span, metres_low)),
        _ => None,
    });
    let judged = stated.filter_map(|(span, metres_low)| {
        if !evidence.motion.is_known() {
            let reason = "the program cannot check how far the path goes";
            return Some(new_finding(CheckKind::Order, Verdict::Unverified, reason, Some(span)));
        }
        let reason = || format!("the whole path is {length_m:.0} m long");
        (metres_low > length_m * LENGTH_FACTOR + SLACK_M)
            .then(|| new_finding(CheckKind::Order, Verdict::Fail, reason(), Some(span)))
    });
    judged.collect()
}
