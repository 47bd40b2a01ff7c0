//! An instruction, with its verdict and with links from its words to the evidence.

use crate::{CheckFinding, TextAmbiguity, Verdict};
use serde::{Deserialize, Serialize};

/// Longest text of an instruction, bytes, whether it comes from a dataset or from a model. An instruction is a few
/// sentences. A longer text is refused unread.
pub const MAX_TEXT_BYTES: usize = 20_000;

/// A wayfinding instruction, its provenance, and the findings of its checks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Instruction {
    /// Its words.
    pub text: String,
    /// Name of the style it is written in.
    pub style: String,
    /// The parts of the text that have evidence, in the order of the text.
    pub mentions: Vec<TextMention>,
    /// The parts of the text in order, each with its frames of the path; none where the text was not aligned with its path, as in
    /// records of older versions.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<InstructionPart>,
    /// All checks together.
    pub verdict: Verdict,
    /// Each check's outcome.
    pub findings: Vec<CheckFinding>,
    /// What the text may mean; `None` where it was not examined, as in records of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ambiguity: Option<TextAmbiguity>,
    /// How it came about.
    pub provenance: TextProvenance,
}

/// Words of an instruction that name something on the path.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct TextMention {
    /// Byte range in the text.
    pub span: [usize; 2],
    /// The kind of thing that they name.
    pub kind: MentionKind,
    /// The frame that has the evidence.
    pub frame: usize,
}

/// A part of an instruction: words that belong to one stretch of the path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InstructionPart {
    /// Byte range in the text.
    pub span: [usize; 2],
    /// The frames where its stretch begins and ends. The next part begins where it ends.
    pub frames: [usize; 2],
    /// How likely its stretch is exactly this, from 0 to 1; `None` where the motion along the path is unknown, so that only the places
    /// that the text names decide.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub confidence: Option<f64>,
}

/// The kind of thing that words of an instruction name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MentionKind {
    /// An object.
    Landmark,
    /// A room.
    Room,
    /// A turn.
    Turn,
    /// A storey or stairs.
    Floor,
    /// The object of the closing task.
    Target,
}

/// How an instruction came about.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TextProvenance {
    /// Version of Wayword that made it.
    pub wayword: String,
    /// The asker of questions about the frames (`rules`, `provider/model`).
    pub asker: String,
    /// The answerer (`labels` is ground truth, not perception).
    pub answerer: String,
    /// The detector that looked for things in the pictures, and the meaning of its scores.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub detector: Option<String>,
    /// The summariser of the answers.
    pub summariser: String,
    /// The writer of the text.
    pub writer: String,
    /// The evidence that the checks compared it with (`labels`, `captions`).
    pub checked_against: String,
    /// The run's seed.
    pub seed: u64,
    /// Hash of the style's reference texts and constraints.
    pub style_hash: String,
    /// Hash of the prompts, where a language model took part.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prompts_hash: Option<String>,
    /// How often it was written again because a check failed.
    pub repairs: u32,
    /// The writer that gave up because all its texts failed their checks, where another writer finished for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub finished_for: Option<String>,
    /// How it was chosen, where several texts were written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chosen: Option<TextSelection>,
    /// The texts of a model that were not kept, in the order in which they were written.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub drafts: Vec<WrittenDraft>,
    /// The rounds in which a text that passed was written again because a follower did not arrive by it surely.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub refined: Vec<RefinedRound>,
    /// Whether the path has a target that was not visible from the last frame: the writer knew its name alone.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub target_undescribed: bool,
}

/// A text that a model wrote and that was not kept.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WrittenDraft {
    /// The text, or the beginning of a reply that is none.
    pub text: String,
    /// The number of its candidate, from 0.
    #[serde(default)]
    pub candidate: u32,
    /// Why it was not kept.
    pub reasons: Vec<String>,
    /// The checks that it failed; empty where it was not kept for another reason. Spans are byte ranges of the text.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<CheckFinding>,
}

/// A round of writing a text again after a follower walked by it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RefinedRound {
    /// How likely the text before led to the end of its walk, from 0 to 1.
    pub before: f64,
    /// The same of the new text; `None` where it failed its checks or cannot be followed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub after: Option<f64>,
    /// Whether the new text was kept.
    pub kept: bool,
}

/// How a text was chosen among several.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct TextSelection {
    /// How many texts were written, repairs left out.
    pub among: u32,
    /// How many of them passed their checks.
    pub passed: u32,
    /// Which of them it is, from 0.
    #[serde(default)]
    pub number: u32,
    /// The judge that chose.
    pub by: ChosenBy,
}

/// The judge that chose a text among several.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChosenBy {
    /// A follower: the text leads to the end of its walk, and means its object, most surely for its length.
    Follower,
    /// The checks alone, because no text can be followed.
    Checks,
}
