//! The parts of a study (plan, settings, items, routes, scenes, answers), and the folder that contains them.

mod data;
mod error;
mod folder;
mod item;
mod plan;
mod settings;

pub use data::{Answer, Choice, Data, Move, Participant, Passed, Slot, SlotState, Status};
pub use error::StudyError;
pub use folder::Study;
pub use item::{Item, Mark, Picture, Place, Route, Scene, Told};
pub use plan::{Condition, Kind, Mode, Plan};
pub use settings::{Codes, Question, Recruiter, Settings};
