//! `wayword robustness` on a small run over a made-up building.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{Building, Ran};
use serde_json::Value;
use std::fs;

fn robustness(building: &Building, args: &[&str]) -> Ran {
    building.wayword(&[&["robustness", "--run", "run", "--out", "robust", "--resamples", "100"], args].concat())
}

fn results(building: &Building) -> Value {
    serde_json::from_str(&fs::read_to_string(building.path("robust/robustness.json")).unwrap()).unwrap()
}

fn texts(building: &Building) -> String {
    fs::read_to_string(building.path("robust/texts.jsonl")).unwrap()
}

#[test]
fn texts_are_written_again_and_what_must_change_is_judged() {
    let building = Building::new();
    building.run_over_episodes("run");
    let ran = robustness(&building, &["--change", "mirror", "--change", "turn"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let found = results(&building);
    assert_eq!(found["again"]["equal"], found["again"]["of"], "the unchanged world gives the run's texts");
    for style in found["styles"].as_array().unwrap() {
        for expectation in style["expectations"].as_array().unwrap() {
            assert!(expectation["told"].as_u64() > Some(0), "{expectation}");
        }
    }
    let page = fs::read_to_string(building.path("robust/report.html")).unwrap();
    assert!(page.contains("the text is equal but left and right") && !page.contains("<script"));
}

#[test]
fn robustness_continued_writes_no_text_twice_and_ends_the_same() {
    let building = Building::new();
    building.run_over_episodes("run");
    let changes = ["--change", "start_heading_deg=90", "--limit", "2"];
    let ran = robustness(&building, &changes);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let whole = texts(&building);
    let lines: Vec<&str> = whole.split_inclusive('\n').collect();
    // A process that was killed leaves half a line.
    let half = lines[..3].concat() + &lines[3][..20];
    fs::write(building.path("robust/texts.jsonl"), half).unwrap();
    assert_eq!(robustness(&building, &changes).code, Some(0));
    assert_eq!(texts(&building), whole);
    // More changes may be asked for; other paths may not.
    assert_eq!(robustness(&building, &["--change", "mirror", "--limit", "2"]).code, Some(0));
    assert!(texts(&building).starts_with(&whole));
    let other = robustness(&building, &["--change", "mirror", "--limit", "1"]);
    assert_eq!(other.code, Some(1), "{other:?}");
    assert!(other.err.contains("other settings: limit"), "{}", other.err);
}

#[test]
fn robustness_refuses_meaningless_changes_with_the_reason() {
    let building = Building::new();
    building.run_over_episodes("run");
    let ran = robustness(&building, &["--change", "camera_height_m=0.3", "--change", "mirror", "--limit", "1"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(ran.err.contains("camera_height_m=0.3 means nothing here"), "{}", ran.err);
    assert_eq!(results(&building)["refused"].as_array().unwrap().len(), 1);
    let none = robustness(&building, &["--change", "blur_px=2", "--limit", "1"]);
    assert_eq!(none.code, Some(1));
    assert!(none.err.contains("labels are not read from pictures"), "{}", none.err);
    let unknown = robustness(&building, &["--change", "mirorr"]);
    assert!(unknown.code == Some(1) && unknown.err.contains("mirror"), "{}", unknown.err);
    let list = building.wayword(&["robustness", "--list"]);
    assert!(
        list.out.contains("default set: platform=habitat, mirror, turn, remove, camera_height_m=0.3"),
        "{}",
        list.out
    );
}

/// A folder with a run of one path through a generated house.
fn with_a_house_run() -> Building {
    let building = Building::new();
    let ran = building.wayword(&["generate", "--paths", "1", "--style", "r2r", "--out", "run"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    building
}

#[test]
fn the_same_poses_are_seen_on_other_platforms() {
    let building = with_a_house_run();
    let ran = robustness(&building, &["--change", "platform=habitat", "--change", "platform=recording"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(ran.err.contains("platform=recording means nothing here: a recording has no labels"), "{}", ran.err);
    let lines: Vec<Value> = texts(&building).lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let line = |arm: &str| lines.iter().find(|line| line["arm"] == arm).unwrap();
    let (before, after) = (line("unchanged"), line("platform-habitat"));
    assert_eq!(before["path"]["frames"], after["path"]["frames"]);
    assert!(after["texts"][0]["text"].as_str().is_some_and(|text| !text.is_empty()), "{after}");
}

#[test]
fn an_eye_sees_a_recording_of_the_path() {
    let building = with_a_house_run();
    let ran = robustness(&building, &["--eye", "recall=1", "--change", "platform=recording"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let lines: Vec<Value> = texts(&building).lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let filmed = lines.iter().find(|line| line["arm"] == "platform-recording").unwrap();
    let frames = filmed["base_frame_of"].as_array().unwrap();
    assert!(frames.len() > 2 && filmed["left_out"].is_null(), "{filmed}");
    assert!(filmed["texts"][0]["mentions"].as_array().is_some_and(|mentions| !mentions.is_empty()), "{filmed}");
}

#[test]
fn sets_of_a_comparison_are_compared_with_each_other() {
    let building = Building::new();
    building.run_over_episodes("run");
    let mut all = vec!["compare", "--platform", "matterport", "--data", "data", "--grounder", "labels/lexical"];
    all.extend(["--episodes", "data/reverie/REVERIE_val_seen.json", "--resamples", "100", "--out", "walked"]);
    all.extend(["--instructions", "original", "--instructions", "ours=run#reverie"]);
    let ran = building.wayword(&all);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let ran = building.wayword(&["robustness", "--compared", "walked", "--resamples", "100", "--json"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let found: Value = serde_json::from_str(&ran.out).unwrap();
    assert_eq!(found["sets"], serde_json::json!(["original", "ours"]));
    let table: Value =
        serde_json::from_str(&fs::read_to_string(building.path("walked/comparison.json")).unwrap()).unwrap();
    assert!(found["agents"].as_array().unwrap().len() > 1 && table["rows"].is_array(), "{found}");
    assert_eq!(found["rankings"][0]["one"], "original");
    let none = building.wayword(&["robustness", "--compared", "run"]);
    assert!(none.refused().contains("has to be of `wayword compare`"), "{none:?}");
    fs::remove_file(building.path("walked/followed.jsonl")).unwrap();
    let none = building.wayword(&["robustness", "--compared", "walked"]);
    assert!(none.refused().contains("followed.jsonl"), "{none:?}");
}

/// Rewrites the head of a folder's settings as a version of the future would.
fn make_later(building: &Building, folder: &str) {
    let file = building.path(&format!("{folder}/config.toml"));
    let text = fs::read_to_string(&file).unwrap();
    let (format, rest) = text.split_once('\n').unwrap();
    let (writer, rest) = rest.split_once('\n').unwrap();
    assert!(format.ends_with("/1\"") && writer.starts_with("wayword = "), "{text}");
    fs::write(&file, format!("{}\nwayword = \"7.0.3\"\nfresh = true\n{rest}", format.replace("/1\"", "/2\""))).unwrap();
}

/// A command refuses a folder of a later format, and changes no file.
fn assert_refused(building: &Building, (folder, format): (&str, &str), command: &[&str]) {
    let settings = || fs::read(building.path(&format!("{folder}/config.toml"))).unwrap();
    let before = settings();
    let ran = building.wayword(command);
    let told = ran.refused();
    assert!(told.contains(&format!("\"{format}/2\"")) && told.contains("7.0.3"), "{command:?}: {told}");
    assert!(told.contains("hint: use the version that wrote it"), "{told}");
    assert_eq!(settings(), before);
}

#[test]
fn a_folder_of_a_later_format_is_refused_by_every_command_that_reads_it() {
    let building = Building::new();
    building.run_over_episodes("run");
    let episodes = ["--platform", "matterport", "--data", "data", "--episodes", "data/reverie/REVERIE_val_seen.json"];
    let compare =
        [&["compare"], &episodes[..], &["--grounder", "labels/lexical", "--out", "walked", "--resamples", "100"]];
    let (compare, generate) = (compare.concat(), [&["generate"], &episodes[..], &["--out", "run"]].concat());
    let robust = ["robustness", "--run", "run", "--out", "robust", "--change", "mirror", "--limit", "1"];
    for command in [&compare[..], &robust] {
        assert_eq!(building.wayword(command).code, Some(0));
    }

    make_later(&building, "robust");
    assert_refused(&building, ("robust", "wayword-robustness"), &robust);
    make_later(&building, "walked");
    for command in [&compare[..], &["report", "--run", "walked"], &["robustness", "--compared", "walked"]] {
        assert_refused(&building, ("walked", "wayword-comparison"), command);
    }
    make_later(&building, "run");
    let check = ["check", "run/instructions.jsonl", "--run", "run"];
    for command in [&generate[..], &["report", "--run", "run"], &check, &robust] {
        assert_refused(&building, ("run", "wayword-run"), command);
    }
}
