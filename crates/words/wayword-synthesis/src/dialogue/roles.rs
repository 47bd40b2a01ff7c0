//! The roles that make the caption of a view, as traits that rules and models implement.

use super::DialogueMode;
use wayword_core::{Caption, DialogueExchange, ModelError, ViewAnswerer};

/// Chooses the questions.
pub trait QuestionAsker: Send + Sync {
    /// `rules`, or `provider/model`.
    fn name(&self) -> &str;
    /// The next question after this transcript, or `None` if there is none left to ask.
    ///
    /// # Errors
    /// When the model that chooses it fails.
    fn next_question(&self, transcript: &[DialogueExchange]) -> Result<Option<String>, ModelError>;
}

/// Sums a dialogue up.
pub trait CaptionSummariser: Send + Sync {
    /// `rules`, or `provider/model`.
    fn name(&self) -> &str;
    /// A caption of the answers that `answerer` gave. It names no object that an answer denied.
    ///
    /// # Errors
    /// When the model that writes it fails.
    fn sum_up(&self, transcript: &[DialogueExchange], answerer: &str) -> Result<Caption, ModelError>;

    /// Condenses captions of one place, each with its direction in words ("north"), into one description of fewer than
    /// `fewer_words_than` words. The result names who made it, where that is not this summariser.
    ///
    /// # Errors
    /// When the model that writes it fails.
    fn condense(&self, captions: &[(&str, &Caption)], fewer_words_than: usize) -> Result<CondensedCaption, ModelError>;
}

/// Captions of several looks as one description.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CondensedCaption {
    /// The description.
    pub text: String,
    /// The name of who made it, if the summariser failed and another took over.
    pub by: Option<String>,
}

/// The roles that make captions of views: asker, answerer and summariser, and the mode in which they work.
#[derive(Clone, Copy)]
pub struct ObservationRoles<'a> {
    /// Chooses the questions.
    pub asker: &'a dyn QuestionAsker,
    /// Answers them.
    pub answerer: &'a dyn ViewAnswerer,
    /// Sums the answers up.
    pub summariser: &'a dyn CaptionSummariser,
    /// Dialogue, or fixed queries.
    pub mode: DialogueMode,
    /// Hash of the prompts, where a language model plays a role.
    pub prompts_hash: Option<&'a str>,
    /// The name of the detector that corrected the captions, with its score threshold, if there is one.
    pub detector: Option<&'a str>,
}

impl ObservationRoles<'_> {
    /// The error for an answerer that returns no answer to a question. Without the error the dialogue would repeat the
    /// question forever.
    pub(crate) fn unanswered_error(&self) -> ModelError {
        ModelError::Failed { model: self.answerer.name().to_owned(), reason: "it gave no answer".to_owned() }
    }
}
