//! The kinds of corruption.

use super::{
    corruptible_text::CorruptibleText,
    repeats_and_swaps,
    replacements::{self, ReplacementDistance},
    turns,
};
use crate::key::WordEdit;
use rand::{Rng, seq::IndexedRandom};

/// A way to make a person's text wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PeopleCorruptionKind {
    /// A left turn becomes a right turn, or the other way round.
    TurnFlipped,
    /// A climb becomes a descent, or the other way round.
    ClimbFlipped,
    /// A sentence repeated.
    SentenceTwice,
    /// A room replaced by one of a kind that the building lacks.
    RoomLacking,
    /// A room replaced by one that the building has, but not within 5 m of the path.
    RoomElsewhere,
    /// An object replaced by one that no label of the building has.
    ObjectLacking,
    /// An object replaced by one that is listed in the building, but only 8 m or more from the path.
    ObjectFar,
    /// An object replaced by one that is 3 to 8 m from the path, by its nearest label.
    ObjectNear,
    /// Two landmarks swapped.
    LandmarksSwapped,
    /// The place to stop at, replaced by one elsewhere in the building.
    StopElsewhere,
    /// The text of another path of the building.
    OtherPath,
}

impl PeopleCorruptionKind {
    /// All kinds.
    pub(super) const ALL: [Self; 11] = [
        Self::TurnFlipped,
        Self::ClimbFlipped,
        Self::SentenceTwice,
        Self::RoomLacking,
        Self::RoomElsewhere,
        Self::ObjectLacking,
        Self::ObjectFar,
        Self::ObjectNear,
        Self::LandmarksSwapped,
        Self::StopElsewhere,
        Self::OtherPath,
    ];

    /// Its name, in keys and on the command line.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::TurnFlipped => "turn-flipped",
            Self::ClimbFlipped => "climb-flipped",
            Self::SentenceTwice => "sentence-twice",
            Self::RoomLacking => "room-lacking",
            Self::RoomElsewhere => "room-elsewhere",
            Self::ObjectLacking => "object-lacking",
            Self::ObjectFar => "object-far",
            Self::ObjectNear => "object-near",
            Self::LandmarksSwapped => "landmarks-swapped",
            Self::StopElsewhere => "stop-elsewhere",
            Self::OtherPath => "other-path",
        }
    }

    /// Draws the edits that corrupt a text; `None` where it has no words that this kind can change.
    pub(super) fn draw_edits(self, text: &CorruptibleText<'_>, rng: &mut impl Rng) -> Option<Vec<WordEdit>> {
        let choose_one = |edits: Vec<WordEdit>, rng: &mut _| Some(vec![edits.choose(rng)?.clone()]);
        match self {
            Self::TurnFlipped => choose_one(turns::flipped_turns(text.text, &text.words), rng),
            Self::ClimbFlipped => choose_one(turns::flipped_climbs(text.text, &text.words), rng),
            Self::SentenceTwice => repeats_and_swaps::repeat_sentence(text, rng),
            Self::RoomLacking => replacements::replace_room(text, ReplacementDistance::Lacking, rng),
            Self::RoomElsewhere => replacements::replace_room(text, ReplacementDistance::Far, rng),
            Self::ObjectLacking => replacements::replace_object(text, ReplacementDistance::Lacking, rng),
            Self::ObjectFar => replacements::replace_object(text, ReplacementDistance::Far, rng),
            Self::ObjectNear => replacements::replace_object(text, ReplacementDistance::Near, rng),
            Self::LandmarksSwapped => repeats_and_swaps::swap_mentions(text, rng),
            Self::StopElsewhere => replacements::replace_stop(text, rng),
            Self::OtherPath => repeats_and_swaps::take_other_path(text, rng),
        }
    }
}
