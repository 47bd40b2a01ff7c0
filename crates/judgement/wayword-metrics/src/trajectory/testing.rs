//! Graphs, episodes and trajectories for the property tests of this folder.

use super::{AgentTrajectory, EpisodeDemand};
use proptest::prelude::*;
use wayword_core::{DVec3, ObjectId, ViewpointGraph, ViewpointId};

pub(super) fn id(n: usize) -> ViewpointId {
    ViewpointId::new(format!("v{n}")).unwrap()
}

pub(super) fn ids(places: &[usize]) -> Vec<ViewpointId> {
    places.iter().map(|n| id(*n)).collect()
}

pub(super) fn object(name: &str) -> ObjectId {
    ObjectId::new(name).unwrap()
}

pub(super) fn graph(points: &[[f64; 2]], edges: &[(usize, usize)]) -> ViewpointGraph {
    let mut graph = ViewpointGraph::default();
    for (n, [x, y]) in points.iter().enumerate() {
        graph.add_viewpoint(id(n), DVec3::new(*x, *y, 0.0), Some(1)).unwrap();
    }
    for (a, b) in edges {
        graph.join_viewpoints(&id(*a), &id(*b)).unwrap();
    }
    graph
}

/// Places, some of which may coincide, and edges that need not connect them all.
pub(super) fn any_graph() -> impl Strategy<Value = ViewpointGraph> {
    let points = prop::collection::vec((0..6u8, 0..6u8), 1..14);
    let edges = prop::collection::vec((0..14usize, 0..14usize), 0..30);
    (points, edges).prop_map(|(points, edges)| {
        let metres: Vec<[f64; 2]> = points.iter().map(|(x, y)| [f64::from(*x) * 1.3, f64::from(*y) * 0.9]).collect();
        let n = metres.len();
        graph(&metres, &edges.into_iter().map(|(a, b)| (a % n, b % n)).collect::<Vec<_>>())
    })
}

/// A walk from a viewpoint: each choice takes one of the neighbours, or stays.
fn walk(graph: &ViewpointGraph, start: usize, choices: &[usize]) -> Vec<ViewpointId> {
    let mut taken = vec![id(start)];
    for choice in choices {
        let here = &taken[taken.len() - 1];
        let ways = graph.neighbours_of(here);
        let next = ways.get(choice % (ways.len() + 1)).map_or_else(|| here.clone(), |way| (*way).clone());
        taken.push(next);
    }
    taken
}

/// A graph, an episode on it, and a trajectory that can be scored. Sometimes the goal cannot be reached.
pub(super) fn any_case() -> impl Strategy<Value = (ViewpointGraph, EpisodeDemand, AgentTrajectory)> {
    let choices = || prop::collection::vec(0..20usize, 0..12);
    let seen = prop::collection::btree_set(0..14usize, 0..8);
    let far_goal = prop::option::weighted(0.2, 0..14usize);
    (any_graph(), 0..14usize, choices(), choices(), seen, far_goal, any::<bool>(), any::<bool>()).prop_map(
        |(graph, start, on_path, taken, seen, far_goal, names_it, is_named)| {
            let start = start % graph.len();
            let mut reference = walk(&graph, start, &on_path);
            reference.extend(far_goal.map(|goal| id(goal % graph.len())));
            let demand = EpisodeDemand {
                reference,
                object: is_named.then(|| object("lamp")),
                visible_from: Some(seen.into_iter().map(id).collect()),
            };
            let named = Some(object(if names_it { "lamp" } else { "door" }));
            let trajectory = AgentTrajectory { viewpoints: walk(&graph, start, &taken), object: named };
            (graph, demand, trajectory)
        },
    )
}
