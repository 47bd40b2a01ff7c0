//! Metamorphic checks: each compares the text for a changed world or path with the text before the change.
//!
//! No one knows the one right text for a path, but often how it has to react: in a mirrored world, left and right must have changed
//! places and every other word must be the same. Each expectation is exact. If it does not hold, a sentence explains the difference.

mod clauses;
mod reversal;
mod space;
mod things;

pub use reversal::check_reversed_path;
pub use space::{check_mirrored_world, check_turned_world};
pub use things::{ChangedThing, check_added_thing, check_changed_material, check_removed_thing};

use wayword_core::TextMention;

/// A text with its mentions.
#[derive(Debug, Clone, Copy)]
pub struct AnnotatedText<'a> {
    /// The text.
    pub text: &'a str,
    /// The things, rooms and turns that its words mention, each with the frame that has the evidence.
    pub mentions: &'a [TextMention],
    /// The last frame of its path.
    pub last_frame: usize,
}

/// The outcome of a check.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ExpectationOutcome {
    /// The expectation holds.
    Holds,
    /// The text does not mention the changed thing, so there is no expectation.
    NotTold,
    /// The expectation does not hold. The sentence explains the difference.
    Differs(String),
}

impl ExpectationOutcome {
    /// Compares texts that have to be equal.
    fn from_equal_texts(expected: &str, found: &str) -> Self {
        if expected == found {
            Self::Holds
        } else {
            Self::Differs(format!("expected \"{expected}\", but the text is \"{found}\""))
        }
    }
}
