//! How a step relates to a place that it names: into it, past it, near it.

use crate::{
    reading::{PlaceMention, PlaceMotion},
    text::TextToken,
};

/// How far before a place the word for the relation may be, words.
const RELATION_REACH_WORDS: usize = 7;

/// How a step relates to a place that it names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum StepRelation {
    /// No word expresses a relation.
    Plain,
    /// The step leaves it.
    OutOf,
    /// The step leads into it.
    Into,
    /// The step is in it, or ends in it.
    In,
    /// The step leads through it.
    Through,
    /// The step passes it.
    Past,
    /// The step leads to it, or towards it.
    To,
    /// The step follows it.
    Along,
    /// The step is at it.
    At,
    /// The step is next to it or near it.
    Near,
    /// The step is in front of it.
    Before,
    /// The step is between it and something else.
    Between,
    /// It is seen from there.
    With,
    /// It belongs to another place: "the door of the kitchen".
    Of,
}

impl StepRelation {
    /// All of them.
    pub const ALL: [Self; 14] = [
        Self::Plain,
        Self::OutOf,
        Self::Into,
        Self::In,
        Self::Through,
        Self::Past,
        Self::To,
        Self::Along,
        Self::At,
        Self::Near,
        Self::Before,
        Self::Between,
        Self::With,
        Self::Of,
    ];

    /// The relation of a place. `words` are those of its step before it; `earlier` is the place before it in the step, by
    /// its first word, and that place's relation.
    pub(super) fn from_place(place: &PlaceMention, words: &[TextToken], earlier: Option<(usize, Self)>) -> Self {
        let by_words = Self::from_words(words, earlier);
        match place.going {
            None => by_words,
            Some(PlaceMotion::Leaving) => Self::OutOf,
            Some(PlaceMotion::Entering) => Self::Into,
            Some(PlaceMotion::Through) => Self::Through,
            Some(PlaceMotion::Along | PlaceMotion::Around) => Self::Along,
            Some(PlaceMotion::Past) => Self::Past,
            Some(PlaceMotion::Towards | PlaceMotion::Until) => match by_words {
                Self::At | Self::Near | Self::Before | Self::In => by_words,
                _ => Self::To,
            },
        }
    }

    /// The relation by the last word before a place that expresses one. In "past the sofa and the table" the table has the
    /// relation of the sofa.
    fn from_words(words: &[TextToken], earlier: Option<(usize, Self)>) -> Self {
        let from = earlier.map_or(0, |(at, _)| at + 1).max(words.len().saturating_sub(RELATION_REACH_WORDS));
        let mut is_joined = false;
        for at in (from..words.len()).rev() {
            let before = at.checked_sub(1).map_or("", |before| words[before].word.as_str());
            if let Some(relation) = Self::from_word(&words[at].word, before) {
                return relation;
            }
            is_joined |= matches!(words[at].word.as_str(), "and" | "or");
        }
        earlier.filter(|_| is_joined).map_or(Self::Plain, |(_, relation)| relation)
    }

    /// The relation that a word expresses, given the word before it.
    fn from_word(word: &str, before: &str) -> Option<Self> {
        Some(match (word, before) {
            ("of", "out") => Self::OutOf,
            ("of", "front") => Self::Before,
            ("of", "end" | "top" | "bottom" | "middle" | "center" | "centre" | "foot" | "edge") => Self::At,
            ("of", "left" | "right" | "side") => Self::Near,
            ("to", "next" | "close" | "closest" | "nearest" | "adjacent") => Self::Near,
            ("by", "walk" | "go" | "walking" | "going" | "move" | "moving") => Self::Past,
            ("exit" | "exiting" | "leave" | "leaving" | "from" | "out" | "outside" | "off", _) => Self::OutOf,
            ("enter" | "entering" | "into" | "onto" | "inside", _) => Self::Into,
            ("in" | "within", _) => Self::In,
            ("through" | "thru" | "across" | "cross" | "crossing" | "via" | "over", _) => Self::Through,
            ("past" | "pass" | "passing" | "passed" | "beyond" | "after" | "behind", _) => Self::Past,
            ("to" | "toward" | "towards" | "reach" | "reaching" | "until" | "till" | "for", _)
            | ("approach" | "find" | "see", _) => Self::To,
            ("down" | "along" | "up" | "follow" | "following" | "around" | "alongside" | "take", _)
            | ("use" | "climb" | "descend" | "ascend", _) => Self::Along,
            ("at" | "on" | "against" | "under" | "underneath" | "below", _) => Self::At,
            ("near" | "by" | "beside" | "next" | "close" | "nearest" | "closest" | "adjacent" | "opposite", _) => {
                Self::Near
            }
            ("front" | "before", _) => Self::Before,
            ("between", _) => Self::Between,
            ("with" | "facing" | "face" | "has" | "have" | "is" | "are", _) => Self::With,
            ("of" | "leading" | "leads", _) => Self::Of,
            _ => return None,
        })
    }
}
