//! `wayword export --format steps`: walks in single actions, with pictures.

#![cfg(feature = "habitat")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{Building, Ran};
use serde_json::{Value, json};
use std::{collections::BTreeMap, fs};
use wayword_core::{AgentAction, DVec3};
use wayword_formats::{
    DatasetFormat,
    trajectories::{
        ActionTrajectory, CameraWalk, PictureKind, PictureLocation, read_camera_walks, read_pictures, read_trajectories,
    },
    vlnce_actions::{self, EpisodeActions},
};
use wayword_report::export::replay_export;

/// A run of three walks through a house with one storey, in two styles.
fn run(building: &Building) {
    let generate = ["generate", "--paths", "3", "--scan", "house2-1", "--metres", "4..9", "--out", "run"];
    let ran = building.wayword(&generate);
    assert_eq!(ran.code, Some(0), "{ran:?}");
}

fn export(building: &Building, out: &str, more: &[&str]) -> Ran {
    let steps = ["export", "--run", "run", "--format", "steps", "--size-px", "48x48", "--out", out, "--json"];
    building.wayword(&[&steps[..], more].concat())
}

fn trajectories(building: &Building, out: &str) -> Vec<ActionTrajectory> {
    read_trajectories(&building.path(out).join("trajectories.jsonl")).unwrap()
}

/// What the usual camera saw along each walk.
fn seen(building: &Building, out: &str) -> Vec<CameraWalk> {
    read_camera_walks(&building.path(out).join("cameras/125cm_0deg/pictures.jsonl")).unwrap()
}

fn pictures(building: &Building, out: &str, walk: &CameraWalk, kind: PictureKind) -> Vec<Vec<u8>> {
    read_pictures(&building.path(out), walk.pictures(kind), kind, walk.world_from_camera.len()).unwrap()
}

/// Every file of a folder with its bytes, except its lock files.
fn files(building: &Building, out: &str) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![building.path(out)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if entry.is_dir() {
                folders.push(entry);
            } else if entry.file_name().unwrap() != "run.lock" {
                found.insert(
                    entry.strip_prefix(building.path(out)).unwrap().display().to_string(),
                    fs::read(&entry).unwrap(),
                );
            }
        }
    }
    found
}

#[test]
fn walks_end_where_they_should_and_pictures_are_those_of_their_poses() {
    let building = Building::new();
    run(&building);
    let ran = export(&building, "steps", &[]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let told = ran.json();
    assert_eq!((&told["walks"], &told["instructions"], &told["failed"]), (&json!(3), &json!(6), &json!(0)));
    let again = replay_export(&building.path("steps"), &building.path("run"), 1).unwrap();
    assert_eq!((again.walks, again.astray, again.others), (3, 0, 0));
    // Each picture has its depths.
    assert!(again.farthest_off_m <= 0.5 && json!(again.pictures / 2) == told["pictures"], "{again:?}");
    assert!(again.goals > 20 && again.goals_near == again.goals, "{again:?}");
    let ends: BTreeMap<String, DVec3> = building
        .records("run")
        .into_iter()
        .map(|record| (record.path.id, record.path.frames.last().unwrap().pose.position - DVec3::Z * 1.5))
        .collect();
    for (trajectory, walk) in trajectories(&building, "steps").into_iter().zip(seen(&building, "steps")) {
        let last = trajectory.positions.last().unwrap();
        assert!((*last - ends[&trajectory.id]).truncate().length() <= 0.5, "{last}");
        let steps = trajectory.positions.windows(2).zip(&trajectory.actions);
        for (pair, action) in steps {
            let gone_m = (pair[1] - pair[0]).truncate().length();
            let expected_m = if *action == AgentAction::Forward { 0.25 } else { 0.0 };
            assert!((gone_m - expected_m).abs() < 1e-3, "{action:?}: {gone_m}");
        }
        let styles: Vec<&str> = trajectory.instructions.iter().map(|told| told.style.as_str()).collect();
        assert_eq!(styles, ["r2r", "reverie"]);
        let parts = &trajectory.instructions[0].sub_instructions;
        assert!(parts.len() > 1 && parts[0].steps[0] == 0);
        assert!(parts.windows(2).all(|pair| pair[0].steps[0] < pair[1].steps[0]), "{parts:?}");
        let above: Vec<f64> = trajectory.above_floor_m.iter().flatten().copied().collect();
        assert!(above.len() == trajectory.actions.len() && above.iter().all(|above_m| (0.0..0.3).contains(above_m)));
        for kind in [PictureKind::Rgb, PictureKind::Depth] {
            let shown = pictures(&building, "steps", &walk, kind);
            let shown: Vec<_> = shown.iter().map(|bytes| image::load_from_memory(bytes).unwrap()).collect();
            assert!(shown.iter().all(|picture| (picture.width(), picture.height()) == (48, 48)));
            assert_eq!(shown.len(), trajectory.actions.len());
        }
    }
}

#[test]
fn vlnce_files_agree_with_the_steps() {
    let building = Building::new();
    run(&building);
    assert_eq!(export(&building, "steps", &["--split", "val_seen"]).code, Some(0));
    let episodes = DatasetFormat::Vlnce.read_file(&building.path("steps/val_seen.json.gz")).unwrap();
    let acted = vlnce_actions::read_actions(&building.path("steps/val_seen_gt.json.gz")).unwrap();
    let mut told = BTreeMap::new();
    for trajectory in trajectories(&building, "steps") {
        assert_eq!(trajectory.split, "val_seen");
        for instruction in &trajectory.instructions {
            told.insert(instruction.episode_id.clone(), instruction.text.clone());
            assert_eq!(
                acted[&instruction.episode_id],
                EpisodeActions::from_positions(&trajectory.actions, &trajectory.positions)
            );
        }
    }
    let written: BTreeMap<String, String> =
        episodes.into_iter().map(|episode| (episode.id, episode.instructions[0].clone())).collect();
    assert_eq!((written.len(), acted.len()), (6, 6));
    assert_eq!(written, told);
}

#[test]
fn an_export_that_was_stopped_goes_on_and_gives_the_same_bytes() {
    let building = Building::new();
    run(&building);
    for more in [&[][..], &["--shard", "2"]] {
        let out = if more.is_empty() { "folders" } else { "shards" };
        assert_eq!(export(&building, out, more).code, Some(0));
        let whole = files(&building, out);
        let ids: Vec<String> = trajectories(&building, out).into_iter().map(|trajectory| trajectory.id).collect();
        // As if the program had been killed while it wrote the last lines, with pictures half written.
        for name in ["trajectories.jsonl", "cameras/125cm_0deg/pictures.jsonl"] {
            let lines = fs::read_to_string(building.path(out).join(name)).unwrap();
            let first = lines.lines().next().unwrap();
            fs::write(building.path(out).join(name), format!("{first}\n{}", &first[..40])).unwrap();
        }
        for made in ["train.json.gz", "train_gt.json.gz", "train.json.gz.provenance.jsonl"] {
            fs::remove_file(building.path(out).join(made)).unwrap();
        }
        if more.is_empty() {
            let last = ids.last().unwrap();
            let images = building.path(out).join("cameras/125cm_0deg/rgb").join(last);
            fs::rename(&images, images.with_file_name(format!(".{last}.part"))).unwrap();
        }
        assert_eq!(export(&building, out, more).code, Some(0));
        assert!(files(&building, out) == whole, "{out} differs");
        let settings = export(&building, out, &[more, &["--turn-deg", "30"]].concat());
        assert!(settings.refused().contains("other settings: turn_deg"), "{settings:?}");
    }
}

#[test]
fn a_camera_that_is_added_draws_only_its_own_pictures() {
    let building = Building::new();
    run(&building);
    assert_eq!(export(&building, "steps", &[]).code, Some(0));
    let before = files(&building, "steps");
    let kept =
        building.path("steps/cameras/125cm_0deg/rgb").join(&trajectories(&building, "steps")[0].id).join("0000.jpg");
    let drawn_at = fs::metadata(&kept).unwrap().modified().unwrap();
    assert_eq!(export(&building, "steps", &["--camera", "1.25,0", "--camera", "0.6,-30"]).code, Some(0));
    let after = files(&building, "steps");
    assert!(before.iter().all(|(name, bytes)| after.get(name) == Some(bytes)));
    assert_eq!(fs::metadata(&kept).unwrap().modified().unwrap(), drawn_at);
    assert!(after.keys().any(|name| name.starts_with("cameras/60cm_30deg/depth/")));
    let again = replay_export(&building.path("steps"), &building.path("run"), 1).unwrap();
    assert_eq!((again.others, again.goals_near), (0, again.goals));
}

#[test]
fn lost_pictures_are_drawn_again_and_changed_ones_are_not_packed() {
    let building = Building::new();
    run(&building);
    assert_eq!(export(&building, "steps", &[]).code, Some(0));
    let whole = files(&building, "steps");
    let walk = building.path("steps/cameras/125cm_0deg/rgb").join(&trajectories(&building, "steps")[1].id);
    fs::remove_file(walk.join("0003.jpg")).unwrap();
    assert_eq!(export(&building, "steps", &[]).code, Some(0));
    assert!(files(&building, "steps") == whole);
    fs::write(walk.join("0003.jpg"), "no picture").unwrap();
    let pack = ["export", "--run", "run", "--steps", "steps", "--format", "streamvln", "--out", "streamvln"];
    let ran = building.wayword(&pack);
    assert!(ran.refused().contains("these pictures are not those that were written"), "{ran:?}");
    assert!(!building.path("streamvln/train").exists());
    fs::remove_dir_all(&walk).unwrap();
    assert_eq!(building.wayword(&pack).code, Some(0));
    assert!(files(&building, "steps") == whole);
}

#[test]
fn walks_do_not_move_to_another_split_beside_the_files_of_the_old_one() {
    let building = Building::new();
    run(&building);
    assert_eq!(export(&building, "steps", &[]).code, Some(0));
    let whole = files(&building, "steps");
    let ran = export(&building, "steps", &["--split", "val_seen"]);
    assert!(ran.refused().contains("in split train, and now it would be in val_seen"), "{ran:?}");
    assert!(files(&building, "steps") == whole);
    // A layout takes its own splits, and leaves those of the steps alone.
    let pack =
        ["export", "--run", "run", "--steps", "steps", "--format", "navila", "--split", "val_seen", "--out", "navila"];
    assert_eq!(building.wayword(&pack).code, Some(0));
    assert!(building.path("navila/val_seen/annotations.json").is_file() && files(&building, "steps") == whole);
}

#[test]
fn tar_shards_have_the_same_content_as_folders() {
    let building = Building::new();
    run(&building);
    assert_eq!(export(&building, "folders", &[]).code, Some(0));
    assert_eq!(export(&building, "shards", &["--shard", "2"]).code, Some(0));
    assert_eq!(trajectories(&building, "folders"), trajectories(&building, "shards"));
    for (apart, packed) in seen(&building, "folders").iter().zip(&seen(&building, "shards")) {
        assert!(matches!(packed.rgb.place, PictureLocation::Sample { .. }));
        for kind in [PictureKind::Rgb, PictureKind::Depth] {
            assert!(pictures(&building, "folders", apart, kind) == pictures(&building, "shards", packed, kind));
        }
        assert_eq!(apart.pixel_goals, packed.pixel_goals);
    }
    let shards: Vec<String> = files(&building, "shards").into_keys().filter(|name| name.ends_with(".tar")).collect();
    assert_eq!(shards, ["cameras/125cm_0deg/shards/000000.tar", "cameras/125cm_0deg/shards/000001.tar"]);
}

#[test]
fn a_walk_that_cannot_be_taken_is_an_error_of_its_own() {
    let building = Building::new();
    run(&building);
    let mut lines = building.lines("run/instructions.jsonl");
    // The second walk leads out of the house.
    let second = lines[2]["path"]["id"].clone();
    for line in lines.iter_mut().filter(|line| line["path"]["id"] == second) {
        line["path"]["frames"][1]["pose"]["position"] = json!([90.0, 90.0, 1.5]);
    }
    let text: String = lines.iter().map(|line| format!("{line}\n")).collect();
    building.write("run/instructions.jsonl", text);
    let ran = export(&building, "steps", &[]);
    assert_eq!((ran.code, &ran.json()["walks"], &ran.json()["failed"]), (Some(3), &json!(2), &json!(1)));
    let errors = building.lines("steps/errors.jsonl");
    assert_eq!((errors.len(), &errors[0]["item"], &errors[0]["failure"]), (1, &second, &json!("broken")));
    assert!(errors[0]["reason"].as_str().unwrap().starts_with("place 1 of the walk: "), "{errors:?}");
}

#[test]
fn steps_refuse_flags_that_do_not_fit() {
    let building = Building::new();
    run(&building);
    assert!(export(&building, "steps", &["--turn-deg", "50"]).refused().contains("a turn of 50 degrees"));
    let flags = ["export", "--run", "run", "--format", "r2r", "--style", "r2r", "--out", "x.json", "--fov-deg", "60"];
    assert!(
        building
            .wayword(&flags)
            .refused()
            .contains("the flags of steps are for --format steps and what is packed from it")
    );
    building.run_over_episodes("matterport");
    let ran = building.wayword(&["export", "--run", "matterport", "--format", "steps", "--out", "steps"]);
    assert!(ran.refused().contains("platform matterport has no ground on which single steps can be taken"), "{ran:?}");
    assert!(!building.path("steps").exists());
}

#[test]
fn houses_are_a_set_of_scenes_for_habitat_with_episodes_that_can_be_walked() {
    let building = Building::new();
    let ran = building.wayword(&["house", "--seed", "1", "--paths", "3", "--out", "set", "--json"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let json_of = |name: &str| serde_json::from_slice::<Value>(&fs::read(building.path(name)).unwrap()).unwrap();
    let stage = json_of("set/house2-1/house2-1.stage_config.json");
    for named in ["render_asset", "semantic_asset", "semantic_descriptor_filename", "nav_asset"] {
        let file = building.path("set/house2-1").join(stage[named].as_str().unwrap());
        assert!(file.is_file(), "{named}: {}", file.display());
    }
    assert_eq!(json_of("set/houses.scene_dataset_config.json")["stages"]["paths"][".json"], json!(["house2-*"]));
    let episodes = DatasetFormat::Vlnce.read_file(&building.path("set/episodes/train.json.gz")).unwrap();
    let acted = vlnce_actions::read_actions(&building.path("set/episodes/train_gt.json.gz")).unwrap();
    assert_eq!((episodes.len(), acted.len()), (3, 3));
    for episode in &episodes {
        let acted = &acted[&episode.id];
        let (first, last) = (episode.floor_positions[0], *episode.floor_positions.last().unwrap());
        assert!((acted.locations[0] - first).truncate().length() < 0.3);
        assert!((*acted.locations.last().unwrap() - last).truncate().length() <= 0.5);
    }
    let written = unzipped(&building.path("set/episodes/train.json.gz"));
    for episode in written["episodes"].as_array().unwrap() {
        assert!(building.path("set").join(episode["scene_id"].as_str().unwrap()).is_file());
        assert!(episode["info"].get("scene_needs").is_none(), "{episode}");
    }
    let lab = fs::read_to_string(building.path("set/vln.yaml")).unwrap();
    for told in ["# @package _global_", "/benchmark/nav/vln_r2r", "scenes_dir: .", "episodes/{split}.json.gz"] {
        assert!(lab.contains(told), "{told}: {lab}");
    }
    // The houses of a run, with its instructions.
    let again = building.wayword(&["house", "--run", "set/run", "--out", "again", "--json"]);
    assert_eq!(again.code, Some(0), "{again:?}");
    for same in ["episodes/train.json.gz", "episodes/train_gt.json.gz", "house2-1/house2-1.navmesh", "vln.yaml"] {
        let bytes = |set: &str| fs::read(building.path(set).join(same)).unwrap();
        assert!(bytes("set") == bytes("again"), "{same}");
    }
}

fn unzipped(file: &std::path::Path) -> Value {
    serde_json::from_reader(flate2::read::GzDecoder::new(fs::File::open(file).unwrap())).unwrap()
}
