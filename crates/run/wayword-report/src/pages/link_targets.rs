//! Anchors of items and frames, and the sides of the agent in words, for all parts of an item's page.

use wayword_core::Side;

/// The frames of an item to which links can lead.
#[derive(Debug, Clone, Copy)]
pub(super) struct LinkTargets<'a> {
    /// The item's anchor.
    pub(super) item: &'a str,
    /// How many frames its path has.
    pub(super) frames: usize,
    /// How many of them the page shows.
    pub(super) shown: usize,
}

/// The anchor of an item's heading: a number, because a name from a file may contain any character.
pub(super) fn item_anchor(number: usize) -> String {
    format!("w{number}")
}

/// The anchor of a frame of an item, by its number.
pub(super) fn frame_anchor(item: &str, number: usize) -> String {
    format!("{item}-f{number}")
}

/// A side of the agent in words.
pub(super) fn side_words(side: Side) -> &'static str {
    match side {
        Side::Ahead => "ahead",
        Side::Right => "on the right",
        Side::Behind => "behind",
        Side::Left => "on the left",
    }
}
