//! The parts of a study (plan, settings, items, routes, scenes, answers), and the folder that contains them.

mod data;
mod error;
mod folder;
mod item;
mod plan;
mod settings;

pub use data::{
    AttentionCheck, ItemSlot, PairChoice, Participant, ParticipantAnswer, ParticipantMove, ParticipantStatus,
    SlotState, StudyData,
};
pub use error::StudyError;
pub use folder::Study;
pub use item::{FilmPicture, StudyItem, StudyRoute, StudyScene, StudyText, StudyViewpoint, TextMark};
pub use plan::{ConditionKind, StudyCondition, StudyDesign, StudyTask};
pub use settings::{CompletionCodes, ComprehensionQuestion, RecruiterSettings, StudySettings};
