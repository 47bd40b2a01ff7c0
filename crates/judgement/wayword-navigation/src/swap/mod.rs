//! Instructions made wrong in one way: an agent that does as well by them does not listen to that.

use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};

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

/// A name that no swap has.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no swap {name:?}: name one of {}", Swap::ALL.map(Swap::name).join(", "))]
pub struct UnknownSwap {
    /// The name.
    pub name: String,
}

impl Swap {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Directions, Self::Landmarks, Self::Sentences, Self::OtherPath];

    /// Its name: `directions`, `landmarks`, `sentences`, `other-path`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Directions => "directions",
            Self::Landmarks => "landmarks",
            Self::Sentences => "sentences",
            Self::OtherPath => "other-path",
        }
    }
}

impl fmt::Display for Swap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Swap {
    type Err = UnknownSwap;

    fn from_str(name: &str) -> Result<Self, UnknownSwap> {
        let unknown = || UnknownSwap { name: name.to_owned() };
        Self::ALL.into_iter().find(|swap| swap.name() == name).ok_or_else(unknown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back_and_are_those_in_files() {
        for swap in Swap::ALL {
            assert_eq!(swap.to_string().parse(), Ok(swap));
            assert_eq!(serde_json::to_value(swap).unwrap(), swap.name());
        }
        assert!(
            "left".parse::<Swap>().unwrap_err().to_string().ends_with("directions, landmarks, sentences, other-path")
        );
    }
}
