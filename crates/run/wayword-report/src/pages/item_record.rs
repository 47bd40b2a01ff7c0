//! One item of a run as the report reads it, and the state of its texts.

use serde::Serialize;
use wayword_core::{Instruction, Verdict};
use wayword_run::run_folder::{RejectedText, WalkRecord};

/// One item.
pub(super) struct ItemRecord {
    pub(super) walk: WalkRecord,
    pub(super) accepted: Vec<Instruction>,
    pub(super) rejected: Vec<RejectedText>,
}

/// The state of an instruction, the worst first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum TextState {
    /// It failed a check, and is not part of the dataset.
    Rejected,
    /// Something could not be checked.
    Unverified,
    /// It passed every check.
    Passed,
}

/// The state of an accepted instruction.
pub(super) fn state_from_verdict(verdict: Verdict) -> TextState {
    match verdict {
        Verdict::Pass => TextState::Passed,
        Verdict::Unverified => TextState::Unverified,
        Verdict::Fail => TextState::Rejected,
    }
}
