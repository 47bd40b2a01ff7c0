//! English as instructions and answers use it: words, the names of things and rooms, and the reading of a text.
//!
//! [`text`] splits a text into words and sentences. [`lexicon`] has the names of things and rooms, which of them mean
//! the same, and the forms of a name. [`reading`] finds what an instruction says. [`Language`] says in which language a text is. [`answers`], [`chatter`] and [`directions`] have
//! the vocabulary by which other crates read answers, take off what a model says around a text, and split instructions. [`rewording`] finds the words that tell a turn
//! or a way, and tells it otherwise. The lists are data, in `words/`.
//!
//! Architecture invariant: nothing here depends on a path, a model or a writer.

pub mod answers;
pub mod chatter;
mod data;
pub mod directions;
mod language;
pub mod lexicon;
pub mod reading;
pub mod rewording;
pub mod text;

pub use data::{Phrases, Words};
pub use language::Language;
