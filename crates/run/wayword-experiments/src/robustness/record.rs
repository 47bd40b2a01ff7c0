//! The lines of `texts.jsonl`: a path in one arm, with its texts.

use super::arm::RobustnessArm;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use wayword_core::{Instruction, Path, TextMention};
use wayword_synthesis::repair::WritingOutcome;

/// A path in one arm, with its texts.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct ArmPathRecord {
    /// The arm.
    pub(super) arm: String,
    /// The path in that arm; its id is that of the run's path.
    pub(super) path: Path,
    /// For each of its frames, the index of the corresponding frame of the run's path.
    pub(super) base_frame_of: Vec<usize>,
    /// Its texts, one for each style.
    pub(super) texts: Vec<ArmText>,
    /// The reason why there are no texts, if the arm does not apply to the path.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) left_out: Option<String>,
}

/// The lines of the unchanged arm, by path.
pub(super) type UnchangedRecords = BTreeMap<String, ArmPathRecord>;

/// A text of one style.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct ArmText {
    pub(super) style: String,
    /// Its words; `None` where every text failed its checks.
    pub(super) text: Option<String>,
    /// Which of several candidates it is.
    #[serde(default)]
    pub(super) candidate: u32,
    /// The statements of the text that have evidence.
    pub(super) mentions: Vec<TextMention>,
    /// The thing that was changed for this text, in an arm that changes one thing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) edit: Option<ThingEdit>,
    /// 1 if the agent arrived by the text, 0 if not; `None` if it did not walk.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) arrived: Option<f64>,
}

/// One thing that was removed, added, or given another colour.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct ThingEdit {
    /// Its name.
    pub(super) name: String,
    /// The indices of the frames that see it or another thing of its name.
    pub(super) seen_from: Vec<usize>,
    /// The word for its colour before and after.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) colours: Option<[String; 2]>,
}

impl ArmText {
    /// Makes the record of a text from the outcome of its writing.
    pub(super) fn from_outcome(style: &str, outcome: WritingOutcome) -> Self {
        let without_text =
            Self { style: style.to_owned(), text: None, candidate: 0, mentions: Vec::new(), edit: None, arrived: None };
        match outcome {
            WritingOutcome::Accepted(Instruction { text, mentions, provenance, .. }) => {
                let candidate = provenance.chosen.map_or(0, |chosen| chosen.number);
                Self { text: Some(text), candidate, mentions, ..without_text }
            }
            WritingOutcome::Rejected { .. } => without_text,
        }
    }
}

/// The key of a line: an arm and a path.
pub(super) fn record_key(arm: &str, path: &str) -> String {
    format!("{arm}\u{1f}{path}")
}

impl ArmPathRecord {
    pub(super) fn key_of(value: &Value) -> Option<String> {
        Some(record_key(value.get("arm")?.as_str()?, value.get("path")?.get("id")?.as_str()?))
    }

    /// The line of a path to which an arm does not apply, with the reason.
    pub(super) fn left_out(arm: &RobustnessArm, path: &Path, reason: &str) -> Self {
        let left_out = Some(reason.to_owned());
        Self { arm: arm.id(), path: path.clone(), base_frame_of: Vec::new(), texts: Vec::new(), left_out }
    }

    /// The number of the candidate that each text is, by style.
    pub(super) fn candidates_by_style(&self) -> BTreeMap<String, u32> {
        self.texts.iter().map(|text| (text.style.clone(), text.candidate)).collect()
    }

    /// The text of a style.
    pub(super) fn text_in_style(&self, style: &str) -> Option<&ArmText> {
        self.texts.iter().find(|text| text.style == style)
    }
}
