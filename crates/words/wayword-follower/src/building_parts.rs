//! The parts of a building that the follower knows: viewpoints, and things that are seen from them.

use wayword_core::DVec3;

/// A viewpoint.
#[derive(Debug, Clone)]
pub(crate) struct BuildingViewpoint {
    /// Metres, z up.
    pub(crate) position: DVec3,
    /// The viewpoints to which one can go from here, by their numbers in the building.
    pub(crate) neighbours: Vec<usize>,
    /// The name of its room, where it is known.
    pub(crate) room: Option<String>,
    /// Its storey, the lowest being 1, where the platform knows it.
    pub(crate) level: Option<u32>,
    /// Whether its room, its things and all its neighbours are known.
    pub(crate) is_known: bool,
    /// Whether a way up begins here, and a way down.
    pub(crate) climbs: [bool; 2],
}

/// An object.
#[derive(Debug, Clone)]
pub(crate) struct BuildingThing {
    /// Its name, normalised as the lexicon does it.
    pub(crate) name: String,
    /// Metres, z up.
    pub(crate) position: DVec3,
    /// The viewpoints from which it is seen.
    pub(crate) seen_from: Vec<usize>,
}
