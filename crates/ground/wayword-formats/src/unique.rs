//! Names that may be given once in a file.

use crate::{Episode, FormatError, Item};
use std::collections::BTreeSet;

/// The names that a file has given so far.
#[derive(Default)]
pub(crate) struct Unique(BTreeSet<String>);

impl Unique {
    /// Refuses a name that was given before; the field's loaders would silently drop one of the two.
    pub(crate) fn claim(&mut self, item: &Item<'_>, field: &str, episode: &Episode) -> Result<(), FormatError> {
        if self.0.insert(episode.id.clone()) {
            return Ok(());
        }
        let problem = format!("{:?} was given to an earlier item", episode.id);
        Err(item.wrong(field, problem, "give each item a name of its own"))
    }
}
