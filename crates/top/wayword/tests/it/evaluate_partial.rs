//! `wayword evaluate --partial`: a submission that lacks instructions.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::submissions;

use crate::common::{Building, EPISODES};
use serde_json::{Value, json};
use std::fs;
use submissions::{R2R, annotated, evaluate, evaluate_file, problems, report};

/// The submission of `original` that `wayword compare` writes when it is compared with a set that lacks two items.
fn compared(building: &Building) -> &'static str {
    let ran = building.generate("run", &["--episodes", EPISODES, "--style", "reverie"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let text = fs::read_to_string(building.path("run/instructions.jsonl")).unwrap();
    building.write("few.jsonl", text.lines().skip(2).map(|line| format!("{line}\n")).collect::<String>());
    let sets = ["--instructions", "original", "--instructions", "few=few.jsonl"];
    let world = ["--platform", "matterport", "--data", "data", "--episodes", EPISODES];
    let agents = ["--agents", "clip-nav", "--swaps", "none", "--resamples", "100", "--out", "table"];
    let ran = building.wayword(&[&["compare"][..], &world, &sets, &agents].concat());
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(ran.err.contains("submissions cover 8 of 10 items") && ran.err.contains("--partial"), "{ran:?}");
    "table/submissions/clip-nav.original.json"
}

#[test]
fn partial_scores_a_comparison_s_submission_and_reports_its_extent() {
    let building = Building::new();
    let submission = compared(&building);
    let refused = evaluate_file(&building, submission, EPISODES, &[]);
    assert!(refused.code == Some(1) && refused.err.contains("score the others with --partial"), "{refused:?}");
    let shown = evaluate_file(&building, submission, EPISODES, &["--partial"]);
    assert_eq!(shown.code, Some(0), "{shown:?}");
    let told = format!("partial: 16 of 20 instructions and 8 of 10 items of {EPISODES} are scored");
    assert!(shown.out.contains(&told), "{shown:?}");
    let found = report(&evaluate_file(&building, submission, EPISODES, &["--partial", "--json"]));
    let numbers = ["instructions", "of_instructions", "items", "of_items"].map(|name| found[name].as_u64().unwrap());
    assert_eq!(numbers, [16, 20, 8, 10]);
    let compared: Value = serde_json::from_slice(&fs::read(building.path("table/comparison.json")).unwrap()).unwrap();
    assert_eq!(compared["about"]["items"], 8, "{compared}");
}

#[test]
fn partial_overlooks_missing_items_and_no_other_problem() {
    let building = Building::new();
    let mut submitted = annotated(&building, R2R);
    submitted.truncate(6);
    submitted[2]["trajectory"].as_array_mut().unwrap().reverse();
    submitted[4]["instr_id"] = json!("999_0");
    let found = problems(&evaluate(&building, &submitted, R2R, &["--partial", "--json"]));
    assert_eq!(found.len(), 2, "{found:#?}");
    let mixed = evaluate(&building, &submitted, R2R, &[]);
    let told = "fix the problems listed above; --partial skips 15 instructions";
    assert!(mixed.err.contains(told), "{mixed:?}");
    let none = evaluate(&building, &[], R2R, &["--partial"]);
    assert!(none.refused().contains("no instruction has a trajectory"), "{none:?}");
    let whole = evaluate(&building, &annotated(&building, R2R), R2R, &["--partial"]);
    assert!(whole.code == Some(0) && !whole.out.contains("partial"), "{whole:?}");
}
