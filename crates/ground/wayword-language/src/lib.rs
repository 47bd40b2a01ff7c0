//! English as instructions and answers use it: words, the names of things and rooms, and the reading of a text. Other languages are read
//! through English.
//!
//! [`text`] splits a text into words and sentences. [`lexicon`] has the names of things and rooms, which of them mean
//! the same, and the forms of a name. [`reading`] finds the places, turns, climbs and tasks of an instruction.
//! [`Language`] is the language of a text. [`languages`] puts texts of other languages into English words. [`answers`], [`chatter`] and
//! [`directions`] have the vocabulary by which other crates read answers, take off the words that a model puts around a text, and split
//! instructions.
//! [`rewording`] finds the words for a turn or a way, and gives other words for it. The lists are data, in `languages/en/`.
//!
//! Architecture invariant: this crate depends on no path, model or writer.
//!
//! # Where things are
//!
//! A new English word goes into a list in `languages/en/`, a new construction into the code that reads the list. A new list is
//! also named in the file that uses it, as `reading/vocabulary.rs`.
//!
//! - `reading/`: one file for each thing that is recognised, as `turns/`, `climbs.rs`, `places.rs`, `stops.rs`, `denial.rs`, `task.rs`.
//! - `reading/steps.rs`, `languages/en/steps.txt`: the steps of a text.
//! - `reading/coverage.rs`, `languages/en/roles.txt`: the role of each word, and which clauses count as understood.
//! - `languages/en/motions.txt`: how a motion is meant, for the checks.
//! - `languages/en/objects.txt`, `rooms.txt`, `colours.txt`: names of things, rooms and colours, and which of them mean the same.
//! - `lexicon/normal_spelling.rs`, `forms.rs`: plurals, articles and numbers of a name.
//! - `languages/en/languages.txt`: the languages that are recognised.
//! - `languages/zh/`, `languages/hi/`: the packs of Chinese and Hindi, `words.txt` and `rules.txt`.
//! - `languages/pack_words.rs`, `rules.rs`, `gloss.rs`: how a text becomes English words by a pack.
//! - `languages/en/answers.txt`, `chatter.txt`, `directions.txt`, `rewording.txt`: the lists of the modules of these names.

pub mod answers;
pub mod chatter;
mod data;
pub mod directions;
mod language;
pub mod languages;
pub mod lexicon;
pub mod reading;
pub mod rewording;
pub mod text;

pub use data::{PhraseList, WordList};
pub use language::Language;
