//! English as instructions and answers use it: words, the names of things and rooms, and the reading of a text.
//!
//! [`text`] takes a text apart into words and sentences. [`lexicon`] knows what things and rooms are called, which names mean
//! the same, and the forms of a name. [`reading`] tells what an instruction says. [`answers`] and [`directions`] hold the
//! vocabulary by which others read answers and take instructions apart. The lists are data, in `words/`.
//!
//! Architecture invariant: nothing here knows a path, a model or a writer.

pub mod answers;
mod data;
pub mod directions;
pub mod lexicon;
pub mod reading;
pub mod text;

pub use data::{Phrases, Words};
