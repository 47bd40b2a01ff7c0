//! What the finds and misses of a detector say about a path.
//!
//! A detector is a witness with measured recall and false alarms ([`DetectorFigures`]). A name is there, or is not, only
//! where the odds are at least nine to one. What a detector missed was seen by nobody else either, so an absence needs more:
//! the thing would have been found with at least 0.9 over all frames from which it could be seen.

mod figures;
mod odds;
#[cfg(test)]
mod tests;

pub use figures::{DetectorFigures, Rates};
pub use odds::{Judged, judge};
