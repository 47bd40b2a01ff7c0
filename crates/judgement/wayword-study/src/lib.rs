//! A study with people, who judge texts that describe a way: they walk by a text, rate one, or choose between two.
//!
//! A caller makes a study from items (text, path, pictures, graph) with [`Study::create`]. [`serve`] shows it to people as a web site
//! and keeps each answer on disk before it acknowledges it. [`results()`] turns the answers ([`Data`]) into tables.
//!
//! Architecture invariants: an async runtime lives in the folder `site` alone, and no page contains the name of a goal, a path, a scene
//! or a condition, because a participant could guess from it which text is expected to be the better one.

mod office;
pub mod results;
mod site;
mod store;
mod study;
mod token;
mod wording;

pub use results::{Results, results};
pub use site::{Listen, Security, Started, serve};
pub use store::{Forgotten, Invited, Progress, Reconciled, Reconciliation, Row, now_ms};
pub use study::{
    Answer, Choice, Codes, Condition, Data, Item, Kind, Mark, Mode, Move, Participant, Passed, Picture, Place, Plan,
    Question, Recruiter, Route, Scene, Settings, Slot, SlotState, Status, Study, StudyError, Told,
};
pub use wording::{QUESTIONS, STATEMENTS, Scale};
