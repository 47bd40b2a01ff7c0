//! `wayword compare`: agents walk through a made-up building by people's instructions and by those of a run.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{Building, Ran};
use serde_json::Value;
use std::fs;

const REVERIE: &str = "data/reverie/REVERIE_val_seen.json";
const R2R: &str = "data/r2r/R2R_val_seen.json";

fn compare(building: &Building, episodes: &str, args: &[&str]) -> Ran {
    let mut all = vec!["compare", "--platform", "matterport", "--data", "data", "--episodes", episodes];
    if !args.contains(&"--resamples") {
        all.extend(["--resamples", "200"]);
    }
    if !args.contains(&"--grounder") {
        all.extend(["--grounder", "labels/lexical"]);
    }
    if !args.contains(&"--out") {
        all.extend(["--out", "walked"]);
    }
    all.extend(args);
    building.wayword(&all)
}

fn comparison(building: &Building) -> Value {
    serde_json::from_str(&fs::read_to_string(building.path("walked/comparison.json")).unwrap()).unwrap()
}

fn rate(found: &Value, agent: &str, set: Option<&str>) -> f64 {
    let rows = found["rows"].as_array().unwrap();
    let row = rows.iter().find(|row| row["agent"] == agent && row["set"].as_str() == set).unwrap();
    row["figures"]["success_rate"]["mean"].as_f64().unwrap()
}

#[test]
fn the_table_has_agents_floors_and_ceilings() {
    let building = Building::new();
    building.run_over_episodes("run");
    let ran = compare(&building, REVERIE, &["--instructions", "original", "--instructions", "ours=run#reverie"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let found = comparison(&building);
    assert_eq!(found["about"]["rule"], "visible");
    assert_eq!(found["about"]["grounder"], "labels/lexical");
    assert_eq!(found["about"]["detector"], "labels/lexical/detector");
    assert_eq!(rate(&found, "oracle", None), 1.0);
    for agent in ["clip-nav", "seq-clip-nav", "glip-nav", "nearest-room"] {
        for set in ["original", "ours"] {
            assert!((0.0..=1.0).contains(&rate(&found, agent, Some(set))));
        }
    }
    assert!(rate(&found, "random/5", None) < rate(&found, "clip-nav", Some("original")), "{found}");
    for row in found["rows"].as_array().unwrap() {
        let figure = |name: &str| row["figures"][name]["mean"].as_f64().unwrap();
        assert!(figure("spl") <= figure("success_rate") + 1e-12, "{row}");
        assert!(figure("success_rate") <= figure("oracle_success_rate") + 1e-12, "{row}");
    }
    let swaps = found["swaps"].as_array().unwrap();
    assert_eq!(swaps.len(), 3 * 4, "three agents, four swaps");
    for name in ["comparison.md", "comparison.tex", "report.html", "walks.jsonl", "config.toml"] {
        assert!(building.path("walked").join(name).exists(), "{name}");
    }
    assert!(ran.out.contains("not perception") && ran.out.contains("clip-nav"), "{}", ran.out);
}

/// The evaluator accepts the agents' trajectories, and its figures equal those of the table.
#[test]
fn the_submissions_evaluate_to_the_tables_figures() {
    let building = Building::new();
    assert_eq!(compare(&building, REVERIE, &["--swaps", "none"]).code, Some(0));
    let submission = "walked/submissions/seq-clip-nav.original.json";
    let args = ["evaluate", submission, "--platform", "matterport", "--data", "data", "--episodes", REVERIE, "--json"];
    let ran = building.wayword(&args);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let told: Value = serde_json::from_str(&ran.out).unwrap();
    let text = told.to_string();
    // Every item of the building has two texts: the mean over texts is the mean over items.
    let expected = rate(&comparison(&building), "seq-clip-nav", Some("original"));
    assert!(text.contains(&format!("\"mean\":{expected}")), "{expected} is not in {text}");
}

#[test]
fn a_comparison_that_was_stopped_goes_on_and_ends_the_same() {
    let building = Building::new();
    assert_eq!(compare(&building, R2R, &[]).code, Some(0));
    let read = |name: &str| fs::read(building.path("walked").join(name)).unwrap();
    let (walks, table) = (read("walks.jsonl"), read("comparison.json"));
    for cut in [0, walks.len() / 3, walks.len() / 2 + 7, walks.len() - 1] {
        fs::write(building.path("walked/walks.jsonl"), &walks[..cut]).unwrap();
        let ran = compare(&building, R2R, &[]);
        assert_eq!(ran.code, Some(0), "{ran:?}");
        assert_eq!((read("walks.jsonl"), read("comparison.json")), (walks.clone(), table.clone()), "cut at {cut}");
    }
    let other = compare(&building, R2R, &["--seed", "7"]);
    assert_eq!(other.code, Some(1));
    assert!(other.err.contains("other settings: seed"), "{other:?}");
}

#[test]
fn the_report_shows_walks_that_succeed_and_walks_that_do_not() {
    let building = Building::new();
    building.run_over_episodes("run");
    let sets = ["--instructions", "original", "--instructions", "ours=run#reverie", "--replays", "0"];
    assert_eq!(compare(&building, REVERIE, &sets).code, Some(0));
    let page = || fs::read_to_string(building.path("walked/report.html")).unwrap();
    assert!(!page().contains("<article "));
    // The page needs only the platform and the episodes.
    fs::remove_dir_all(building.path("run")).unwrap();
    let ran = building.wayword(&["report", "--run", "walked", "--items", "30"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let page = page();
    assert_eq!(page.matches("<article ").count(), 30);
    assert!(page.contains("✓ success</span></h2>") && page.contains("✗ no success</span></h2>"));
    assert!(page.contains("class=\"flag\"") && page.contains("class=\"view chosen\""));
}

#[test]
fn a_seed_gives_one_table() {
    let building = Building::new();
    let folder = |out: &str| {
        let ran = compare(&building, R2R, &["--out", out, "--seed", "3"]);
        assert_eq!(ran.code, Some(0), "{ran:?}");
        crate::common::files(&building.path(out))
    };
    assert!(folder("a") == folder("b"), "two folders of one command differ");
}

#[test]
fn decision_rule_of_agents_can_be_chosen_by_name() {
    let building = Building::new();
    fs::write(building.path("p.toml"), "[clip-nav]\nmax_hops = 0\n").unwrap();
    let args = ["--agents", "clip-nav", "--parameters", "p.toml", "--swaps", "none"];
    let ran = compare(&building, R2R, &args);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let found = comparison(&building);
    assert_eq!(found["about"]["parameters"]["clip-nav"]["max_hops"], "0");
    assert_eq!(rate(&found, "clip-nav", Some("original")), 0.0, "who may not walk does not arrive");
    for (text, told) in [
        ("[clip-nav]\nstop = 1\n", "unknown field"),
        ("[glip-nav]\nmax_hops = 3\n", "no agent of this command is named glip-nav"),
        ("[clip-nav]\nmax_hops = 5000\n", "at most 1000"),
        ("[clip-nav]\nstop_threshold = nan\n", "a finite number"),
        ("[clip-nav.back]\nwindow = 3\nthreshold = 0.1\nnodes = 1\n", "never goes back"),
        ("clip-nav = 3\n", "must be a table"),
    ] {
        fs::write(building.path("p.toml"), text).unwrap();
        let ran = compare(&building, R2R, &args);
        assert!(ran.code == Some(1) && ran.err.contains(told) && ran.err.contains("p.toml"), "{text}: {ran:?}");
    }
}

#[test]
fn compare_refuses_senseless_flags_and_leaves_no_folder() {
    let building = Building::new();
    building.run_over_episodes("run");
    for (args, told) in [
        (vec!["--agents", "clip-nav,clip-nav"], "is named twice"),
        (vec!["--instructions", "ours"], "does not name a set"),
        (vec!["--instructions", "original", "--instructions", "original"], "is used twice"),
        (vec!["--instructions", "ours=run"], "several styles"),
        (vec!["--instructions", "none=run#reverie"], "does not name a set"),
        (vec!["--instructions", "..=run#reverie"], "does not name a set"),
        (vec!["--instructions", "a=run#r2r", "--instructions", "A=run#reverie"], "is used twice"),
        (vec!["--swaps", "none,directions"], "together with others"),
        (vec!["--swaps", "sentences,sentences"], "a swap twice"),
        (vec!["--grounder", "magic"], "there is no such grounder"),
        (vec!["--grounder", "detector"], "no detector is named"),
        (vec!["--detector", "ollama/x"], "detectors run inside this program"),
        (vec!["--grounder", "hf/openai/clip-vit-base-patch32"], "glip-nav needs a detector"),
        (vec!["--rule", "visible", "--episodes", R2R], "names no object"),
    ] {
        let ran = if args.contains(&"--episodes") {
            compare(&building, R2R, &args[..2])
        } else {
            compare(&building, REVERIE, &args)
        };
        assert_eq!(ran.code, Some(1), "{args:?}: {ran:?}");
        assert!(ran.err.contains(told) && ran.err.contains("hint: "), "{args:?}: {ran:?}");
        assert!(!building.path("walked").exists(), "{args:?}");
    }
}

#[test]
fn generated_houses_can_be_walked_by_their_own_instructions() {
    let building = Building::new();
    let made =
        building.wayword(&["generate", "--paths", "2", "--style", "reverie", "--scan", "house2-1", "--out", "houses"]);
    assert_eq!(made.code, Some(0), "{made:?}");
    let ran = building.wayword(&[
        "compare",
        "--episodes",
        "houses/instructions.jsonl",
        "--grounder",
        "labels/lexical",
        "--agents",
        "clip-nav",
        "--swaps",
        "none",
        "--resamples",
        "200",
        "--out",
        "walked",
    ]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert_eq!(rate(&comparison(&building), "oracle", None), 1.0);
}

/// The program reports a wrong episode, with its place, before any agent walks.
#[test]
fn misfit_episode_is_refused_before_any_agent_walks() {
    let building = Building::new();
    let mut items: Vec<Value> = serde_json::from_str(&fs::read_to_string(building.r2r()).unwrap()).unwrap();
    items[1]["path"][2] = "nowhere".into();
    building.write("bad.json", serde_json::to_string(&items).unwrap());
    let ran = compare(&building, "bad.json", &[]);
    let told = ran.refused();
    assert!(told.contains("bad.json") && told.contains("nowhere") && !building.path("walked").exists(), "{told}");
}

#[test]
fn texts_of_several_styles_are_not_mixed() {
    let building = Building::new();
    building.run_over_episodes("run");
    let mixed = compare(&building, "run/instructions.jsonl", &[]);
    assert!(mixed.refused().contains("several styles"), "{mixed:?}");
    let apart = ["--instructions", "short=run#reverie", "--instructions", "long=run#r2r", "--swaps", "none"];
    assert_eq!(compare(&building, "run/instructions.jsonl", &apart).code, Some(0));
    let found = comparison(&building);
    assert_eq!(found["sets"][0]["texts"], found["about"]["items"]);
    // Items of one path are one cluster, also when they come from different files.
    let (items, paths) = (found["about"]["items"].as_u64().unwrap(), found["about"]["paths"].as_u64().unwrap());
    let of_dataset: Vec<Value> = serde_json::from_str(&fs::read_to_string(building.reverie()).unwrap()).unwrap();
    let distinct: std::collections::BTreeSet<String> =
        of_dataset.iter().map(|item| item["path_id"].to_string()).collect();
    assert_eq!((items, paths), (of_dataset.len() as u64, distinct.len() as u64));
}

#[test]
fn a_page_is_made_of_what_was_compared_or_not_at_all() {
    let building = Building::new();
    assert_eq!(compare(&building, R2R, &["--swaps", "none"]).code, Some(0));
    let report = || building.wayword(&["report", "--run", "walked"]);
    assert_eq!(report().code, Some(0));
    let episodes = fs::read_to_string(building.r2r()).unwrap();
    fs::write(building.r2r(), format!("{episodes} ")).unwrap();
    assert!(report().refused().contains("has changed since"));
    fs::write(building.r2r(), episodes).unwrap();
    fs::remove_file(building.path("walked/comparison.json")).unwrap();
    assert!(report().refused().contains("not finished"));
    // The rule can be changed, because the walks do not depend on it.
    let ran = compare(&building, R2R, &["--swaps", "none", "--rule", "distance", "--resamples", "300"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
}

/// Agents that read, on people's texts: rows, walks, page, and the same end after a stop.
#[test]
fn readers_have_their_rows_their_walks_and_their_floors() {
    let building = Building::new();
    let ran = compare(&building, R2R, &["--agents", "reader,reader-map"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let found = comparison(&building);
    assert_eq!(found["about"]["prior"], "shortest:1-20");
    let row = |agent: &str, set: &str| {
        let rows = found["rows"].as_array().unwrap();
        rows.iter().find(|row| row["agent"] == agent && row["set"] == set).unwrap().clone()
    };
    assert_eq!(row("reader", "original")["kind"], "agent");
    for set in ["original", "original~empty", "original~other-path"] {
        assert_eq!(row("reader-map", set)["kind"], "informed");
    }
    let (reads, empty) =
        (rate(&found, "reader-map", Some("original")), rate(&found, "reader-map", Some("original~empty")));
    assert!(reads > empty && rate(&found, "reader", Some("original")) > rate(&found, "random/5", None), "{found}");
    let tested: Vec<&str> =
        found["swaps"].as_array().unwrap().iter().map(|swap| swap["agent"].as_str().unwrap()).collect();
    assert_eq!(tested, [["reader"; 4], ["reader-map"; 4]].concat());
    for told in ["reader-map, knows the map", "an empty text", "Rooms and labels are ground truth", "1-20 hops away"] {
        assert!(ran.out.contains(told), "{told} is not in {}", ran.out);
    }
    assert!(!ran.out.contains("split into phrases"), "{}", ran.out);
    let page = fs::read_to_string(building.path("walked/report.html")).unwrap();
    assert!(page.contains("is told: ") && page.contains(">reader-map, original, "), "both are replayed");
    let walks = fs::read(building.path("walked/walks.jsonl")).unwrap();
    fs::write(building.path("walked/walks.jsonl"), &walks[..walks.len() / 2]).unwrap();
    assert_eq!(compare(&building, R2R, &["--agents", "reader,reader-map"]).code, Some(0));
    assert_eq!(fs::read(building.path("walked/walks.jsonl")).unwrap(), walks);
    assert_eq!(comparison(&building), found);
    let submissions: Vec<String> = fs::read_dir(building.path("walked/submissions"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    assert!(submissions.contains(&"reader.original.json".to_owned()), "{submissions:?}");
    assert!(submissions.iter().all(|name| !name.contains('~')), "{submissions:?}");
}

#[test]
fn floors_are_printed_without_swap_tests_and_by_the_prior_that_was_asked_for() {
    let building = Building::new();
    let args = ["--agents", "reader-map", "--swaps", "none", "--prior", "none"];
    let ran = compare(&building, R2R, &args);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let found = comparison(&building);
    assert!(found["about"]["prior"] == "none" && found["swaps"].as_array().unwrap().is_empty());
    for set in ["original~empty", "original~other-path"] {
        assert!((0.0..=1.0).contains(&rate(&found, "reader-map", Some(set))), "{set}");
    }
    assert!(ran.out.contains("walks of two shortest pieces"), "{}", ran.out);
    // Another prior is another comparison.
    let other = compare(&building, R2R, &["--agents", "reader-map", "--swaps", "none"]);
    assert!(other.code == Some(1) && other.err.contains("other settings: prior"), "{other:?}");
    let near = ["--agents", "reader-map", "--swaps", "none", "--prior", "shortest:1-1", "--out", "near"];
    assert_eq!(compare(&building, R2R, &near).code, Some(0));
    for walk in building.lines("near/walks.jsonl") {
        let hops = walk["steps"].as_array().unwrap().len() - 1;
        assert!(walk["agent"] != "reader-map" || hops <= 1, "{walk}");
    }
}

#[test]
fn compare_refuses_flags_that_readers_lack() {
    let building = Building::new();
    fs::write(building.path("p.toml"), "[reader]\nphrase_threshold = 0.3\n").unwrap();
    for (args, told) in [
        (vec!["--prior", "none"], "--prior none has no effect"),
        (vec!["--agents", "reader", "--parameters", "p.toml"], "reader has no thresholds here"),
        (vec!["--agents", "reader,reader"], "is named twice"),
    ] {
        let ran = compare(&building, R2R, &args);
        assert!(ran.refused().contains(told), "{args:?}: {ran:?}");
    }
    for typed in ["shortest", "shortest:1-0", "shortest:1-99", "shortest:2-8", "longest:1-8"] {
        let ran = compare(&building, R2R, &["--agents", "reader-map", "--prior", typed]);
        assert!(ran.code == Some(2) && ran.err.contains("give shortest:1-N"), "{typed}: {ran:?}");
    }
}
