//! Claims in people's texts about their paths, with wrong claims made from them: the samples that weights and calibrations are
//! fitted to.

mod samples;
mod walks;

pub use samples::{ClaimSample, LabelNames, belongs_to_case, is_known, sample_claims};
pub use walks::{PeopleText, PeopleWalk, SceneSurveys, left_out, read_episodes, read_people_walks};
