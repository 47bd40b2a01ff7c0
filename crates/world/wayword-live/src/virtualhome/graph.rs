//! The environment graph: everything in a home, with its box.

use crate::unity::wayword_from_unity;
use serde::Deserialize;
use wayword_core::DVec3;

/// Everything in a home. The graph's edges are not read, because the boxes already show which object is in which room.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
pub struct EnvironmentGraph {
    /// Rooms, walls, doors, furniture, things.
    pub nodes: Vec<EnvironmentNode>,
}

/// Something in a home.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct EnvironmentNode {
    /// Its number.
    pub id: i64,
    /// Its class, with the words run together: `coffeetable`.
    pub class_name: String,
    /// Its category, such as `Rooms`, `Doors`, `Walls` or `Furniture`.
    #[serde(default)]
    pub category: String,
    /// Its box, where it has one.
    #[serde(default)]
    pub bounding_box: Option<BoundingBox>,
}

/// A box along Unity's axes.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct BoundingBox {
    /// Its middle, metres.
    pub center: [f64; 3],
    /// Its size, metres.
    pub size: [f64; 3],
}

impl BoundingBox {
    /// Lower and upper corner in the world frame. `None` where they are not finite or too far out.
    pub(super) fn bounds_m(&self) -> Option<(DVec3, DVec3)> {
        let (centre, half) = (wayword_from_unity(self.center), wayword_from_unity(self.size).abs() / 2.0);
        let usable = centre.is_finite() && half.is_finite() && centre.abs().max_element() < 1e5;
        usable.then_some((centre - half, centre + half))
    }
}

impl EnvironmentNode {
    pub(super) fn is_room(&self) -> bool {
        self.category == "Rooms"
    }

    /// Whether it leads from room to room.
    pub(super) fn is_passage(&self) -> bool {
        matches!(self.class_name.as_str(), "doorjamb" | "door" | "doorway")
    }

    /// Whether it is an object, and not a part of the building or a character.
    pub(super) fn is_thing(&self) -> bool {
        !matches!(self.category.as_str(), "Rooms" | "Walls" | "Floor" | "Floors" | "Ceiling" | "Characters")
    }
}
