//! How long shortest paths take over a viewpoint graph like a building's: 200 viewpoints on three storeys, about 2 m
//! apart.

#![allow(clippy::expect_used, clippy::print_stdout, missing_docs, reason = "a benchmark may fail and print")]

use criterion::{Criterion, criterion_group, criterion_main};
use rand::Rng;
use std::hint::black_box;
use wayword_core::{DVec3, ViewpointGraph, ViewpointId, seeded_rng};

/// Viewpoints of a storey, along x and y.
const FLOOR: [usize; 2] = [11, 6];
const FLOORS: usize = 3;
/// Two landings, each in the middle of a flight.
const LANDINGS: usize = 2;

fn name(floor: usize, x: usize, y: usize) -> ViewpointId {
    ViewpointId::new(format!("{floor}-{x}-{y}")).expect("a plain name")
}

/// Three storeys of rooms. Neighbours on a storey are joined unless there is a wall between them, and stairs join the
/// storeys.
fn building() -> ViewpointGraph {
    let mut graph = ViewpointGraph::default();
    let mut rng = seeded_rng(7, &["building"]);
    for floor in 0..FLOORS {
        for (x, y) in places() {
            let [x_m, y_m] = [x, y].map(|at| 2.0 * at as f64 + rng.random_range(-0.4..0.4));
            let position = DVec3::new(x_m, y_m, 1.5 + 2.9 * floor as f64);
            graph.add_viewpoint(name(floor, x, y), position, Some(floor as u32 + 1)).expect("names are unique");
        }
    }
    for floor in 0..FLOORS {
        for (x, y) in places() {
            for (dx, dy) in [(1, 0), (0, 1), (1, 1)] {
                // Rooms open onto a corridor along y = 2; there are doors between some of them.
                let is_open = dx == 0 || (y == 2 && dy == 0) || rng.random_bool(0.4);
                if is_open && x + dx < FLOOR[0] && y + dy < FLOOR[1] {
                    graph.join_viewpoints(&name(floor, x, y), &name(floor, x + dx, y + dy)).expect("both are there");
                }
            }
        }
    }
    for floor in 0..LANDINGS {
        let landing = ViewpointId::new(format!("landing-{floor}")).expect("a plain name");
        graph
            .add_viewpoint(landing.clone(), DVec3::new(20.0, 4.0, 2.95 + 2.9 * floor as f64), None)
            .expect("names are unique");
        for end in [floor, floor + 1] {
            graph.join_viewpoints(&name(end, 10, 2), &landing).expect("both are there");
        }
    }
    graph
}

fn places() -> impl Iterator<Item = (usize, usize)> {
    (0..FLOOR[0]).flat_map(|x| (0..FLOOR[1]).map(move |y| (x, y)))
}

fn shortest_paths(criterion: &mut Criterion) {
    let graph = building();
    println!("{} viewpoints, {} edges, {} components", graph.len(), graph.edges().count(), graph.count_components());
    let names: Vec<ViewpointId> = graph.viewpoints().cloned().collect();
    criterion.bench_function("one shortest path across the building", |bencher| {
        let (start, goal) = (name(0, 0, 2), name(2, 0, 2));
        bencher.iter(|| graph.shortest_path(black_box(&start), black_box(&goal)));
    });
    criterion.bench_function("distances from one viewpoint to all", |bencher| {
        bencher.iter(|| graph.distances_from(black_box(&names[0])).map(|distances| distances.len()));
    });
    let mut group = criterion.benchmark_group("all pairs of 200 viewpoints");
    group.sample_size(10);
    group.bench_function("distances", |bencher| {
        let reached = |start: &ViewpointId| graph.distances_from(start).map_or(0, |distances| distances.len());
        bencher.iter(|| names.iter().map(reached).sum::<usize>());
    });
    group.bench_function("paths", |bencher| {
        let hops = |start: &ViewpointId, goal: &ViewpointId| {
            graph.shortest_path(start, goal).ok().flatten().map_or(0, |route| route.viewpoints.len())
        };
        bencher.iter(|| names.iter().flat_map(|start| names.iter().map(move |goal| hops(start, goal))).sum::<usize>());
    });
    group.finish();
}

criterion_group!(benches, shortest_paths);
criterion_main!(benches);
