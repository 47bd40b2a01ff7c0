//! The parts of a study (plan, settings, items, routes, scenes, answers), and the folder that contains them.

mod consent_page;
mod data;
mod end_question;
mod error;
mod exclusion;
mod folder;
mod item;
mod output_guard;
mod page_texts;
mod plan;
mod serve_lock;
mod settings;
mod window;

pub use consent_page::ConsentLink;
pub use data::{
    AttentionCheck, ItemSlot, PairChoice, Participant, ParticipantAnswer, ParticipantMove, ParticipantStatus,
    SlotState, StudyData,
};
pub(crate) use end_question::EndAnswerFault;
pub use end_question::{EndAnswer, EndQuestion, EndQuestionKind};
pub use error::StudyError;
pub use exclusion::ExclusionRules;
pub(crate) use exclusion::{FILM_NOT_WATCHED, TOO_FAST, TOO_FEW_MOVES};
pub use folder::Study;
pub use item::{FilmPicture, StudyItem, StudyRoute, StudyScene, StudyText, StudyViewpoint, TextMark};
pub(crate) use page_texts::fill_placeholders;
pub use page_texts::{ENGLISH_TEXTS, FilmMotion, PageTexts};
pub use plan::{ConditionKind, StudyCondition, StudyDesign, StudyTask};
pub(crate) use serve_lock::ServeLock;
pub use settings::{CompletionCodes, ComprehensionQuestion, RecruiterSettings, StudySettings};
pub use window::WindowSize;
