//! `wayword export` as a user runs it: every format, read back, has the texts and paths of the run.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::{Building, EPISODES, files};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::{DVec3, Frame, Heading, Path, PathMotion, Pose, ViewpointId};
use wayword_formats::{DatasetFormat, jsonl, jsonl::DatasetSplit};
use wayword_testkit::{SCAN, viewpoint_id};

fn export(building: &Building, format: &str, out: &str) -> Value {
    let ran =
        building.wayword(&["export", "--run", "run", "--style", "reverie", "--format", format, "--out", out, "--json"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    ran.json()
}

fn viewpoints(path: &Path) -> Vec<ViewpointId> {
    path.frames.iter().map(|frame| frame.viewpoint.clone().unwrap()).collect()
}

#[test]
fn each_format_is_read_back_with_the_same_texts_and_paths() {
    let building = Building::new();
    let mut records = building.run_over_episodes("run");
    records.retain(|record| record.instruction.style == "reverie");
    for format in DatasetFormat::ALL.into_iter().filter(|format| !format.holds_recordings()) {
        let out = format!("out.{format}.json");
        let written = export(&building, format.name(), &out);
        assert_eq!(written["instructions"], 10, "{written}");
        let episodes = format.read_file(&building.path(&out)).unwrap();
        assert_eq!(wayword_formats::detect_format(&building.path(&out)).unwrap(), format);
        assert_eq!(episodes.len(), records.len());
        for (episode, record) in episodes.iter().zip(&records) {
            let path = &record.path;
            assert_eq!((&episode.scene, &episode.instructions), (&path.scene, &vec![record.instruction.text.clone()]));
            let start: Heading = path.frames[0].pose.heading;
            assert!(start.turn_to(episode.start_heading.unwrap()).abs() < 1e-6, "{format}");
            if format == DatasetFormat::Vlnce {
                let off = |(floor, frame): (&wayword_core::DVec3, &wayword_core::Frame)| {
                    floor.truncate().distance(frame.pose.position.truncate())
                };
                assert_eq!(episode.floor_positions.len(), path.frames.len());
                assert!(episode.floor_positions.iter().zip(&path.frames).map(off).all(|off_m| off_m < 1e-6));
            } else {
                assert_eq!(episode.viewpoints, viewpoints(path), "{format}");
            }
            if matches!(format, DatasetFormat::Reverie | DatasetFormat::Wayword) {
                assert_eq!(episode.target_object.as_ref(), path.target.as_ref().map(|target| &target.object));
            }
        }
    }
}

#[test]
fn provenance_is_in_the_file_or_next_to_it() {
    let building = Building::new();
    building.run_over_episodes("run");
    for format in ["reverie", "rxr"] {
        let out = format!("within.{format}");
        assert!(export(&building, format, &out).get("provenance").is_none());
        let episodes = wayword_formats::read_any_format(&building.path(&out)).unwrap();
        assert!(
            episodes.iter().all(|episode| episode.extra["wayword"][0]["provenance"]["answerer"] == "labels"),
            "{format}"
        );
        assert!(episodes.iter().all(|episode| episode.extra["wayword"][0]["verdict"] == "pass"), "{format}");
    }
    for format in ["r2r", "vlnce"] {
        let out = format!("beside.{format}");
        let beside = export(&building, format, &out)["provenance"].as_str().unwrap().to_owned();
        let lines = building.lines(&beside);
        let texts: BTreeSet<String> = lines.iter().map(|line| line["text"].as_str().unwrap().to_owned()).collect();
        let episodes = wayword_formats::read_any_format(&building.path(&out)).unwrap();
        assert_eq!(texts, episodes.into_iter().flat_map(|episode| episode.instructions).collect(), "{format}");
        assert!(lines.iter().all(|line| line["wayword"]["provenance"]["writer"] == "rules"), "{format}");
    }
}

#[test]
fn what_is_exported_as_reverie_keeps_the_ids_of_its_episodes() {
    let building = Building::new();
    building.run_over_episodes("run");
    export(&building, "reverie", "out.json");
    let ids = |file: &str| -> Vec<(String, String)> {
        let episodes = DatasetFormat::Reverie.read_file(&building.path(file)).unwrap();
        episodes.into_iter().map(|episode| (episode.id, episode.path_id)).collect()
    };
    assert_eq!(ids("out.json"), ids(crate::common::EPISODES));
}

/// Two short paths through houses, in two scenes, with pictures.
fn houses(building: &Building) {
    for (out, scene) in [("a", "house2-3"), ("b", "house2-4")] {
        let arguments = ["generate", "--paths", "1", "--metres", "5..7", "--scan", scene, "--seed"];
        let ran = building.wayword(&[&arguments[..], &[&scene[7..], "--out", out]].concat());
        assert_eq!(ran.code, Some(0), "{ran:?}");
    }
}

#[test]
fn runs_merge_and_no_scene_is_in_both_splits() {
    let building = Building::new();
    building.run_over_episodes("run");
    houses(&building);
    let merge = |out: &str, seed: &str| {
        let arguments = ["export", "--run", "run", "--run", "a", "--run", "b", "--format", "wayword"];
        let more = ["--val-share", "0.5", "--seed", seed, "--out", out];
        let ran = building.wayword(&[&arguments[..], &more[..]].concat());
        assert_eq!(ran.code, Some(0), "{ran:?}");
        jsonl::read_records(&building.path(out)).unwrap()
    };
    let merged = merge("merged.jsonl", "0");
    assert_eq!(merged.len(), 20 + 2 + 2);
    let mut splits: BTreeMap<(&str, &str), BTreeSet<DatasetSplit>> = BTreeMap::new();
    for record in &merged {
        let scene = (record.platform.as_str(), record.path.scene.as_str());
        splits.entry(scene).or_default().insert(record.split.unwrap());
    }
    assert_eq!(splits.len(), 3);
    assert!(splits.values().all(|of_scene| of_scene.len() == 1), "{splits:?}");
    let of_houses: BTreeSet<&DatasetSplit> =
        splits.iter().filter(|((platform, _), _)| *platform == "house").flat_map(|(_, split)| split).collect();
    assert_eq!(of_houses.len(), 2, "each split has a house: {splits:?}");
    assert!(merge("again.jsonl", "0") == merged);
    let val_of = |seed: u64| {
        let merged = merge("seeded.jsonl", &seed.to_string());
        merged
            .into_iter()
            .find(|record| record.split == Some(DatasetSplit::Val) && record.platform == "house")
            .unwrap()
            .path
            .scene
    };
    assert!((1..8).map(val_of).collect::<BTreeSet<_>>().len() == 2, "the seed decides");
}

#[test]
fn vlnce_numbers_the_texts_of_one_path() {
    let building = Building::new();
    let ran = building.generate("run", &["--episodes", EPISODES, "--style", "r2r", "--per-path", "2"]);
    assert!([Some(0), Some(3)].contains(&ran.code), "{ran:?}");
    let ran = building.wayword(&["export", "--run", "run", "--format", "vlnce", "--out", "two.json"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let file: Value = serde_json::from_slice(&std::fs::read(building.path("two.json")).unwrap()).unwrap();
    let ids: Vec<&str> =
        file["episodes"].as_array().unwrap().iter().map(|e| e["episode_id"].as_str().unwrap()).collect();
    let both = |id: &&&str| id.strip_suffix("_0").is_some_and(|name| ids.contains(&format!("{name}_1").as_str()));
    assert!(ids.len() > 2 && ids.iter().filter(both).count() > 0, "{ids:?}");
}

#[test]
fn vlnce_names_the_command_that_gives_habitat_a_generated_house() {
    let building = Building::new();
    let run = ["generate", "--paths", "4", "--scan", "house2-3", "--style", "r2r", "--out", "a"];
    assert_eq!(building.wayword(&run).code, Some(0));
    let arguments = ["export", "--run", "a", "--style", "r2r", "--format", "vlnce", "--out", "a.json", "--json"];
    let ran = building.wayword(&arguments);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let needs = "save the house: wayword house --seed 3 --paths 0 --out SCENES/house";
    assert!(ran.err.contains(needs) && ran.err.contains("scenes_dir"), "{ran:?}");
    assert_eq!(ran.json()["scene_needs"], serde_json::json!([needs]));
    let dataset: Value = serde_json::from_slice(&std::fs::read(building.path("a.json")).unwrap()).unwrap();
    let episode = &dataset["episodes"][0];
    assert_eq!(
        (&episode["scene_id"], &episode["info"]["scene_needs"]),
        (&"house/house2-3/house2-3.glb".into(), &needs.into())
    );
    let has_navmesh = cfg!(feature = "habitat");
    assert_eq!(episode["info"]["geodesic_distance_over"], if has_navmesh { "navmesh" } else { "frames" });
    let houses = wayword_run::platforms::open_named("house", None, None, None).unwrap();
    let (episodes, records) =
        (DatasetFormat::Vlnce.read_file(&building.path("a.json")).unwrap(), building.records("a"));
    let standing = |floor: DVec3| Frame {
        pose: Pose::looking_level(floor + DVec3::Z * 1.5, Heading::NORTH),
        viewpoint: None,
        level: None,
    };
    let mut corners = 0;
    for (episode, record) in episodes.iter().zip(&records) {
        corners += episode.floor_positions.len() - record.path.frames.len();
        // `house_episodes.rs` holds hops over the navmesh against it.
        for hop in episode.floor_positions.windows(2).filter(|_| !has_navmesh) {
            let way = houses
                .ground()
                .ground_route(&record.path.scene, &standing(hop[0]), &standing(hop[1]))
                .unwrap()
                .unwrap();
            assert!(way.length_m <= hop[0].distance(hop[1]) + 0.08, "{hop:?} is no straight walk");
        }
    }
    assert!(corners > 0, "no path has a corner between two frames");
    // The command that `scene_needs` names writes the file to this place.
    assert_eq!(building.wayword(&["house", "--seed", "3", "--paths", "0", "--out", "SCENES/house"]).code, Some(0));
    assert!(building.path("SCENES").join(episode["scene_id"].as_str().unwrap()).is_file());
}

#[test]
fn vlnce_names_the_ground_of_distances_and_the_gaps_of_a_recording() {
    let building = Building::new();
    let mut records = building.run_over_episodes("run");
    let export = |out: &str| {
        let ran = building.wayword(&["export", "--run", "run", "--style", "r2r", "--format", "vlnce", "--out", out]);
        assert_eq!(ran.code, Some(0), "{ran:?}");
        let dataset: Value = serde_json::from_slice(&std::fs::read(building.path(out)).unwrap()).unwrap();
        (ran.err, dataset["episodes"][0].clone())
    };
    let (said, episode) = export("matterport.json");
    assert!(!said.contains("scenes_dir"), "{said}");
    assert_eq!(episode["info"]["geodesic_distance_over"], "graph");
    let scan = records[0].path.scene.clone();
    assert_eq!(episode["scene_id"], format!("mp3d/{scan}/{scan}.glb"));
    for record in &mut records {
        record.platform = "recording".to_owned();
    }
    jsonl::write_records(&building.path("run/instructions.jsonl"), &records).unwrap();
    let (said, episode) = export("recording.json");
    assert_eq!(episode["scene_id"], format!("recording/{scan}/{scan}.glb"));
    let needs = episode["info"]["scene_needs"].as_str().unwrap();
    assert!(needs.contains("put your own scene at SCENES/recording/") && said.contains(needs), "{needs}: {said}");
}

#[test]
fn bad_combinations_are_refused_with_what_to_do() {
    let building = Building::new();
    building.run_over_episodes("run");
    let before = files(&building.path("."));
    let cases: [(&[&str], &str, &str); 11] = [
        (&["--run", "run", "--format", "reverie"], "texts of one style only", "--style"),
        (
            &["--run", "run", "--run", "run", "--style", "r2r", "--format", "r2r"],
            "takes one run only",
            "--format wayword",
        ),
        (&["--run", "run", "--style", "r2r", "--format", "r2r", "--val-share", "0.1"], "no splits", "--format wayword"),
        (&["--run", "run", "--format", "wayword", "--val-share", "1.5"], "is not a share", "from 0 to 1"),
        (&["--run", "run", "--format", "wayword", "--val-share", "nan"], "is not a share", "from 0 to 1"),
        (&["--run", "run", "--format", "wayword", "--split", "val"], "have a split only with", "--val-share"),
        (&["--run", "run", "--style", "r2r", "--format", "r2r", "--tokenizer", "x"], "--format duet", "leave them out"),
        (
            &["--run", "run", "--style", "r2r", "--format", "r2r", "--split", "a/b"],
            "\"a/b\" is not the name",
            "letters",
        ),
        (&["--run", "run", "--style", "r2r", "--format", "duet"], "--tokenizer is missing", "models fetch --tokenizer"),
        (&["--run", "run", "--style", "poem", "--format", "r2r"], "no instruction of style poem", "r2r, reverie"),
        (
            &["--run", "nowhere", "--style", "r2r", "--format", "r2r"],
            "--run nowhere: there is no such folder",
            "--out folder",
        ),
    ];
    for (arguments, problem, hint) in cases {
        let ran = building.wayword(&[&["export", "--out", "out"], arguments].concat());
        let error = ran.refused();
        assert!(error.contains(problem) && error.contains(hint), "{arguments:?}: {error}");
        assert!(files(&building.path(".")) == before, "{arguments:?} left something behind");
    }
}

/// The run's scene gets a name that is officially held out.
fn rename_scene(building: &Building, name: &str) {
    let file = building.path("run/instructions.jsonl");
    let renamed = std::fs::read_to_string(&file).unwrap().replace(SCAN, name);
    std::fs::write(file, renamed).unwrap();
}

#[test]
fn a_scene_that_is_held_out_does_not_slip_into_another_split() {
    let building = Building::new();
    building.run_over_episodes("run");
    let export = |more: &[&str]| {
        building.wayword(&[&["export", "--run", "run", "--style", "r2r", "--out", "out.json"][..], more].concat())
    };
    let split = || building.lines("out.json")[0]["split"].clone();
    // Without an official split the name of the episodes' file decides.
    assert_eq!((export(&["--format", "rxr"]).code, split()), (Some(0), json!("val_seen")));
    assert_eq!((export(&["--format", "rxr", "--split", "train"]).code, split()), (Some(0), json!("train")));
    rename_scene(&building, "2azQ1b91cZZ");
    for more in
        [&["--format", "rxr"][..], &["--format", "rxr", "--split", "train"], &["--format", "r2r", "--split", "train"]]
    {
        let ran = export(more);
        let error = ran.refused();
        assert!(error.contains("2azQ1b91cZZ is of the official split val_unseen"), "{error}");
        assert!(error.contains("hint: give --split val_unseen"), "{error}");
    }
    assert_eq!((export(&["--format", "rxr", "--split", "val_unseen"]).code, split()), (Some(0), json!("val_unseen")));
    let ran = export(&["--format", "r2r"]);
    assert!(ran.code == Some(0) && ran.err.contains("10 texts in scenes of the official split val_unseen"), "{ran:?}");
    // A run over random paths has no episodes, and so the official split counts.
    std::fs::remove_file(building.path("run/config.toml")).unwrap();
    assert_eq!((export(&["--format", "rxr"]).code, split()), (Some(0), json!("val_unseen")));
    let ran =
        building.wayword(&["export", "--run", "run", "--format", "wayword", "--val-share", "0", "--out", "out.jsonl"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(building.lines("out.jsonl").iter().all(|line| line["split"] == "val"));
}

#[test]
fn export_prints_one_line_with_the_terms_of_scenes() {
    let building = Building::new();
    building.run_over_episodes("run");
    houses(&building);
    let said = |run: &str| {
        building.wayword(&["export", "--run", run, "--style", "r2r", "--format", "r2r", "--out", "out.json"]).err
    };
    assert_eq!(said("run").matches("terms of the scenes of platform matterport").count(), 1);
    assert!(!said("a").contains("terms of the scenes"));
}

#[test]
fn a_recording_without_poses_is_exported_as_records_alone() {
    let building = Building::new();
    let mut records = building.run_over_episodes("run");
    for record in &mut records {
        record.path.motion = PathMotion::Unknown;
    }
    jsonl::write_records(&building.path("run/instructions.jsonl"), &records).unwrap();
    for format in DatasetFormat::ALL.into_iter().filter(|format| !format.holds_recordings()) {
        let ran =
            building.wayword(&["export", "--run", "run", "--style", "r2r", "--format", format.name(), "--out", "o"]);
        if format == DatasetFormat::Wayword {
            assert_eq!(ran.code, Some(0), "{ran:?}");
            assert!(
                jsonl::read_records(&building.path("o")).unwrap().iter().all(|record| !record.path.motion.is_known())
            );
        } else {
            let error = ran.refused();
            assert!(error.contains("needs poses") && error.contains("--format wayword"), "{error}");
            assert!(!building.path("o").exists());
        }
    }
}

#[test]
fn two_runs_are_one_file_only_as_records() {
    let building = Building::new();
    building.run_over_episodes("run");
    assert!(building.generate("more", &["--paths", "2", "--hops", "3..7", "--style", "r2r"]).code.is_some());
    let both = ["export", "--run", "run", "--run", "more", "--style", "r2r", "--out", "out"];
    let ran = building.wayword(&[&both[..], &["--format", "r2r"]].concat());
    assert!(ran.refused().contains("--format wayword"), "{ran:?}");
    assert_eq!(building.wayword(&[&both[..], &["--format", "wayword"]].concat()).code, Some(0));
}

/// From the refrigerator through the kitchen and the hallway to the entryway, and right into the living room.
const TO_THE_LAMP: [usize; 5] = [5, 4, 1, 0, 2];

/// A dataset of one path with these texts.
fn texts(building: &Building, texts: &[&str]) -> &'static str {
    let path: Vec<String> = TO_THE_LAMP.iter().map(|index| viewpoint_id(*index)).collect();
    let item =
        json!({ "path_id": 1, "scan": SCAN, "path": path, "heading": 3.3, "distance": 12.0, "instructions": texts });
    building.write("texts.json", json!([item]).to_string());
    "texts.json"
}

/// `wayword export --texts FILE --highlight doubts`, and the file that it wrote.
fn highlighted(building: &Building, told: &[&str]) -> (Value, Value) {
    let file = texts(building, told);
    let asked = ["--texts", file, "--platform", "matterport", "--data", "data", "--highlight", "doubts", "--json"];
    let ran = building.wayword(&[&["export"], &asked[..]].concat());
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let written = std::fs::read_to_string(building.path("doubts.json")).unwrap();
    (ran.json(), serde_json::from_str(&written).unwrap())
}

/// The doubted words of a text in the file, each with its grade and its alternatives; "-" where they may be left out.
fn doubted(file: &Value, at: usize) -> Vec<(String, String, Vec<String>)> {
    let text = &file["texts"][at];
    let words = text["text"].as_str().unwrap();
    let told = |doubt: &Value| {
        let span = doubt["span"].as_array().unwrap();
        let place = |end: usize| usize::try_from(span[end].as_u64().unwrap()).unwrap();
        let alternatives = doubt["alternatives"].as_array().unwrap().iter();
        let alternatives = alternatives.map(|one| one["words"].as_str().unwrap_or("-").to_owned());
        (words[place(0)..place(1)].to_owned(), doubt["grade"].as_str().unwrap().to_owned(), alternatives.collect())
    };
    text["doubts"].as_array().unwrap().iter().map(told).collect()
}

#[test]
fn highlight_marks_doubted_words_with_their_alternatives() {
    let building = Building::new();
    let right = "Leave the kitchen and walk to the entryway. Turn right at the coat rack and go into the living room. Stop at the lamp.";
    let wrong = right.replace("Turn right", "Make a Left");
    let (counts, file) = highlighted(&building, &[right, &wrong, "Gehe nach links <b>& warte</b>."]);
    assert_eq!((&counts["texts"], &counts["unfollowed"]), (&3.into(), &1.into()), "{counts}");
    assert_eq!((&file["format"], &file["version"]), (&"wayword-doubts".into(), &1.into()));
    assert!(doubted(&file, 0).iter().all(|(_, grade, _)| grade != "likely"), "{file:#}");
    let turn = doubted(&file, 1).into_iter().find(|(words, ..)| words == "Make a Left").unwrap();
    assert!(turn.1 == "likely" && turn.2.contains(&"Make a Right".to_owned()), "{turn:?}");
    let page = std::fs::read_to_string(building.path("doubts.html")).unwrap();
    assert!(page.contains(">Make a Left</mark>") && page.contains("<bdi>Make a Right</bdi>"), "{page}");
    assert!(page.contains("links &lt;b&gt;&amp; warte&lt;") && page.contains("Not followed: "), "{page}");
    let scripts = (page.matches("<script").count(), page.contains("script-src 'sha256-"));
    assert!(scripts == (1, true) && !page.contains("://"), "the page has only its own script, and loads nothing");
}

#[test]
fn texts_of_a_run_are_highlighted_by_the_run_alone() {
    let building = Building::new();
    building.run_over_episodes("run");
    let highlight = |more: &[&str]| {
        building
            .wayword(&[&["export", "--run", "run", "--style", "r2r", "--highlight", "doubts", "--json"], more].concat())
    };
    let closed = highlight(&[]).json();
    assert!(closed["texts"].as_u64().unwrap() > 0, "{closed}");
    assert_eq!((&closed["likely"], &closed["unfollowed"]), (&0.into(), &0.into()), "its own texts pass: {closed}");
    let open = highlight(&["--world", "open"]).json();
    assert_eq!(open["texts"], closed["texts"]);
    let file: Value = serde_json::from_slice(&std::fs::read(building.path("doubts.json")).unwrap()).unwrap();
    assert!(file["texts"].as_array().unwrap().iter().all(|text| text["style"] == "r2r" && text["world"] == "open"));
}

#[test]
fn flags_that_do_not_fit_together_are_refused() {
    let building = Building::new();
    building.run_over_episodes("run");
    let file = texts(&building, &["Stop."]);
    for (args, problem) in [
        (&["--run", "run", "--highlight", "d", "--format", "r2r"][..], "writes no dataset"),
        (&["--run", "run", "--highlight", "d", "--out", "o"], "writes no dataset"),
        (&["--run", "run", "--texts", file, "--highlight", "d"], "of one run, or of one file"),
        (&["--highlight", "d"], "of one run, or of one file"),
        (&["--run", "run", "--highlight", "d", "--platform", "matterport"], "a run knows its platform"),
        (&["--run", "run", "--highlight", "d", "--style", "none"], "no text of style none"),
        (&["--run", "run", "--style", "r2r", "--out", "o"], "--format is missing"),
        (&["--run", "run", "--style", "r2r", "--format", "r2r"], "--out is missing"),
        (&["--format", "r2r", "--out", "o"], "--run is missing"),
        (&["--texts", file, "--format", "r2r", "--out", "o"], "for --highlight"),
    ] {
        let refused = building.wayword(&[&["export"], args].concat());
        assert!(refused.refused().contains(problem), "{args:?}: {refused:?}");
    }
    assert!(!building.path("d.html").exists());
}
