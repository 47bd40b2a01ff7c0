//! How a failure is dealt with.

use serde::{Deserialize, Serialize};

/// What a failure asks of whoever met it. A text that fails a check is no failure: it was judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Failure {
    /// Something that was asked for is not there: the user can supply it.
    Missing,
    /// Something is there and cannot be used. Trying again gives the same.
    Broken,
    /// The world or the service went away while it was in use. Trying again may do better.
    Lost,
}

impl Failure {
    /// The name, as files have it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Missing => "missing",
            Self::Broken => "broken",
            Self::Lost => "lost",
        }
    }
}
