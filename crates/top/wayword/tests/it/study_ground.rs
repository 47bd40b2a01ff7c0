//! `wayword study new`: the ground that people walk on, controls without a second path, and what a failed command leaves.

#![cfg(feature = "study")]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{Ran, command, run};
use serde_json::Value;
use std::path::Path;

fn wayword(folder: &Path, args: &[&str]) -> Ran {
    run(command(args).current_dir(folder))
}

/// A run of one path in each of these houses.
fn run_in_houses(houses: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (seed, house) in (3..).zip(houses) {
        // The seed is a part of a path's name.
        let (out, seed) = (format!("run-{house}"), format!("{seed}"));
        let args = ["generate", "--paths", "1", "--scan", house, "--style", "r2r", "--seed", &seed, "--out", &out];
        assert_eq!(wayword(folder.path(), &args).code, Some(0));
    }
    let texts =
        |house: &&str| std::fs::read_to_string(folder.path().join(format!("run-{house}/instructions.jsonl"))).unwrap();
    std::fs::write(folder.path().join("run.jsonl"), houses.iter().map(texts).collect::<String>()).unwrap();
    folder
}

#[test]
fn a_study_in_a_house_lies_on_its_graph_and_corrupts_its_own_texts() {
    let folder = run_in_houses(&["house2-1"]);
    let new =
        ["study", "new", "--run", "ours=run.jsonl", "--include", "corrupted", "--mode", "follow", "--out", "study"];
    let made = wayword(folder.path(), &[&new[..], &["--items", "1", "--json"]].concat());
    assert_eq!(made.code, Some(0), "{made:?}");
    let made = made.json();
    assert_eq!(made["conditions"], serde_json::json!(["ours", "corrupted"]));
    let study = folder.path().join("study");
    let ground: Value = serde_json::from_slice(&std::fs::read(study.join("ground.json")).unwrap()).unwrap();
    assert_eq!(ground, made["ground"]);
    assert_eq!(ground["edge_steps"], ground["route_steps"]);
    assert!(ground["route_steps"].as_u64().unwrap() > 1 && ground["near_goal"].as_u64().unwrap() > 0, "{ground}");
    let items = std::fs::read_to_string(study.join("items.jsonl")).unwrap();
    let texts: Vec<Value> =
        items.lines().map(|line| serde_json::from_str::<Value>(line).unwrap()["texts"][0]["text"].clone()).collect();
    assert!(texts.len() == 2 && texts[0] != texts[1], "{texts:?}");
}

#[test]
fn a_study_that_fails_leaves_nothing_and_says_what_to_do() {
    let folder = run_in_houses(&["house2-1", "house2-2"]);
    let new = ["study", "new", "--run", "ours=run.jsonl", "--mode", "follow", "--out", "out/study"];
    let refused = wayword(folder.path(), &[&new[..], &["--include", "other-path"]].concat());
    let told = refused.refused();
    assert!(told.contains("none of 2 paths") && told.contains("--include corrupted"), "{told}");
    assert!(!folder.path().join("out").exists());
}
