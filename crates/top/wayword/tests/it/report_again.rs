//! `wayword report` after somebody edited the texts of a run: they are found by their hash, checked again, and listed first.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::Building;
use serde_json::{Value, json};
use std::fs;

/// Writes the lines of a run's instructions.
fn write_lines(building: &Building, lines: &[Value]) {
    building.write("run/instructions.jsonl", lines.iter().map(|line| format!("{line}\n")).collect::<String>());
}

/// The first row of the report's list.
fn first_row(building: &Building) -> String {
    let page = fs::read_to_string(building.path("run/report.html")).unwrap();
    page.split("<li class=\"row ").nth(1).unwrap().to_owned()
}

#[test]
fn an_edited_text_is_checked_again_and_comes_first() {
    let building = Building::new();
    building.run_over_episodes("run");
    let written = building.lines("run/instructions.jsonl");
    assert!(written.iter().all(|line| line["text_hash"].as_str().unwrap().len() == 16));

    let ran = building.wayword(&["report", "--run", "run", "--json"]);
    assert_eq!((ran.code, &ran.json()["wrong"]), (Some(0), &json!(0)), "{ran:?}");
    assert!(!first_row(&building).contains("changed after the run"));

    // A thing that is nowhere, in a text that is too short for the places of its old words.
    let mut edited = written;
    edited[17]["text"] = "Pass the grand piano.".into();
    write_lines(&building, &edited);
    let ran = building.wayword(&["report", "--run", "run", "--json"]);
    assert_eq!((ran.code, &ran.json()["wrong"]), (Some(0), &json!(1)), "{ran:?}");
    let row = first_row(&building);
    for told in ["✗ fails a check now", "changed after the run; checked again", "grand piano"] {
        assert!(row.contains(told), "{told}: {row}");
    }

    let ran = building.wayword(&["report", "--run", "run", "--no-check", "--json"]);
    assert_eq!((ran.code, &ran.json()["wrong"]), (Some(0), &json!(0)), "{ran:?}");
    assert!(first_row(&building).contains("changed after the run; not checked again"));

    // A record of an older version has no hash: the check alone finds the text.
    edited[17].as_object_mut().unwrap().remove("text_hash");
    write_lines(&building, &edited);
    building.wayword(&["report", "--run", "run"]);
    let row = first_row(&building);
    assert!(row.contains("✗ fails a check now") && !row.contains("changed after the run"), "{row}");
}

#[test]
fn without_the_data_of_the_platform_a_report_is_written_from_the_run_alone() {
    let building = Building::new();
    building.run_over_episodes("run");
    fs::remove_dir_all(building.data()).unwrap();
    let ran = building.wayword(&["report", "--run", "run"]);
    assert!(ran.code == Some(0) && ran.err.contains("captions are the evidence"), "{ran:?}");
    let page = fs::read_to_string(building.path("run/report.html")).unwrap();
    assert!(page.contains("texts checked again against captions"));
}
