//! A study with people: they walk by a text, rate it, or choose between two; nothing that they gave is lost.
//!
//! A caller makes a study from items (text, path, pictures, graph) with [`Study::create`], [`serve`] shows it to people, and
//! [`Data`] reads what they gave. Architecture invariant: an async runtime lives in the folder `site` alone, and what a page receives
//! never names a goal, a path, a scene or a condition.

pub mod results;
mod study;
mod wording;

pub use results::{Results, results};
pub use study::{
    Answer, Choice, Condition, Data, Item, Kind, Mode, Move, Participant, Passed, Picture, Place, Plan, Route, Scene,
    Settings, Slot, SlotState, Status, Study, StudyError, Told,
};
