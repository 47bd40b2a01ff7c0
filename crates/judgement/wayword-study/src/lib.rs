//! A study with people: they walk by a text, rate it, or choose between two; nothing that they gave is lost.
//!
//! A caller makes a study from items (text, path, pictures, graph) with [`Study::create`], [`serve`] shows it to people, and
//! [`results()`] turns what they gave ([`Data`]) into tables. Architecture invariant: an async runtime lives in the folder `site` alone, and what a page receives
//! never names a goal, a path, a scene or a condition.

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
