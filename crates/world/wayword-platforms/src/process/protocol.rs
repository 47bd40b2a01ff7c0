//! The greeting of a world program, and the list of abilities that it can offer. `docs/PROCESS.md` describes the protocol.

use serde::Deserialize;
use std::{collections::BTreeSet, fmt, path::PathBuf};
use wayword_world::said::plain;

/// Version of the protocol.
pub const PROTOCOL: u64 = 1;
/// The frame and the units of all numbers. The child has to repeat this text, which shows that its author has read it.
pub(crate) const FRAME: &str = "z-up, metres, radians clockwise from +y";
/// Longest name of a world program, an object, a room or a colour, characters.
pub(crate) const MAX_NAME_CHARS: usize = 200;

/// Something that a world program can provide, besides its scenes and the views from a pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Offer {
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

impl Offer {
    const ALL: [(Self, &'static str); 10] = [
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

    fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, other)| *other == name).map(|(offer, _)| *offer)
    }
}

impl fmt::Display for Offer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = Self::ALL.iter().find(|(offer, _)| offer == self).map_or("", |(_, name)| name);
        f.write_str(name)
    }
}

/// A world program, as its greeting describes it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct World {
    /// Its name, for display.
    pub name: String,
    /// What it provides.
    pub offers: BTreeSet<Offer>,
}

impl World {
    /// Whether it provides this.
    #[must_use]
    pub fn has(&self, offer: Offer) -> bool {
        self.offers.contains(&offer)
    }
}

/// The answer to `hello`.
#[derive(Debug, Deserialize)]
pub(crate) struct Greeting {
    pub(crate) protocol: u64,
    pub(crate) frame: String,
    name: String,
    offers: Vec<String>,
    /// The folder of its pictures, if it does not send them within its answers.
    #[serde(default)]
    pub(crate) images: Option<PathBuf>,
}

impl Greeting {
    /// The world program that the greeting describes. Offers of later versions are ignored.
    ///
    /// # Errors
    /// If its offers are not enough for paths and views.
    pub(crate) fn world(&self) -> Result<World, String> {
        let offers: BTreeSet<Offer> = self.offers.iter().filter_map(|name| Offer::named(name)).collect();
        let world = World { name: name("`name`", &self.name)?, offers };
        let joins = world.has(Offer::Neighbours) || world.has(Offer::Walkable);
        let walks = world.has(Offer::Graph) || (world.has(Offer::Points) && joins);
        if !walks {
            return Err("`offers` must contain `graph`, or `points` with `neighbours` or `walkable`".into());
        }
        if !world.has(Offer::Pictures) && !world.has(Offer::Labels) {
            return Err("`offers` must contain `pictures`, `labels` or both".into());
        }
        Ok(world)
    }
}

/// A name that may be displayed, without blanks around it.
///
/// # Errors
/// If it is empty, too long, or contains control characters.
pub(crate) fn name(what: &str, text: &str) -> Result<String, String> {
    let text = text.trim();
    if text.is_empty() || plain(text, MAX_NAME_CHARS) != text {
        let shown = plain(text, 40);
        return Err(format!("{what} {shown:?} is not a name: expected one line of 1 to {MAX_NAME_CHARS} characters"));
    }
    Ok(text.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn greeting(offers: &[&str]) -> Result<World, String> {
        let greeting = serde_json::json!({"protocol": 1, "frame": FRAME, "name": " A world ", "offers": offers});
        serde_json::from_value::<Greeting>(greeting).unwrap().world()
    }

    #[test]
    fn an_offer_is_shown_by_the_name_that_it_is_sent_by() {
        for (offer, name) in Offer::ALL {
            assert_eq!((offer.to_string().as_str(), Offer::named(name)), (name, Some(offer)));
        }
        assert_eq!(Offer::ALL.iter().map(|(offer, _)| offer).collect::<BTreeSet<_>>().len(), Offer::ALL.len());
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
        assert_eq!(name("x", " lamp ").unwrap(), "lamp");
        for bad in ["", "  ", "a\nb", "\u{1b}[2J", &"x".repeat(201)] {
            assert!(name("x", bad).is_err(), "{bad:?}");
        }
    }
}
