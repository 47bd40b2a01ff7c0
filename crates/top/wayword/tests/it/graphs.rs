//! A folder of scans with viewpoint graphs in Matterport's format, as HM3D and Gibson come with ScaleVLN's graphs: one
//! command uses every scene that can be used, and names the others.

#![cfg(feature = "habitat")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{
    Building,
    scans::{connectivity, flats, graph_of, included, write_scan},
};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use wayword_core::{DVec3, SceneId};
use wayword_formats::OfficialSplit;

/// Name of the scene that is numbered as HM3D's are.
const NUMBERED: &str = "00800-AbCdEfGhIjK";

/// Writes the first `count` flats to `scenes` and their graphs to `graphs`. The first one is numbered. Returns their names.
fn write(building: &Building, count: usize) -> Vec<String> {
    std::fs::create_dir_all(building.path("graphs")).unwrap();
    let mut names = Vec::new();
    for (number, house) in flats().take(count).enumerate() {
        let name = format!("flat{number:02}");
        let (name, stem, ending) = match number {
            0 => (NUMBERED, "AbCdEfGhIjK", ".basis.glb"),
            _ => (name.as_str(), name.as_str(), ".glb"),
        };
        write_scan(&house, &building.path(&format!("scenes/{name}")), stem, ending);
        write_graph(building, name, &connectivity(&graph_of(&house), |place| place));
        names.push(name.to_owned());
    }
    names
}

fn write_graph(building: &Building, name: &str, graph: &Value) {
    building.write(&format!("graphs/{name}_connectivity.json"), graph.to_string());
}

/// Cuts the GLB of one scene short, turns the graph of another to y up, and takes the graph of a third away.
fn spoil(building: &Building, [cut, turned, bare]: [usize; 3]) {
    let stage = building.path(&format!("scenes/flat{cut:02}/flat{cut:02}.glb"));
    let whole = std::fs::read(&stage).unwrap();
    std::fs::write(&stage, &whole[..whole.len() / 2]).unwrap();
    let y_up = |place: DVec3| DVec3::new(place.x, place.z, -place.y);
    let graph = connectivity(&graph_of(&flats().nth(turned).unwrap()), y_up);
    write_graph(building, &format!("flat{turned:02}"), &graph);
    std::fs::remove_file(building.path(&format!("graphs/flat{bare:02}_connectivity.json"))).unwrap();
}

const WORLD: [&str; 6] = ["--platform", "habitat", "--data", "scenes", "--connectivity", "graphs"];

fn generate(building: &Building, more: &[&str]) -> crate::common::Ran {
    let usual =
        ["--style", "r2r", "--no-route", "--candidates", "1", "--metres", "2..9", "--hops", "1..2", "--out", "run"];
    building.wayword(&[&["generate"], &WORLD[..], &usual, more].concat())
}

#[test]
fn of_twenty_scenes_seventeen_are_used_and_three_are_named_with_the_reason() {
    let building = Building::new();
    let names = write(&building, 20);
    spoil(&building, [7, 12, 19]);
    let ran = generate(&building, &["--paths", "17", "--json"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let summary = ran.json();
    assert_eq!((&summary["items"], &summary["errors"]), (&json!(17), &json!(0)), "{ran:?}");
    let records = building.records("run");
    let used: BTreeSet<&str> = records.iter().map(|record| record.path.scene.as_str()).collect();
    let spoilt = ["flat07", "flat12", "flat19"];
    assert_eq!(used, names.iter().map(String::as_str).filter(|name| !spoilt.contains(name)).collect());
    assert!(records.iter().all(|record| record.path.frames.iter().all(|frame| frame.viewpoint.is_some())));

    let left_out = summary["left_out"].as_object().unwrap();
    assert_eq!(left_out.keys().map(String::as_str).collect::<Vec<_>>(), spoilt);
    for (scene, what, hint) in [
        ("flat07", "flat07.glb: ", "export the scene again"),
        (
            "flat12",
            "flat12_connectivity.json: the viewpoints of this graph have y up, as in Habitat: ",
            "pose[7] becomes -pose[11]",
        ),
        ("flat19", "flat19.glb: there is no viewpoint graph for it in graphs", "put flat19_connectivity.json there"),
    ] {
        let told = (left_out[scene]["what"].as_str().unwrap(), left_out[scene]["hint"].as_str().unwrap());
        assert!(told.0.contains(what) && told.1.contains(hint), "{told:?}");
        let lines = ran.err.lines().filter(|line| line.starts_with(&format!("left out: scene {scene}: ")));
        assert_eq!(lines.count(), 1, "{ran:?}");
    }
    assert!(ran.err.contains("17 of 20 scenes are used"), "{ran:?}");

    // A run goes on with the scenes that it began with, and does not examine them again.
    std::fs::rename(building.path("graphs/flat12_connectivity.json"), building.path("graphs/flat19_connectivity.json"))
        .unwrap();
    let ran = generate(&building, &["--paths", "18"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(!ran.err.contains("left out: "), "{ran:?}");
    assert!(ran.out.contains("left out: 3 scenes (flat07, flat12, flat19)"), "{ran:?}");
    assert_eq!(building.records("run").len(), 18);
}

#[test]
fn doctor_lists_what_each_scene_has_and_lacks() {
    let building = Building::new();
    write(&building, 5);
    spoil(&building, [1, 2, 3]);
    std::fs::remove_file(building.path("scenes/flat04/flat04.semantic.txt")).unwrap();
    write_graph(&building, "00801-Elsewhere12", &json!([]));
    let doctor = [&["doctor"], &WORLD[..], &["--scenes"]].concat();
    let ran = building.wayword(&[&doctor[..], &["--json"]].concat());
    assert_eq!(ran.code, Some(1), "{ran:?}");
    let report = ran.json();
    let scenes = report["scenes"].as_array().unwrap();
    let bad: Vec<&str> = scenes
        .iter()
        .filter(|scene| !scene["unusable"].is_null())
        .map(|scene| scene["scene"].as_str().unwrap())
        .collect();
    assert_eq!((scenes.len(), &bad[..]), (5, &["flat01", "flat02", "flat03"][..]));
    let first = &scenes[0];
    assert_eq!(first["scene"], NUMBERED);
    assert_eq!(
        (&first["has_pictures"], &first["has_labels"], &first["rooms"]),
        (&json!(true), &json!(true), &json!("rules"))
    );
    let (graph, fit) = (&first["graph"], &first["fit"]);
    assert!(graph["viewpoints"] == 8 && fit["viewpoints"] == graph["viewpoints"], "{first}");
    assert!(fit["edges"] == graph["edges"] && first["storeys"] == 1, "{first}");
    let text = building.wayword(&doctor).out;
    assert!(text.contains("ok       scene 00800-AbCdEfGhIjK: pictures, a graph of "), "{text}");
    assert!(text.contains("storey, labels, rooms by rules, ") && text.contains(" edges cross a wall"), "{text}");
    assert!(text.contains("warning  scene flat04: no labels and no rooms"), "{text}");
    let idle = building.wayword(&doctor).err;
    assert!(idle.contains("1 of the graphs have no scene below --data: 00801-Elsewhere12"), "{idle}");
    assert!(text.contains("ok       scenes: 2 of 5 scenes can be used"), "{text}");
    assert!(text.contains("platform habitat: "), "{text}");
    let over_navmeshes = building.wayword(&["doctor", "--platform", "habitat", "--data", "scenes", "--scenes"]);
    assert!(
        over_navmeshes.out.contains("warning  scene flat02: no navmesh beside it, so one is baked"),
        "{over_navmeshes:?}"
    );
    assert!(over_navmeshes.out.contains("ok       scenes: 4 of 5 scenes can be used"), "{over_navmeshes:?}");
    let other = building.wayword(&["doctor", "--scenes"]);
    assert!(other.out.contains("the scenes of platform house cannot be examined"), "{other:?}");
}

#[test]
fn episodes_over_the_graphs_are_taken_under_either_name_of_a_scene() {
    let building = Building::new();
    write(&building, 2);
    let graph = graph_of(&flats().next().unwrap());
    let included = included(&graph);
    let way = graph.shortest_path(included[0], included[included.len() - 1]).unwrap().unwrap().viewpoints;
    let episode = |path_id: u32, scan: &str| json!({ "path_id": path_id, "scan": scan, "path": way, "heading": 1.0, "distance": 5.0, "instructions": ["Go."] });
    let episodes = json!([episode(1, NUMBERED), episode(2, "AbCdEfGhIjK"), episode(3, "flat01"), episode(4, "flat09")]);
    building.write("r2r.json", episodes.to_string());
    let ran = building.wayword(
        &[&["generate"], &WORLD[..], &["--episodes", "r2r.json", "--style", "r2r", "--out", "run", "--json"]].concat(),
    );
    assert_eq!(ran.code, Some(3), "{ran:?}");
    let scenes: Vec<String> = building.records("run").iter().map(|record| record.path.scene.to_string()).collect();
    // The scene has one name everywhere, so that it comes into one split.
    assert_eq!(scenes[..2], [NUMBERED, NUMBERED]);
    let numbered = SceneId::new(NUMBERED).unwrap();
    assert_eq!(OfficialSplit::for_scene(&numbered), Some(OfficialSplit::Val), "the number says which split it is in");
    assert!(ran.err.contains("left out: scene flat09: there is no scene flat09"), "{ran:?}");
    // The scene of the fourth is unknown, and the way of the third is not one of its scene, except by chance.
    assert!(ran.json()["errors"].as_u64().unwrap() >= 1, "{ran:?}");
}

#[test]
fn walks_along_graphs_are_exported_in_single_steps() {
    let building = Building::new();
    write(&building, 1);
    assert_eq!(generate(&building, &["--paths", "2"]).code, Some(0));
    let export = ["export", "--run", "run", "--format", "steps", "--size-px", "32x32", "--out", "steps", "--json"];
    let ran = building.wayword(&export);
    let told = ran.json();
    let (walks, failed) = (told["walks"].as_u64().unwrap(), told["failed"].as_u64().unwrap());
    assert_eq!((walks + failed, walks > 0), (2, true), "{ran:?}");
    assert!(told["farthest_off_m"].as_f64().unwrap() <= 0.5, "{ran:?}");
    let taken = wayword_formats::trajectories::read_trajectories(&building.path("steps/trajectories.jsonl")).unwrap();
    let seen = building.path("steps/cameras/125cm_0deg/pictures.jsonl");
    let seen = wayword_formats::trajectories::read_camera_walks(&seen).unwrap();
    assert_eq!(seen[0].world_from_camera.len(), taken[0].actions.len());
}

#[test]
fn run_is_refused_if_no_scene_can_be_used() {
    let building = Building::new();
    write(&building, 4);
    spoil(&building, [1, 2, 3]);
    let ran = generate(&building, &["--paths", "3", "--scan", "flat02"]);
    assert!(ran.refused().contains("no scene can be used: graphs/flat02_connectivity.json: the viewpoints"), "{ran:?}");
    assert!(ran.err.contains("hint: write each pose again, z up") && !building.path("run").exists(), "{ran:?}");
    let ran = generate(&building, &["--paths", "3", "--scan", "flat01", "--scan", "AbCdEfGhIjK"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(ran.err.contains("1 of 2 scenes are used"), "{ran:?}");
    assert!(building.records("run").iter().all(|record| record.path.scene.as_str() == NUMBERED));
    let both = generate(&building, &["--paths", "3", "--island", "1"]);
    assert!(both.refused().contains("--island and --connectivity cannot be combined"), "{both:?}");
    let house = building.wayword(&["generate", "--paths", "1", "--connectivity", "graphs", "--out", "other"]);
    assert!(house.refused().contains("platform house, the default, takes no --connectivity"), "{house:?}");
}
