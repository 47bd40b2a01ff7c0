//! The text of a person, together with what the generator needs to corrupt it: its words, its path and its building.

use super::{building::LabelledBuilding, text::PlainWord};
use wayword_core::DVec3;

/// A text with its words, its path and its building.
pub(super) struct CorruptibleText<'a> {
    /// The text as it was written.
    pub(super) text: &'a str,
    /// The words of the text.
    pub(super) words: Vec<PlainWord>,
    /// Positions of the path's viewpoints, metres, in the scene's coordinates.
    pub(super) path: Vec<DVec3>,
    /// The rooms and objects of the building, by its labels.
    pub(super) building: &'a LabelledBuilding,
    /// Texts of other paths of the building.
    pub(super) others: &'a [&'a str],
}
