//! The command line itself: help, exit codes, completions, the demo, and the errors for wrong input.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::{Building, EPISODES, command, files, run};
use serde_json::{Value, json};
use std::fs;

const COMMANDS: [&str; 8] = ["demo", "generate", "check", "export", "report", "similarity", "models", "house"];

#[test]
fn the_help_of_every_command_has_examples_that_name_it() {
    for name in COMMANDS {
        let ran = run(&mut command(&[name, "--help"]));
        assert_eq!((ran.code, ran.err.as_str()), (Some(0), ""));
        let (_, examples) = ran.out.split_once("Examples:").unwrap_or_else(|| panic!("{name}: {}", ran.out));
        assert!(examples.contains(&format!("wayword {name}")), "{examples}");
    }
    let ran = run(&mut command(&["--help"]));
    assert!(COMMANDS.iter().all(|name| ran.out.contains(name)) && ran.out.contains("Examples:"), "{}", ran.out);
}

#[test]
fn the_examples_of_the_help_are_command_lines_that_can_be_read() {
    use clap::{CommandFactory, Parser};
    use wayword::cli::WaywordCli;
    for name in COMMANDS {
        // Unwrapped, because a narrow terminal would break the lines.
        let told = WaywordCli::command().find_subcommand(name).unwrap().get_after_long_help().unwrap().to_string();
        let lines: Vec<&str> = told.lines().map(str::trim).filter(|line| line.starts_with("wayword ")).collect();
        assert!(!lines.is_empty());
        for line in lines {
            let words = line.split("  ").next().unwrap().split(' ');
            assert!(WaywordCli::try_parse_from(words).is_ok(), "{line}");
        }
    }
}

#[test]
fn exit_codes_are_as_the_help_lists_them() {
    let help = run(&mut command(&["--help"])).out;
    let codes = help.split_once("Exit codes:").unwrap().1;
    for code in 0..=4 {
        assert!(codes.lines().any(|line| line.trim().starts_with(&format!("{code}  "))), "{codes}");
    }
    // The tests of generate and check cover the codes 0, 3 and 4.
    assert_eq!(run(&mut command(&["generate"])).code, Some(2));
    assert_eq!(run(&mut command(&["generate", "--out", "x", "--frames", "sideways"])).code, Some(2));
    assert_eq!(run(&mut command(&["no-such-command"])).code, Some(2));
    assert_eq!(run(&mut command(&["export", "--run", "/nowhere", "--format", "wayword", "--out", "x"])).code, Some(1));
}

#[test]
fn completions_know_the_commands_and_flags() {
    for shell in ["bash", "zsh", "fish"] {
        let ran = run(&mut command(&["completions", shell]));
        assert_eq!((ran.code, ran.err.as_str()), (Some(0), ""));
        assert!(COMMANDS.iter().all(|name| ran.out.contains(name)) && ran.out.contains("val-share"), "{shell}");
    }
}

#[test]
fn the_demo_shows_a_walk_with_both_instructions_and_writes_its_report() {
    let folder = tempfile::tempdir().unwrap();
    let ran = run(command(&["demo"]).current_dir(folder.path()));
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let told: Vec<Value> = fs::read_to_string(folder.path().join("wayword-demo/instructions.jsonl"))
        .unwrap()
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert_eq!(told.len(), 2);
    let page = fs::read_to_string(folder.path().join("wayword-demo/report.html")).unwrap();
    for record in &told {
        let text = record["text"].as_str().unwrap();
        assert_eq!(record["verdict"], "pass", "{text}");
        assert!(ran.out.contains(text), "{}", ran.out);
        let last_word = text.trim_end_matches('.').rsplit(' ').next().unwrap();
        assert!(page.contains(last_word), "{last_word}");
    }
    assert!(ran.out.contains("No model took part") && ran.out.contains("report.html"), "{}", ran.out);
    assert!(page.contains("src=\"report-files/") && page.contains("<svg"), "pictures and a map");
    assert!(!page.contains("http://") || !page.contains("src=\"http"), "nothing is fetched");

    // The same command succeeds when no work is left.
    let again = run(command(&["demo", "--json"]).current_dir(folder.path())).json();
    assert_eq!(again["records"].as_array().unwrap().len(), 2, "{again}");
}

#[test]
fn report_is_written_for_a_run_and_refused_for_other_folders() {
    let building = Building::new();
    building.run_over_episodes("run");
    let ran = building.wayword(&["report", "--run", "run", "--items", "3", "--json"]);
    let written = ran.json();
    assert_eq!((&written["items"], &written["left_out"]), (&3.into(), &7.into()), "{written}");
    assert!(building.path("run/report.html").is_file());
    let before = files(&building.path("."));
    for (given, told) in [
        ("data", ["--run data: it is not a run folder", "`wayword generate`"]),
        ("nowhere", ["--run nowhere: there is no such folder", "`wayword compare`"]),
        ("run/walks.jsonl", ["it is a file", "--run run"]),
        (".", ["it is not a run folder", "--run ./run"]),
    ] {
        let ran = building.wayword(&["report", "--run", given]);
        assert!(told.iter().all(|told| ran.refused().contains(told)), "{ran:?}");
    }
    assert!(files(&building.path(".")) == before);
}

#[test]
fn a_house_is_saved_with_its_navigation_data() {
    let building = Building::new();
    let ran = building.wayword(&["house", "--seed", "2", "--paths", "0", "--out", "houses"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(fs::read(building.path("houses/house2-2/house2-2.glb")).unwrap().starts_with(b"glTF"));
    let navigation = fs::read(building.path("houses/house2-2/house2-2.navigation.json")).unwrap();
    assert!(serde_json::from_slice::<Value>(&navigation).unwrap().is_object());
}

/// Runs a command that has to be refused, and checks that it left no file behind.
fn refused(building: &Building, arguments: &[&str]) -> String {
    let before = files(&building.path("."));
    let ran = building.wayword(arguments);
    let error = ran.refused().to_owned();
    assert!(files(&building.path(".")) == before, "{arguments:?} left something behind");
    assert!(!building.path("run").exists(), "{arguments:?} made its run folder");
    error
}

#[test]
fn wrong_flags_are_refused_with_what_is_wrong_and_what_to_do() {
    let building = Building::new();
    let matterport = ["--platform", "matterport", "--data", "data"];
    building.write("wrong.toml", "platform = \"matterprot\"");
    let cases: [(&[&str], &[&str]); 18] = [
        (&["--platform", "matterport"], &["--data", "connectivity"]),
        (&["--platform", "matterport", "--data", "nowhere"], &["nowhere", "--data"]),
        (&["--platform", "matterport", "--data", "data/r2r"], &["data/r2r", "connectivity"]),
        (&["--style", "none.toml"], &["none.toml"]),
        (&["--style", "x=none.json"], &["none.json"]),
        (&["--style", "r2r", "--style", "r2r"], &["r2r", "once"]),
        (&["--hops", "7..4"], &["--hops 7..4", "4..7"]),
        (&["--hops", "four"], &["--hops four"]),
        (&["--hops=-1..3"], &["--hops -1..3"]),
        (&["--metres", "NaN..3"], &["--metres NaN..3"]),
        (&["--paths", "2000000"], &["2000000", "1000000"]),
        (&["--episodes", EPISODES, "--paths", "3"], &["--episodes", "--paths", "cannot be combined"]),
        (&["--episodes", "nowhere.json"], &["nowhere.json"]),
        (&["--config", "nowhere.toml"], &["nowhere.toml"]),
        (&["--config", "wrong.toml"], &["\"matterprot\"; did you mean \"matterport\"?", "house, matterport"]),
        (&["--paths", "0"], &["--paths 0 asks for no path", "leave the flag out"]),
        (&["--episodes", EPISODES, "--paths", "0"], &["--paths 0"]),
        (&["--limit", "0"], &["--limit 0 leaves no item", "leave the flag out"]),
    ];
    for (arguments, told) in cases {
        let is_whole = arguments.iter().any(|argument| ["--platform", "wrong.toml"].contains(argument));
        let base: &[&str] = if is_whole { &[] } else { &matterport };
        let error = refused(&building, &[&["generate", "--out", "run"], base, arguments].concat());
        assert!(told.iter().all(|words| error.contains(words)), "{arguments:?}: {error}");
    }
    let error = refused(
        &building,
        &["generate", "--out", "run", "--platform", "matterport", "--data", "data", "--scan", "elsewhere"],
    );
    assert!(error.contains("elsewhere"), "{error}");
    let error = refused(&building, &["check", EPISODES, "--platform", "matterport"]);
    assert!(error.contains("--data"), "{error}");
    let error = refused(&building, &["check", "data/r2r", "--platform", "matterport", "--data", "data"]);
    assert!(error.contains("data/r2r"), "{error}");
}

/// The program refuses a pipe, which has no end, and a name that is not UTF-8. The error names which of the two it is.
#[cfg(target_os = "linux")]
#[test]
fn a_pipe_for_a_dataset_and_a_name_that_is_no_text_are_refused() {
    use std::os::unix::ffi::OsStrExt;
    let building = Building::new();
    let pipe = building.path("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let matterport = ["--platform", "matterport", "--data", "data"];
    for command in [
        &["generate", "--out", "run", "--episodes", "pipe"][..],
        &["generate", "--out", "run", "--config", "pipe", "--episodes", EPISODES],
        &["generate", "--out", "run", "--style", "mine=pipe"],
        &["compare", "--out", "run", "--episodes", "pipe"],
        &["check", "pipe"],
    ] {
        let ran = building.wayword(&[command, &matterport].concat());
        assert!(ran.refused().contains("a pipe or a device"), "{command:?}: {ran:?}");
    }
    let named = std::ffi::OsStr::from_bytes(b"da\xffta");
    fs::rename(building.data(), building.path(".").join(named)).unwrap();
    let ran = run(building.command(&["generate", "--platform", "matterport", "--out", "run"]).arg("--data").arg(named));
    assert!(ran.refused().contains("not valid UTF-8") && !ran.err.contains("bug"), "{ran:?}");
    assert!(!building.path("run").exists());
}

/// The episodes, with the second one changed by `spoil`.
fn broken(building: &Building, spoil: impl Fn(&mut Value)) -> &'static str {
    let mut items: Value = serde_json::from_slice(&fs::read(building.reverie()).unwrap()).unwrap();
    spoil(&mut items[1]);
    building.write("broken.json", items.to_string());
    "broken.json"
}

#[test]
fn a_broken_episodes_file_is_refused_with_file_item_and_field() {
    let building = Building::new();
    let cases: [(&str, Value); 8] = [
        ("heading", json!("north")),
        ("heading", json!(null)),
        ("path", json!([])),
        ("path[0]", json!(["../../etc/passwd"])),
        ("scan", json!("../../x")),
        ("instructions", json!("go")),
        ("objId", json!({"id": 3})),
        ("id", json!("../../x")),
    ];
    for (field, value) in cases {
        let key = field.trim_end_matches("[0]");
        let file = broken(&building, |item| item[key] = value.clone());
        for arguments in
            [["generate", "--out", "run", "--episodes", file], ["check", file, "--style", "reverie", "--quiet"]]
        {
            let error = refused(&building, &[&arguments[..], &["--platform", "matterport", "--data", "data"]].concat());
            let told = error.contains("broken.json")
                && error.contains("item 1")
                && error.contains(&format!("field \"{field}\""));
            assert!(told, "{field} = {value}: {error}");
        }
    }
}

#[test]
fn names_that_could_leave_the_run_folder_are_refused() {
    let building = Building::new();
    for name in ["../../x", "a/b", "..", "/etc/passwd", "a\\b", "line\nbreak"] {
        let file = broken(&building, |item| item["id"] = name.into());
        let error = refused(
            &building,
            &["generate", "--out", "run", "--episodes", file, "--platform", "matterport", "--data", "data"],
        );
        assert!(error.lines().next().unwrap().contains("name") || error.contains("id"), "{name:?}: {error}");
    }
    let twice = broken(&building, |item| item["id"] = "100_27".into());
    let error = refused(
        &building,
        &["generate", "--out", "run", "--episodes", twice, "--platform", "matterport", "--data", "data"],
    );
    assert!(error.contains("100_27"), "{error}");
}

#[test]
fn an_episode_that_does_not_fit_the_building_costs_that_item_alone() {
    let building = Building::new();
    let file = broken(&building, |item| item["path"] = json!([wayword_testkit::viewpoint_id(0), "0123456789abcdef"]));
    let ran = building.generate("run", &["--episodes", file, "--style", "r2r"]);
    assert_eq!(ran.code, Some(3), "{ran:?}");
    let errors = building.lines("run/errors.jsonl");
    assert_eq!((errors.len(), building.lines("run/rejected.jsonl").len(), building.records("run").len()), (1, 0, 9));
    assert!(errors[0]["reason"].as_str().unwrap().contains("0123456789abcdef"), "{}", errors[0]);
}

#[test]
fn a_reader_that_has_gone_away_is_no_error() {
    let building = Building::new();
    building.run_over_episodes("run");
    for arguments in [
        &["completions", "bash"][..],
        &["report", "--run", "run"],
        &["check", EPISODES, "--platform", "matterport", "--data", "data"],
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = building.command(arguments).stdout(writer).output().unwrap();
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(matches!(output.status.code(), Some(0 | 3)) && !told.contains("panicked"), "{arguments:?}: {told}");
    }
}

#[test]
fn values_that_no_flag_can_have_are_exit_code_2_and_name_what_was_meant() {
    let cases: [(&[&str], &[&str]); 12] = [
        (&["generate", "--out", "x", "--platform", "hause"], &["--platform", "'house'"]),
        (&["generate", "--out", "x", "--platform", "moon"], &["house, matterport", "virtualhome"]),
        (&["view", "map", "--out", "x.svg", "--platform", "habitad"], &["'habitat'"]),
        (&["generate", "--out", "x", "--style", "revery"], &["--style", "did you mean \"reverie\"?"]),
        (&["generate", "--out", "x", "--style", "poem"], &["r2r, reverie", ".toml", "NAME=DATASET"]),
        (&["check", "x.json", "--style", "r3r"], &["did you mean \"r2r\"?"]),
        (&["export", "--run", "x", "--out", "y", "--format", "revere"], &["--format", "'reverie'"]),
        (&["export", "--run", "x", "--out", "y", "--format", "csv"], &["r2r, reverie, rxr, vlnce, wayword"]),
        (&["compare", "--episodes", "e", "--out", "x", "--agents", "clip_nav"], &["--agents", "'clip-nav'"]),
        (&["compare", "--episodes", "e", "--out", "x", "--agents", "clip-nav,flip-nav"], &["flip-nav", "glip-nav"]),
        (&["compare", "--episodes", "e", "--out", "x", "--split", "foo"], &["--split", "as in --split ollama/qwen3"]),
        (&["compare", "--episodes", "e", "--out", "x", "--split", "/qwen"], &["name rules", "provider/model"]),
    ];
    for (arguments, told) in cases {
        let ran = run(&mut command(arguments));
        assert_eq!(ran.code, Some(2), "{arguments:?}: {ran:?}");
        assert!(told.iter().all(|told| ran.err.contains(told)), "{arguments:?}: {}", ran.err);
        assert!(!ran.err.contains("--ask"), "{}", ran.err);
    }
}

#[test]
fn run_over_buildings_without_boxes_warns_with_a_hint() {
    let building = Building::new();
    let scan = wayword_testkit::SCAN;
    fs::remove_file(building.path(&format!("data/matterport/v1/scans/{scan}/house_segmentations/{scan}.house")))
        .unwrap();
    let matterport = |data: &str| {
        let world = ["generate", "--platform", "matterport", "--data", data, "--paths", "1", "--dry-run"];
        let ran = building.wayword(&world);
        assert_eq!(ran.code, Some(0), "{ran:?}");
        ran.err
    };
    let told = matterport("data/matterport");
    assert!(told.contains("warning: data/matterport: there are no REVERIE boxes (looked for "), "{told}");
    assert!(told.contains("hint: give the folder above it") && told.contains("/data\n"), "{told}");
    assert_eq!(matterport("data"), "");
}
