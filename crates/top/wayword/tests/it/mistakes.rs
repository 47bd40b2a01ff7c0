//! Mistakes on the command line: the error names what is wrong, where, and what to do.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{Building, EPISODES};
use serde_json::{Value, json};
use std::fs;

const WORLD: [&str; 4] = ["--platform", "matterport", "--data", "data"];

/// Runs commands that are refused, and compares what they say with the words expected.
fn refuse_all(building: &Building, cases: &[(&[&str], &[&str])]) {
    for (args, words) in cases {
        let ran = building.wayword(args);
        let told = ran.refused();
        for word in *words {
            assert!(told.contains(word), "{args:?}: {word:?} is not in {told}");
        }
    }
}

#[test]
fn another_thing_than_a_run_is_told_by_its_name() {
    let building = Building::new();
    building.run_over_episodes("run");
    let table = ["compare", "--episodes", EPISODES, "--agents", "reader", "--swaps", "none", "--out", "table"];
    assert_eq!(building.wayword(&[&table[..], &WORLD].concat()).code, Some(0));
    let export = |run| ["export", "--run", run, "--format", "wayword", "--out", "texts.jsonl"];
    refuse_all(
        &building,
        &[
            (&export("run/instructions.jsonl"), &["it is a file, not a run folder", "--run run\n"]),
            (&export("table"), &["`wayword compare` wrote it", "of `wayword generate`"]),
            (&export("."), &["it is not a run folder", "--run ./run"]),
            (&["check", EPISODES, "--run", "nowhere"], &["--run nowhere: there is no such folder"]),
            (&["check", EPISODES, "--run", "table"], &["`wayword compare` wrote it", "of `wayword generate`"]),
            (&["robustness", "--run", "table", "--out", "changed"], &["`wayword compare` wrote it"]),
            (&[&table[..8], &["run"], &WORLD].concat(), &["`wayword generate` wrote it", "another --out"]),
            (&["check", "run", "--run", "run"], &["not a file but a folder", "give the file instructions.jsonl in it"]),
            (
                &[&["check", "run/walks.jsonl"], &WORLD[..]].concat(),
                &["walks.jsonl of a run", "texts are in instructions.jsonl"],
            ),
            (&["runs", "status", "run"], &["one machine makes this run", "it has no chunks"]),
            (&["generate", "--paths", "1", "--out", EPISODES], &["cannot make the folder", "a file has this name"]),
            (&["demo", "--out", EPISODES], &["cannot make the folder", "a file has this name"]),
        ],
    );
}

#[test]
fn files_in_each_other_s_places_are_told_apart() {
    let building = Building::new();
    let submission = json!([{"instr_id": "1_0", "trajectory": [["a", 0, 0]]}]);
    building.write("walked.json", submission.to_string());
    building.write("mine.toml", "name = \"mine\"\nreferences = [\"Walk past the lamp. Wait at the desk.\"]");
    building.run_over_episodes("run");
    let on_house = ["check", "run/instructions.jsonl", "--platform", "house"];
    refuse_all(
        &building,
        &[
            (
                &[&["evaluate", EPISODES, "--episodes", "walked.json"], &WORLD[..]].concat(),
                &["they seem to be swapped", "`wayword evaluate walked.json --episodes data/reverie"],
            ),
            (&["generate", "--config", EPISODES, "--out", "x"], &["it looks like JSON, and settings are TOML"]),
            (
                &["generate", "--paths", "1", "--style", "x=mine.toml", "--out", "x"],
                &["after = stands a dataset", "--style mine.toml"],
            ),
            (&on_house, &["its paths are of platform matterport, and --platform is house", "--platform matterport"]),
        ],
    );
}

#[test]
fn a_scene_with_another_case_is_suggested() {
    let building = Building::new();
    let scene = building.run_over_episodes("run")[0].path.scene.to_string();
    let typed = scene.to_uppercase();
    assert_ne!(typed, scene);
    let ran = building.generate("other", &["--scan", &typed, "--paths", "1"]);
    assert!(ran.refused().contains(&format!("did you mean {scene:?}?")), "{ran:?}");
}

#[test]
fn numbers_out_of_their_range_are_repeated() {
    let building = Building::new();
    let generate = |flag, value| ["generate", "--paths", "1", "--out", "x", flag, value];
    refuse_all(
        &building,
        &[
            (&generate("--candidates", "100"), &["--candidates 100 is not from 1 to 32"]),
            (&generate("--per-path", "12"), &["--per-path 12 is not from 1 to 9"]),
            (&generate("--refine", "9"), &["--refine 9 is more than 5"]),
            (&generate("--timeout-s", "0"), &["--timeout-s 0 is out of range"]),
            (&generate("--max-usd", "-2.5"), &["--max-usd -2.5 is out of range"]),
            (&["perceive", "--views", "0"], &["--views 0 asks for no view"]),
        ],
    );
}

#[test]
fn settings_without_effect_are_named() {
    let building = Building::new();
    let episodes = ["--episodes", EPISODES, "--limit", "1", "--style", "r2r", "--no-pictures"];
    let told = |out: &str, more: &[&str]| building.generate(out, &[&episodes[..], more].concat()).err;
    assert_eq!(told("plain", &[]), "");
    for (out, more, word) in [
        ("a", ["--hops", "2..3"], "--hops and --metres have no effect with --episodes"),
        ("b", ["--target", "free"], "--target free has no effect, because no style of this run ends in a task"),
        ("c", ["--finish", "nobody"], "these settings have no effect: --finish"),
    ] {
        let told = told(out, &more);
        assert!(told.contains("warning: ") && told.contains(word), "{more:?}: {told}");
    }
    let told = told("e", &["--perception", "single", "--questions", "4"]);
    assert!(told.contains("--questions has no effect without --perception dialogue or follow-up"), "{told}");
}

#[test]
fn folder_with_files_of_the_user_takes_no_output() {
    let building = Building::new();
    fs::create_dir(building.path("recording")).unwrap();
    building.write("recording/000000.jpg", "a picture");
    let words: &[&str] = &["--out recording: the folder holds 1 file", "such as 000000.jpg", "an empty folder"];
    let commands: [&[&str]; 4] =
        [&["generate", "--paths", "1"], &["generate", "--paths", "1", "--shard", "0/1"], &["demo"], &["house"]];
    for command in commands {
        refuse_all(&building, &[(&[command, &["--out", "recording"]].concat(), words)]);
    }
    assert_eq!(fs::read_dir(building.path("recording")).unwrap().count(), 1, "something was written");
    building.run_over_episodes("run");
    refuse_all(&building, &[(&["house", "--out", "run"], &["--out run: the folder holds"])]);
    let demo = building.wayword(&["demo", "--out", "run"]).err;
    assert!(demo.contains("platform (\"matterport\" before, \"house\" now)"), "{demo}");
}

#[test]
fn input_of_another_kind_is_told_where_it_belongs() {
    let building = Building::new();
    building.run_over_episodes("run");
    building.write("mine.toml", "name = \"mine\"\nreferences = [\"Walk past the lamp. Wait at the desk.\"]");
    let calibrate =
        |from: &'static str, out: &'static str| [&["calibrate", "--from", from, "--out", out], &WORLD[..]].concat();
    let pods = ["launch", "kubernetes", "--workers", "2", "--image", "i"];
    let work = ["--", "generate", "--paths", "9", "--out", "/shared/x"];
    let claimed = [&pods[..], &["--shared-claim", "runs=/other"]].concat();
    refuse_all(
        &building,
        &[
            (&calibrate("run/instructions.jsonl", "c.toml"), &["rules wrote its texts from labels", "people wrote"]),
            (&calibrate(EPISODES, EPISODES), &["--out would overwrite", "which this command reads"]),
            (&["doctor", "--config", "mine.toml"], &["it is a style", "--style mine.toml"]),
            (&["generate", "--paths", "1", "--out", "~/run"], &["has not replaced the ~", "$HOME"]),
            (&[&pods[..], &work].concat(), &["share no folder", "--shared-claim CLAIM=/DIR"]),
            (&[&claimed[..], &work].concat(), &["--out /shared/x is not in the folder that the workers share, /other"]),
        ],
    );
    assert!(!building.path("~").exists());
}

#[test]
fn command_of_workers_is_read_before_it_is_handed_to_them() {
    let building = Building::new();
    let launch = ["launch", "slurm", "--workers", "4", "--time", "1:00:00", "--"];
    let cases: [(&[&str], &[&str]); 5] = [
        (&["generate", "--path", "10", "--out", "x"], &["unexpected argument '--path' found", "'--paths'"]),
        (&["generate", "--paths", "1e3", "--out", "x"], &["invalid value '1e3'", "a whole number"]),
        (
            &["generate", "--paths", "9", "--episodes", "e", "--out", "x"],
            &["--episodes and --paths cannot be combined"],
        ),
        (&["generate", "--paths", "9", "--shard", "0/4", "--out", "x"], &["has --shard", "leave it out"]),
        (&["wayword", "generate", "--out", "x"], &["begins with wayword", "leave that word out"]),
    ];
    for (command, words) in cases {
        refuse_all(&building, &[(&[&launch[..], command].concat(), words)]);
    }
}

#[test]
fn only_style_of_a_run_needs_no_flag_and_several_are_named() {
    let building = Building::new();
    let export = |run, more: &[&str]| {
        building.wayword(&[&["export", "--run", run, "--format", "r2r", "--out", "texts.json"], more].concat())
    };
    let args = ["--episodes", EPISODES, "--style", "r2r", "--no-pictures"];
    assert_eq!(building.generate("one", &args).code, Some(0));
    assert_eq!(export("one", &[]).code, Some(0));
    building.run_over_episodes("two");
    let told = export("two", &[]);
    assert!(told.refused().contains("the run has texts of r2r, reverie") && told.err.contains("--style"), "{told:?}");
}

#[test]
fn checked_texts_that_failed_come_first_and_the_rest_is_counted() {
    let building = Building::new();
    let mut items: Vec<Value> = serde_json::from_slice(&fs::read(building.r2r()).unwrap()).unwrap();
    let (unclear, wrong) = ("Frobnicate the quux bazingly. Walk on.", "Walk past the piano and stop at the piano.");
    for item in &mut items {
        item["instructions"] = json!([unclear, wrong]);
    }
    building.write("texts.json", Value::from(items.clone()).to_string());
    let check = |more: &[&str]| {
        let args = [&["check", "texts.json", "--world", "closed", "--no-witnesses"], &WORLD[..], more].concat();
        building.wayword(&args).out
    };
    let id = items[0]["path_id"].to_string();
    let two = check(&["--show", "2"]);
    let (first, rest) = two.split_once('\n').unwrap();
    assert!(first.starts_with(&format!("{id}_1 Fail: ")), "{two}");
    let number = items.len();
    let more = format!("{} more did not pass, {} of which failed: --show fail lists", 2 * number - 2, number - 2);
    assert!(rest.contains(&more), "{more}: {two}");
    let heads =
        |out: &str, word: &str| out.lines().filter(|line| line.contains(word) && !line.starts_with(' ')).count();
    let failed = check(&["--show", "fail"]);
    assert_eq!((heads(&failed, " Fail: "), heads(&failed, "unverified: Frob")), (number, 0), "{failed}");
    let all = check(&["--show", "all"]);
    assert_eq!((heads(&all, " Fail: "), heads(&all, "unverified: Frob")), (number, number), "{all}");
    assert!(!all.contains("--show fail lists"), "{all}");
    let json: Value = serde_json::from_str(&check(&["--json"])).unwrap();
    assert_eq!(json["not_passed"][1]["name"], format!("{id}_1"));
}

#[test]
fn walks_by_a_generated_set_are_not_taken_for_those_by_the_dataset() {
    let building = Building::new();
    building.run_over_episodes("run");
    let sets = ["--instructions", "original", "--instructions", "ours=run#reverie"];
    let compare = ["compare", "--episodes", EPISODES, "--agents", "reader", "--swaps", "none", "--out", "table"];
    assert_eq!(building.wayword(&[&compare[..], &sets, &WORLD].concat()).code, Some(0));
    let evaluate = |set: &str| {
        let submission = format!("table/submissions/reader.{set}.json");
        let args = [&["evaluate", &submission, "--episodes", EPISODES, "--partial"], &WORLD[..]].concat();
        building.wayword(&args).out
    };
    assert!(evaluate("ours").contains(
        "these walks follow the texts of the set ours (run#reverie): the figures are theirs, on the paths of"
    ));
    assert!(!evaluate("original").contains("these walks follow"));
}
