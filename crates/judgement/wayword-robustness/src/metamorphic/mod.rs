//! What a text has to be after a change of its world or its path, given the text before it. Each expectation is exact: where it
//! does not hold, a sentence says what differs.

mod clauses;
mod space;
mod things;
mod way;

pub use space::{mirror, turn};
pub use things::{Gone, add, material, remove};
pub use way::reverse;

use wayword_core::Mention;

/// A text, and what its words speak of.
#[derive(Debug, Clone, Copy)]
pub struct Written<'a> {
    /// The text.
    pub text: &'a str,
    /// What its words speak of, with the frame that has the evidence.
    pub mentions: &'a [Mention],
    /// The last frame of its path.
    pub last_frame: usize,
}

/// Whether an expectation holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// It does.
    Holds,
    /// The text does not tell what was changed, so that nothing can be expected of it.
    NotTold,
    /// It does not; what differs, in a sentence.
    Differs(String),
}

impl Outcome {
    /// Of texts that have to be the same.
    fn of_equal(expected: &str, found: &str) -> Self {
        if expected == found {
            Self::Holds
        } else {
            Self::Differs(format!("expected \"{expected}\", but the text is \"{found}\""))
        }
    }
}
