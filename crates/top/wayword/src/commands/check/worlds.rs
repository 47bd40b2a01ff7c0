//! The world that each text is held against.

use super::walks::Text;
use crate::cli::AskedWorld;
use wayword_checks::{Source, World};

/// The world of a text: the one that was asked for, or else closed for a record whose provenance and evidence match
/// what is at hand, and open for everything else.
pub(super) fn world_of(text: &Text, asked: AskedWorld, platform: &str, source: Source) -> World {
    match (asked, &text.made) {
        (AskedWorld::Open, _) | (AskedWorld::Auto, None) => World::Open,
        (AskedWorld::Closed, _) => World::Closed,
        (AskedWorld::Auto, Some((made_on, provenance))) => World::of_record(provenance, made_on, platform, source),
    }
}
