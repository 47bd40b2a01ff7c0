//! `wayword compare` with models: one behind HTTP takes instructions apart, one in process looks at pictures.

#![cfg(feature = "local")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::{Building, EPISODES, Ran, run};
use std::{fs, path::Path};
use wayword_testkit::provider::{ModelScript, ProviderBehaviour, ProviderDialect, ScriptRequest, ScriptedProvider};

/// Takes every instruction apart in the same way. The reply to an instruction with a pillow is useless.
struct Splits;

impl ModelScript for Splits {
    fn reply(&self, heard: &ScriptRequest) -> String {
        if heard.prompt().contains("pillow") {
            return "I would rather not.".to_owned();
        }
        "Sure! Here it is:\n1. the hallway\n2. the bathroom\nTASK: wipe the mirror".to_owned()
    }
}

fn compare(building: &Building, out: &str, args: &[&str]) -> Ran {
    let all = ["compare", "--platform", "matterport", "--data", "data", "--episodes", EPISODES, "--swaps", "none"];
    let more = ["--agents", "clip-nav", "--resamples", "200", "--ledger", "ledger.db", "--out", out];
    run(building.command(&[&all[..], &more, args].concat()).env("WAYWORD_OFFLINE", "1"))
}

#[test]
fn a_model_takes_instructions_apart_and_each_is_paid_once() {
    let (building, provider) =
        (Building::new(), ScriptedProvider::start(ProviderBehaviour::for_model("words", Splits)).unwrap());
    let base = provider.base_url(ProviderDialect::OpenAi);
    let args = ["--split", "server/words", "--base-url", &base];
    let ran = compare(&building, "first", &args);
    // The items with a pillow could not be taken apart: they are reported and left out.
    assert_eq!(ran.code, Some(3), "{ran:?}");
    assert!(ran.err.contains("item ") && ran.err.contains("words"), "{ran:?}");
    let walks = building.lines("first/walks.jsonl");
    let read: Vec<_> = walks.iter().filter(|walk| !walk["directions"].is_null()).collect();
    assert!(!read.is_empty());
    for walk in &read {
        assert_eq!(walk["directions"]["activity"], "wipe the mirror", "{walk}");
        assert_eq!(walk["directions"]["phrases"][1], "the bathroom", "{walk}");
    }
    let paid = provider.request_count();
    assert!(paid > 0);
    let again = compare(&building, "second", &args);
    assert_eq!(again.code, Some(3), "{again:?}");
    let unreadable = provider.request_count() - paid;
    assert!(unreadable < paid, "what was answered is not asked for again: {paid}, then {unreadable}");
    assert_eq!(building.lines("second/walks.jsonl"), walks);
    let comparison: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(building.path("first/comparison.json")).unwrap()).unwrap();
    assert_eq!(comparison["about"]["splitter"], "server/words");
}

#[test]
fn a_budget_stops_it_and_the_same_command_goes_on() {
    let (building, provider) =
        (Building::new(), ScriptedProvider::start(ProviderBehaviour::for_model("words", Splits)).unwrap());
    let base = provider.base_url(ProviderDialect::OpenAi);
    let args = ["--split", "server/words", "--base-url", &base, "--concurrency", "1"];
    let stopped = compare(&building, "walked", &[&args[..], &["--max-calls", "6"]].concat());
    assert_eq!(stopped.code, Some(5), "{stopped:?}");
    assert!(!building.path("walked/comparison.json").exists(), "a part of the items is no comparison");
    let ran = compare(&building, "walked", &args);
    assert_eq!(ran.code, Some(3), "{ran:?}");
    assert!(building.path("walked/comparison.json").exists());
}

#[test]
fn clip_in_process_looks_at_pictures() {
    let building = Building::new();
    wayword_testkit::write_distinct_skyboxes(&building.data()).unwrap();
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/wayword-local/fixtures/clip");
    let name = format!("hf/{}", fixture.canonicalize().unwrap().display());
    let ran = compare(&building, "walked", &["--grounder", &name, "--limit", "2"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(!ran.out.contains("ground truth"), "nothing here comes from labels: {}", ran.out);
    let walks = building.lines("walked/walks.jsonl");
    let seen = &walks.iter().find(|walk| walk["agent"] == "clip-nav").unwrap()["steps"][0]["views"];
    let scores: std::collections::BTreeSet<String> =
        seen.as_array().unwrap().iter().map(|view| view[1].to_string()).collect();
    assert!(scores.len() > 1, "different pictures score differently: {seen}");
    let blind = Building::new();
    let ran = compare(&blind, "walked", &["--grounder", &name, "--limit", "2"]);
    assert!(ran.refused().contains("needs a picture"), "{ran:?}");
}
