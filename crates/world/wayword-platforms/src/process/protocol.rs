//! What both sides agree on: the greeting, and what a world can offer. `docs/PROCESS.md` is the same in words.

use serde::Deserialize;
use std::{collections::BTreeSet, fmt, path::PathBuf};
use wayword_world::said::plain;

/// Version of the protocol.
pub const PROTOCOL: u64 = 1;
/// The frame and the units of every number, which a child has to repeat: z up, metres, radians clockwise from +y.
pub(crate) const FRAME: &str = "z-up, metres, radians clockwise from +y";
/// Longest name of a world, an object, a room or a colour, characters.
pub(crate) const MAX_NAME_CHARS: usize = 200;

/// One thing that a world can be asked for, beside its scenes and what is seen from a pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Offer {
    /// The whole viewpoint graph of a scene.
    Graph,
    /// Places where one can stand.
    Points,
    /// The points that can be reached from a point in one hop.
    Neighbours,
    /// Whether one can walk straight from one place to another.
    Walkable,
    /// Random paths of its own.
    SamplePath,
    /// Pictures.
    Pictures,
    /// The objects that are seen, each time all of them.
    Labels,
    /// The room in which one stands.
    Rooms,
    /// The name of an object by its id.
    ObjectName,
    /// From where an object can be seen.
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

/// What a child is, as it says in its greeting.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct World {
    /// Its name, to be shown.
    pub name: String,
    /// What it can be asked for.
    pub offers: BTreeSet<Offer>,
}

impl World {
    /// Whether it can be asked for something.
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
    /// The folder of its pictures, where it does not send them within its answers.
    #[serde(default)]
    pub(crate) images: Option<PathBuf>,
}

impl Greeting {
    /// The world that it makes known. Offers of later versions are passed over.
    ///
    /// # Errors
    /// When what it offers is too little to walk and to see.
    pub(crate) fn world(&self) -> Result<World, String> {
        let offers: BTreeSet<Offer> = self.offers.iter().filter_map(|name| Offer::named(name)).collect();
        let world = World { name: name("its name", &self.name)?, offers };
        let joins = world.has(Offer::Neighbours) || world.has(Offer::Walkable);
        let walks = world.has(Offer::Graph) || (world.has(Offer::Points) && joins);
        if !walks {
            return Err("a world offers `graph`, or `points` with `neighbours` or `walkable`".into());
        }
        if !world.has(Offer::Pictures) && !world.has(Offer::Labels) {
            return Err("a world offers `pictures`, `labels` or both".into());
        }
        Ok(world)
    }
}

/// A name that may be shown, without blanks around it.
///
/// # Errors
/// When it is empty, too long, or holds control characters.
pub(crate) fn name(what: &str, text: &str) -> Result<String, String> {
    let text = text.trim();
    if text.is_empty() || plain(text, MAX_NAME_CHARS) != text {
        let shown = plain(text, 40);
        return Err(format!("{what} {shown:?} is no name: one line of 1 to {MAX_NAME_CHARS} characters is"));
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
