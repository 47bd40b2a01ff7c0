//! Reads `SCAN_connectivity.json`: the viewpoints of a building, and the pairs between which one can walk straight.
//!
//! Format: Matterport3DSimulator's `connectivity/README.md`; a list of `{image_id, pose[16], included, visible[],
//! unobstructed[], height}`, the pose row-major and in metres, z up. `visible` is not read, so a file may leave it out.

use crate::{
    files::{file_error, json_if_there},
    json_values, levels,
};
use serde_json::Value;
use std::{collections::BTreeSet, fs, path::Path};
use wayword_core::{DMat3, DVec3, PlatformError, ViewpointGraph, ViewpointId, graph::GraphError};

/// The end of such a file's name, after the name of the scene.
pub const CONNECTIVITY_FILE_SUFFIX: &str = "_connectivity.json";

/// Most viewpoints of a building (the largest real one has 345); the table of edges grows with the square of this
/// number.
const MAX_VIEWPOINTS: usize = 4096;
/// Largest file, bytes; the largest real one has 1.5 MB. Parsed in memory, a list of zeros takes about fifty times its
/// size.
const MAX_BYTES: u64 = 4 << 20;
/// Most files of a folder that are examined for ways in one direction.
const MAX_EXAMINED_FILES: usize = 5000;

/// A building's viewpoints.
#[derive(Debug, Clone, PartialEq)]
pub struct ConnectivityGraph {
    /// The included viewpoints, in the file's order.
    pub viewpoints: Vec<PanoramaViewpoint>,
    /// Pairs of indices into `viewpoints`.
    pub edges: Vec<(usize, usize)>,
}

/// A place from which a panorama was taken.
#[derive(Debug, Clone, PartialEq)]
pub struct PanoramaViewpoint {
    /// Its name.
    pub id: ViewpointId,
    /// Position of the camera, metres, world frame.
    pub position: DVec3,
    /// The camera's height above the floor, metres.
    pub height_m: f64,
    /// The 3x3 part of the pose: it rotates the skybox's axes to the world's.
    pub world_from_skybox: DMat3,
}

impl PanoramaViewpoint {
    /// Height of the floor below the camera, metres, world frame.
    #[must_use]
    pub fn floor_m(&self) -> f64 {
        self.position.z - self.height_m
    }
}

impl ConnectivityGraph {
    /// The viewpoint graph. `level` gives the storey of a viewpoint; if it gives `None`, the storey is found from the heights
    /// of all floors.
    ///
    /// # Errors
    /// When two viewpoints have one name.
    pub fn to_viewpoint_graph(
        &self,
        level: impl Fn(&ViewpointId) -> Option<u32>,
    ) -> Result<ViewpointGraph, GraphError> {
        let floors_m: Vec<f64> = self.viewpoints.iter().map(PanoramaViewpoint::floor_m).collect();
        let by_height = levels::from_floor_heights(&floors_m);
        let mut graph = ViewpointGraph::default();
        for (viewpoint, by_height) in self.viewpoints.iter().zip(by_height) {
            let level = level(&viewpoint.id).unwrap_or(by_height);
            graph.add_viewpoint(viewpoint.id.clone(), viewpoint.position, Some(level))?;
            graph.set_floor(&viewpoint.id, viewpoint.floor_m())?;
        }
        for (from, to) in &self.edges {
            graph.join_viewpoints(&self.viewpoints[*from].id, &self.viewpoints[*to].id)?;
        }
        Ok(graph)
    }

    /// The pairs of viewpoints of which only the first lists the other as its neighbour.
    #[must_use]
    pub fn one_way_edges(&self) -> Vec<(&ViewpointId, &ViewpointId)> {
        let all: BTreeSet<(usize, usize)> = self.edges.iter().copied().collect();
        let one_way = self.edges.iter().filter(|(from, to)| !all.contains(&(*to, *from)));
        let id = |at: usize| self.viewpoints.get(at).map(|viewpoint| &viewpoint.id);
        one_way.filter_map(|(from, to)| id(*from).zip(id(*to))).collect()
    }
}

/// The edges in one direction of all graphs in a folder, in a line for the user; `None` if there are none. A file that cannot be
/// read is passed over, because whoever uses it gets its error.
#[must_use]
pub fn describe_one_way_edges(folder: &Path) -> Option<String> {
    let entries = fs::read_dir(folder).ok()?.filter_map(Result::ok).take(MAX_EXAMINED_FILES);
    let mut files: Vec<_> = entries
        .map(|entry| entry.path())
        .filter(|file| file.to_string_lossy().ends_with(CONNECTIVITY_FILE_SUFFIX))
        .collect();
    files.sort();
    let (mut edges, mut scenes, mut first) = (0, 0, None);
    for file in files {
        let Ok(Some(graph)) = read_connectivity_file(&file, "") else { continue };
        let found = graph.one_way_edges();
        edges += found.len();
        scenes += usize::from(!found.is_empty());
        if let (None, Some((from, to))) = (&first, found.first()) {
            let name = file.file_name().unwrap_or_default().display();
            first = Some(format!("{name} lists {to} as a neighbour of {from}, but not the other way"));
        }
    }
    let more = match edges {
        0 | 1 => String::new(),
        _ => format!("; there are {edges} such edges in {scenes} of the graphs"),
    };
    Some(format!("{}{more}", first?))
}

/// Reads a connectivity file; `None` if there is none. `hint` is the advice to the user in an error about a broken file.
///
/// # Errors
/// If the file does not have this format; the message names the viewpoint and the field.
pub fn read_connectivity_file(file: &Path, hint: &'static str) -> Result<Option<ConnectivityGraph>, PlatformError> {
    let Some(bytes) = json_if_there(file, MAX_BYTES, hint)? else {
        return Ok(None);
    };
    parse_connectivity(&bytes).map(Some).map_err(|reason| file_error(file, reason, hint))
}

fn parse_connectivity(bytes: &[u8]) -> Result<ConnectivityGraph, String> {
    let items: Vec<Value> =
        serde_json::from_slice(bytes).map_err(|error| format!("is not a JSON list of viewpoints: {error}"))?;
    if items.len() > MAX_VIEWPOINTS {
        return Err(format!("lists {} viewpoints, expected at most {MAX_VIEWPOINTS}", items.len()));
    }
    // Index among the included viewpoints, by index in the file.
    let mut included = Vec::with_capacity(items.len());
    let mut viewpoints = Vec::new();
    for (number, item) in items.iter().enumerate() {
        let viewpoint = parse_viewpoint(item).map_err(|reason| format!("viewpoint {number}: {reason}"))?;
        included.push(viewpoint.as_ref().map(|_| viewpoints.len()));
        viewpoints.extend(viewpoint);
    }
    let mut edges = Vec::new();
    for (number, item) in items.iter().enumerate() {
        let open = parse_neighbours(item, items.len()).map_err(|reason| format!("viewpoint {number}: {reason}"))?;
        let Some(from) = included[number] else { continue };
        edges
            .extend(open.into_iter().filter_map(|other| included[other]).filter(|to| *to != from).map(|to| (from, to)));
    }
    Ok(ConnectivityGraph { viewpoints, edges })
}

/// One item of the list; `None` if it is not included in the graph.
fn parse_viewpoint(item: &Value) -> Result<Option<PanoramaViewpoint>, String> {
    let id = ViewpointId::new(json_values::text_field(item, "image_id")?)
        .map_err(|error| format!("field `image_id`: {error}"))?;
    let named = |reason| format!("{id}: {reason}");
    if !json_values::read_flag(json_values::required_field(item, "included").map_err(named)?, "included")
        .map_err(named)?
    {
        // The pose of a viewpoint that is not included is not used, and it may not consist of numbers.
        return Ok(None);
    }
    let pose = parse_pose(item).map_err(named)?;
    let height_m = json_values::read_coordinate(json_values::required_field(item, "height").map_err(named)?, "height")
        .map_err(named)?;
    Ok(Some(PanoramaViewpoint {
        position: DVec3::new(pose[3], pose[7], pose[11]),
        height_m,
        world_from_skybox: DMat3::from_cols_array(&[
            pose[0], pose[4], pose[8], pose[1], pose[5], pose[9], pose[2], pose[6], pose[10],
        ]),
        id,
    }))
}

fn parse_pose(item: &Value) -> Result<[f64; 16], String> {
    let numbers = json_values::list_field(item, "pose")?;
    if numbers.len() != 16 {
        return Err(format!("field `pose` has {} numbers, expected 16", numbers.len()));
    }
    let mut pose = [0.0; 16];
    for (place, value) in pose.iter_mut().zip(numbers) {
        *place = json_values::read_coordinate(value, "pose")?;
    }
    Ok(pose)
}

/// The indices of the viewpoints to which one can walk straight from this item, among all `count` items of the file.
fn parse_neighbours(item: &Value, count: usize) -> Result<Vec<usize>, String> {
    let flags = json_values::list_field(item, "unobstructed")?;
    if flags.len() != count {
        return Err(format!("field `unobstructed` has length {}, but the list of viewpoints has {count}", flags.len()));
    }
    let mut open = Vec::new();
    for (other, value) in flags.iter().enumerate() {
        if json_values::read_flag(value, "unobstructed")? {
            open.push(other);
        }
    }
    Ok(open)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::json;

    fn item(id: &str, included: bool, x: f64, unobstructed: &[bool]) -> Value {
        json!({
            "image_id": id, "included": included, "height": 1.5, "unobstructed": unobstructed, "visible": unobstructed,
            "pose": [0.0, -1.0, 0.0, x, 0.0, 0.0, -1.0, 2.0, 1.0, 0.0, 0.0, 1.6, 0.0, 0.0, 0.0, 1.0],
        })
    }

    fn parsed(value: &Value) -> Result<ConnectivityGraph, String> {
        parse_connectivity(value.to_string().as_bytes())
    }

    #[test]
    fn positions_heights_and_rotation_come_from_the_pose() {
        let read = parsed(&json!([item("a", true, 4.0, &[false])])).unwrap();
        let only = &read.viewpoints[0];
        assert_eq!(only.position, DVec3::new(4.0, 2.0, 1.6));
        assert!((only.floor_m() - 0.1).abs() < 1e-12);
        assert_eq!(only.world_from_skybox * DVec3::X, DVec3::Z, "the first column is pose[0], pose[4], pose[8]");
    }

    #[test]
    fn an_edge_needs_a_free_way_and_both_ends_included() {
        let all = [true, true, true];
        let read =
            parsed(&json!([item("a", true, 0.0, &all), item("b", false, 1.0, &all), item("c", true, 2.0, &all)]))
                .unwrap();
        assert_eq!(read.viewpoints.len(), 2);
        assert_eq!(read.edges, [(0, 1), (1, 0)]);
    }

    #[test]
    fn an_edge_in_one_direction_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, value: &Value| std::fs::write(folder.path().join(name), value.to_string()).unwrap();
        write("whole_connectivity.json", &row(4));
        write("broken_connectivity.json", &json!({}));
        assert_eq!(describe_one_way_edges(folder.path()), None);
        let mut cut = row(4);
        cut[2]["unobstructed"][1] = json!(false);
        // A viewpoint that is not included has no edges.
        cut[3]["included"] = json!(false);
        cut[3]["unobstructed"][2] = json!(false);
        let read = parsed(&cut).unwrap();
        let one_way: Vec<_> = read.one_way_edges().iter().map(|(from, to)| (from.as_str(), to.as_str())).collect();
        assert_eq!(one_way, [("v1", "v2")]);
        write("cut_connectivity.json", &cut);
        let told = describe_one_way_edges(folder.path()).unwrap();
        assert_eq!(told, "cut_connectivity.json lists v2 as a neighbour of v1, but not the other way");
        cut[0]["unobstructed"][1] = json!(false);
        write("more_connectivity.json", &cut);
        assert!(describe_one_way_edges(folder.path()).unwrap().ends_with("3 such edges in 2 of the graphs"));
    }

    #[test]
    fn errors_name_the_viewpoint_and_the_field() {
        let mut broken = json!([item("a", true, 0.0, &[false])]);
        broken[0]["pose"][3] = json!("east");
        assert_eq!(parsed(&broken).unwrap_err(), "viewpoint 0: a: field `pose` holds a text, not a number");
        broken[0]["pose"][3] = json!(1e300);
        assert!(parsed(&broken).unwrap_err().contains("not a plausible coordinate"));
        let short = parsed(&json!([item("a", true, 0.0, &[])])).unwrap_err();
        assert_eq!(short, "viewpoint 0: field `unobstructed` has length 0, but the list of viewpoints has 1");
        assert!(parsed(&json!([item("../a", true, 0.0, &[false])])).unwrap_err().contains("path separators"));
        assert!(parse_connectivity(b"[{\"pose\": [NaN]}]").unwrap_err().contains("is not a JSON list"));
    }

    /// A file of `count` viewpoints in a row, each joined with the next.
    fn row(count: usize) -> Value {
        let open = |at: usize| (0..count).map(|other| at.abs_diff(other) == 1).collect::<Vec<bool>>();
        (0..count).map(|at| item(&format!("v{at}"), true, at as f64, &open(at))).collect()
    }

    #[test]
    fn parse_connectivity_accepts_a_file_without_unused_fields() {
        let mut bare = row(2);
        bare[0].as_object_mut().unwrap().remove("visible");
        bare[0]["pose"] = json!([0, 0, 0, 7, 0, 0, 0, 2, 0, 0, 0, 1.6, 0, 0, 0, 1]);
        let read = parsed(&bare).unwrap();
        assert_eq!((read.viewpoints[0].position, read.edges.len()), (DVec3::new(7.0, 2.0, 1.6), 2));
    }

    proptest! {
        #[test]
        fn parse_connectivity_names_a_field_that_is_missing_or_of_another_kind(
            count in 1..9_usize, at in any::<prop::sample::Index>(), field in 0..5_usize, is_gone in any::<bool>()
        ) {
            let (mut file, number) = (row(count), at.index(count));
            let name = ["image_id", "pose", "included", "unobstructed", "height"][field];
            if is_gone {
                file[number].as_object_mut().unwrap().remove(name);
            } else {
                file[number][name] = json!({ "a": 1 });
            }
            let refused = parsed(&file).unwrap_err();
            let told = format!("viewpoint {number}: ");
            prop_assert!(refused.starts_with(&told) && refused.contains(&format!("`{name}`")), "{}", refused);
        }

        #[test]
        fn edges_are_those_between_included_viewpoints(count in 1..9_usize, left_out in any::<prop::sample::Index>()) {
            let (mut file, gone) = (row(count), left_out.index(count));
            file[gone]["included"] = json!(false);
            let read = parsed(&file).unwrap();
            let ends = usize::from(gone > 0) + usize::from(gone + 1 < count);
            prop_assert_eq!(read.edges.len(), 2 * (count - 1 - ends));
            prop_assert_eq!(read.to_viewpoint_graph(|_| None).unwrap().len(), count - 1);
        }
    }
}
