//! The answers of a study as data, the input of [`crate::compute_results()`].

use super::{EndAnswer, PageTexts, StudyDesign, StudyItem, StudyRoute, StudyScene, StudySettings, WindowSize};
use serde::{Deserialize, Serialize};
use wayword_core::ViewpointId;

/// A study with all answers of its participants. It does not contain ids from recruiters.
#[derive(Debug, Clone)]
pub struct StudyData {
    /// The plan, which was fixed when the study was made.
    pub plan: StudyDesign,
    /// Wording and other settings.
    pub settings: StudySettings,
    /// The words of the pages.
    pub texts: PageTexts,
    /// All items, by id.
    pub items: Vec<StudyItem>,
    /// All routes, by id.
    pub routes: Vec<StudyRoute>,
    /// The scenes that people walked; empty unless the mode is following.
    pub scenes: Vec<StudyScene>,
    /// All participants who consented and were not forgotten, in order of consent.
    pub participants: Vec<Participant>,
    /// Items that were handed out, in order, including practice items.
    pub slots: Vec<ItemSlot>,
    /// How many participants were forgotten.
    pub forgotten: u64,
    /// Whether the study is closed.
    pub is_closed: bool,
}

/// How far a participant has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ParticipantStatus {
    /// Has consented and not finished. The participant may still come back.
    Started,
    /// Has answered everything.
    Complete,
    /// Has stopped, and let us keep the answers.
    Withdrawn,
    /// Did not understand the task in two tries.
    ScreenedOut,
    /// Has answered everything, and failed the attention checks.
    AttentionFailed,
}

impl ParticipantStatus {
    /// All statuses.
    pub(crate) const ALL: [Self; 5] =
        [Self::Started, Self::Complete, Self::Withdrawn, Self::ScreenedOut, Self::AttentionFailed];

    /// Its name in files and in the database.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Started => "started",
            Self::Complete => "complete",
            Self::Withdrawn => "withdrawn",
            Self::ScreenedOut => "screened_out",
            Self::AttentionFailed => "attention_failed",
        }
    }
}

/// A person who takes part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Participant {
    /// A random id, made for the results.
    pub id: String,
    /// How far the participant has come.
    pub status: ParticipantStatus,
    /// Unix time of consent, milliseconds.
    pub consented_ms: i64,
    /// Hash of the consent text to which the participant agreed.
    pub consent: String,
    /// Unix time of the end, milliseconds.
    pub finished_ms: Option<i64>,
    /// Unix time of the last sign of life, milliseconds.
    pub seen_ms: i64,
    /// How often the questions about the task were answered wrongly: 0, 1 or 2.
    pub misunderstood: u32,
    /// Whether the questions about the task were answered rightly in the end; true if the study has no such questions.
    pub understood: bool,
    /// The recruiter's status of the submission when its list was last imported.
    pub recruiter_status: Option<String>,
    /// The attention checks that were answered, in order.
    pub attention: Vec<AttentionCheck>,
    /// How many items were to be answered.
    pub expected: u32,
    /// The answers to the questions at the end; empty until they are answered.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub end: Vec<EndAnswer>,
}

/// The result of an attention check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct AttentionCheck {
    /// Its number, from 0.
    pub number: u32,
    /// Whether the participant chose the answer that the check asked for.
    pub passed: bool,
    /// Unix time, milliseconds.
    pub at_ms: i64,
}

/// An item that was given to a participant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ItemSlot {
    /// The participant's id.
    pub participant: String,
    /// The item's number.
    pub item: u32,
    /// Its place among the participant's items, from 0; `None` for a practice item.
    pub position: Option<u32>,
    /// What became of it.
    pub state: SlotState,
    /// Unix time when it was given, milliseconds.
    pub given_ms: i64,
    /// Unix time of the answer, milliseconds.
    pub answered_ms: Option<i64>,
    /// In a pair: whether the item's second text was shown as A.
    pub is_turned: bool,
    /// The answer, if there is one.
    pub answer: Option<ParticipantAnswer>,
    /// The text that the participant wrote first, if the study asked for one.
    pub own_text: Option<String>,
    /// How many different pictures of the film the participant saw, as the page counted; `None` where it could not count.
    pub pictures_seen: Option<u32>,
    /// The steps of the participant's walk. The start is left out.
    pub moves: Vec<ParticipantMove>,
}

/// What became of an item that was handed out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SlotState {
    /// The participant has it and may still answer.
    Live,
    /// The participant has answered it.
    Answered,
    /// The lease ran out or the participant stopped, and the item went back to the others.
    Returned,
}

/// A step of a walk.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ParticipantMove {
    /// The viewpoint to which it leads.
    pub viewpoint: ViewpointId,
    /// Unix time, milliseconds.
    pub at_ms: i64,
}

/// An answer to an item.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "mode")]
pub enum ParticipantAnswer {
    /// The answer after a walk.
    Follow {
        /// Agreement with the three statements, 1 to 5.
        statements: [u8; 3],
        /// How often the participant turned to look, as the page counted.
        looks: u32,
        /// Unix time of stopping, milliseconds.
        stopped_ms: i64,
        /// The window in which the page was shown; `None` where the page could not measure it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        window: Option<WindowSize>,
    },
    /// The rating of a text.
    Rate {
        /// The levels of the four questions, 1 to 5.
        ratings: [u8; 4],
    },
    /// The choice between two texts.
    Pair {
        /// The chosen side of the page.
        choice: PairChoice,
    },
}

/// Which of two texts was chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PairChoice {
    /// The text shown as A.
    A,
    /// The text shown as B.
    B,
    /// About equal.
    Tie,
    /// Neither is good.
    Bad,
}
