//! Splits instructions for agents that walk by phrases: into key phrases in their order, and the activity at the end (a task, or the
//! place of arrival). There are two splitters: by rules, and by a language model.

mod clauses;
mod instruction_pieces;
mod model;
pub mod places;
mod reply;
mod rules;

use serde::{Deserialize, Serialize};
use wayword_core::ModelError;

pub(crate) use clauses::clause_texts;
pub use model::{ModelSplitter, split_prompt};
pub use places::{NamedPlace, named_places};
pub use rules::RuleSplitter;

/// An instruction split in two (arXiv 2211.16649, section 3: navigation component and activity component).
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SplitInstruction {
    /// The navigation component: key phrases in the order in which they are met. Empty where the text only names a task.
    pub phrases: Vec<String>,
    /// The activity component: the task or the place of arrival ("wipe the sink", "stop at the sink"). Never empty.
    pub activity: String,
}

/// Splits instructions.
///
/// Blocking, object-safe and batching; threads belong to the caller.
pub trait InstructionSplitter: Send + Sync {
    /// `rules`, or `provider/model`.
    fn name(&self) -> &str;

    /// One result per instruction, in their order. One that fails does not fail the others.
    fn split_instructions(&self, instructions: &[&str]) -> Vec<Result<SplitInstruction, ModelError>>;
}

/// Most key phrases of an instruction; later ones are left out. Texts by people have up to about ten.
const MAX_PHRASES: usize = 12;
/// Most words of a phrase or an activity; a longer one is cut. CLIP reads no more than 77 tokens.
const MAX_PHRASE_WORDS: usize = 50;
/// Most bytes of a phrase or an activity, because a text without spaces is one word; a longer one is cut.
const MAX_PHRASE_BYTES: usize = 400;
/// Most bytes of an instruction that are read; texts by people have up to about 2,500.
const MAX_READ_BYTES: usize = 8_000;

/// The beginning of a text, up to a number of bytes.
fn first_bytes(text: &str, most_bytes: usize) -> &str {
    &text[..text.floor_char_boundary(most_bytes)]
}

/// The part of an instruction that agents read.
pub(crate) fn beginning_of(instruction: &str) -> &str {
    first_bytes(instruction, MAX_READ_BYTES)
}

/// The beginning of a phrase that is not too long for a grounder.
fn shorten_phrase(text: &str) -> String {
    let text = first_bytes(text.trim(), MAX_PHRASE_BYTES);
    // Where a word ends within the text, bytes.
    let end = |word: &str| word.as_ptr() as usize + word.len() - text.as_ptr() as usize;
    let end = text.split_whitespace().take(MAX_PHRASE_WORDS).last().map_or(0, end);
    text[..end].to_owned()
}

/// The part of an instruction that splitters read.
///
/// # Errors
/// When it has no words.
fn readable_part<'a>(text: &'a str, splitter: &str) -> Result<&'a str, ModelError> {
    let text = first_bytes(text, MAX_READ_BYTES);
    if text.contains(char::is_alphanumeric) {
        return Ok(text);
    }
    Err(ModelError::Failed { model: splitter.to_owned(), reason: "the instruction has no words".to_owned() })
}
