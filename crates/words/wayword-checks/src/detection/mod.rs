//! Decides from a detector's finds and misses along a path whether a thing is there.
//!
//! A detector is a witness with measured recall and false alarms ([`DetectorFigures`]). A name is there, or is absent,
//! only if the odds are at least nine to one. There is no second witness for a thing that the detector missed, so an
//! absence needs more: the thing would have been found with at least 0.9 over all frames from which it could be seen.

mod figures;
mod odds;
#[cfg(test)]
mod tests;

pub use figures::{DetectorFigures, DetectorRates};
pub use odds::{DetectionVerdict, judge_finds};
