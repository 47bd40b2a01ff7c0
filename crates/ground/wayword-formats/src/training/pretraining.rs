//! The lines from which VLN-DUET and ScaleVLN pre-train, and the table of views in which the neighbours of a viewpoint lie.
//!
//! Source: cshizhe/VLN-DUET and wz0919/ScaleVLN, `pretrain_src/data/dataset.py`; the angles and views are those of the Matterport3D
//! simulator (`MatterSim.cpp`).

#![allow(
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "it writes what this program made, and reads nothing from a file"
)]

use crate::{FormatError, output};
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::{
    collections::BTreeMap,
    f64::consts::{FRAC_PI_6, PI, TAU},
    path::Path,
};
use wayword_core::{ViewpointGraph, ViewpointId};

/// A text about a path, as tokens.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PretrainingLine {
    /// `PATH_I`, or with an object `PATH_OBJECT_I`: loaders split it at `_`.
    pub instr_id: String,
    /// The scene.
    pub scan: String,
    /// The viewpoints from start to end.
    pub path: Vec<ViewpointId>,
    /// Which way the agent looks at the start, radians, 0 along +y, clockwise.
    pub heading: f64,
    /// The ids of the text's tokens, with those of the beginning and the end.
    pub instr_encoding: Vec<u32>,
    /// With an object: the viewpoints from which it is seen.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pos_vps: Option<Vec<ViewpointId>>,
}

/// Writes the lines.
///
/// # Errors
/// When the file cannot be written.
pub fn write_pretraining_lines(file: &Path, lines: &[PretrainingLine]) -> Result<(), FormatError> {
    output::write_file(file, |out| output::write_lines(out, lines))
}

/// Where each neighbour of the viewpoints of a scene lies: for `SCAN_VIEWPOINT` an object from each neighbour to the number of the
/// nearest of the 36 views (12 headings of 30 degrees in 3 rows of elevation, from the lowest), the angle to the middle of that view,
/// and its parts along heading and elevation, radians.
#[must_use]
pub fn neighbour_views(scan: &str, graph: &ViewpointGraph) -> BTreeMap<String, Value> {
    let views_of = |id: &ViewpointId| {
        let entry = |other: &ViewpointId| Some((other.to_string(), neighbour_view(graph, id, other)?));
        let views: Map<String, Value> = graph.neighbours_of(id).into_iter().filter_map(entry).collect();
        (format!("{scan}_{id}"), Value::Object(views))
    };
    graph.viewpoints().map(views_of).collect()
}

fn neighbour_view(graph: &ViewpointGraph, from: &ViewpointId, to: &ViewpointId) -> Option<Value> {
    const HEADINGS: i64 = 12;
    let offset = graph.position_of(to)? - graph.position_of(from)?;
    let heading = libm::atan2(offset.x, offset.y).rem_euclid(TAU);
    let elevation = libm::atan2(offset.z, libm::hypot(offset.x, offset.y));
    let column = (heading / FRAC_PI_6).round() as i64 % HEADINGS;
    // The middle row reaches 15 degrees up and down.
    let row = 1 + i64::from(elevation > FRAC_PI_6 / 2.0) - i64::from(elevation < -FRAC_PI_6 / 2.0);
    let beside = (heading - FRAC_PI_6 * column as f64 + PI).rem_euclid(TAU) - PI;
    let above = elevation - FRAC_PI_6 * (row - 1) as f64;
    Some(json!([HEADINGS * row + column, libm::hypot(beside, above), beside, above]))
}

/// Writes the table of neighbours' views.
///
/// # Errors
/// When the file cannot be written.
pub fn write_neighbour_views(file: &Path, views: &BTreeMap<String, Value>) -> Result<(), FormatError> {
    output::write_file(file, |out| Ok(serde_json::to_writer(out, views)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::DVec3;

    #[test]
    fn a_neighbour_lies_in_the_view_that_looks_at_it() {
        let id = |name: &str| ViewpointId::new(name).unwrap();
        let mut graph = ViewpointGraph::default();
        let places = [
            ("here", [0.0, 0.0, 0.0]),
            ("north", [0.0, 2.0, 0.0]),
            ("east_up", [2.0, 0.0, 1.0]),
            ("west", [-2.0, 0.1, 0.0]),
        ];
        for (name, place) in places {
            graph.add_viewpoint(id(name), DVec3::from_array(place), None).unwrap();
            if name != "here" {
                graph.join_viewpoints(&id("here"), &id(name)).unwrap();
            }
        }
        let views = neighbour_views("flat", &graph);
        let numbers = |name: &str| -> Vec<f64> { serde_json::from_value(views["flat_here"][name].clone()).unwrap() };
        assert_eq!(numbers("north"), [12.0, 0.0, 0.0, 0.0]);
        let up = numbers("east_up");
        assert!(up[0] == 27.0 && up[2].abs() < 1e-9 && (up[3] - (0.5_f64.atan() - FRAC_PI_6)).abs() < 1e-9, "{up:?}");
        let west = numbers("west");
        assert!(west[0] == 21.0 && (west[2] - 0.05_f64.atan()).abs() < 1e-9, "{west:?}");
    }
}
