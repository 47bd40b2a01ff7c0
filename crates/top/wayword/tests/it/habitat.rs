//! Habitat's scenes as a user runs them: on which island paths lie, and the way in a VLN-CE export.

#![cfg(feature = "habitat")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::Building;
use serde_json::Value;
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};
use wayword_core::{DVec3, Frame, Heading, Platform, Pose};
use wayword_formats::DatasetFormat;
use wayword_habitat::{HabitatOptions, HabitatPlatform, NavMeshSettings, bake::bake_navmesh, scene::SceneModel};
use wayword_render::Mesh;

/// A house saved as a scene of Habitat: its stage.
fn house(building: &Building) -> PathBuf {
    let saved = building.wayword(&["house", "--seed", "2", "--paths", "0", "--out", "scenes/own", "--json"]).json();
    PathBuf::from(saved["houses"][0]["stage"].as_str().unwrap())
}

fn run(building: &Building, data: &str, out: &str, more: &[&str]) -> crate::common::Ran {
    let world = ["generate", "--platform", "habitat", "--data", data, "--paths", "6", "--style", "r2r", "--out", out];
    building.wayword(&[&world[..], more].concat())
}

#[test]
fn vlnce_has_every_corner_of_the_way_and_the_distance_over_the_navmesh() {
    let building = Building::new();
    let stage = house(&building);
    assert_eq!(run(&building, "scenes", "run", &[]).code, Some(0));
    let export = ["export", "--run", "run", "--style", "r2r", "--format", "vlnce", "--out", "run.json"];
    assert_eq!(building.wayword(&export).code, Some(0));
    let options = HabitatOptions::default();
    let world =
        HabitatPlatform::open(&building.path(stage.to_str().unwrap()), options, Arc::new(|_: &str| {})).unwrap();
    let scene = world.list_scenes().unwrap().remove(0);
    let standing = |floor: DVec3| {
        let pose = Pose::looking_level(floor + DVec3::Z * 1.5, Heading::NORTH);
        Frame { pose, viewpoint: None, level: None }
    };
    let length_m = |from: DVec3, to: DVec3| {
        world.ground().ground_route(&scene, &standing(from), &standing(to)).unwrap().unwrap().length_m
    };
    let dataset: Value = serde_json::from_slice(&std::fs::read(building.path("run.json")).unwrap()).unwrap();
    let episodes = DatasetFormat::Vlnce.read_file(&building.path("run.json")).unwrap();
    let records = building.records("run");
    let mut corners = 0;
    for ((episode, written), record) in episodes.iter().zip(dataset["episodes"].as_array().unwrap()).zip(&records) {
        let path = &episode.floor_positions;
        corners += path.len() - record.path.frames.len();
        let walked_m: f64 = path.windows(2).map(|hop| hop[0].distance(hop[1])).sum();
        for hop in path.windows(2) {
            let straight_m = hop[0].distance(hop[1]);
            assert!(length_m(hop[0], hop[1]) <= straight_m + 0.01, "{hop:?} is no straight walk");
        }
        let told_m = written["info"]["geodesic_distance"].as_f64().unwrap();
        assert!((told_m - length_m(path[0], path[path.len() - 1])).abs() < 1e-6);
        // The paths are shortest ways themselves; heights of stairs and floors differ by centimetres.
        assert!((told_m - walked_m).abs() < 0.02 * told_m + 0.05, "{told_m} {walked_m}");
        assert_eq!(written["info"]["geodesic_distance_over"], "navmesh");
        assert_eq!(written["scene_id"], "own/house2-2/house2-2.stage_config.json");
        assert_eq!(episode.scene, record.path.scene);
    }
    assert!(corners > 0, "no walk has a bend between two frames");
}

#[test]
fn vlnce_is_exported_over_the_frames_where_the_scenes_are_gone() {
    let building = Building::new();
    house(&building);
    assert_eq!(run(&building, "scenes", "run", &[]).code, Some(0));
    std::fs::rename(building.path("scenes"), building.path("elsewhere")).unwrap();
    let export = ["export", "--run", "run", "--style", "r2r", "--format", "vlnce", "--out", "run.json"];
    let ran = building.wayword(&export);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let warnings: Vec<&str> = ran.err.lines().filter(|line| line.starts_with("warning: ")).collect();
    let [warning] = warnings[..] else { panic!("{ran:?}") };
    assert!(warning.contains("scenes") && warning.contains("corners and distances"), "{warning}");
    let dataset: Value = serde_json::from_slice(&std::fs::read(building.path("run.json")).unwrap()).unwrap();
    let episodes = DatasetFormat::Vlnce.read_file(&building.path("run.json")).unwrap();
    let records = building.records("run");
    for ((episode, written), record) in episodes.iter().zip(dataset["episodes"].as_array().unwrap()).zip(&records) {
        assert_eq!(written["info"]["geodesic_distance_over"], "frames");
        assert_eq!(episode.floor_positions.len(), record.path.frames.len());
        assert_eq!(episode.scene, record.path.scene);
    }
    assert_eq!(episodes.len(), records.len());
}

/// Puts a navmesh next to a scene. Its only ground is far above the rooms.
fn roof(building: &Building, stage: &Path) {
    let stage = building.path(stage.to_str().unwrap());
    let world = HabitatPlatform::open(&stage, HabitatOptions::default(), Arc::new(|_: &str| {})).unwrap();
    let graph = world.graph_for_scene(&world.list_scenes().unwrap()[0]).unwrap();
    let places = || graph.viewpoints().filter_map(|viewpoint| graph.position_of(viewpoint));
    let (low, high) = (places().reduce(DVec3::min).unwrap(), places().reduce(DVec3::max).unwrap());
    let corner = |x: f64, y: f64| DVec3::new(x, y, 40.0).as_vec3();
    let positions = vec![corner(low.x, low.y), corner(high.x, low.y), corner(high.x, high.y), corner(low.x, high.y)];
    let sheet = Mesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() };
    let mesh = bake_navmesh(&SceneModel { meshes: vec![sheet], ..SceneModel::default() }, &NavMeshSettings::default())
        .unwrap();
    std::fs::write(stage.with_file_name("house2-2.navmesh"), mesh.to_bytes()).unwrap();
}

#[test]
fn islands_are_listed_and_one_can_be_named() {
    let building = Building::new();
    let stage = house(&building);
    let stage = stage.to_str().unwrap();
    let map = ["view", "map", "--platform", "habitat", "--data", stage, "--out", "map.svg"];
    let ran = building.wayword(&[&map[..], &["--json"]].concat());
    let walked: Vec<Value> = ran.json()["islands"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|island| island["is_walked"] == true)
        .cloned()
        .collect();
    assert_eq!((walked.len(), &walked[0]["cover"]), (1, &"ceiling".into()), "{ran:?}");
    assert!(building.wayword(&map).out.contains("under a ceiling, used for random paths"));
    let ran = run(&building, stage, "run", &["--island", "99"]);
    assert!(ran.refused().contains("has no island 99: island 0: ") && ran.err.contains("--island"), "{ran:?}");
    let ran = building.wayword(&["generate", "--paths", "1", "--island", "0", "--out", "run"]);
    assert!(ran.refused().contains("platform house, the default, takes no --island"), "{ran:?}");
}

#[test]
fn scene_without_walkable_ground_is_refused_with_its_islands() {
    let building = Building::new();
    let stage = house(&building);
    roof(&building, &stage);
    let ran = run(&building, stage.to_str().unwrap(), "run", &[]);
    assert!(ran.refused().contains("no island of its navmesh is a place to walk on"), "{ran:?}");
    assert!(ran.err.contains("island 0: ") && ran.err.contains("on top of a roof"), "{ran:?}");
    assert!(!building.path("run").exists());
}
