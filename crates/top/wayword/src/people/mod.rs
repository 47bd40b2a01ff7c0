//! What people's texts claim of their paths, and wrong claims made of them: what weights and calibrations are fitted to.

mod samples;
mod walks;

pub use samples::{Held, Labels, belongs, held, is_known};
pub use walks::{Surveys, Text, Walk, episodes, left_out, walks};
