//! Reads the viewpoint graph of a scene from a file in Matterport's format.

use super::graph_fit;
use crate::{file_error::FileError, scene::SceneModel, triangle_columns::TriangleColumns};
use std::path::Path;
use wayword_core::{DVec3, PlatformError, ViewpointGraph};
use wayword_world::connectivity::{self, ConnectivityGraph};

const GRAPH_HINT: &str = "get the graph again from where it was published, or take it out of --connectivity";
/// Greatest distance from an edge at which a view may be taken, metres.
const MAX_BESIDE_EDGE_M: f64 = 0.5;
/// Greatest height above or below an edge at which a view may be taken, metres: a robot's camera is lower than a person's eye.
const MAX_ABOVE_EDGE_M: f64 = 2.0;

/// Reads a graph's file.
pub(super) fn read_connectivity(file: &Path) -> Result<ConnectivityGraph, PlatformError> {
    connectivity::read_connectivity_file(file, GRAPH_HINT)?
        .ok_or_else(|| FileError::new(file, "there is no such file", GRAPH_HINT).into())
}

/// Reads the graph of a scene. If `model` is given, a graph that does not lie in it is refused.
pub(super) fn read_graph(file: &Path, model: Option<&SceneModel>) -> Result<ViewpointGraph, PlatformError> {
    let connectivity = read_connectivity(file)?;
    if let Some(model) = model {
        let judged = graph_fit::judge_fit(&TriangleColumns::with_walls(model.triangles()), &connectivity);
        judged.map_err(|misfit| FileError::new(file, misfit.reason, misfit.hint))?;
    }
    build_graph(file, &connectivity).map_err(PlatformError::from)
}

/// Makes the viewpoint graph from the contents of its file.
pub(super) fn build_graph(file: &Path, connectivity: &ConnectivityGraph) -> Result<ViewpointGraph, FileError> {
    connectivity.to_viewpoint_graph(|_| None).map_err(|error| FileError::new(file, error.to_string(), GRAPH_HINT))
}

/// Whether a place is at a viewpoint or on an edge, or near enough to one.
pub(super) fn is_near_graph(graph: &ViewpointGraph, eye: DVec3) -> bool {
    let place = |viewpoint| graph.position_of(viewpoint);
    let near = |on_way: DVec3| {
        let off = eye - on_way;
        off.truncate().length() <= MAX_BESIDE_EDGE_M && off.z.abs() <= MAX_ABOVE_EDGE_M
    };
    let along = |from: DVec3, to: DVec3| {
        let way = (to - from).truncate();
        let share = (eye - from).truncate().dot(way) / way.length_squared();
        near(from.lerp(to, if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 }))
    };
    graph.viewpoints().filter_map(place).any(near)
        || graph.edges().any(|(from, to, _)| place(from).zip(place(to)).is_some_and(|(from, to)| along(from, to)))
}
