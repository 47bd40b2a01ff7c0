//! Instruments of quality: what the checks catch and refuse, how generated texts compare with people's, and how far followers, critics
//! and studies can be believed. `wayword-measure` is their command line.

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
pub mod house_views;
pub mod key;
pub mod people;
pub mod reader_figures;
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
