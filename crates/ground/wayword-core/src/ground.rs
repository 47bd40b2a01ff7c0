//! Walkable ground between viewpoints, for platforms that know it: routes on foot and islands.

use glam::DVec3;
use serde::Serialize;
use std::fmt;

/// The shortest way on foot between two places.
#[derive(Debug, Clone, PartialEq)]
pub struct GroundRoute {
    /// Positions on the ground: the start, every bend, and the end. Between two of them the way is straight.
    pub corners: Vec<DVec3>,
    /// Its length, metres.
    pub length_m: f64,
}

/// A connected part of the ground. No way leads from one island to another.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroundIsland {
    /// Its number; 0 is the largest.
    pub number: usize,
    /// Its area, square metres.
    pub area_m2: f64,
    /// The height of most of it in the world frame, metres.
    pub height_m: f64,
    /// The cover over most of it.
    pub cover: GroundCover,
    /// Whether random paths use it.
    pub is_walked: bool,
}

/// The cover over a piece of ground: ceiling, sky, or too low a ceiling.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum GroundCover {
    /// A ceiling that is high enough to stand under.
    Ceiling,
    /// The open sky.
    Sky,
    /// The open sky, with rooms below: it is a roof.
    OnRoof,
    /// A ceiling that is too low to stand under.
    Low,
}

impl fmt::Display for GroundCover {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ceiling => "under a ceiling",
            Self::Sky => "under the open sky",
            Self::OnRoof => "on top of a roof",
            Self::Low => "too low to stand upright",
        })
    }
}

impl fmt::Display for GroundIsland {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { number, area_m2, height_m, cover, .. } = self;
        write!(f, "island {number}: {area_m2:.1} m2 at height {height_m:.1} m, {cover}")
    }
}
