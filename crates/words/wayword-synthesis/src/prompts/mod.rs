//! Prompts for language models: templates, which users can override one by one, and the values that fill them.
//!
//! The parts of the writing prompt and their order follow arXiv 2403.11487; the wording is our own. Beyond the paper,
//! the prompt contains measured moves, so that the model need not guess turns, and the reasons why an earlier text
//! failed.

mod bounds;
mod corrections;
mod detail;
mod looks;
mod move_words;
pub(crate) mod trial_fill;
mod walk_parts;
mod writing;

use minijinja::{Environment, ErrorKind, UndefinedBehavior, context};
use sha2::{Digest, Sha256};
use wayword_core::{DialogueExchange, ModelError, ObjectSighting, WitnessAnswer, hex_text};

use crate::{dialogue::is_opening, writer::WritingBrief};
use detail::PromptDetail;
use writing::writing_context;

/// The built-in templates: name and source. A user can override each by its name.
const BUILT_IN: [(&str, &str); 8] = [
    ("see", include_str!("templates/see.j2")),
    ("question", include_str!("templates/question.j2")),
    ("answer", include_str!("templates/answer.j2")),
    ("answer_question", include_str!("templates/answer_question.j2")),
    ("answer_completion", include_str!("templates/answer_completion.j2")),
    ("summary", include_str!("templates/summary.j2")),
    ("condense", include_str!("templates/condense.j2")),
    ("write", include_str!("templates/write.j2")),
];

/// The form of prompt that a vision model expects.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum PromptManner {
    /// It follows instructions: the prompt explains how to answer (`answer`).
    #[default]
    Chat,
    /// It takes a bare question, and describes the picture if the prompt is empty (`answer_question`): BLIP.
    Question,
    /// It continues a text (`answer_completion`): BLIP-2. The form is ChatCaptioner's.
    Completion,
}

/// The templates, and a hash that identifies them.
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
    /// It is no valid template, or asks for a variable that it does not get.
    #[error("prompt {name}.j2: {source}")]
    Template {
        /// Which prompt.
        name: String,
        /// The fault.
        source: minijinja::Error,
    },
    /// It uses a feature that can take unlimited memory or time.
    #[error("prompt {name}.j2, line {line}: {what}")]
    Refused {
        /// Which prompt.
        name: String,
        /// The line, from 1.
        line: usize,
        /// What it uses, and what prompts offer.
        what: String,
    },
    /// It writes more text or takes more steps than any prompt needs.
    #[error("prompt {name}.j2: {what}; write a shorter one")]
    TooMuch {
        /// Which prompt.
        name: String,
        /// What it does, with the bound.
        what: String,
    },
}

impl From<PromptError> for ModelError {
    /// A prompt that cannot be filled would fail for every frame.
    fn from(error: PromptError) -> Self {
        let hint = "correct the template in the folder of --prompts".to_owned();
        Self::Stopped { reason: error.to_string(), hint, is_lost: false }
    }
}

impl Prompts {
    /// The built-in prompts, with the user's own (name and source) in place of those of the same name.
    ///
    /// # Errors
    /// When a name is unknown, a source is no template, or one asks for a variable that it does not get.
    pub fn new(own: &[(String, String)]) -> Result<Self, PromptError> {
        if let Some((name, _)) = own.iter().find(|(name, _)| !BUILT_IN.iter().any(|(built_in, _)| built_in == name)) {
            return Err(PromptError::Unknown { name: name.clone() });
        }
        let mut templates = bounds::bounded_environment();
        // A template that asks for a variable that it does not get is an error, because the prompt would have a gap.
        templates.set_undefined_behavior(UndefinedBehavior::Strict);
        let mut hash = Sha256::new();
        for (name, source) in BUILT_IN {
            let source = own.iter().find(|(own, _)| own == name).map_or(source, |(_, source)| source);
            hash.update(name);
            hash.update([0]);
            hash.update(source);
            hash.update([0]);
            let failed = |source| PromptError::Template { name: name.to_owned(), source };
            bounds::check_template(name, source)?;
            templates.add_template_owned(name, source.to_owned()).map_err(failed)?;
        }
        let hash = hex_text(&hash.finalize()[..8]);
        let prompts = Self { templates, hash };
        trial_fill::fill_all(&prompts)?;
        Ok(prompts)
    }

    /// The names of the prompts.
    pub fn names() -> impl Iterator<Item = &'static str> {
        BUILT_IN.iter().map(|(name, _)| *name)
    }

    /// Identifies the templates, for provenance.
    #[must_use]
    pub fn hash(&self) -> &str {
        &self.hash
    }

    fn fill_template(&self, name: &str, with: minijinja::Value) -> Result<String, PromptError> {
        let failed = |source: minijinja::Error| match source.kind() {
            ErrorKind::OutOfFuel => PromptError::TooMuch { name: name.to_owned(), what: bounds::too_many_steps() },
            ErrorKind::WriteFailure => PromptError::TooMuch { name: name.to_owned(), what: bounds::too_many_bytes() },
            _ => PromptError::Template { name: name.to_owned(), source },
        };
        let mut text = bounds::PromptText::default();
        let template = self.templates.get_template(name).map_err(failed)?;
        template.render_captured_to(with, &mut text).map_err(failed)?;
        Ok(text.into_string().trim().to_owned())
    }

    /// Asks a language model for the next question.
    ///
    /// # Errors
    /// When an overridden template cannot be filled.
    pub fn question_prompt(&self, transcript: &[DialogueExchange]) -> Result<String, PromptError> {
        self.fill_template("question", context! { transcript })
    }

    /// Puts a question to a vision model.
    ///
    /// # Errors
    /// When an overridden template cannot be filled.
    pub fn answer_prompt(
        &self,
        manner: PromptManner,
        question: &str,
        history: &[DialogueExchange],
    ) -> Result<String, PromptError> {
        let name = match manner {
            PromptManner::Chat => "answer",
            PromptManner::Question => "answer_question",
            PromptManner::Completion => "answer_completion",
        };
        self.fill_template(name, context! { question, history, is_opening => is_opening(question) })
    }

    /// Asks a vision model for everything that a view shows, as JSON. `complaint` is the fault of its last answer.
    ///
    /// # Errors
    /// When an overridden template cannot be filled.
    pub fn view_prompt(&self, complaint: Option<&str>) -> Result<String, PromptError> {
        self.fill_template("see", context! { complaint => complaint.unwrap_or_default() })
    }

    /// Asks a language model to summarise a dialogue. The prompt lists the denied objects, so that they stay out, and
    /// the faults of an earlier summary.
    ///
    /// # Errors
    /// When an overridden template cannot be filled.
    pub fn summary_prompt(
        &self,
        transcript: &[DialogueExchange],
        sightings: &[ObjectSighting],
        complaints: &[String],
    ) -> Result<String, PromptError> {
        let denied: Vec<&str> = sightings
            .iter()
            .filter(|sighting| sighting.witness == WitnessAnswer::Denied)
            .map(|sighting| sighting.name.as_str())
            .collect();
        self.fill_template("summary", context! { transcript, denied, complaints })
    }

    /// Asks a language model to condense captions of several directions.
    ///
    /// # Errors
    /// When an overridden template cannot be filled.
    pub fn condense_prompt(
        &self,
        captions: &[(&str, &str)],
        fewer_words_than: usize,
        complaints: &[String],
    ) -> Result<String, PromptError> {
        let captions: Vec<_> = captions.iter().map(|(direction, text)| context! { direction, text }).collect();
        self.fill_template("condense", context! { captions, fewer_words_than, complaints })
    }

    /// Asks a language model to write an instruction, or to write it again.
    ///
    /// # Errors
    /// When an overridden template cannot be filled.
    pub fn writing_prompt(&self, brief: &WritingBrief<'_>) -> Result<String, PromptError> {
        self.fill_template("write", writing_context(brief, PromptDetail::Full))
    }

    /// The same for a model that reads at most so many bytes: the longest of several prompts that fits, or else the shortest. Also
    /// whether it tells less than it could.
    ///
    /// # Errors
    /// As for [`Self::writing_prompt()`].
    pub(crate) fn writing_prompt_within(
        &self,
        brief: &WritingBrief<'_>,
        most_bytes: usize,
    ) -> Result<(String, bool), PromptError> {
        let mut shortest = String::new();
        for detail in PromptDetail::ALL {
            shortest = self.fill_template("write", writing_context(brief, detail))?;
            if shortest.len() <= most_bytes {
                return Ok((shortest, detail != PromptDetail::Full));
            }
        }
        Ok((shortest, true))
    }
}

#[cfg(test)]
mod tests;
