//! Claims in people's texts about their paths, with wrong claims made from them: the samples that weights and calibrations are
//! fitted to.

mod samples;
mod walks;

pub use samples::{Held, Labels, belongs, held, is_known};
pub use walks::{Surveys, Text, Walk, episodes, left_out, walks};
