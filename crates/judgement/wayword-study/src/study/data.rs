//! What people gave.

use super::{Item, Plan, Route, Scene, Settings};
use serde::{Deserialize, Serialize};
use wayword_core::ViewpointId;

/// A study with all that people gave: what results are made of. Ids of recruiters are not in it.
#[derive(Debug, Clone)]
pub struct Data {
    /// What was fixed.
    pub plan: Plan,
    /// How it was worded.
    pub settings: Settings,
    /// All items, by id.
    pub items: Vec<Item>,
    /// All routes, by id.
    pub routes: Vec<Route>,
    /// The ground that was walked; empty where nobody walks.
    pub scenes: Vec<Scene>,
    /// Everybody who consented and was not forgotten, in order of consent.
    pub participants: Vec<Participant>,
    /// Items that were given to people, in order; those of practice too.
    pub slots: Vec<Slot>,
    /// How many participants were forgotten.
    pub forgotten: u64,
    /// Whether the study is closed.
    pub is_closed: bool,
}

/// How far a participant is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// Has consented and not finished. Whether somebody still comes back is not known.
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

impl Status {
    /// All of them.
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

/// Somebody who takes part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Participant {
    /// A random id, made for the results.
    pub id: String,
    /// How far.
    pub status: Status,
    /// Unix time of consent, milliseconds.
    pub consented_ms: i64,
    /// Hash of what was consented to.
    pub consent: String,
    /// Unix time of the end, milliseconds.
    pub finished_ms: Option<i64>,
    /// Unix time of the last sign of life, milliseconds.
    pub seen_ms: i64,
    /// How often the questions about the task were answered wrongly: 0, 1 or 2.
    pub misunderstood: u32,
    /// Whether they were answered rightly in the end, or there are none.
    pub understood: bool,
    /// What the recruiter said of the submission when its list was last imported.
    pub recruiter_status: Option<String>,
    /// The attention checks that were answered, in order.
    pub attention: Vec<Passed>,
    /// How many items were to be answered.
    pub expected: u32,
}

/// An attention check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Passed {
    /// Its number, from 0.
    pub number: u32,
    /// Whether the answer that was asked for was given.
    pub passed: bool,
    /// Unix time, milliseconds.
    pub at_ms: i64,
}

/// An item that was given to a participant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Slot {
    /// The participant's id.
    pub participant: String,
    /// The item's number.
    pub item: u32,
    /// Its place among the participant's items, from 0; practice has none.
    pub position: Option<u32>,
    /// What became of it.
    pub state: SlotState,
    /// Unix time when it was given, milliseconds.
    pub given_ms: i64,
    /// Unix time of the answer, milliseconds.
    pub answered_ms: Option<i64>,
    /// In a pair: whether the item's second text was shown as A.
    pub is_turned: bool,
    /// What was answered.
    pub answer: Option<Answer>,
    /// A text of the participant's own, where one was asked for first.
    pub own_text: Option<String>,
    /// Where the participant walked; the start is not in it.
    pub moves: Vec<Move>,
}

/// What became of an item that was given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SlotState {
    /// The participant has it and may still answer.
    Live,
    /// Answered.
    Answered,
    /// The time ran out, or the participant stopped: it went back.
    Returned,
}

/// A step of a walk.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Move {
    /// Where it leads.
    pub viewpoint: ViewpointId,
    /// Unix time, milliseconds.
    pub at_ms: i64,
}

/// An answer to an item.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "mode")]
pub enum Answer {
    /// Of a walk.
    Follow {
        /// How far one agrees to the three statements, 1 to 5.
        statements: [u8; 3],
        /// How often the participant turned to look, as the page counted.
        looks: u32,
        /// Unix time of stopping, milliseconds.
        stopped_ms: i64,
    },
    /// Of a text.
    Rate {
        /// The levels of the four questions, 1 to 5.
        ratings: [u8; 4],
    },
    /// Between two texts.
    Pair {
        /// Which one, by the sides on which they were shown.
        choice: Choice,
    },
}

/// Which of two texts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Choice {
    /// The text shown as A.
    A,
    /// The text shown as B.
    B,
    /// About equal.
    Tie,
    /// Neither is good.
    Bad,
}
