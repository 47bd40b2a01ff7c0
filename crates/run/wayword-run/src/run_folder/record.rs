//! The records of a run folder: a type for a line of each of its files, and the keys that identify the lines.

use super::cost::{ItemCalls, TextCost};
use serde::{Deserialize, Serialize};
use serde_json::{Map as JsonMap, Value};
use wayword_core::{
    DVec3, FailureKind, FrameObservation, Instruction, Path, Platform, PlatformError, ViewpointGraph, WrittenDraft,
};
use wayword_formats::jsonl::InstructionRecord;

/// A path and what was seen along it: a line of `walks.jsonl`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct WalkRecord {
    /// Name of the platform.
    pub platform: String,
    /// The path.
    pub path: Path,
    /// One per frame.
    pub observations: Vec<FrameObservation>,
    /// Instructions by people for the same path, if the episodes have any.
    pub originals: Vec<String>,
    /// The viewpoint graph around the path.
    pub map: PathMap,
    /// Whether `frames/` holds pictures of the frames, named ITEM_FRAME.jpg.
    pub has_pictures: bool,
    /// The answers of models that the item used, and what they cost when they were made, also if the ledger had them already.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub used: Option<ItemCalls>,
}

/// The viewpoint graph around a path, from above.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct PathMap {
    /// Positions of nodes: x and y, metres, world frame.
    pub nodes: Vec<[f64; 2]>,
    /// Pairs of nodes, as indices into `nodes`.
    pub edges: Vec<[usize; 2]>,
}

/// How far from the path the map reaches, metres.
const MAP_MARGIN_M: f64 = 4.0;
/// A node belongs to another storey if it is higher or lower than the path by more than this, metres.
const MAP_HEIGHT_M: f64 = 1.6;

/// A text that failed its checks: a line of `rejected.jsonl`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RejectedText {
    /// The item.
    pub item: String,
    /// The style.
    pub style: String,
    /// Why it was rejected.
    pub reason: String,
    /// The best text there was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last: Option<Instruction>,
    /// Its number among the texts of its path and style, from 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub number: usize,
    /// The texts of a model before it, with the reasons.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub drafts: Vec<WrittenDraft>,
    /// What its texts cost; `None` where no model took part, and in lines of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cost: Option<TextCost>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands a reference")]
fn is_zero(number: &usize) -> bool {
    *number == 0
}

/// An item that failed: a line of `errors.jsonl`. The same command tries it again.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct FailedItem {
    /// The item.
    pub item: String,
    /// The kind of failure. Older versions wrote no kind, and kept only failures of models.
    #[serde(default = "lost")]
    pub failure: FailureKind,
    /// The message of the error.
    pub reason: String,
}

fn lost() -> FailureKind {
    FailureKind::Lost
}

/// The key of a line about a text: its item, and its name within the item ([`text_name`]), with a control character
/// between them.
pub(super) fn line_key(item: &str, text: &str) -> String {
    format!("{item}\u{1f}{text}")
}

/// Identifies a text within its item: its style, and its number where the style has several.
#[must_use]
pub fn text_name(style: &str, number: usize) -> String {
    if number == 0 { style.to_owned() } else { format!("{style}\u{1f}{number}") }
}

/// As people read it: the style of a text, and from the second text of a path and style on its number.
#[must_use]
pub fn text_label(style: &str, number: usize) -> String {
    if number == 0 { style.to_owned() } else { format!("{style}, text {}", number + 1) }
}

/// The field of a record that has the number of its text.
const NUMBER_FIELD: &str = "number";

/// The number of a record's text among those of its path and style, from 0.
#[must_use]
pub fn number_of_text(record: &InstructionRecord) -> usize {
    let number = record.extra.get(NUMBER_FIELD).and_then(Value::as_u64);
    number.and_then(|number| usize::try_from(number).ok()).unwrap_or(0)
}

/// Identifies the text of a record within its item, as a part of file names: its style, and its number where the style has
/// several.
#[must_use]
pub fn text_file_name(record: &InstructionRecord) -> String {
    let style = &record.instruction.style;
    match number_of_text(record) {
        0 => style.clone(),
        number => format!("{style}-{number}"),
    }
}

/// The name within its item ([`text_name`]) of the text in a line.
fn text_name_in_line(value: &Value) -> Option<String> {
    let number = value.get(NUMBER_FIELD).and_then(Value::as_u64).and_then(|number| usize::try_from(number).ok());
    Some(text_name(value.get("style")?.as_str()?, number.unwrap_or(0)))
}

/// The key of a line of `instructions.jsonl`.
pub(super) fn instruction_key(value: &Value) -> Option<String> {
    Some(line_key(value.get("path")?.get("id")?.as_str()?, &text_name_in_line(value)?))
}

/// The item of a key, and the name of its text if it has one.
pub(super) fn key_parts(key: &str) -> (&str, Option<&str>) {
    key.split_once('\u{1f}').map_or((key, None), |(item, text)| (item, Some(text)))
}

impl FailedItem {
    /// The key of a line of `errors.jsonl`: its item. `None` if the line has none.
    pub fn key_of(value: &Value) -> Option<String> {
        Some(value.get("item")?.as_str()?.to_owned())
    }
}

impl WalkRecord {
    /// The key of a line of `walks.jsonl`: the id of its path, which is that of the item.
    pub(super) fn key_of(value: &Value) -> Option<String> {
        Some(value.get("path")?.get("id")?.as_str()?.to_owned())
    }
}

impl RejectedText {
    /// The key of a line of `rejected.jsonl`.
    pub(super) fn key_of(value: &Value) -> Option<String> {
        Some(line_key(value.get("item")?.as_str()?, &text_name_in_line(value)?))
    }
}

/// The additional fields of an instruction's record: the path in its dataset, and the number of the text where its path and
/// style have several.
#[must_use]
pub fn extra_fields(path_id: &str, number: usize) -> JsonMap<String, Value> {
    let mut extra = JsonMap::new();
    extra.insert("path_id".to_owned(), path_id.into());
    if number > 0 {
        extra.insert(NUMBER_FIELD.to_owned(), number.into());
    }
    extra
}

impl PathMap {
    /// The graph around a path; empty if the path has no poses.
    ///
    /// # Errors
    /// When the platform cannot give it.
    pub fn around_path(path: &Path, platform: &dyn Platform) -> Result<Self, PlatformError> {
        if !path.motion.is_known() {
            return Ok(Self::default());
        }
        let stops: Vec<DVec3> = path.frames.iter().map(|frame| frame.pose.position).collect();
        Ok(Self::near_stops(&stops, &*platform.graph_for_scene(&path.scene)?))
    }

    /// A graph around some places, on their storeys.
    #[must_use]
    pub fn near_stops(stops: &[DVec3], graph: &ViewpointGraph) -> Self {
        let near = |position: DVec3| {
            stops.iter().any(|stop| {
                let off = *stop - position;
                off.truncate().length() <= MAP_MARGIN_M && off.z.abs() <= MAP_HEIGHT_M
            })
        };
        let mut map = Self::default();
        let mut places = std::collections::BTreeMap::new();
        for (id, position) in graph
            .viewpoints()
            .filter_map(|id| Some((id, graph.position_of(id)?)))
            .filter(|(_, position)| near(*position))
        {
            places.insert(id, map.nodes.len());
            map.nodes.push([round_to_centimetres(position.x), round_to_centimetres(position.y)]);
        }
        map.edges = graph.edges().filter_map(|(a, b, _)| Some([*places.get(a)?, *places.get(b)?])).collect();
        map
    }
}

fn round_to_centimetres(metres: f64) -> f64 {
    (metres * 100.0).round() / 100.0
}
