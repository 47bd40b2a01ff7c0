//! `wayword check --run`: texts that were edited after an export are checked against the evidence of their run.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::models as stage;

use crate::common::{Building, EPISODES};
use serde_json::Value;
use stage::{Stage, cast};
use std::fs;

/// Changes the texts of a file as a user with an editor does.
fn edit(building: &Building, file: &str, from: &str, to: &str) {
    let text = fs::read_to_string(building.path(file)).unwrap();
    assert!(text.contains(from), "{text}");
    building.write(file, text.replace(from, to));
}

#[test]
fn edited_texts_are_checked_without_the_platform() {
    let stage = Stage::new(cast());
    let building = &stage.building;
    assert_eq!(stage.generate("run", &["--paths", "6"]).code, Some(0));
    assert_eq!(
        building.wayword(&["export", "--run", "run", "--format", "r2r", "--style", "r2r", "--out", "x.json"]).code,
        Some(0)
    );
    // The platform's data is removed.
    fs::remove_dir_all(building.data()).unwrap();
    for file in ["x.json", "run/instructions.jsonl"] {
        let ran = building.wayword(&["check", file, "--run", "run", "--json"]);
        let report = ran.json();
        assert_eq!((ran.code, report["failed"].as_u64()), (Some(0), Some(0)), "{file}: {ran:?}");
        assert_eq!(
            (&report["checked_against"][0], &report["worlds"]["closed"]),
            (&"captions".into(), &6.into()),
            "{ran:?}"
        );
        assert_eq!(report["styles"]["r2r"], 6, "{ran:?}");
    }
    edit(building, "x.json", "Stop at the ", "Stop at the piano beside the ");
    let ran = building.wayword(&["check", "x.json", "--run", "run", "--json"]);
    let report = ran.json();
    assert!(ran.code == Some(3) && report["failed"].as_u64().unwrap() > 0, "{ran:?}");
    let told = report["not_passed"].to_string();
    assert!(told.contains("no frame of the path shows \\\"piano\\\""), "{told}");
}

#[test]
fn claims_from_labels_are_unverified_where_only_captions_are_left() {
    let building = Building::new();
    assert_eq!(building.run_over_episodes("run").len(), 20);
    fs::remove_dir_all(building.data()).unwrap();
    let ran = building.wayword(&["check", "run/instructions.jsonl", "--run", "run", "--json"]);
    let report = ran.json();
    assert_eq!((ran.code, report["failed"].as_u64()), (Some(0), Some(0)), "{ran:?}");
    assert_eq!(report["worlds"]["open"], 20, "{ran:?}");
}

#[test]
fn texts_from_labels_keep_their_verdicts_and_fail_once_they_are_wrong() {
    let building = Building::new();
    let houses = ["--paths", "4", "--seed", "11", "--style", "r2r", "--no-pictures"];
    assert_eq!(building.wayword(&[&["generate", "--out", "run"][..], &houses].concat()).code, Some(0));
    let written: Vec<Value> = building.lines("run/instructions.jsonl");
    building.wayword(&["export", "--run", "run", "--format", "wayword", "--out", "x.jsonl"]);
    for file in ["x.jsonl", "run/instructions.jsonl"] {
        let report = building.wayword(&["check", file, "--run", "run", "--json"]).json();
        assert_eq!(
            (&report["checked_against"][0], &report["worlds"]["closed"]),
            (&"labels".into(), &4.into()),
            "{report}"
        );
        assert!(written.iter().all(|record| record["verdict"] == "pass") && report["passed"] == 4, "{report}");
    }
    let flipped = |text: &str| text.replace("left", "RIGHT").replace("right", "left").replace("RIGHT", "right");
    let turns = written.iter().filter(|record| flipped(record["text"].as_str().unwrap()) != record["text"]).count();
    let edit = |mut record: Value| {
        record["text"] = flipped(record["text"].as_str().unwrap()).into();
        (record["mentions"], record["findings"]) = (Value::Array(Vec::new()), Value::Array(Vec::new()));
        format!("{record}\n")
    };
    building.write("x.jsonl", building.lines("x.jsonl").into_iter().map(edit).collect::<String>());
    let ran = building.wayword(&["check", "x.jsonl", "--run", "run", "--json"]);
    assert!(turns > 0 && ran.code == Some(3) && ran.json()["failed"] == turns, "{turns}: {ran:?}");
}

#[test]
fn a_text_of_another_run_is_refused_by_its_path() {
    let building = Building::new();
    building.run_over_episodes("run");
    let other = building.generate("other", &["--episodes", EPISODES, "--style", "r2r", "--limit", "2"]);
    assert_eq!(other.code, Some(0));
    let ran = building.wayword(&["check", "run/instructions.jsonl", "--run", "other"]);
    assert!(ran.refused().contains("the run other has no path"), "{ran:?}");
    let both = building.wayword(&["check", "x.json", "--run", "run", "--platform", "house"]);
    assert_eq!(both.code, Some(2), "{both:?}");
    let lines: Vec<Value> = building.lines("other/instructions.jsonl");
    assert_eq!(lines.len(), 2);
}
