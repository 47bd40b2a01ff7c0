//! Places that outputs go to: pipes, devices, links, full disks, and what is shown of addresses and hidden characters.

#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{Building, Ran, files, run};
use std::{
    fs,
    os::unix::fs::{FileTypeExt, symlink},
    process::{Command, Stdio},
    time::{Duration, Instant},
};

const EXPORT: [&str; 6] = ["export", "--run", "run", "--format", "wayword", "--out"];
const REPORT: [&str; 4] = ["report", "--run", "run", "--out"];

fn with_run() -> Building {
    let building = Building::new();
    building.run_over_episodes("run");
    building
}

fn to(building: &Building, command: &[&str], out: &str) -> Ran {
    building.wayword(&[command, &[out]].concat())
}

/// What was left in the folder of a command, beside the names that are expected.
fn names(building: &Building) -> Vec<String> {
    let entries = fs::read_dir(building.path(".")).unwrap();
    let mut names: Vec<String> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_full_device_is_code_7_and_stays_a_device() {
    let building = with_run();
    let before = names(&building);
    let parquet = ["export", "--run", "run", "--format", "parquet", "--out"];
    let r2r = ["export", "--run", "run", "--format", "r2r", "--style", "r2r", "--out"];
    for command in [&EXPORT[..], &r2r, &parquet, &REPORT] {
        let ran = to(&building, command, "/dev/full");
        assert_eq!(ran.code, Some(7), "{command:?}: {ran:?}");
        assert!(ran.err.contains("free some space") && ran.out.is_empty(), "{command:?}: {ran:?}");
    }
    assert!(fs::metadata("/dev/full").unwrap().file_type().is_char_device());
    symlink("/dev/full", building.path("full.svg")).unwrap();
    let ran = building.wayword(&["view", "map", "--out", "full.svg"]);
    assert_eq!(ran.code, Some(7), "{ran:?}");
    fs::remove_file(building.path("full.svg")).unwrap();
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let status = building.command(&["check", "run/instructions.jsonl", "--run", "run"]).stdout(full).status();
    assert_eq!(status.unwrap().code(), Some(7));
    assert_eq!(names(&building), before);
}

#[test]
fn standard_output_carries_the_data_and_nothing_else() {
    let building = with_run();
    // Beside a file a report has a folder of pictures, beside a stream it has none.
    let report = ["report", "--run", "run", "--single-file", "--out"];
    for command in [&EXPORT[..], &report] {
        assert_eq!(to(&building, command, "deep/er/file").code, Some(0));
        let whole = fs::read_to_string(building.path("deep/er/file")).unwrap();
        for name in ["-", "/dev/stdout", "/dev/fd/1"] {
            let ran = to(&building, command, name);
            assert_eq!((ran.code, &ran.out), (Some(0), &whole), "{name}: {}", ran.err);
            let ran = to(&building, &[&["--json"], command].concat(), name);
            assert_eq!((ran.code, &ran.out), (Some(0), &whole), "{name}: {}", ran.err);
        }
        fs::remove_dir_all(building.path("deep")).unwrap();
    }
    // A file that a shell opened keeps what is in it.
    fs::write(building.path("log"), "before\n").unwrap();
    let log = fs::File::options().append(true).open(building.path("log")).unwrap();
    let all: Vec<&str> = [&EXPORT[..], &["-"]].concat();
    assert!(building.command(&all).stdout(log).status().unwrap().success());
    let kept = fs::read_to_string(building.path("log")).unwrap();
    assert!(kept.starts_with("before\n{") && kept.ends_with("}\n"), "{kept:.60}");
    for folder in
        [&["export", "--run", "run", "--format", "hf", "--i-have-the-right", "--out", "-"][..], &["demo", "--out", "-"]]
    {
        let ran = building.wayword(folder);
        assert!(ran.code == Some(1) && ran.err.contains("takes only one") && !building.path("-").exists(), "{ran:?}");
    }
}

#[test]
fn a_pipe_without_a_reader_is_given_up_and_an_odd_place_is_refused() {
    let building = with_run();
    let pipe = building.path("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let socket = building.path("socket");
    let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
    let begun = Instant::now();
    assert!(to(&building, &EXPORT, "pipe").refused().contains("no program has opened this pipe"));
    assert!(begun.elapsed() < Duration::from_secs(60));
    assert!(fs::metadata(&pipe).unwrap().file_type().is_fifo());
    for place in ["data", "socket", "run/", "run/config.toml/x"] {
        let ran = to(&building, &EXPORT, place);
        assert!(
            ["is a folder", "is a socket", "that of a folder", "is no folder"]
                .iter()
                .any(|why| ran.refused().contains(why)),
            "{place}: {ran:?}"
        );
    }
    assert!(fs::metadata(&socket).unwrap().file_type().is_socket());
    let models = ["--see", "openai/x", "--write", "openai/x"];
    for ledger in ["pipe", "data", "/dev/null", "socket"] {
        let ran = building.wayword(&["ledger", "--ledger", ledger, "show"]);
        assert!(ran.refused().contains("not a file"), "{ledger}: {ran:?}");
        let mut command = building.command(&[&["generate", "--out", "new", "--ledger", ledger], &models[..]].concat());
        let ran = run(command.env("OPENAI_API_KEY", "none"));
        assert!(ran.refused().contains("not a file"), "{ledger}: {ran:?}");
    }
    for out in ["pipe", "run/config.toml", "/dev/null"] {
        let ran = building.generate(out, &["--paths", "1"]);
        assert!(ran.refused().contains("cannot make the folder"), "{out}: {ran:?}");
    }
}

#[test]
fn a_link_stays_and_only_a_file_that_was_replaced_is_told_so() {
    let building = with_run();
    symlink("real.jsonl", building.path("link")).unwrap();
    assert!(!to(&building, &EXPORT, "link").err.contains("replaced"));
    let ran = to(&building, &EXPORT, "link");
    assert!(ran.code == Some(0) && ran.err.contains("replaced the old file link"), "{ran:?}");
    assert!(fs::symlink_metadata(building.path("link")).unwrap().is_symlink());
    assert!(fs::symlink_metadata(building.path("real.jsonl")).unwrap().is_file());
    fs::remove_dir_all(building.path("run")).unwrap();
    assert!(!to(&building, &EXPORT, "link").err.contains("replaced"));
}

#[test]
fn a_file_beyond_the_users_limit_is_code_7_and_says_so() {
    let building = with_run();
    let before = names(&building);
    for command in [&EXPORT[..], &REPORT] {
        let shell = format!("ulimit -f 1; exec \"$0\" {} big", command.join(" "));
        let mut limited = Command::new("bash");
        limited
            .args(["-c", &shell, env!("CARGO_BIN_EXE_wayword")])
            .current_dir(building.path("."))
            .stdin(Stdio::null());
        let ran = run(&mut limited);
        assert!(ran.code == Some(7) && ran.err.contains("ulimit -f"), "{ran:?}");
    }
    assert_eq!(names(&building), before);
}

#[test]
fn a_published_folder_that_was_killed_half_way_is_made_again() {
    let building = with_run();
    let publish = ["export", "--run", "run", "--format", "hf", "--i-have-the-right", "--out"];
    assert_eq!(to(&building, &publish, "whole").code, Some(0));
    fs::create_dir_all(building.path("half/.unfinished/data")).unwrap();
    fs::create_dir_all(building.path("half/data")).unwrap();
    fs::write(building.path("half/data/old.parquet"), "half").unwrap();
    fs::write(building.path("half/.unfinished/README.md"), "half").unwrap();
    assert_eq!(to(&building, &publish, "half").code, Some(0));
    let [whole, half] = ["whole", "half"].map(|folder| files(&building.path(folder)));
    assert_eq!(half.keys().collect::<Vec<_>>(), whole.keys().collect::<Vec<_>>());
    let ran = to(&building, &publish, "whole");
    assert!(ran.refused().contains("the folder has files"), "{ran:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_terminal_that_is_gone_ends_a_run_like_sigterm_unless_it_is_ignored() {
    let building = Building::new();
    let begin = |out: &str, program: &[&str]| {
        let mut all: Vec<&str> = program.to_vec();
        all.extend([env!("CARGO_BIN_EXE_wayword"), "generate", "--paths", "400", "--out", out]);
        let mut command = Command::new(all[0]);
        command.args(&all[1..]).current_dir(building.path(".")).stdin(Stdio::null());
        let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        let lines = building.path(out).join("instructions.jsonl");
        let begun = Instant::now();
        while fs::metadata(&lines).map_or(0, |about| about.len()) == 0 && begun.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(5));
        }
        assert!(Command::new("kill").args(["-HUP", &child.id().to_string()]).status().unwrap().success());
        child
    };
    // The test itself may run where the signal is ignored.
    assert_eq!(begin("hung", &["env", "--default-signal=HUP"]).wait().unwrap().code(), Some(6));
    assert!(!building.records("hung").is_empty());
    let mut ignoring = begin("kept", &["nohup"]);
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(ignoring.try_wait().unwrap(), None);
    assert!(Command::new("kill").arg(ignoring.id().to_string()).status().unwrap().success());
    assert_eq!(ignoring.wait().unwrap().code(), Some(6));
}

#[test]
fn a_secret_in_an_address_is_never_repeated() {
    let building = with_run();
    let web = "https://me:geheim@host.invalid/x?api_key=geheim";
    for args in [
        &["check", web, "--run", "run"][..],
        &["check", "run/instructions.jsonl", "--platform", "matterport", "--data", web],
        &["--json", "report", "--run", web],
        &["generate", "--platform", "virtualhome", "--at", "http://me:geheim@127.0.0.1:9", "--out", "new"],
        &["generate", "--episodes", web, "--out", "new"],
        &["generate", "--out", web],
        &["generate", "--paths", web, "--out", "new"],
        &["generate", "--see", "openai/x", "--base-url", web, "--out", "new"],
        &["runs", "status", "postgres://me:geheim@host/db"],
        &["launch", "slurm", "--", "generate", "--out", "x", "--episodes", web],
        &["study", "status", web],
        &["models", "fetch", web],
    ] {
        let ran = run(building.command(args).env("OPENAI_API_KEY", "none"));
        assert!(ran.code != Some(0) && !format!("{ran:?}").contains("geheim"), "{args:?}: {ran:?}");
    }
    assert!(!building.path("new").exists());
}

#[test]
fn hidden_characters_are_shown_on_the_screen_and_on_pages_and_kept_in_data() {
    let building = with_run();
    let file = building.path("run/instructions.jsonl");
    let lines = fs::read_to_string(&file).unwrap().replacen("\"text\":\"", "\"text\":\"\u{202e}\u{200b}hidden. ", 1);
    assert!(lines.contains('\u{202e}'));
    fs::write(&file, lines).unwrap();
    let ran = to(&building, &REPORT, "page.html");
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let page = fs::read_to_string(building.path("page.html")).unwrap();
    assert!(page.contains("\\u{202e}\\u{200b}") && !page.contains(['\u{202e}', '\u{200b}']));
    let ran = building.wayword(&["check", "run/instructions.jsonl", "--platform", "matterport", "--data", "data"]);
    assert!(ran.out.contains("\\u{202e}\\u{200b}hidden") && !ran.out.contains('\u{202e}'), "{ran:?}");
    assert!(to(&building, &EXPORT, "-").out.contains("\u{202e}\u{200b}hidden"));
    let ran = building.wayword(&["report", "--run", "no\u{202e}where"]);
    assert!(ran.refused().contains("no\\u{202e}where"), "{ran:?}");
}
