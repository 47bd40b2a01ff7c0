//! The greeting of a world program, and the list of abilities that it can offer. `docs/PROCESS.md` describes the protocol.

use serde::Deserialize;
use std::{collections::BTreeSet, fmt, path::PathBuf};
use wayword_world::output_lines::to_safe_text;

/// Version of the protocol.
pub const PROTOCOL_VERSION: u64 = 1;
/// The frame and the units of all numbers. The child has to repeat this text, which shows that its author has read it.
pub(crate) const WORLD_FRAME: &str = "z-up, metres, radians clockwise from +y";
/// Longest name of a world program, an object, a room or a colour, characters.
pub(crate) const MAX_NAME_CHARS: usize = 200;

/// Something that a world program can provide, besides its scenes and the views from a pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum WorldOffer {
    /// The whole viewpoint graph of a scene.
    Graph,
    /// Places where one can stand.
    Points,
    /// The points that one can reach from a point in one hop.
    Neighbours,
    /// Whether one can walk straight from one place to another.
    Walkable,
    /// Random paths that it chooses itself.
    SamplePath,
    /// Pictures.
    Pictures,
    /// The visible objects; always all of them.
    Labels,
    /// The room of a place.
    Rooms,
    /// The name of an object by its id.
    ObjectName,
    /// The viewpoints from which an object is visible.
    VisibleFrom,
}

impl WorldOffer {
    /// Each offer with its name in a greeting.
    const NAMED_OFFERS: [(Self, &'static str); 10] = [
        (Self::Graph, "graph"),
        (Self::Points, "points"),
        (Self::Neighbours, "neighbours"),
        (Self::Walkable, "walkable"),
        (Self::SamplePath, "sample_path"),
        (Self::Pictures, "pictures"),
        (Self::Labels, "labels"),
        (Self::Rooms, "rooms"),
        (Self::ObjectName, "object_name"),
        (Self::VisibleFrom, "visible_from"),
    ];

    fn from_name(name: &str) -> Option<Self> {
        Self::NAMED_OFFERS.iter().find(|(_, other)| *other == name).map(|(offer, _)| *offer)
    }
}

impl fmt::Display for WorldOffer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = Self::NAMED_OFFERS.iter().find(|(offer, _)| offer == self).map_or("", |(_, name)| name);
        f.write_str(name)
    }
}

/// A world program, as its greeting describes it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WorldProgram {
    /// Its name, for display.
    pub name: String,
    /// What it provides.
    pub offers: BTreeSet<WorldOffer>,
}

impl WorldProgram {
    /// Whether it provides this.
    #[must_use]
    pub fn has_offer(&self, offer: WorldOffer) -> bool {
        self.offers.contains(&offer)
    }
}

/// The answer to `hello`.
#[derive(Debug, Deserialize)]
pub(crate) struct ChildGreeting {
    pub(crate) protocol: u64,
    pub(crate) frame: String,
    name: String,
    offers: Vec<String>,
    /// The folder of its pictures, if it does not send them within its answers.
    #[serde(default)]
    pub(crate) images: Option<PathBuf>,
}

impl ChildGreeting {
    /// The world program that the greeting describes. Offers of later versions are ignored.
    ///
    /// # Errors
    /// If its offers are not enough for paths and views.
    pub(crate) fn to_world_program(&self) -> Result<WorldProgram, String> {
        let offers: BTreeSet<WorldOffer> = self.offers.iter().filter_map(|name| WorldOffer::from_name(name)).collect();
        let world = WorldProgram { name: checked_name("`name`", &self.name)?, offers };
        let joins = world.has_offer(WorldOffer::Neighbours) || world.has_offer(WorldOffer::Walkable);
        let walks = world.has_offer(WorldOffer::Graph) || (world.has_offer(WorldOffer::Points) && joins);
        if !walks {
            return Err("`offers` must contain `graph`, or `points` with `neighbours` or `walkable`".into());
        }
        if !world.has_offer(WorldOffer::Pictures) && !world.has_offer(WorldOffer::Labels) {
            return Err("`offers` must contain `pictures`, `labels` or both".into());
        }
        Ok(world)
    }
}

/// A name that may be displayed, without blanks around it.
///
/// # Errors
/// If it is empty, too long, or contains control characters.
pub(crate) fn checked_name(what: &str, text: &str) -> Result<String, String> {
    let text = text.trim();
    if text.is_empty() || to_safe_text(text, MAX_NAME_CHARS) != text {
        let shown = to_safe_text(text, 40);
        return Err(format!("{what} {shown:?} is not a name: expected one line of 1 to {MAX_NAME_CHARS} characters"));
    }
    Ok(text.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn greeting(offers: &[&str]) -> Result<WorldProgram, String> {
        let greeting = serde_json::json!({"protocol": 1, "frame": WORLD_FRAME, "name": " A world ", "offers": offers});
        serde_json::from_value::<ChildGreeting>(greeting).unwrap().to_world_program()
    }

    #[test]
    fn an_offer_is_shown_by_the_name_that_it_is_sent_by() {
        for (offer, name) in WorldOffer::NAMED_OFFERS {
            assert_eq!((offer.to_string().as_str(), WorldOffer::from_name(name)), (name, Some(offer)));
        }
        assert_eq!(
            WorldOffer::NAMED_OFFERS.iter().map(|(offer, _)| offer).collect::<BTreeSet<_>>().len(),
            WorldOffer::NAMED_OFFERS.len()
        );
    }

    #[test]
    fn a_world_can_be_walked_and_seen() {
        assert_eq!(greeting(&["graph", "labels", "teleport"]).unwrap().name, "A world");
        assert!(greeting(&["points", "walkable", "pictures"]).is_ok());
        for (offers, missing) in [
            (&["pictures"][..], "graph"),
            (&["points", "pictures"], "walkable"),
            (&["neighbours", "pictures"], "points"),
            (&["graph", "rooms"], "pictures"),
        ] {
            let error = greeting(offers).unwrap_err();
            assert!(error.contains(missing), "{offers:?}: {error}");
        }
    }

    #[test]
    fn names_are_one_short_line() {
        assert_eq!(checked_name("x", " lamp ").unwrap(), "lamp");
        for bad in ["", "  ", "a\nb", "\u{1b}[2J", &"x".repeat(201)] {
            assert!(checked_name("x", bad).is_err(), "{bad:?}");
        }
    }
}
