//! Our figures against those of a script that was written from the official evaluators' definitions
//! (`fixtures/make_trajectories.py`), on graphs of our own.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use serde_json::Value;
use wayword_core::{DVec3, ViewpointGraph, ViewpointId};
use wayword_metrics::{SceneDistances, score_trajectory};

fn graph(of: &Value) -> ViewpointGraph {
    let mut graph = ViewpointGraph::default();
    for (id, position) in of["viewpoints"].as_object().unwrap() {
        let [x, y, z] = [0, 1, 2].map(|axis| position[axis].as_f64().unwrap());
        graph.add_viewpoint(ViewpointId::new(id).unwrap(), DVec3::new(x, y, z), None).unwrap();
    }
    for edge in of["edges"].as_array().unwrap() {
        let ends: Vec<ViewpointId> = crate::common::viewpoints(edge.as_array().unwrap());
        graph.join_viewpoints(&ends[0], &ends[1]).unwrap();
    }
    graph
}

#[test]
fn figures_are_those_of_the_official_definitions() {
    let fixture: Value = serde_json::from_str(include_str!("../../fixtures/trajectories.json")).unwrap();
    let distances: Vec<SceneDistances> =
        fixture["graphs"].as_array().unwrap().iter().map(|of| SceneDistances::new(&graph(of))).collect();
    let cases = fixture["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 240);
    for (n, case) in cases.iter().enumerate() {
        let seen = crate::common::viewpoints(case["visible_from"].as_array().unwrap());
        let on = &distances[case["graph"].as_u64().unwrap() as usize];
        let found =
            score_trajectory(on, &crate::common::demand(case, Some(seen)), &crate::common::trajectory(case)).unwrap();
        crate::common::assert_agrees(&found, &case["expected"], &format!("case {n}"));
    }
}
