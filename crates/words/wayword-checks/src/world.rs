//! The closed and the open world of a check: the two meanings of missing evidence.

use crate::{evidence::PathSurroundings, open::Calibration};
use wayword_core::TextProvenance;

/// The meaning of missing evidence.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum CheckWorld {
    /// The text was written from this evidence: a thing that the evidence does not show is wrong.
    #[default]
    Closed,
    /// Another author wrote the text: an absence counts only if the evidence would have shown the thing.
    Open,
}

impl CheckWorld {
    /// Its name, in files and on the screen.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Closed => "closed",
            Self::Open => "open",
        }
    }

    /// The world of a record's text. It is closed only where the text was written and checked on this platform,
    /// against the evidence that is at hand now, and the questions about it were answered from the source of that
    /// evidence. `made_on`: the platform that the record names.
    #[must_use]
    pub fn for_record(
        provenance: &TextProvenance,
        made_on: &str,
        platform: &str,
        source: crate::EvidenceSource,
    ) -> Self {
        let labels = crate::EvidenceSource::Labels;
        let answered = source != labels || provenance.answerer == labels.name();
        let matches = made_on == platform && provenance.checked_against == source.name() && answered;
        if matches { Self::Closed } else { Self::Open }
    }
}

/// Knowledge of an open world beyond the frames of the path. Without it, fewer things can be decided.
#[derive(Debug, Clone, Copy, Default)]
pub struct WorldReach<'a> {
    /// The listed objects and rooms around the path and elsewhere in the building.
    pub surroundings: Option<&'a PathSurroundings>,
    /// Shares by the names of objects and rooms, made from a file that the user has.
    pub calibration: Option<&'a Calibration>,
}

/// The judge of the turns of a text in an open world. Turns fit a path or not only together with the rest of the walk,
/// so they are judged by a comparison of whole walks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TurnJudge {
    /// A comparison of whole walks, which adds its findings ([`crate::TextFindings::add_findings`]).
    JudgedElsewhere,
    /// No comparison, for this reason: the turns are unverified.
    NotJudged(&'static str),
}

impl Default for TurnJudge {
    fn default() -> Self {
        Self::NotJudged("no walks are compared")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::EvidenceSource;

    fn provenance(answerer: &str, checked_against: &str) -> TextProvenance {
        let text = |text: &str| text.to_owned();
        TextProvenance {
            wayword: text("1"),
            asker: text("rules"),
            answerer: text(answerer),
            detector: None,
            summariser: text("rules"),
            writer: text("rules"),
            checked_against: text(checked_against),
            seed: 1,
            style_hash: String::new(),
            prompts_hash: None,
            repairs: 0,
            finished_for: None,
            chosen: None,
            drafts: Vec::new(),
            refined: Vec::new(),
            target_undescribed: false,
        }
    }

    #[test]
    fn a_record_is_closed_only_with_its_platform_its_evidence_and_its_answers() {
        use EvidenceSource::{Captions, Labels};
        let world = |answerer: &str, against: &str, made_on: &str, source| {
            CheckWorld::for_record(&provenance(answerer, against), made_on, "matterport", source)
        };
        assert_eq!(world("labels", "labels", "matterport", Labels), CheckWorld::Closed);
        assert_eq!(world("labels", "labels", "habitat", Labels), CheckWorld::Open);
        assert_eq!(world("labels", "captions", "matterport", Labels), CheckWorld::Open);
        assert_eq!(world("some/model", "labels", "matterport", Labels), CheckWorld::Open);
        // Captions hold the answers of any model.
        assert_eq!(world("some/model", "captions", "matterport", Captions), CheckWorld::Closed);
        assert_eq!(world("some/model", "labels", "matterport", Captions), CheckWorld::Open);
    }

    #[test]
    fn worlds_have_names_and_the_first_is_closed() {
        assert_eq!([CheckWorld::Closed, CheckWorld::Open].map(CheckWorld::name), ["closed", "open"]);
        assert_eq!(CheckWorld::default(), CheckWorld::Closed);
        assert_eq!(TurnJudge::default(), TurnJudge::NotJudged("no walks are compared"));
    }
}
