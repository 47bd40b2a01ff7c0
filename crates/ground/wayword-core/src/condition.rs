//! The condition of a scene's files: what they offer and what they lack, examined before a run uses them.

use crate::SceneId;
use serde::{Deserialize, Serialize};
use std::fmt;

/// The condition of a scene's files.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SceneCondition {
    /// The scene.
    pub scene: SceneId,
    /// Whether its pictures can be drawn.
    pub has_pictures: bool,
    /// How large its viewpoint graph is, where a file gives the graph.
    pub graph: Option<GraphSize>,
    /// The number of its storeys, where the graph has them.
    pub storeys: Option<u32>,
    /// Whether its objects are known.
    pub has_labels: bool,
    /// Where the names of its rooms come from.
    pub rooms: RoomNames,
    /// How its viewpoint graph lies in it, where that was examined.
    pub fit: Option<GraphFit>,
    /// Defects that do not keep a run from using the scene.
    pub lacks: Vec<SceneLack>,
    /// Why the scene cannot be used; `None` if it can.
    pub unusable: Option<SceneLack>,
}

/// How large a viewpoint graph is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct GraphSize {
    /// Its viewpoints.
    pub viewpoints: usize,
    /// Its edges, each counted once.
    pub edges: usize,
}

/// Where the names of rooms come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RoomNames {
    /// The dataset names them.
    Dataset,
    /// Rules make them from labels.
    Rules,
    /// They are not known.
    Unknown,
}

/// How a viewpoint graph lies in its scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct GraphFit {
    /// Viewpoints.
    pub viewpoints: usize,
    /// Viewpoints that have a floor below them, about an eye's height down.
    pub over_floor: usize,
    /// Edges that were examined.
    pub edges: usize,
    /// Edges among these that cross a wall.
    pub through_walls: usize,
}

/// Something that is missing or wrong in a scene's files, and how the user can repair it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneLack {
    /// The problem, in words.
    pub what: String,
    /// Advice for the user.
    pub hint: String,
}

impl SceneCondition {
    /// The condition of a scene that cannot be used and was not examined further.
    #[must_use]
    pub fn for_unusable(scene: SceneId, why: SceneLack) -> Self {
        Self {
            scene,
            has_pictures: false,
            graph: None,
            storeys: None,
            has_labels: false,
            rooms: RoomNames::Unknown,
            fit: None,
            lacks: Vec::new(),
            unusable: Some(why),
        }
    }
}

impl fmt::Display for GraphFit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { viewpoints, over_floor, edges, through_walls } = self;
        write!(
            f,
            "{over_floor} of {viewpoints} viewpoints stand over a floor, {through_walls} of {edges} edges cross a wall"
        )
    }
}

impl fmt::Display for RoomNames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Dataset => "rooms",
            Self::Rules => "rooms by rules",
            Self::Unknown => "no rooms",
        })
    }
}
