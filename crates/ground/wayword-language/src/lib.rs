//! English as instructions and answers use it: words, the names of things and rooms, and the reading of a text.
//!
//! [`text`] splits a text into words and sentences. [`lexicon`] has the names of things and rooms, which of them mean
//! the same, and the forms of a name. [`reading`] finds the places, turns, climbs and tasks of an instruction.
//! [`Language`] is the language of a text. [`answers`], [`chatter`] and [`directions`] have the vocabulary by which
//! other crates read answers, take off the words that a model puts around a text, and split instructions.
//! [`rewording`] finds the words for a turn or a way, and gives other words for it. The lists are data, in `words/`.
//!
//! Architecture invariant: this crate depends on no path, model or writer.

pub mod answers;
pub mod chatter;
mod data;
pub mod directions;
mod language;
pub mod lexicon;
pub mod reading;
pub mod rewording;
pub mod text;

pub use data::{PhraseList, WordList};
pub use language::Language;
