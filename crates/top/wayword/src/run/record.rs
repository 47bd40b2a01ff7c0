//! The lines of a run folder.

use serde::{Deserialize, Serialize};
use serde_json::{Map as JsonMap, Value, json};
use wayword_core::{DVec3, Failure, Instruction, Observation, Path, Platform, PlatformError, ViewpointGraph};

/// A path and what was seen along it: a line of `walks.jsonl`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct WalkRecord {
    /// Name of the platform.
    pub platform: String,
    /// The path.
    pub path: Path,
    /// One per frame.
    pub observations: Vec<Observation>,
    /// What people said about the path, if the episodes have it.
    pub originals: Vec<String>,
    /// The viewpoint graph around the path.
    pub map: Map,
    /// Whether `frames/` holds pictures of the frames, named ITEM_FRAME.jpg.
    pub has_pictures: bool,
}

/// The viewpoint graph around a path, from above.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Map {
    /// Positions of nodes: x and y, metres, world frame.
    pub nodes: Vec<[f64; 2]>,
    /// Pairs of nodes.
    pub edges: Vec<[usize; 2]>,
}

/// How far from the path the map reaches, metres.
const MAP_MARGIN_M: f64 = 4.0;
/// Nodes that are higher or lower than the path by more than this belong to other storeys, metres.
const MAP_HEIGHT_M: f64 = 1.6;

/// A text that failed its checks: a line of `rejected.jsonl`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Rejected {
    /// The item.
    pub item: String,
    /// The style.
    pub style: String,
    /// Why.
    pub reason: String,
    /// The best text there was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last: Option<Instruction>,
}

/// An item that failed: a line of `errors.jsonl`. The same command tries it again.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct FailedItem {
    /// The item.
    pub item: String,
    /// What kind of failure it was. Older versions wrote no kind, and kept only failures of models.
    #[serde(default = "lost")]
    pub failure: Failure,
    /// What happened.
    pub reason: String,
}

fn lost() -> Failure {
    Failure::Lost
}

/// The name of a line: an item and a style.
pub(super) fn key(item: &str, style: &str) -> String {
    format!("{item}\u{1f}{style}")
}

pub(super) fn instruction_key(value: &Value) -> Option<String> {
    Some(key(value.get("path")?.get("id")?.as_str()?, value.get("style")?.as_str()?))
}

/// The item of a key, and the style if it has one.
pub(super) fn parts(key: &str) -> (&str, Option<&str>) {
    key.split_once('\u{1f}').map_or((key, None), |(item, style)| (item, Some(style)))
}

impl FailedItem {
    pub(super) fn key_of(value: &Value) -> Option<String> {
        Some(value.get("item")?.as_str()?.to_owned())
    }
}

impl WalkRecord {
    pub(super) fn key_of(value: &Value) -> Option<String> {
        Some(value.get("path")?.get("id")?.as_str()?.to_owned())
    }
}

impl Rejected {
    pub(super) fn key_of(value: &Value) -> Option<String> {
        Some(key(value.get("item")?.as_str()?, value.get("style")?.as_str()?))
    }
}

/// What an instruction's record holds besides the format's own fields.
#[must_use]
pub fn extra(path_id: &str) -> JsonMap<String, Value> {
    match json!({ "path_id": path_id }) {
        Value::Object(extra) => extra,
        _ => JsonMap::new(),
    }
}

impl Map {
    /// The graph around a path; empty if the path has no poses.
    ///
    /// # Errors
    /// When the platform cannot give it.
    pub fn around(path: &Path, platform: &dyn Platform) -> Result<Self, PlatformError> {
        if !path.motion.is_known() {
            return Ok(Self::default());
        }
        let stops: Vec<DVec3> = path.frames.iter().map(|frame| frame.pose.position).collect();
        Ok(Self::near(&stops, &*platform.graph(&path.scene)?))
    }

    /// A graph around some places, on their storeys.
    #[must_use]
    pub fn near(stops: &[DVec3], graph: &ViewpointGraph) -> Self {
        let near = |position: DVec3| {
            stops.iter().any(|stop| {
                let off = *stop - position;
                off.truncate().length() <= MAP_MARGIN_M && off.z.abs() <= MAP_HEIGHT_M
            })
        };
        let mut map = Self::default();
        let mut places = std::collections::BTreeMap::new();
        for (id, position) in
            graph.viewpoints().filter_map(|id| Some((id, graph.position(id)?))).filter(|(_, position)| near(*position))
        {
            places.insert(id, map.nodes.len());
            map.nodes.push([centimetres(position.x), centimetres(position.y)]);
        }
        map.edges = graph.edges().filter_map(|(a, b, _)| Some([*places.get(a)?, *places.get(b)?])).collect();
        map
    }
}

fn centimetres(metres: f64) -> f64 {
    (metres * 100.0).round() / 100.0
}
