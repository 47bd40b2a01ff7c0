//! Gets the viewpoint graph of a child's scene. A child may send its own graph. Otherwise the graph is made here, from
//! places that the child proposes: it is asked for the neighbours of each place, or whether one can walk straight between
//! two of them.

use super::{
    child_keeper::ChildKeeper,
    labels::{plausible_level, plausible_position},
    protocol::WorldOffer,
};
use serde::Deserialize;
use serde_json::json;
use std::collections::BTreeSet;
use wayword_core::{DVec3, PlatformError, SceneId, ViewpointGraph, ViewpointId, graph::GraphError};

/// Most viewpoints of a child's own graph; a larger one is refused.
const MAX_VIEWPOINTS: usize = 20_000;
/// Most edges of a graph, or neighbours in all; more are refused.
const MAX_EDGES: usize = 200_000;
/// Number of places to ask for, if the graph is made here.
const POINTS_ASKED: usize = 1000;
/// Most places from which a graph is made here.
const MAX_POINTS: usize = 5000;
/// Longest walk that the child is asked about, in multiples of the spacing.
const REACH_SPACINGS: f64 = 3.0;
/// Number of nearest places that a walk is tried to from each place.
const MAX_NEIGHBOURS_TRIED: usize = 8;
/// Most walks in one request.
const MAX_PAIRS_PER_REQUEST: usize = 128;

/// A place in the child's words, where a walker can stand. `level` is its storey, 1 for the lowest.
#[derive(Debug, Clone, Deserialize)]
struct ChildWaypoint {
    #[serde(default)]
    id: Option<ViewpointId>,
    position: [f64; 3],
    #[serde(default)]
    level: Option<u32>,
}

/// The answer to `graph`.
#[derive(Deserialize)]
struct GraphAnswer {
    viewpoints: Vec<ChildWaypoint>,
    edges: Vec<(ViewpointId, ViewpointId)>,
}

/// The answer to `points`.
#[derive(Deserialize)]
struct PointsAnswer {
    points: Vec<ChildWaypoint>,
}

/// The answer to `neighbours`.
#[derive(Deserialize)]
struct NeighboursAnswer {
    viewpoints: Vec<ViewpointId>,
}

/// The answer to `walkable`: one value for each pair that was asked about.
#[derive(Deserialize)]
struct WalkableAnswer {
    walkable: Vec<bool>,
}

/// The graph of a scene.
///
/// # Errors
/// If the child does not answer, or its answers do not make a graph.
pub(crate) fn ask_scene_graph(keeper: &ChildKeeper, scene: &SceneId) -> Result<ViewpointGraph, PlatformError> {
    if keeper.world().has_offer(WorldOffer::Graph) {
        return ask_whole_graph(keeper, scene);
    }
    let asked = json!({ "scene": scene, "count": POINTS_ASKED, "seed": 0 });
    let PointsAnswer { points } = keeper.ask_and_read("points", &asked)?;
    if points.is_empty() || points.len() > MAX_POINTS {
        let reason = format!("{} points, expected 1 to {MAX_POINTS}", points.len());
        return Err(keeper.misfit_error("points", reason));
    }
    if keeper.world().has_offer(WorldOffer::Neighbours) {
        graph_by_neighbours(keeper, scene, &points)
    } else {
        graph_by_walking(keeper, scene, points)
    }
}

/// The graph that the child sends as a whole.
fn ask_whole_graph(keeper: &ChildKeeper, scene: &SceneId) -> Result<ViewpointGraph, PlatformError> {
    let GraphAnswer { viewpoints, edges } = keeper.ask_and_read("graph", &json!({ "scene": scene }))?;
    if viewpoints.is_empty() || viewpoints.len() > MAX_VIEWPOINTS || edges.len() > MAX_EDGES {
        let reason = format!(
            "viewpoints: {}, expected 1 to {MAX_VIEWPOINTS}; edges: {}, expected at most {MAX_EDGES}",
            viewpoints.len(),
            edges.len()
        );
        return Err(keeper.misfit_error("graph", reason));
    }
    let mut graph = graph_without_edges(&viewpoints).map_err(|reason| keeper.misfit_error("graph", reason))?;
    for (index, (a, b)) in edges.iter().enumerate() {
        if a == b {
            return Err(keeper.misfit_error("graph", format!("`edges[{index}]` leads from viewpoint {a} to itself")));
        }
        graph.join_viewpoints(a, b).map_err(|error| keeper.misfit_error("graph", error.to_string()))?;
    }
    Ok(graph)
}

/// A graph of places, with the neighbours that the child gives for each.
fn graph_by_neighbours(
    keeper: &ChildKeeper,
    scene: &SceneId,
    points: &[ChildWaypoint],
) -> Result<ViewpointGraph, PlatformError> {
    let mut graph = graph_without_edges(points).map_err(|reason| keeper.misfit_error("points", reason))?;
    let names: Vec<ViewpointId> = graph.viewpoints().cloned().collect();
    let mut edges = 0;
    for name in &names {
        let asked = json!({ "scene": scene, "viewpoint": name });
        let NeighboursAnswer { viewpoints } = keeper.ask_and_read("neighbours", &asked)?;
        edges += viewpoints.len();
        if edges > MAX_EDGES {
            return Err(keeper.misfit_error("neighbours", format!("more than {MAX_EDGES} neighbours in all")));
        }
        for other in &viewpoints {
            graph.join_viewpoints(name, other).map_err(|error| keeper.misfit_error("neighbours", error.to_string()))?;
        }
    }
    Ok(graph)
}

/// A graph of these places without edges, with the names that the child gave them.
fn graph_without_edges(places: &[ChildWaypoint]) -> Result<ViewpointGraph, String> {
    let mut graph = ViewpointGraph::default();
    for (index, here) in places.iter().enumerate() {
        let id = here.id.clone().ok_or_else(|| format!("viewpoint {index} has no `id`"))?;
        let position = plausible_position(here.position).map_err(|reason| format!("viewpoint {id}: {reason}"))?;
        let level = plausible_level(here.level).map_err(|reason| format!("viewpoint {id}: {reason}"))?;
        graph.add_viewpoint(id, position, level).map_err(|error| error.to_string())?;
    }
    Ok(graph)
}

/// Thins the places out, asks for each near pair whether one can walk straight, and keeps the largest connected part.
fn graph_by_walking(
    keeper: &ChildKeeper,
    scene: &SceneId,
    points: Vec<ChildWaypoint>,
) -> Result<ViewpointGraph, PlatformError> {
    let spacing_m = keeper.options().spacing_m;
    let points = thin_out(points, spacing_m).map_err(|reason| keeper.misfit_error("points", reason))?;
    let tried = near_pairs(&points, REACH_SPACINGS * spacing_m);
    let mut open = Vec::new();
    for batch in tried.chunks(MAX_PAIRS_PER_REQUEST) {
        let place = |point: &usize| points.get(*point).map(|point| point.position);
        let pairs: Vec<_> = batch.iter().filter_map(|(a, b)| Some([place(a)?, place(b)?])).collect();
        let WalkableAnswer { walkable } =
            keeper.ask_and_read("walkable", &json!({ "scene": scene, "pairs": pairs }))?;
        if walkable.len() != batch.len() {
            let reason = format!("`walkable` has length {}, but `pairs` has {}", walkable.len(), batch.len());
            return Err(keeper.misfit_error("walkable", reason));
        }
        open.extend(batch.iter().zip(walkable).filter(|(_, open)| *open).map(|(pair, _)| *pair));
    }
    largest_connected_part(&points, &open).map_err(|source| PlatformError::Graph { scene: scene.clone(), source })
}

/// Drops places that are less than `spacing_m` from an earlier one, and gives the rest names if they have none.
fn thin_out(points: Vec<ChildWaypoint>, spacing_m: f64) -> Result<Vec<ChildWaypoint>, String> {
    let mut kept: Vec<ChildWaypoint> = Vec::new();
    for (index, point) in points.into_iter().enumerate() {
        let here = plausible_position(point.position)?;
        plausible_level(point.level).map_err(|reason| format!("`points[{index}]`: {reason}"))?;
        if kept.iter().all(|other| DVec3::from_array(other.position).distance(here) >= spacing_m) {
            let name = || ViewpointId::new(format!("p{}", kept.len())).map_err(|error| error.to_string());
            let id = point.id.clone().map_or_else(name, Ok)?;
            kept.push(ChildWaypoint { id: Some(id), ..point });
        }
    }
    Ok(kept)
}

/// Pairs of each place with its nearest ones, sorted, each pair once.
fn near_pairs(points: &[ChildWaypoint], reach_m: f64) -> Vec<(usize, usize)> {
    let positions: Vec<DVec3> = points.iter().map(|point| DVec3::from_array(point.position)).collect();
    let mut pairs = BTreeSet::new();
    for (here, from) in positions.iter().enumerate() {
        let mut near: Vec<(f64, usize)> = positions
            .iter()
            .enumerate()
            .map(|(other, to)| (from.distance(*to), other))
            .filter(|(far_m, other)| *other != here && *far_m <= reach_m)
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        pairs.extend(near.into_iter().take(MAX_NEIGHBOURS_TRIED).map(|(_, other)| (here.min(other), here.max(other))));
    }
    pairs.into_iter().collect()
}

/// The largest connected part of the graph; of two with the same size, the one with the first place.
fn largest_connected_part(points: &[ChildWaypoint], open: &[(usize, usize)]) -> Result<ViewpointGraph, GraphError> {
    let part = label_parts(points.len(), open);
    let size = |number: usize| part.iter().filter(|other| **other == number).count();
    let numbers: BTreeSet<usize> = part.iter().copied().collect();
    let largest = numbers.into_iter().rev().max_by_key(|number| size(*number));
    let mut graph = ViewpointGraph::default();
    for (point, number) in points.iter().zip(&part) {
        if let (Some(id), true) = (&point.id, Some(*number) == largest) {
            graph.add_viewpoint(id.clone(), DVec3::from_array(point.position), point.level)?;
        }
    }
    let id_of = |point: &usize| points.get(*point)?.id.as_ref();
    for (a, b) in open {
        if let (Some(from), Some(to), true) = (id_of(a), id_of(b), part.get(*a).copied() == largest) {
            graph.join_viewpoints(from, to)?;
        }
    }
    Ok(graph)
}

/// For each place, the first place of its connected part.
fn label_parts(count: usize, open: &[(usize, usize)]) -> Vec<usize> {
    let mut beside = vec![Vec::new(); count];
    for (from, to) in open.iter().flat_map(|(a, b)| [(*a, *b), (*b, *a)]) {
        if let Some(beside) = beside.get_mut(from) {
            beside.push(to);
        }
    }
    let mut part: Vec<Option<usize>> = vec![None; count];
    for start in 0..count {
        let mut waiting = vec![start];
        while let Some(here) = waiting.pop() {
            let Some((part, beside)) = part.get_mut(here).zip(beside.get(here)) else { continue };
            if part.is_none() {
                *part = Some(start);
                waiting.extend(beside);
            }
        }
    }
    part.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn at(x: f64, y: f64) -> ChildWaypoint {
        ChildWaypoint { id: None, position: [x, y, 1.5], level: None }
    }

    #[test]
    fn a_graph_of_walks_is_the_largest_part_and_avoids_walls() {
        let points: Vec<ChildWaypoint> = (0..8).map(|n| at(f64::from(n), 0.0)).collect();
        let points = thin_out(points, 1.0).unwrap();
        // A wall between 4 and 5.
        let open: Vec<_> = near_pairs(&points, 2.0).into_iter().filter(|(a, b)| (*a < 5) == (*b < 5)).collect();
        let graph = largest_connected_part(&points, &open).unwrap();
        assert_eq!((graph.len(), graph.count_components()), (5, 1));
        assert!(graph.viewpoints().all(|id| id.as_str() < "p5"));
    }

    #[test]
    fn a_level_that_is_no_storey_is_refused() {
        let places = |level| vec![ChildWaypoint { id: ViewpointId::new("a").ok(), level: Some(level), ..at(0.0, 0.0) }];
        assert!(graph_without_edges(&places(2)).is_ok() && thin_out(places(2), 1.0).is_ok());
        let told = graph_without_edges(&places(0)).unwrap_err();
        assert!(told.starts_with("viewpoint a: `level` is 0, expected 1"), "{told}");
        assert!(thin_out(places(99_999), 1.0).unwrap_err().starts_with("`points[0]`: `level` is 99999"));
    }

    proptest! {
        #[test]
        fn thinned_places_lie_apart_and_every_place_has_one_near(
            xs in prop::collection::vec((0.0..8.0f64, 0.0..8.0f64), 1..80),
        ) {
            let points: Vec<ChildWaypoint> = xs.iter().map(|(x, y)| at(*x, *y)).collect();
            let kept = thin_out(points.clone(), 1.0).unwrap();
            let far = |a: &ChildWaypoint, b: &ChildWaypoint| DVec3::from_array(a.position).distance(DVec3::from_array(b.position));
            for (n, a) in kept.iter().enumerate() {
                prop_assert!(kept[..n].iter().all(|b| far(a, b) >= 1.0));
            }
            prop_assert!(points.iter().all(|a| kept.iter().any(|b| far(a, b) < 1.0)));
            let pairs = near_pairs(&kept, 3.0);
            prop_assert!(pairs.iter().all(|(a, b)| a < b && far(&kept[*a], &kept[*b]) <= 3.0));
            let graph = largest_connected_part(&kept, &pairs).unwrap();
            prop_assert_eq!(graph.count_components(), 1);
            let inside = |n: usize| graph.position_of(kept[n].id.as_ref().unwrap()).is_some();
            prop_assert!(pairs.iter().all(|(a, b)| inside(*a) == inside(*b)), "a way leads out of the part that was kept");
            let all = label_parts(kept.len(), &pairs);
            let largest = all.iter().map(|part| all.iter().filter(|other| *other == part).count()).max();
            prop_assert_eq!(Some(graph.len()), largest);
        }
    }
}
