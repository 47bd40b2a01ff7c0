//! Prompts for language models: templates, each of which can be overridden, and what they are filled with.
//!
//! The parts of the writing prompt and their order follow arXiv 2403.11487; the words are ours. Beyond it: measured moves,
//! so that no turn is guessed, and the reasons for which an earlier text was refused.

mod bounds;
pub(crate) mod trial;
mod writing;

use minijinja::{Environment, ErrorKind, UndefinedBehavior, context};
use sha2::{Digest, Sha256};
use wayword_core::{Exchange, ModelError, Sighting, Witness};

use crate::{dialogue::is_opening, writer::Brief};

/// The templates: name and source.
const BUILT_IN: [(&str, &str); 7] = [
    ("question", include_str!("templates/question.j2")),
    ("answer", include_str!("templates/answer.j2")),
    ("answer_question", include_str!("templates/answer_question.j2")),
    ("answer_completion", include_str!("templates/answer_completion.j2")),
    ("summary", include_str!("templates/summary.j2")),
    ("condense", include_str!("templates/condense.j2")),
    ("write", include_str!("templates/write.j2")),
];

/// How a model that sees wants to be spoken to.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Manner {
    /// It follows instructions, and is told how to answer (`answer`).
    #[default]
    Chat,
    /// It takes a bare question, and describes where there are no words (`answer_question`): BLIP.
    Question,
    /// It goes on with a text (`answer_completion`): BLIP-2. The form is the one of ChatCaptioner.
    Completion,
}

/// Filled templates, and the hash that tells which ones they were.
#[derive(Debug)]
pub struct Prompts {
    templates: Environment<'static>,
    hash: String,
}

/// A template that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PromptError {
    /// A name that no prompt has.
    #[error("there is no prompt {name:?}: name one of {}", Prompts::names().collect::<Vec<_>>().join(", "))]
    Unknown {
        /// The name.
        name: String,
    },
    /// It is no template, or asks for what it is not given.
    #[error("prompt {name}: {source}")]
    Template {
        /// Which.
        name: String,
        /// What is wrong with it.
        source: minijinja::Error,
    },
    /// It asks for something that takes memory or time without bound.
    #[error("prompt {name}, line {line}: {what}")]
    Refused {
        /// Which.
        name: String,
        /// Where.
        line: usize,
        /// What it asks for, and what prompts offer.
        what: String,
    },
    /// It writes or does more than any prompt needs.
    #[error("prompt {name}: {what}; write a shorter one")]
    TooMuch {
        /// Which.
        name: String,
        /// What it does, with the bound.
        what: String,
    },
}

impl From<PromptError> for ModelError {
    /// A prompt that cannot be filled would fail for every frame.
    fn from(error: PromptError) -> Self {
        let hint = "correct the template in the folder of --prompts".to_owned();
        Self::Stopped { reason: error.to_string(), hint }
    }
}

impl Prompts {
    /// The built-in prompts, with those of a user's own (name and source) in their stead.
    ///
    /// # Errors
    /// When a name is unknown, a source is no template, or one asks for what it is not given.
    pub fn new(own: &[(String, String)]) -> Result<Self, PromptError> {
        if let Some((name, _)) = own.iter().find(|(name, _)| !BUILT_IN.iter().any(|(built_in, _)| built_in == name)) {
            return Err(PromptError::Unknown { name: name.clone() });
        }
        let mut templates = bounds::environment();
        // A template that asks for what it is not given is a mistake to be told, not a gap in a prompt.
        templates.set_undefined_behavior(UndefinedBehavior::Strict);
        let mut hash = Sha256::new();
        for (name, source) in BUILT_IN {
            let source = own.iter().find(|(own, _)| own == name).map_or(source, |(_, source)| source);
            hash.update(name);
            hash.update([0]);
            hash.update(source);
            hash.update([0]);
            let failed = |source| PromptError::Template { name: name.to_owned(), source };
            bounds::allow(name, source)?;
            templates.add_template_owned(name, source.to_owned()).map_err(failed)?;
        }
        let hash = hash.finalize().iter().take(8).map(|byte| format!("{byte:02x}")).collect();
        let prompts = Self { templates, hash };
        trial::fill_all(&prompts)?;
        Ok(prompts)
    }

    /// The names of the prompts.
    pub fn names() -> impl Iterator<Item = &'static str> {
        BUILT_IN.iter().map(|(name, _)| *name)
    }

    /// Tells which templates these are, for provenance.
    #[must_use]
    pub fn hash(&self) -> &str {
        &self.hash
    }

    fn fill(&self, name: &str, with: minijinja::Value) -> Result<String, PromptError> {
        let failed = |source: minijinja::Error| match source.kind() {
            ErrorKind::OutOfFuel => PromptError::TooMuch { name: name.to_owned(), what: bounds::too_many_steps() },
            ErrorKind::WriteFailure => PromptError::TooMuch { name: name.to_owned(), what: bounds::too_many_bytes() },
            _ => PromptError::Template { name: name.to_owned(), source },
        };
        let mut text = bounds::Text::default();
        let template = self.templates.get_template(name).map_err(failed)?;
        template.render_captured_to(with, &mut text).map_err(failed)?;
        Ok(text.into_string().trim().to_owned())
    }

    /// Asks a language model for the next question.
    ///
    /// # Errors
    /// When an overridden template does not fit.
    pub fn question(&self, transcript: &[Exchange]) -> Result<String, PromptError> {
        self.fill("question", context! { transcript })
    }

    /// Puts a question to a model that sees.
    ///
    /// # Errors
    /// When an overridden template does not fit.
    pub fn answer(&self, manner: Manner, question: &str, history: &[Exchange]) -> Result<String, PromptError> {
        let name = match manner {
            Manner::Chat => "answer",
            Manner::Question => "answer_question",
            Manner::Completion => "answer_completion",
        };
        self.fill(name, context! { question, history, is_opening => is_opening(question) })
    }

    /// Asks a language model to sum a dialogue up; what was denied is named, so that it stays out, and so is what was wrong
    /// with an earlier summary.
    ///
    /// # Errors
    /// When an overridden template does not fit.
    pub fn summary(
        &self,
        transcript: &[Exchange],
        told: &[Sighting],
        complaints: &[String],
    ) -> Result<String, PromptError> {
        let denied: Vec<&str> = told
            .iter()
            .filter(|sighting| sighting.witness == Witness::Denied)
            .map(|sighting| sighting.name.as_str())
            .collect();
        self.fill("summary", context! { transcript, denied, complaints })
    }

    /// Asks a language model to condense captions of several directions.
    ///
    /// # Errors
    /// When an overridden template does not fit.
    pub fn condense(
        &self,
        captions: &[(&str, &str)],
        fewer_words_than: usize,
        complaints: &[String],
    ) -> Result<String, PromptError> {
        let captions: Vec<_> = captions.iter().map(|(direction, text)| context! { direction, text }).collect();
        self.fill("condense", context! { captions, fewer_words_than, complaints })
    }

    /// Asks a language model to write an instruction, or to write it again.
    ///
    /// # Errors
    /// When an overridden template does not fit.
    pub fn write(&self, brief: &Brief<'_>) -> Result<String, PromptError> {
        self.fill("write", writing::context(brief))
    }
}

#[cfg(test)]
mod tests;
