//! Instructions made wrong in one way: an agent that does as well by them does not listen to that.

use serde::{Deserialize, Serialize};

/// A way to make instructions wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Swap {
    /// Left for right, up for down, and the other way round.
    Directions,
    /// Each thing and room for another that the text does not name.
    Landmarks,
    /// Sentences in another order; the clauses, where there is one sentence.
    Sentences,
    /// The instruction of another path of the same building, with another goal.
    OtherPath,
}
