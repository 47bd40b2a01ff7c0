//! Draws random paths along a viewpoint graph, and a target at the end of each.

use crate::object_names;
use rand::{Rng, seq::SliceRandom};
use std::f64::consts::TAU;
use wayword_core::{
    Heading, ObjectLabel, Path, PathMotion, PathRequest, PathTarget, PlatformError, SceneId, ViewpointGraph,
    ViewpointId, ViewpointRoute, seeded_rng,
};

/// How many ends without a visible object are skipped before a path without a target is accepted.
const MAX_BARE_ENDS: usize = 64;

/// Draws a shortest path between two random viewpoints that fits `request`, with a random start heading (as in REVERIE).
/// If possible, it ends at a viewpoint with a visible object, which becomes its target. `labels_at` gives the objects
/// that are visible at a viewpoint.
///
/// # Errors
/// When no two viewpoints are as far apart as `request` asks, or `labels_at` fails.
pub fn sample_graph_path(
    scene: &SceneId,
    graph: &ViewpointGraph,
    request: &PathRequest,
    seed: u64,
    labels_at: impl Fn(&ViewpointId) -> Result<Vec<ObjectLabel>, PlatformError>,
) -> Result<Path, PlatformError> {
    let failed = |source| PlatformError::Graph { scene: scene.clone(), source };
    let mut rng = seeded_rng(seed, &["matterport path", scene.as_str()]);
    let heading = Heading::new(rng.random_range(0.0..TAU)).unwrap_or(Heading::NORTH);
    let mut starts: Vec<&ViewpointId> = graph.viewpoints().collect();
    starts.shuffle(&mut rng);
    // The first route that ends where no object is visible. It is used if no better one is found.
    let mut bare: Option<ViewpointRoute> = None;
    let mut bare_ends = 0;
    for start in starts {
        let distances = graph.distances_from(start).map_err(failed)?;
        let far_enough = distances.into_iter().filter(|(_, length_m)| request.length_m.contains(length_m));
        let mut ends: Vec<&ViewpointId> = far_enough.map(|(end, _)| end).collect();
        ends.shuffle(&mut rng);
        for end in ends {
            let route = graph.shortest_path(start, end).map_err(failed)?;
            let Some(route) = route.filter(|route| request.hops.contains(&(route.viewpoints.len() - 1))) else {
                continue;
            };
            let target = choose_target(&labels_at(end)?, &mut rng);
            if target.is_none() && bare_ends < MAX_BARE_ENDS {
                bare_ends += 1;
                bare.get_or_insert(route);
                continue;
            }
            let route = if target.is_none() { bare.unwrap_or(route) } else { route };
            return path_along_route(scene, graph, &route, heading, seed, target);
        }
    }
    match bare {
        Some(route) => path_along_route(scene, graph, &route, heading, seed, None),
        None => Err(PlatformError::NoSuchPath {
            scene: scene.clone(),
            request: describe_path_request(request),
            hint: "widen --hops or --metres",
        }),
    }
}

/// The path along a route, with its frames and its name.
fn path_along_route(
    scene: &SceneId,
    graph: &ViewpointGraph,
    route: &ViewpointRoute,
    heading: Heading,
    seed: u64,
    target: Option<PathTarget>,
) -> Result<Path, PlatformError> {
    let frames = graph
        .path_frames(&route.viewpoints, Some(heading))
        .map_err(|source| PlatformError::Graph { scene: scene.clone(), source })?;
    let start = route.viewpoints.first().map_or("", ViewpointId::as_str);
    Ok(Path { id: format!("{scene}_{start}_{seed}"), scene: scene.clone(), frames, motion: PathMotion::Known, target })
}

/// Chooses one of the visible objects at random. Furnishings come before parts of the building, and then objects that no
/// other visible object shares its name with come before the rest.
pub fn choose_target(labels: &[ObjectLabel], rng: &mut impl Rng) -> Option<PathTarget> {
    let has_namesake = |label: &ObjectLabel| labels.iter().filter(|other| other.name == label.name).count() > 1;
    let rank = |label: &ObjectLabel| (!object_names::is_furnishing(&label.name), has_namesake(label));
    let best = labels.iter().map(rank).min()?;
    let candidates: Vec<&ObjectLabel> = labels.iter().filter(|label| rank(label) == best).collect();
    let chosen = candidates[rng.random_range(0..candidates.len())];
    Some(PathTarget {
        object: chosen.object.clone(),
        name: chosen.name.clone(),
        told_by: Vec::new(),
        has_namesake: has_namesake(chosen),
        descriptions: Vec::new(),
        hangs: false,
        storeys: 0,
    })
}

/// Describes a request for a path, for an error message.
#[must_use]
pub fn describe_path_request(request: &PathRequest) -> String {
    let (hops, length_m) = (&request.hops, &request.length_m);
    format!("{} to {} hops and {} to {} metres", hops.start(), hops.end(), length_m.start(), length_m.end())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use wayword_core::ObjectId;

    fn line(count: usize) -> ViewpointGraph {
        let id = |n: usize| ViewpointId::new(format!("v{n}")).unwrap();
        let mut graph = ViewpointGraph::default();
        for n in 0..count {
            graph.add_viewpoint(id(n), DVec3::new(2.0 * n as f64, 0.0, 1.5), Some(1)).unwrap();
        }
        for n in 1..count {
            graph.join_viewpoints(&id(n - 1), &id(n)).unwrap();
        }
        graph
    }

    fn label(object: &str, name: &str) -> ObjectLabel {
        ObjectLabel {
            object: ObjectId::new(object).unwrap(),
            name: name.into(),
            heading: Heading::NORTH,
            elevation_rad: 0.0,
            box_px: None,
            distance_m: None,
            position: None,
            colour: None,
            room: None,
        }
    }

    fn scene() -> SceneId {
        SceneId::new("s").unwrap()
    }

    #[test]
    fn paths_keep_to_hops_and_metres_and_to_their_seed() {
        let graph = line(12);
        let request = PathRequest { hops: 4..=5, length_m: 5.0..=9.0 };
        let sampled = |seed| sample_graph_path(&scene(), &graph, &request, seed, |_| Ok(Vec::new())).unwrap();
        for seed in 0..50 {
            let path = sampled(seed);
            assert_eq!(path.moves().len(), 4);
            assert!((path.length_m().unwrap() - 8.0).abs() < 1e-9);
            assert_eq!(path, sampled(seed));
        }
        assert_ne!(sampled(1).id, sampled(2).id);
    }

    #[test]
    fn an_end_where_something_is_visible_is_preferred() {
        let graph = line(12);
        let labels = |end: &ViewpointId| Ok(if end.as_str() == "v5" { vec![label("9", "lamp")] } else { Vec::new() });
        for seed in 0..20 {
            let path = sample_graph_path(&scene(), &graph, &PathRequest::default(), seed, labels).unwrap();
            assert_eq!(path.frames.last().unwrap().viewpoint.as_ref().unwrap().as_str(), "v5");
            assert_eq!(path.target.unwrap().name, "lamp");
        }
    }

    #[test]
    fn the_target_is_furniture_and_alone_of_its_name_where_it_can_be() {
        let labels = [label("1", "wall"), label("2", "chair"), label("3", "chair"), label("4", "lamp")];
        for seed in 0..20 {
            let alone = choose_target(&labels, &mut seeded_rng(seed, &[])).unwrap();
            assert_eq!((alone.name.as_str(), alone.has_namesake), ("lamp", false));
            let of_two = choose_target(&labels[..3], &mut seeded_rng(seed, &[])).unwrap();
            assert_eq!((of_two.name.as_str(), of_two.has_namesake), ("chair", true));
        }
        assert_eq!(choose_target(&[], &mut seeded_rng(0, &[])), None);
    }

    #[test]
    fn error_describes_a_request_that_no_path_fits() {
        let request = PathRequest { hops: 40..=50, length_m: 5.0..=9.0 };
        let error = sample_graph_path(&scene(), &line(6), &request, 1, |_| Ok(Vec::new())).unwrap_err().to_string();
        assert!(error.contains("40 to 50 hops and 5 to 9 metres"), "{error}");
    }
}
