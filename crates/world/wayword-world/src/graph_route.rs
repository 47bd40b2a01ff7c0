//! Finds the route over a viewpoint graph that follows a path whose frames lie between the viewpoints.
//!
//! The route is a hidden sequence of viewpoints, one for each frame (Newson and Krumm 2009): it costs its length over the graph,
//! and the squares of the distances between frames and viewpoints. The cheapest sequence, with the shortest routes between its
//! viewpoints, walks along edges only.

use std::collections::BTreeMap;
use wayword_core::{DVec3, Frame, ViewpointGraph, ViewpointId};

/// How many viewpoints near a frame are candidates for it.
const MAX_CANDIDATES: usize = 8;
/// Cost of a square metre between a frame and its viewpoint, in metres of the route.
const COST_PER_M2: f64 = 1.0;
/// Cost of a metre between two viewpoints that no route joins, in metres of a route.
const COST_UNJOINED: f64 = 100.0;

/// A viewpoint that may stand for a frame.
#[derive(Clone, Copy)]
struct RouteCandidate<'a> {
    viewpoint: &'a ViewpointId,
    position: DVec3,
    /// Cost of the cheapest sequence that ends here.
    cost: f64,
    /// Index of the candidate before it.
    before: usize,
}

/// The viewpoints from the start to the end of a path: each two in a row have an edge, except where no route at all joins the places
/// of two frames. A frame that names a viewpoint of the graph stands at that one, and the first and the last frame at the nearest.
#[must_use]
pub fn route_along_frames(graph: &ViewpointGraph, frames: &[Frame]) -> Vec<ViewpointId> {
    let mut distances: BTreeMap<&ViewpointId, BTreeMap<&ViewpointId, f64>> = BTreeMap::new();
    let mut columns: Vec<Vec<RouteCandidate<'_>>> = Vec::with_capacity(frames.len());
    for (number, frame) in frames.iter().enumerate() {
        // A route that begins or ends elsewhere is another route.
        let is_end = number == 0 || number + 1 == frames.len();
        let mut column = candidates_for_frame(graph, frame, if is_end { 1 } else { MAX_CANDIDATES });
        for candidate in &mut column {
            candidate.cost = COST_PER_M2 * candidate.position.distance_squared(frame.pose.position);
            let Some(last) = columns.last() else { continue };
            let walked = last.iter().enumerate().map(|(index, before)| {
                let known = distances
                    .entry(before.viewpoint)
                    .or_insert_with(|| graph.distances_from(before.viewpoint).unwrap_or_default());
                let unjoined_m = || COST_UNJOINED * before.position.distance(candidate.position);
                (index, before.cost + known.get(candidate.viewpoint).copied().unwrap_or_else(unjoined_m))
            });
            if let Some((index, cost)) = walked.min_by(|a, b| a.1.total_cmp(&b.1)) {
                (candidate.before, candidate.cost) = (index, candidate.cost + cost);
            }
        }
        // A graph without viewpoints has no candidates.
        if !column.is_empty() {
            columns.push(column);
        }
    }
    join_by_routes(graph, &cheapest_sequence(&columns))
}

/// The viewpoint that a frame names, or else the `count` nearest to it.
fn candidates_for_frame<'a>(graph: &'a ViewpointGraph, frame: &Frame, count: usize) -> Vec<RouteCandidate<'a>> {
    let named = |id: &&ViewpointId| frame.viewpoint.as_ref() == Some(*id);
    let candidate = |viewpoint| {
        graph.position_of(viewpoint).map(|position| RouteCandidate { viewpoint, position, cost: 0.0, before: 0 })
    };
    if let Some(named) = graph.viewpoints().find(named).and_then(candidate) {
        return vec![named];
    }
    let mut all: Vec<RouteCandidate<'_>> = graph.viewpoints().filter_map(candidate).collect();
    let off_m2 = |candidate: &RouteCandidate<'_>| candidate.position.distance_squared(frame.pose.position);
    all.sort_by(|a, b| off_m2(a).total_cmp(&off_m2(b)));
    all.truncate(count);
    all
}

/// The cheapest sequence of candidates, without repeats in a row.
fn cheapest_sequence<'a>(columns: &[Vec<RouteCandidate<'a>>]) -> Vec<&'a ViewpointId> {
    let Some(last) = columns.last() else { return Vec::new() };
    let cheapest = (0..last.len()).min_by(|a, b| last[*a].cost.total_cmp(&last[*b].cost));
    let mut index = cheapest.unwrap_or(0);
    let mut sequence: Vec<&ViewpointId> = Vec::with_capacity(columns.len());
    for column in columns.iter().rev() {
        let candidate = &column[index];
        sequence.push(candidate.viewpoint);
        index = candidate.before;
    }
    sequence.reverse();
    sequence.dedup();
    sequence
}

/// Fills in the viewpoints between two of a sequence that no edge joins.
fn join_by_routes(graph: &ViewpointGraph, sequence: &[&ViewpointId]) -> Vec<ViewpointId> {
    let mut route: Vec<ViewpointId> = sequence.first().map(|first| (*first).clone()).into_iter().collect();
    for pair in sequence.windows(2) {
        match graph.shortest_path(pair[0], pair[1]).ok().flatten() {
            Some(between) => route.extend(between.viewpoints.into_iter().skip(1)),
            None => route.push(pair[1].clone()),
        }
    }
    route
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use wayword_core::{Heading, Pose};

    fn name(number: usize) -> ViewpointId {
        ViewpointId::new(format!("v{number}")).unwrap()
    }

    fn graph(places: &[(f64, f64)], edges: &[(usize, usize)]) -> ViewpointGraph {
        let mut graph = ViewpointGraph::default();
        for (number, (x, y)) in places.iter().enumerate() {
            graph.add_viewpoint(name(number), DVec3::new(*x, *y, 1.5), Some(1)).unwrap();
        }
        for (a, b) in edges {
            graph.join_viewpoints(&name(*a), &name(*b)).unwrap();
        }
        graph
    }

    fn frames(places: &[(f64, f64)]) -> Vec<Frame> {
        let frame = |(x, y): &(f64, f64)| Frame {
            pose: Pose::looking_level(DVec3::new(*x, *y, 1.5), Heading::NORTH),
            viewpoint: None,
            level: None,
        };
        places.iter().map(frame).collect()
    }

    fn route(graph: &ViewpointGraph, places: &[(f64, f64)]) -> Vec<usize> {
        let number = |id: ViewpointId| id.as_str()[1..].parse().unwrap();
        route_along_frames(graph, &frames(places)).into_iter().map(number).collect()
    }

    /// Two rooms with a wall at x = 2 between them, and a door at y = 6. Viewpoint 4 lies behind the wall, 0.8 m from viewpoint 1.
    fn two_rooms() -> ViewpointGraph {
        graph(
            &[(1.6, 0.0), (1.6, 3.0), (2.0, 6.0), (2.4, 5.0), (2.4, 3.0), (2.4, 0.0)],
            &[(0, 1), (1, 2), (2, 3), (3, 4), (4, 5)],
        )
    }

    #[test]
    fn a_route_stays_on_its_side_of_a_wall() {
        // The walk keeps near the wall, so some frames lie nearer to viewpoints behind it.
        assert_eq!(route(&two_rooms(), &[(1.7, 0.0), (2.05, 1.6), (2.05, 2.9), (1.8, 3.4)]), [0, 1]);
        assert_eq!(route(&two_rooms(), &[(1.7, 0.0), (1.7, 2.0), (1.7, 4.0), (2.0, 6.0), (2.4, 3.4)]), [0, 1, 2, 3, 4]);
    }

    #[test]
    fn viewpoints_between_two_frames_that_lie_far_apart_are_filled_in() {
        assert_eq!(route(&two_rooms(), &[(1.6, 0.0), (2.4, 0.0)]), [0, 1, 2, 3, 4, 5]);
    }

    #[test]
    fn a_walk_there_and_back_again_stays_one() {
        let line = graph(&[(0.0, 0.0), (2.0, 0.0), (4.0, 0.0)], &[(0, 1), (1, 2)]);
        let there_and_back = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (3.0, 0.0), (4.0, 0.0), (3.0, 0.0), (2.0, 0.0)];
        assert_eq!(route(&line, &there_and_back), [0, 1, 2, 1]);
    }

    #[test]
    fn a_named_viewpoint_is_kept_though_a_shorter_way_leads_past_it() {
        let triangle = graph(&[(0.0, 0.0), (2.0, 0.4), (2.0, 0.0)], &[(0, 1), (1, 2), (0, 2)]);
        let mut along = frames(&[(0.0, 0.0), (2.0, 0.4), (2.0, 0.0)]);
        for (number, frame) in along.iter_mut().enumerate() {
            frame.viewpoint = Some(name(number));
        }
        assert_eq!(route_along_frames(&triangle, &along), [name(0), name(1), name(2)]);
    }

    #[test]
    fn graphs_in_parts_and_empty_ones_are_no_error() {
        let parts = graph(&[(0.0, 0.0), (5.0, 0.0)], &[]);
        assert_eq!(route(&parts, &[(0.0, 0.0), (5.0, 0.0)]), [0, 1], "nothing joins them");
        assert!(route(&ViewpointGraph::default(), &[(0.0, 0.0)]).is_empty());
        assert!(route(&parts, &[]).is_empty());
    }

    proptest! {
        #[test]
        fn every_step_of_a_route_is_an_edge(
            places in prop::collection::vec((0.0..9.0f64, 0.0..9.0f64), 2..12),
            walk in prop::collection::vec((0.0..9.0f64, 0.0..9.0f64), 1..12),
        ) {
            let ring: Vec<_> = (1..places.len()).map(|at| (at - 1, at)).collect();
            let graph = graph(&places, &ring);
            let route = route_along_frames(&graph, &frames(&walk));
            prop_assert!(!route.is_empty());
            for pair in route.windows(2) {
                prop_assert!(graph.neighbours_of(&pair[0]).contains(&&pair[1]), "{pair:?}");
            }
        }
    }
}
