//! Our figures against another evaluator's on real buildings, where both are available: `WAYWORD_DATA` names the folder
//! of the data (default: `../shared/data`, next to the repository), and `WAYWORD_PARITY` a file of JSON lines,
//! each with `scan`, `reference`, `object`, `trajectory`, `named` and the `expected` figures, named and nested as in
//! `TrajectoryScore`.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and says what it skipped or measured"
)]

use serde_json::Value;
use std::{
    collections::BTreeMap,
    path::PathBuf,
    sync::Arc,
    time::{Duration, Instant},
};
use wayword_core::{Platform, SceneId};
use wayword_metrics::{
    AgentTrajectory, DistanceAtlas, EpisodeDemand, SceneDistances, TrajectoryScore, score_trajectory,
};
use wayword_platforms::MatterportPlatform;

/// How often the figures are timed. A single measurement is unreliable while other programs run.
const PASSES: usize = 9;

fn platform() -> Option<MatterportPlatform> {
    let beside = || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../../shared/data"));
    let folder = std::env::var_os("WAYWORD_DATA").map_or_else(beside, PathBuf::from);
    let there = folder.join("matterport/connectivity").is_dir();
    if !there {
        println!("SKIPPED: no Matterport3D data in {}; set WAYWORD_DATA to its folder", folder.display());
    }
    there.then(|| MatterportPlatform::open(&folder).unwrap())
}

fn cases() -> Option<Vec<Value>> {
    let Some(file) = std::env::var_os("WAYWORD_PARITY") else {
        println!("SKIPPED: set WAYWORD_PARITY to a file of trajectories with the figures of another evaluator");
        return None;
    };
    let text = std::fs::read_to_string(file).unwrap();
    Some(text.lines().map(|line| serde_json::from_str(line).unwrap()).collect())
}

#[test]
fn an_atlas_knows_every_building_and_computes_it_once() {
    let Some(platform) = platform() else { return };
    let atlas = DistanceAtlas::new(&platform);
    let scenes = platform.list_scenes().unwrap();
    // The platform reads the graphs here and keeps them, so that the times below are without that.
    let graphs: Vec<_> = scenes.iter().map(|scene| platform.graph_for_scene(scene).unwrap()).collect();
    let timed = |of: &dyn Fn() -> Vec<Arc<SceneDistances>>| {
        let before = Instant::now();
        (of(), before.elapsed())
    };
    let all = || scenes.iter().map(|scene| atlas.scene_distances(scene).unwrap()).collect();
    let (first, computed) = timed(&all);
    let (again, found) = timed(&all);
    assert!(first.iter().zip(&again).all(|(first, again)| Arc::ptr_eq(first, again)));
    for (graph, distances) in graphs.iter().zip(&first) {
        assert!(graph.viewpoints().all(|viewpoint| distances.has_viewpoint(viewpoint)));
        assert!(graph.edges().all(|(a, b, length_m)| distances.metres_between(a, b).unwrap() <= length_m));
    }
    println!("all distances of {} buildings: {computed:?} on one core, found again in {found:?}", scenes.len());
}

#[test]
fn figures_are_those_of_another_evaluator() {
    let (Some(platform), Some(cases)) = (platform(), cases()) else { return };
    let atlas = DistanceAtlas::new(&platform);
    let mut seen = BTreeMap::new();
    let mut all: Vec<(Arc<SceneDistances>, EpisodeDemand, AgentTrajectory)> = Vec::new();
    for case in &cases {
        let scene = SceneId::new(case["scan"].as_str().unwrap()).unwrap();
        let object = crate::common::object(&case["object"]).unwrap();
        let visible_from = seen
            .entry((scene.clone(), object.clone()))
            .or_insert_with(|| platform.catalogue().visible_from(&scene, &object).unwrap().unwrap());
        let demand = crate::common::demand(case, Some(visible_from.clone()));
        all.push((atlas.scene_distances(&scene).unwrap(), demand, crate::common::trajectory(case)));
    }
    let pass = || -> (Vec<TrajectoryScore>, Duration) {
        let before = Instant::now();
        let scores =
            all.iter().map(|(on, demand, trajectory)| score_trajectory(on, demand, trajectory).unwrap()).collect();
        (scores, before.elapsed())
    };
    let fastest = (0..PASSES).map(|_| pass().1).min().unwrap();
    let (scores, _) = pass();
    for (n, (score, case)) in scores.iter().zip(&cases).enumerate() {
        crate::common::assert_agrees(score, &case["expected"], &format!("line {}", n + 1));
    }
    println!("{} trajectories agree; their figures alone took {fastest:?} on one core", cases.len());
}
