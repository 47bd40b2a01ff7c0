//! Instruments of quality: what the checks catch and refuse, how generated texts compare with people's, and how far followers, critics
//! and studies can be believed. `wayword-measure` is their command line.
//!
//! # Where things are
//! - [`corrupt_people`]: how people's texts are made wrong to measure the checks. Its word lists (`lists/`) are its own, so that it does not share the
//!   errors of the reader.
//! - [`corruptions`], [`corruption_findings`], [`claims`], [`doubts`], [`people`]: which wrong texts the checks and the follower find,
//!   and which true ones they refuse.
//! - [`house_faults`]: faults in our own texts about generated houses, proved by the plan of the house. Like [`corrupt_people`], it
//!   has word lists of its own (`word_lists.rs`); `locate.rs` decides whether an edited text is wrong.
//! - [`texts`], [`tell_apart`]: figures of texts, and a classifier that separates generated ones from people's; `texts/listener/` finds a target by labels.
//! - [`detector`], [`eye`]: what a detector or a flawed eye with given figures does to texts; `eye_check` checks texts by such an eye.
//! - [`refined`]: what judging a model's text and writing it again mends.
//! - [`remembered`]: how right the memory of a walk is that is made from what such an eye saw.
//! - [`reader_figures`], [`arrivals`], [`critics`], [`sweep`], [`walker`]: followers, critics and agents.
//! - [`study_coverage`]: how often the intervals of studies cover the truth.

pub mod arrivals;
pub mod budget;
pub mod checked_texts;
pub mod claims;
pub mod corrupt;
pub mod corrupt_people;
pub mod corruption_findings;
pub mod corruptions;
pub mod coverage;
pub mod critics;
pub mod detector;
pub mod doubts;
pub mod eye;
mod eye_check;
pub mod house_faults;
pub mod house_views;
pub mod key;
pub mod pairs;
pub mod people;
pub mod reader_figures;
pub mod refined;
pub mod remembered;
pub mod reuse;
pub mod sample;
pub mod share;
pub mod skeleton;
pub mod stage;
pub mod steps;
pub mod study_coverage;
pub mod sweep;
pub mod tell_apart;
#[cfg(test)]
mod test_data;
pub mod texts;
pub mod walker;
