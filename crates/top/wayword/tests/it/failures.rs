//! The program reports a failure with its kind, keeps it apart from rejected texts, and the same command tries it
//! again.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::{Building, files, run};
use std::{
    collections::BTreeMap,
    fs,
    io::{BufRead, BufReader, Read},
    path::PathBuf,
    process::{Command, Output, Stdio},
    thread,
    time::Duration,
};

/// Every file of a run folder except the lock.
fn contents(building: &Building, run: &str) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = files(&building.path(run));
    files.remove(&PathBuf::from("run.lock"));
    files
}

/// Starts a long run, sends it a signal once it has begun, and waits for its end.
fn interrupted(building: &Building, run: &str, args: &[&str], signal: &str) -> Output {
    let all = [&["generate", "--out", run][..], args].concat();
    let child = building.command(&all).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    while fs::metadata(building.path(run).join("walks.jsonl")).map_or(0, |file| file.len()) == 0 {
        thread::sleep(Duration::from_millis(1));
    }
    Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    child.wait_with_output().unwrap()
}

#[test]
fn an_interrupt_without_models_has_a_code_of_its_own_and_loses_nothing() {
    let building = Building::new();
    let args = ["--platform", "matterport", "--data", "data", "--paths", "1200", "--hops", "3..7", "--style", "r2r"];
    assert_eq!(building.wayword(&[&["generate", "--out", "whole"][..], &args].concat()).code, Some(0));
    for signal in ["-INT", "-TERM"] {
        let run = format!("run{signal}");
        let output = interrupted(&building, &run, &args, signal);
        let told = String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(6), "{signal}: {told}");
        assert!(told.contains("interrupted") && told.contains("give the same command again"), "{signal}: {told}");
        assert_eq!(building.wayword(&[&["generate", "--out", &run][..], &args].concat()).code, Some(0));
        assert!(contents(&building, &run) == contents(&building, "whole"), "{signal}");
    }
}

#[test]
fn an_interrupt_ends_a_command_without_a_folder_with_the_same_code() {
    // It waits for a build of ThreeDWorld, which never connects.
    let building = Building::new();
    let args =
        ["view", "map", "--platform", "tdw", "--at", "127.0.0.1:0", "--scan", "floorplan_1a", "--out", "map.svg"];
    let mut child = building.command(&args).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let mut told = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    told.read_line(&mut line).unwrap();
    assert!(line.contains("waiting"), "{line}");
    Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap();
    let mut rest = String::new();
    told.read_to_string(&mut rest).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(6), "{rest}");
    assert!(rest.contains("give the same command again"), "{rest}");
}

#[test]
fn what_the_world_lacks_is_an_error_and_no_rejection_and_is_tried_again() {
    let building = Building::new();
    let args = ["--episodes", crate::common::EPISODES, "--style", "r2r"];
    assert_eq!(building.generate("whole", &args).code, Some(0));
    let graph = format!("matterport/connectivity/{}_connectivity.json", wayword_testkit::SCAN);
    let (graph, away) = (building.data().join(graph), building.path("away.json"));
    fs::rename(&graph, &away).unwrap();
    let ran = building.generate("run", &args);
    assert_eq!(ran.code, Some(1), "all lack the same: {ran:?}");
    let errors = building.lines("run/errors.jsonl");
    assert!(errors.len() == 5 && errors.iter().all(|line| line["failure"] == "missing"), "{errors:?}");
    assert!(building.lines("run/rejected.jsonl").is_empty());
    fs::rename(&away, &graph).unwrap();
    assert_eq!(building.generate("run", &args).code, Some(0));
    assert!(contents(&building, "run") == contents(&building, "whole"));
}

#[test]
fn a_run_can_be_asked_for_more_paths_and_items_and_for_no_fewer() {
    let building = Building::new();
    let paths = |number: &'static str| ["--paths", number, "--hops", "3..7", "--seed", "3", "--style", "r2r"];
    assert_eq!(building.generate("run", &paths("6")).code, Some(0));
    let first = fs::read(building.path("run/instructions.jsonl")).unwrap();
    assert_eq!(building.generate("run", &paths("10")).code, Some(0));
    let more = fs::read(building.path("run/instructions.jsonl")).unwrap();
    assert!(more.starts_with(&first) && building.records("run").len() == 10);
    assert_eq!(building.generate("run", &paths("10")).code, Some(0), "the raised command goes on");
    assert!(building.generate("run", &paths("6")).refused().contains("holds a run of 10 paths, but 6 are asked for"));

    let limit = |number: &'static str| ["--episodes", crate::common::EPISODES, "--style", "r2r", "--limit", number];
    assert_eq!(building.generate("limited", &limit("1")).code, Some(0));
    assert_eq!(building.generate("limited", &limit("2")).code, Some(0));
    assert_eq!(building.records("limited").len(), 2);
    assert_eq!(building.generate("limited", &["--episodes", crate::common::EPISODES, "--style", "r2r"]).code, Some(0));
    assert!(building.generate("limited", &limit("1")).refused().contains("limit"));
}

#[test]
fn a_finished_run_notices_a_torn_or_deleted_walk() {
    let building = Building::new();
    let args = ["--paths", "8", "--hops", "3..7", "--seed", "3", "--style", "r2r"];
    assert_eq!(building.generate("run", &args).code, Some(0));
    let whole = contents(&building, "run");
    let walks = building.path("run/walks.jsonl");
    let bytes = fs::read(&walks).unwrap();
    let first_line = bytes.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    for (what, left) in
        [("torn", &bytes[..bytes.len() - 20]), ("without its first line", &bytes[first_line..]), ("empty", &[])]
    {
        fs::write(&walks, left).unwrap();
        assert_eq!(building.generate("run", &args).code, Some(0), "{what}");
        assert!(contents(&building, "run") == whole, "{what}");
    }
}

#[test]
fn a_finished_run_notices_deleted_pictures() {
    let building = Building::new();
    let generate = || building.wayword(&["generate", "--paths", "1", "--style", "r2r", "--out", "run"]);
    assert_eq!(generate().code, Some(0));
    let whole = contents(&building, "run");
    let frames: Vec<PathBuf> = files(&building.path("run/frames")).into_keys().collect();
    fs::remove_file(building.path("run/frames").join(&frames[1])).unwrap();
    assert_eq!(generate().code, Some(0));
    assert!(contents(&building, "run") == whole);
    fs::remove_dir_all(building.path("run/frames")).unwrap();
    assert_eq!(generate().code, Some(0));
    assert!(contents(&building, "run") == whole);
}

#[test]
fn a_run_is_not_continued_in_a_world_that_has_changed() {
    let building = Building::new();
    let args = ["--episodes", crate::common::EPISODES, "--style", "r2r"];
    let limited = [&args[..], &["--limit", "1"]].concat();
    assert_eq!(building.generate("run", &limited).code, Some(0));
    let walk = &building.lines("run/walks.jsonl")[0];
    let scene = walk["path"]["scene"].as_str().unwrap();
    assert!(fs::read_to_string(building.path("run/data.json")).unwrap().contains(scene));
    let graph = building.data().join(format!("matterport/connectivity/{scene}_connectivity.json"));
    let before = fs::read_to_string(&graph).unwrap();
    fs::write(&graph, before.clone() + "\n").unwrap();
    let ran = building.generate("run", &args);
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(ran.err.contains(scene) && ran.err.contains("put the old files back"), "{ran:?}");
    fs::write(&graph, before).unwrap();
    assert_eq!(building.generate("run", &args).code, Some(0));
}

#[test]
fn a_lack_that_all_items_share_ends_the_run_early() {
    let building = Building::new();
    wayword_testkit::write_skyboxes(&building.data()).unwrap();
    // There are only graphs and photographs, so a model would have to see.
    for known in ["reverie", "matterport/v1/scans/madeUpHouse/house_segmentations"] {
        let _ = fs::remove_dir_all(building.data().join(known));
    }
    let ran = building.generate("run", &["--paths", "40", "--hops", "2..7", "--style", "r2r"]);
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(ran.out.contains("failed for the same reason"), "{ran:?}");
    assert_eq!(building.lines("run/errors.jsonl").len(), 5);
}

/// The system signals a program that writes beyond the user's limit; that must not end it without a word.
#[test]
fn a_file_beyond_the_size_limit_is_an_error_of_its_write() {
    let building = Building::new();
    building.run_over_episodes("run");
    let args = "export --run run --style r2r --format r2r --out large.json";
    let mut shell = Command::new("sh");
    shell.arg("-c").arg(format!("ulimit -f 1; exec '{}' {args}", env!("CARGO_BIN_EXE_wayword")));
    let ran = run(shell.current_dir(building.path("")));
    assert_eq!(ran.code, Some(7), "{ran:?}");
    assert!(ran.err.contains("large.json: cannot write it"), "{ran:?}");
    assert!(!building.path("large.json").exists());
}

#[test]
fn the_record_of_a_run_is_no_settings_file() {
    let building = Building::new();
    building.run_over_episodes("run");
    let said = building.generate("again", &["--config", "run/config.toml"]);
    assert!(said.refused().contains("records the settings of a run"), "{said:?}");
}
