//! A study with people, who judge texts that describe a way: they follow a text, rate one, or choose between two.
//!
//! A caller makes a study from items (text, path, pictures, graph) with [`Study::create`]. [`serve_study`] shows it to people as a web site
//! and keeps each answer on disk before it acknowledges it. [`compute_results()`] turns the answers ([`StudyData`]) into tables.
//!
//! Architecture invariants: an async runtime lives in the folder `site` alone, and no page contains the name of a goal, a path, a scene
//! or a condition, because a participant could guess from it which text is expected to be the better one.
//!
//! # Where things are
//! - `study/plan.rs`, `settings.rs`, `data.rs`: the fixed part of a study, the settings of `study.toml`, and the answers of people.
//! - `study/texts.toml`, `page_texts.rs`: the words of the pages, and their translations.
//! - `study/output_guard.rs`: no output lands in a study's folder.
//! - `study/end_question.rs`, `exclusion.rs`: the researcher's own questions, and the rules that leave out answers.
//! - `wording`: the questions and scales.
//! - `store/assign.rs`, `stage.rs`: who gets which item, and what comes next. `store/schema.sql`: the tables.
//! - `store/people.rs`, `recruits.rs`: consent, links, withdrawal, forgetting; the recruiter's list.
//! - `site/pages/`, `site/assets/`: the pages; `site/pages.rs`: what they are given.
//! - `site/routes.rs`, `request_guard.rs`, `listen.rs`, `tls.rs`: addresses, headers and pace, connections.
//! - `results/`: tables, plots and files, and the outlook of a planned study. Their statistics are in `wayword-metrics`.

mod commands;
pub mod results;
mod site;
mod store;
mod study;
mod token;
mod wording;

pub use results::{StudyReport, compute_results};
pub use site::{ListenOptions, SiteAddress, SiteSecurity, preview_study, serve_study};
pub use store::{
    ConditionProgress, ErasureReport, InviteTokens, Reconciliation, ReconciliationRow, StudyProgress, now_ms,
};
pub use study::{
    AttentionCheck, CompletionCodes, ComprehensionQuestion, ConditionKind, ConsentLink, ENGLISH_TEXTS, EndAnswer,
    EndQuestion, EndQuestionKind, ExclusionRules, FilmMotion, FilmPicture, ItemSlot, PageTexts, PairChoice,
    Participant, ParticipantAnswer, ParticipantMove, ParticipantStatus, RecruiterSettings, SlotState, Study,
    StudyCondition, StudyData, StudyDesign, StudyError, StudyItem, StudyRoute, StudyScene, StudySettings, StudyTask,
    StudyText, StudyViewpoint, TextMark, WindowSize,
};
pub use wording::{FOLLOW_STATEMENTS, RATE_QUESTIONS, RatingScale};
