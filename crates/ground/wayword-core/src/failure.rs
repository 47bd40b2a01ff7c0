//! The kinds of failure, which decide whether the user, a repair of the data, or another try helps.

use serde::{Deserialize, Serialize};

/// The kind of a failure, by its remedy. A text that fails a check is not a failure: the check did its work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FailureKind {
    /// Something that was asked for is not there: the user can supply it.
    Missing,
    /// Something is there and cannot be used. Trying again gives the same result.
    Broken,
    /// The platform or the service went away while it was in use. Trying again may succeed.
    Lost,
}

impl FailureKind {
    /// The name that files use.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Missing => "missing",
            Self::Broken => "broken",
            Self::Lost => "lost",
        }
    }
}
