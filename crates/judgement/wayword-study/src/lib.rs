//! A study with people, who judge texts that describe a way: they walk by a text, rate one, or choose between two.
//!
//! A caller makes a study from items (text, path, pictures, graph) with [`Study::create`]. [`serve_study`] shows it to people as a web site
//! and keeps each answer on disk before it acknowledges it. [`compute_results()`] turns the answers ([`StudyData`]) into tables.
//!
//! Architecture invariants: an async runtime lives in the folder `site` alone, and no page contains the name of a goal, a path, a scene
//! or a condition, because a participant could guess from it which text is expected to be the better one.

mod commands;
pub mod results;
mod site;
mod store;
mod study;
mod token;
mod wording;

pub use results::{StudyReport, compute_results};
pub use site::{ListenOptions, SiteAddress, SiteSecurity, serve_study};
pub use store::{
    ConditionProgress, ErasureReport, InviteTokens, Reconciliation, ReconciliationRow, StudyProgress, now_ms,
};
pub use study::{
    AttentionCheck, CompletionCodes, ComprehensionQuestion, ConditionKind, FilmPicture, ItemSlot, PairChoice,
    Participant, ParticipantAnswer, ParticipantMove, ParticipantStatus, RecruiterSettings, SlotState, Study,
    StudyCondition, StudyData, StudyDesign, StudyError, StudyItem, StudyRoute, StudyScene, StudySettings, StudyTask,
    StudyText, StudyViewpoint, TextMark,
};
pub use wording::{FOLLOW_STATEMENTS, RATE_QUESTIONS, RatingScale};
