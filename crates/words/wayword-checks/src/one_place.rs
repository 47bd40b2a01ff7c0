//! A path of one place decides nothing of a text that tells a way: in a test split the way is hidden, and only its start is known.

use super::new_finding;
use wayword_core::{CheckFinding, CheckKind, Verdict};

const ONE_PLACE_REASON: &str =
    "the path is one place, as in a test split whose way is hidden, so the program cannot check the text against it";

/// The checks that hold a text against its path.
const PATH_CHECKS: [CheckKind; 5] =
    [CheckKind::Task, CheckKind::Landmarks, CheckKind::Order, CheckKind::Turns, CheckKind::Floors];

/// Replaces the findings of every check that reads the path by one that leaves it undecided. That a text ends in no task, or in one
/// without an object, is seen without the path.
pub(super) fn leave_path_undecided(findings: &mut Vec<CheckFinding>) {
    let mut undecided = Vec::new();
    findings.retain(|finding| {
        let needs_path = PATH_CHECKS.contains(&finding.check)
            && !(finding.check == CheckKind::Task && finding.verdict == Verdict::Fail && finding.span.is_none());
        if needs_path && !undecided.contains(&finding.check) {
            undecided.push(finding.check);
        }
        !needs_path
    });
    findings.extend(undecided.into_iter().map(|check| new_finding(check, Verdict::Unverified, ONE_PLACE_REASON, None)));
}
