//! Scenes that lie in their files in another way than Habitat's do, and files with a fault, as a user meets them.

#![cfg(feature = "habitat")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{Building, Ran};
use std::path::{Path, PathBuf};

/// A house saved as a scene of Habitat: its stage. Its file has y up.
fn house(building: &Building) -> PathBuf {
    let saved = building.wayword(&["house", "--seed", "2", "--paths", "0", "--out", "scenes/own", "--json"]).json();
    building.path(saved["houses"][0]["stage"].as_str().unwrap())
}

fn generate(building: &Building, out: &str) -> Ran {
    let world = ["generate", "--platform", "habitat", "--data", "scenes", "--paths", "2", "--style", "r2r"];
    building.wayword(&[&world[..], &["--out", out]].concat())
}

fn doctor(building: &Building) -> Ran {
    building.wayword(&["doctor", "--platform", "habitat", "--data", "scenes", "--scenes"])
}

/// The scene without its navmesh, and with this configuration.
fn configure(stage: &Path, config: Option<&str>) {
    let name = stage.file_name().unwrap().to_str().unwrap().replace(".stage_config.json", "");
    let navmesh = stage.with_file_name(format!("{name}.navmesh"));
    if navmesh.exists() {
        std::fs::remove_file(navmesh).unwrap();
    }
    match config {
        Some(text) => std::fs::write(stage, text).unwrap(),
        None => std::fs::remove_file(stage).unwrap(),
    }
}

#[test]
fn a_scene_with_y_up_is_walked_upright_and_the_run_prints_the_configuration_to_write() {
    let building = Building::new();
    let stage = house(&building);
    configure(&stage, None);
    let ran = generate(&building, "run");
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let told: Vec<&str> = ran.err.lines().filter(|line| line.contains("is read with up = [0, 1, 0]")).collect();
    let [told] = told[..] else { panic!("{ran:?}") };
    let eyes_m = building.records("run").into_iter().flat_map(|record| record.path.frames);
    assert!(eyes_m.into_iter().all(|frame| (1.0..8.0).contains(&frame.pose.position.z)));
    assert!(doctor(&building).out.contains("is read with up = [0, 1, 0]"));
    configure(&stage, Some(&told[told.find('{').unwrap()..=told.rfind('}').unwrap()]));
    let ran = generate(&building, "told");
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(!ran.err.contains("is read with"), "{ran:?}");
    assert_eq!(building.records("run")[0].path.frames, building.records("told")[0].path.frames);
}

#[test]
fn a_scene_that_is_too_small_to_walk_in_is_refused_with_its_size_before_a_run_and_in_it() {
    let building = Building::new();
    let stage = house(&building);
    let asset = stage.file_name().unwrap().to_str().unwrap().replace(".stage_config.json", ".glb");
    let axes = r#""up": [0, 1, 0], "front": [0, 0, -1]"#;
    configure(&stage, Some(&format!(r#"{{"render_asset": "{asset}", {axes}, "units_to_meters": 0.01}}"#)));
    let (examined, ran) = (doctor(&building), generate(&building, "run"));
    assert_eq!((examined.code, ran.code), (Some(1), Some(1)), "{examined:?} {ran:?}");
    for told in [examined.out, ran.err] {
        assert!(told.contains("m large, too small to walk in") && told.contains("units_to_meters"), "{told}");
    }
}

#[test]
fn one_bad_line_of_hm3ds_annotations_leaves_out_its_object_and_nothing_else() {
    let building = Building::new();
    let stage = house(&building);
    let annotations = PathBuf::from(stage.to_str().unwrap().replace(".stage_config.json", ".semantic.txt"));
    let whole = std::fs::read_to_string(&annotations).unwrap();
    let spoilt: Vec<String> = whole
        .lines()
        .enumerate()
        .map(|(number, line)| match (number, line.split_once(',')) {
            (20, Some((id, rest))) => format!("{id},{}", &rest[1..]),
            _ => line.to_owned(),
        })
        .collect();
    std::fs::write(&annotations, spoilt.join("\n")).unwrap();
    let ran = generate(&building, "run");
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let told: Vec<&str> = ran.err.lines().filter(|line| line.contains(".semantic.txt")).collect();
    let [told] = told[..] else { panic!("{ran:?}") };
    assert!(told.contains("line 21: ") && told.contains("is not a 6-digit hex colour"), "{told}");
    assert!(doctor(&building).out.contains("line 21: "));
    std::fs::write(&annotations, whole.replace('\n', "\nx")).unwrap();
    let ran = generate(&building, "refused");
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(ran.err.contains("line 2: ") && !ran.err.contains("download"), "{ran:?}");
}
