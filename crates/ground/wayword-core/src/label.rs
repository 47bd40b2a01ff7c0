//! Ground-truth labels: the objects that a platform knows to be visible.

use crate::{Heading, ObjectId};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// An object that is visible from a pose, as the platform's ground truth has it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ObjectLabel {
    /// Its id in the scene.
    pub object: ObjectId,
    /// Its name in plain words ("coffee table").
    pub name: String,
    /// Direction of the ray to the centre of its box, world frame.
    pub heading: Heading,
    /// Elevation of that ray, radians, up positive.
    pub elevation_rad: f64,
    /// Box in the view's image, pixels: x, y of the upper left corner, width, height. `None` where only the direction
    /// is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub box_px: Option<[f64; 4]>,
    /// Distance from the eye, metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distance_m: Option<f64>,
    /// Its centre, metres, world frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<DVec3>,
    /// The room that it stands in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub room: Option<String>,
    /// Word for its main colour.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colour: Option<String>,
}
