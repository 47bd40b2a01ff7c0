//! One item of a run as the report reads it, and the state of its texts.

use serde::Serialize;
use wayword_core::Instruction;
use wayword_run::run_folder::{RejectedText, TextCost, WalkRecord};

/// One item.
pub(super) struct ItemRecord {
    /// Its place in the run, from 0.
    pub(super) place: usize,
    pub(super) walk: WalkRecord,
    pub(super) accepted: Vec<AcceptedText>,
    pub(super) rejected: Vec<RejectedText>,
}

/// A text of the dataset.
pub(super) struct AcceptedText {
    /// The number of its line in the file of instructions, from 1.
    pub(super) line: usize,
    pub(super) instruction: Instruction,
    /// Its number among the texts of its path and style, from 0.
    pub(super) number: usize,
    /// What it cost; `None` where no model took part.
    pub(super) cost: Option<TextCost>,
}

/// The state of an instruction, the worst first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum TextState {
    /// It is part of the dataset, and fails a check.
    Wrong,
    /// It failed a check, and is not part of the dataset.
    Rejected,
    /// It failed no check, but something could not be checked.
    Unverified,
    /// It passed every check.
    Passed,
}
