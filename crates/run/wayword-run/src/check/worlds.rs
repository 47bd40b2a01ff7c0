//! Decides in which world each text is checked.

use super::walks::Text;
use crate::check::args::AskedWorld;
use wayword_checks::{Source, World};

/// The world of a text: the one that was asked for. Otherwise it is closed for a record with the same platform and source of
/// evidence as in this check, and open for everything else.
pub(super) fn world_of(text: &Text, asked: AskedWorld, platform: &str, source: Source) -> World {
    match (asked, &text.made) {
        (AskedWorld::Open, _) | (AskedWorld::Auto, None) => World::Open,
        (AskedWorld::Closed, _) => World::Closed,
        (AskedWorld::Auto, Some((made_on, provenance))) => World::of_record(provenance, made_on, platform, source),
    }
}
