//! The two worlds that a text can be held against.

use crate::{evidence::Surroundings, open::Calibration};
use wayword_core::Provenance;

/// What the silence of the evidence means.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum World {
    /// The text was written from this evidence: what the evidence does not show is wrong.
    #[default]
    Closed,
    /// Somebody else wrote the text: an absence counts only if the evidence would have shown the thing.
    Open,
}

impl World {
    /// Its name, in files and on the screen.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Closed => "closed",
            Self::Open => "open",
        }
    }

    /// The world of a record's text. It is closed only where the text was written and checked on this platform,
    /// against the evidence that is at hand now, and whoever answered the questions about it is the source of that
    /// evidence.
    #[must_use]
    pub fn of_record(provenance: &Provenance, made_on: &str, platform: &str, source: crate::Source) -> Self {
        let labels = crate::Source::Labels;
        let answered = source != labels || provenance.answerer == labels.name();
        let matches = made_on == platform && provenance.checked_against == source.name() && answered;
        if matches { Self::Closed } else { Self::Open }
    }
}

/// What an open world knows beyond the frames of the path. Without it, fewer things can be said.
#[derive(Debug, Clone, Copy, Default)]
pub struct Reach<'a> {
    /// What is listed around the path and elsewhere in the building.
    pub surroundings: Option<&'a Surroundings>,
    /// Shares by the names of objects and rooms, made from a file that the user has.
    pub calibration: Option<&'a Calibration>,
}

/// Who judges the turns of a text in an open world: they fit a path or not only together with all that the text tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Turns {
    /// Whoever compares whole walks, and adds what was found ([`crate::Checked::add`]).
    JudgedElsewhere,
    /// Nobody, for this reason: they are unverified.
    NotJudged(&'static str),
}

impl Default for Turns {
    fn default() -> Self {
        Self::NotJudged("no walks are compared")
    }
}
