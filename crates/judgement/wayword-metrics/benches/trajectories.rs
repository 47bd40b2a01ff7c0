//! How long scoring takes: a trajectory, and the distances of a building like Matterport's largest, 350 viewpoints about 2 m apart.

#![allow(clippy::expect_used, missing_docs, reason = "a benchmark may fail")]

use criterion::{Criterion, criterion_group, criterion_main};
use rand::Rng;
use std::hint::black_box;
use wayword_core::{DVec3, ObjectId, ViewpointGraph, ViewpointId, seeded_rng};
use wayword_metrics::{AgentTrajectory, EpisodeDemand, SceneDistances, score_trajectory};

/// Viewpoints along x, y and upwards.
const SIZE: [usize; 3] = [14, 5, 5];
/// Hops of the annotated path and of the trajectory.
const HOPS: [usize; 2] = [6, 15];

fn name([x, y, z]: [usize; 3]) -> ViewpointId {
    // Matterport's names are 32 hexadecimal digits in no order.
    let number = (x + SIZE[0] * (y + SIZE[1] * z) + 1) as u64;
    let digits = number.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    ViewpointId::new(format!("{digits:016x}{digits:016x}")).expect("a plain name")
}

fn places() -> impl Iterator<Item = [usize; 3]> {
    let [width, depth, floors] = SIZE;
    (0..width * depth * floors).map(move |n| [n % width, n / width % depth, n / width / depth])
}

/// Storeys of rooms that open onto each other, and stairs in one corner.
fn building() -> ViewpointGraph {
    let mut graph = ViewpointGraph::default();
    let mut rng = seeded_rng(7, &["building"]);
    for place in places() {
        let [x_m, y_m] = [place[0], place[1]].map(|at| 2.0 * at as f64 + rng.random_range(-0.4..0.4));
        graph.add_viewpoint(name(place), DVec3::new(x_m, y_m, 3.0 * place[2] as f64), None).expect("names are unique");
    }
    for [x, y, z] in places() {
        for [dx, dy, dz] in [[1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 0, 1]] {
            let next = [x + dx, y + dy, z + dz];
            let is_open = dz == 0 || [x, y] == [0, 0];
            if is_open && next.iter().zip(SIZE).all(|(at, size)| *at < size) {
                graph.join_viewpoints(&name([x, y, z]), &name(next)).expect("both are there");
            }
        }
    }
    graph
}

fn walk(graph: &ViewpointGraph, start: &ViewpointId, hops: usize) -> Vec<ViewpointId> {
    let mut rng = seeded_rng(7, &["walk"]);
    let mut taken = vec![start.clone()];
    for _ in 0..hops {
        let ways = graph.neighbours_of(&taken[taken.len() - 1]);
        taken.push(ways[rng.random_range(0..ways.len())].clone());
    }
    taken
}

fn trajectories(criterion: &mut Criterion) {
    let graph = building();
    criterion.bench_function("all distances of 350 viewpoints", |bench| {
        bench.iter(|| SceneDistances::new(black_box(&graph)));
    });

    let distances = SceneDistances::new(&graph);
    let [path, trajectory] = HOPS.map(|hops| walk(&graph, &name([5, 2, 0]), hops));
    let object = ObjectId::new("lamp").expect("a plain name");
    let seen = path[path.len() - 1..].iter().cloned().collect();
    let demand = EpisodeDemand { reference: path, object: Some(object.clone()), visible_from: Some(seen) };
    let trajectory = AgentTrajectory { viewpoints: trajectory, object: Some(object) };
    criterion.bench_function("score of a trajectory of 16 viewpoints on a path of 7", |bench| {
        bench.iter(|| score_trajectory(black_box(&distances), black_box(&demand), black_box(&trajectory)));
    });
}

criterion_group!(benches, trajectories);
criterion_main!(benches);
