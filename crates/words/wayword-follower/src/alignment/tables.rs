//! The tables of features of a part on its stretch, as for the steps of the follower.

use super::parts::PartKind;
use crate::features::tables::{FeatureTable, feature_tables};

/// Number of kinds of parts.
pub(super) const KINDS: usize = PartKind::COUNT;
/// Classes of hops: 0 to 6, and more.
pub(super) const HOPS: usize = 8;
/// Places of a part in its text: alone, first, between, last.
pub(super) const PLACES: usize = 4;
/// Classes of word counts.
pub(super) const WORDS: usize = 7;
/// Classes of the hops that there are for each part.
pub(super) const PACES: usize = 8;
/// Classes of lengths.
pub(super) const METRES: usize = 8;
/// Classes of the distance of a boundary from where it would lie if lengths alone counted.
pub(super) const SHIFTS: usize = 13;
/// Classes of an angle towards the side in the text, away from it being negative.
pub(super) const ANGLES: usize = 9;
/// Classes of an angle without its side.
pub(super) const WIDTHS: usize = 5;
/// Classes of a rise in the direction of the text.
pub(super) const RISES: usize = 9;

// Each comment lists the dimensions in their order.
feature_tables! {
    // What needs no word of the text but their number.

    // Place, hops.
    PLACE_HOPS coarse PLACES * HOPS;
    // Words, hops.
    WORD_HOPS coarse WORDS * HOPS;
    // Hops for each part of the text, place, hops.
    PACE_HOPS coarse PACES * PLACES * HOPS;
    // Place, length.
    PLACE_METRES coarse PLACES * METRES;
    // Shift of the end from the share of the words before it, hops.
    WORD_SHIFT coarse SHIFTS;
    // Shift of the end from equal parts, hops.
    EQUAL_SHIFT coarse SHIFTS;
    // Shift of the end from the share of the words before it, metres.
    METRE_SHIFT coarse SHIFTS;

    // What the words ask for.

    // Kind, place, hops.
    KIND_HOPS fine KINDS * PLACES * HOPS;
    // Kind, length.
    KIND_METRES coarse KINDS * METRES;
    // Kind, the next part's kind or none, hops up to 3.
    KIND_NEXT fine KINDS * (KINDS + 1) * 4;
    // Kind, the kind of the part before or none, hops up to 3.
    KIND_BEFORE fine KINDS * (KINDS + 1) * 4;

    // Turns of the stretch, for a part with a turn.

    // Whether the part is the first, bare, angle of the turn where the stretch begins.
    TURN_FIRST coarse 2 * 2 * ANGLES;
    // Bare, angle of the widest later turn of the stretch.
    TURN_LATER coarse 2 * ANGLES;
    // Bare, angle of all turns together.
    TURN_BEND coarse 2 * ANGLES;
    // Angle of the turn where the stretch ends.
    TURN_AFTER coarse ANGLES;
    // Angle of the last turn before the stretch.
    TURN_BEFORE coarse ANGLES;
    // For a part without a turn: kind, width of the turn where the stretch begins.
    UNTOLD_FIRST coarse KINDS * WIDTHS;
    // For a part without a turn: kind, width of the widest later turn.
    UNTOLD_LATER coarse KINDS * WIDTHS;

    // Heights and rooms.

    // For a part with a climb: rise.
    CLIMB_RISE coarse RISES;
    // For a part with a climb: rise of the hop after the stretch.
    CLIMB_AFTER coarse RISES;
    // For a part with a climb: rise of the hop before the stretch.
    CLIMB_BEFORE coarse RISES;
    // For a part without a climb: whether the text has one, kind, rise either way.
    FLAT_RISE coarse 2 * KINDS * WIDTHS;
    // Kind, whether the room changes at the last hop, before it, and at the hop after the stretch.
    KIND_ROOMS coarse KINDS * 2 * 2 * 2;

    // The weight of the follower's own score of the part's steps on the stretch, natural logs.
    FOLLOWER coarse 1;
}
