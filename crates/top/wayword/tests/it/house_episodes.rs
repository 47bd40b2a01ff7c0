//! Episodes in generated houses: all commands that write them lay them on the same ground.

#![cfg(feature = "habitat")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::Building;
use serde_json::Value;
use std::collections::BTreeMap;
use wayword_formats::{DatasetFormat, Episode};
use wayword_habitat::NavMeshGround;

/// The fields of an episode that depend on the ground.
const GROUND_FIELDS: [&str; 4] = ["start_position", "goals", "reference_path", "info"];

/// The ground fields of each episode in a VLN-CE file, by its text, without what has to be done to get the scene.
fn ground_fields(building: &Building, file: &str) -> BTreeMap<String, Vec<Value>> {
    let bytes = std::fs::read(building.path(file)).unwrap();
    let text = if file.ends_with(".gz") {
        std::io::read_to_string(flate2::read::GzDecoder::new(&bytes[..])).unwrap()
    } else {
        String::from_utf8(bytes).unwrap()
    };
    let mut dataset: Value = serde_json::from_str(&text).unwrap();
    let episodes = dataset["episodes"].as_array_mut().unwrap();
    let fields = episodes.iter_mut().map(|episode| {
        episode["info"].as_object_mut().unwrap().remove("scene_needs");
        let text = episode["instruction"]["instruction_text"].as_str().unwrap().to_owned();
        (text, GROUND_FIELDS.map(|field| episode[field].take()).to_vec())
    });
    fields.collect()
}

#[test]
fn every_export_of_a_house_lays_its_paths_on_the_navmesh() {
    let building = Building::new();
    let run = ["generate", "--paths", "4", "--scan", "house2-3", "--style", "r2r", "--out", "run"];
    assert_eq!(building.wayword(&run).code, Some(0));
    for command in [
        &["export", "--run", "run", "--style", "r2r", "--format", "vlnce", "--out", "run.json"][..],
        &["export", "--run", "run", "--style", "r2r", "--format", "steps", "--size-px", "32x32", "--out", "steps"],
        &["house", "--run", "run", "--style", "r2r", "--out", "houses"],
    ] {
        let ran = building.wayword(command);
        assert_eq!(ran.code, Some(0), "{ran:?}");
    }
    let exported = ground_fields(&building, "run.json");
    assert_eq!(exported.len(), 4);
    assert_eq!(ground_fields(&building, "steps/train.json.gz"), exported);
    assert_eq!(ground_fields(&building, "houses/episodes/train.json.gz"), exported);
    assert!(exported.values().all(|fields| fields[3]["geodesic_distance_over"] == "navmesh"));

    let navmesh = std::fs::read(building.path("houses/house2-3/house2-3.navmesh")).unwrap();
    let ground = NavMeshGround::new(&wayword_habitat::NavMesh::from_bytes(&navmesh).unwrap());
    let episodes: Vec<Episode> = DatasetFormat::Vlnce.read_file(&building.path("run.json")).unwrap();
    for (episode, record) in episodes.iter().zip(&building.records("run")) {
        let path = &episode.floor_positions;
        assert!(path.len() >= record.path.frames.len());
        for place in [path[0], path[path.len() - 1]] {
            let on = ground.nearest_foothold(place).unwrap().place;
            assert!(on.distance(place) < 1e-6, "{place} lies beside the navmesh, at {on}");
        }
        for hop in path.windows(2) {
            let way_m = ground.geodesic(hop[0], hop[1]).unwrap().length_m;
            assert!(way_m <= hop[0].distance(hop[1]) + 0.01, "{hop:?} is no straight walk");
        }
        let told_m = exported[&episode.instructions[0]][3]["geodesic_distance"].as_f64().unwrap();
        assert!((told_m - ground.geodesic(path[0], path[path.len() - 1]).unwrap().length_m).abs() < 1e-6);
    }
}
