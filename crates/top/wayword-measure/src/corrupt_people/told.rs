//! A text of a person with what is known of its path.

use super::{building::Building, text::Word};
use wayword_core::DVec3;

/// A text with what is known of its path and its building.
pub(super) struct Told<'a> {
    pub(super) text: &'a str,
    pub(super) words: Vec<Word>,
    /// Where the viewpoints of the path are.
    pub(super) path: Vec<DVec3>,
    pub(super) building: &'a Building,
    /// Texts of other paths of the building.
    pub(super) others: &'a [&'a str],
}
