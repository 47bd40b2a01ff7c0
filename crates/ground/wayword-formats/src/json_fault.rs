//! What is wrong with the JSON of a file, in words, and what to do about it.

use crate::{bounded_tokens, limits};
use serde_json::error::Category;

/// Advice where a value is wrong, and the file whole.
const CORRECT_IT: &str = "correct it at that place";
/// Advice where the end of a file is missing.
const CUT_OFF: &str = "fetch or write it again, to its end";

/// A mistake in the JSON of a file.
pub(crate) struct JsonFault {
    /// The mistake, in words, without its place.
    pub(crate) problem: String,
    /// Advice for the user.
    pub(crate) hint: &'static str,
}

impl JsonFault {
    /// The mistake behind an error of the parser.
    pub(crate) fn new(error: &serde_json::Error) -> Self {
        let text = error.to_string();
        let message = text.rsplit_once(" at line ").map_or(text.as_str(), |(message, _)| message);
        let (problem, hint) = match (error.classify(), message) {
            (Category::Eof, _) => ("the file is cut off", CUT_OFF),
            (Category::Syntax, "invalid unicode code point") => ("it is not UTF-8", "save the file as UTF-8"),
            (Category::Syntax, "trailing characters") => {
                ("something follows the end of the JSON", "give one list, or one object in each line")
            }
            (Category::Io, bounded_tokens::NOT_A_NUMBER) => {
                (message, "write a number there; null only where a value may be missing")
            }
            (Category::Io, bounded_tokens::TOO_LONG) => (message, "shorten it, or leave it out"),
            (Category::Io, limits::TOO_LARGE) => (message, limits::SPLIT_HINT),
            (Category::Io, _) => (message, CUT_OFF),
            _ => (message, CORRECT_IT),
        };
        Self { problem: problem.to_owned(), hint }
    }

    /// The mistake in a line: as [`Self::new`], but the parser of a line does not look for numbers that JSON lacks.
    pub(crate) fn in_line(error: &serde_json::Error, line: &[u8]) -> Self {
        if error.is_syntax() && bounded_tokens::has_not_a_number(line) {
            return Self::new(&serde_json::Error::io(std::io::Error::other(bounded_tokens::NOT_A_NUMBER)));
        }
        Self::new(error)
    }
}
