//! The errors of the Bradley-Terry fit: why choices between systems determine no strengths.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Why choices give no strengths.
#[derive(Debug, Clone, PartialEq, Eq, Error, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum NoStrength {
    /// There are no choices.
    #[error("there are no choices")]
    NoChoices,
    /// A system was compared with itself.
    #[error("a system was compared with itself")]
    Itself,
    /// The systems fall into groups that were never compared.
    #[error("no choice connects {}", groups.iter().map(|group| group.join(", ")).collect::<Vec<_>>().join(" | "))]
    Unconnected {
        /// The systems of each group.
        groups: Vec<Vec<String>>,
    },
    /// Some systems never lost to the others, nor tied with them, so the likelihood has no maximum: larger differences always fit
    /// better.
    #[error("{} never lost to {}, nor tied", above.join(", "), below.join(", "))]
    Separated {
        /// The systems that never lost.
        above: Vec<String>,
        /// The systems that lost to them whenever they met.
        below: Vec<String>,
    },
    /// All choices are ties.
    #[error("nobody preferred one to another")]
    OnlyTies,
    /// Systems were always shown on the same side, so the effect of the side cannot be separated from their strengths.
    #[error("the sides do not vary enough to tell a side's advantage from a system's strength")]
    Sides,
    /// The likelihood has no maximum, or Newton's method did not reach it: the sides or ties explain too much of the choices.
    #[error("no strengths are most likely: the sides and ties of these few choices explain them without end")]
    Endless,
    /// All choices are of one person, or about one item.
    #[error("the choices of one person, or about one item, show nothing beyond them")]
    OneSource,
}
