//! Where an eye is and which way it looks.

use crate::Heading;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A position in the world frame (metres, z up; the eye's, not the floor's), a heading, and an elevation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// The eye, metres, world frame.
    pub position: DVec3,
    /// Where it looks, in the horizontal plane.
    pub heading: Heading,
    /// How far it looks up (positive) or down, radians.
    #[serde(default)]
    pub elevation_rad: f64,
}

impl Pose {
    /// A pose that looks along the horizon.
    #[must_use]
    pub fn looking_level(position: DVec3, heading: Heading) -> Self {
        Self { position, heading, elevation_rad: 0.0 }
    }
}
