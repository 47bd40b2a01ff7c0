//! What happens if a world program misbehaves.

use super::{actor, look, options, pid, started};
use std::{path::Path, sync::Arc, time::Duration};
use wayword_core::{Platform, PlatformError};
use wayword_platforms::{ProcessPlatform, process::ProcessOptions};

fn patient_for(role: &str, answer_within: Duration) -> ProcessPlatform {
    let options = ProcessOptions { answer_within, ..options(role, Path::new("/nowhere")) };
    ProcessPlatform::start(options, Arc::new(|_: &str| ())).unwrap()
}

#[test]
fn a_fault_costs_its_own_request_and_a_fresh_child_answers_the_next() {
    let long = Duration::from_secs(60);
    let short = Duration::from_secs(4);
    for (role, within, says) in [
        ("dies", long, "died (exit status: 3)"),
        ("aborts", long, "died (signal: 6"),
        ("hangs", short, "did not answer within 4 s"),
        ("floods", long, "line of more than 50331648 bytes"),
        ("floods lines", long, "answered request 0 when it was asked request 3"),
        ("prints", long, "not an answer (expected value at line 1 column 1): \"Loading textures...\""),
        ("half", long, "half a line"),
        ("wrong id", long, "answered request 4 when it was asked request 3"),
    ] {
        let platform = patient_for(role, within);
        let before = pid(&look(&platform, "good").unwrap());
        let error = look(&platform, "bad").unwrap_err().to_string();
        assert!(error.contains(says) && error.contains("request 3 (`observe`)"), "{role}: {error}");
        let (_, last_words) = error.split_once("its last error output: ").unwrap();
        assert!(last_words.contains(&format!("about to do something: [31m{role}")), "{role}: {error}");
        let after = pid(&look(&platform, "good").unwrap());
        assert_ne!(before, after, "{role}: the faulty child still answers");
    }
}

#[test]
fn a_child_that_ends_its_output_and_lives_on_is_killed() {
    // Not the actor: its output stays open until every copy of its descriptor 3 is closed.
    let greeting = r#"{"id":1,"result":{"protocol":1,"frame":"z-up, metres, radians clockwise from +y","name":"x","offers":["graph","labels"]}}"#;
    let script = format!("read line; echo '{greeting}'; read line; echo tired >&2; exec >&-; sleep 1000");
    let options = ProcessOptions { arguments: vec!["-c".into(), script], ..ProcessOptions::new("sh") };
    let platform = ProcessPlatform::start(options, Arc::new(|_: &str| ())).unwrap();
    let error = platform.list_scenes().unwrap_err().to_string();
    assert!(
        error.contains("closed its standard output, but is still running; its last error output: tired"),
        "{error}"
    );
}

#[test]
fn an_answer_that_cannot_be_used_is_an_error_and_the_child_lives_on() {
    for (role, says) in [
        ("refuses", "refused the request: the floor islava"),
        ("blind", "no `image`"),
        ("unlabelled", "no `labels`"),
        ("wrong shape", "missing field `object`"),
        ("other size", "33 x 24 pixels, expected 32 x 24"),
        ("no picture", "neither PNG nor JPEG"),
    ] {
        let platform = started(role).unwrap();
        let before = pid(&look(&platform, "good").unwrap());
        let error = look(&platform, "bad").unwrap_err().to_string();
        assert!(error.contains(says), "{role}: {error}");
        assert_eq!(before, pid(&look(&platform, "good").unwrap()), "{role}: the child was restarted for nothing");
    }
    let unknown = look(&started("no such scene").unwrap(), "bad").unwrap_err();
    assert!(matches!(unknown, PlatformError::UnknownScene { .. }), "{unknown}");
}

#[test]
fn a_picture_outside_the_folder_is_not_read() {
    let outside = tempfile::tempdir().unwrap();
    std::fs::write(outside.path().join("secret.png"), actor::png(actor::WIDTH_PX, actor::HEIGHT_PX)).unwrap();
    let folder = outside.path().join("images");
    std::fs::create_dir(&folder).unwrap();
    let platform = ProcessPlatform::start(options("escapes", &folder), Arc::new(|_: &str| ())).unwrap();
    let error = look(&platform, "bad").unwrap_err().to_string();
    assert!(error.contains("not a plain path within the folder"), "{error}");
}

#[test]
fn restarts_are_counted_and_come_to_an_end() {
    let options = ProcessOptions { restarts: 2, ..options("dies", Path::new("/nowhere")) };
    let platform = ProcessPlatform::start(options, Arc::new(|_: &str| ())).unwrap();
    for _ in 0..3 {
        let error = look(&platform, "bad").unwrap_err().to_string();
        assert!(error.contains("died (exit status: 3)"), "{error}");
    }
    let error = look(&platform, "good").unwrap_err().to_string();
    assert!(error.contains("not started again") && error.contains("exit status: 3"), "{error}");
}

#[test]
fn many_answers_earn_a_restart_back() {
    let options = ProcessOptions { restarts: 1, ..options("dies", Path::new("/nowhere")) };
    let platform = ProcessPlatform::start(options, Arc::new(|_: &str| ())).unwrap();
    for _ in 0..3 {
        look(&platform, "bad").unwrap_err();
        for _ in 0..210 {
            look(&platform, "good").unwrap();
        }
    }
}

#[test]
fn an_extra_answer_fails_only_the_next_request() {
    let platform = started("twice").unwrap();
    look(&platform, "bad").unwrap();
    let error = look(&platform, "good").unwrap_err().to_string();
    assert!(error.contains("answered request 2 when it was asked request 3"), "{error}");
    look(&platform, "good").unwrap();
}

#[test]
fn a_greeting_that_cannot_be_used_is_refused_at_once() {
    for (role, says) in [
        ("next version", "speaks version 2 of the protocol; Wayword speaks version 1"),
        ("y up", "uses the world frame \"y-up\"; it must be \"z-up"),
        ("sees nothing", "`pictures`, `labels` or both"),
        ("no such folder", "/nowhere/at/all"),
    ] {
        let error = started(role).err().unwrap().to_string();
        assert!(error.contains(says) && error.contains("`hello`"), "{role}: {error}");
    }
    let mute =
        ProcessOptions { start_within: Duration::from_secs(1), ..options("never greets", Path::new("/nowhere")) };
    let error = ProcessPlatform::start(mute, Arc::new(|_: &str| ())).err().unwrap().to_string();
    assert!(error.contains("did not answer within 1 s"), "{error}");
    let missing = ProcessOptions::new("/nowhere/simulator");
    let error = ProcessPlatform::start(missing, Arc::new(|_: &str| ())).err().unwrap().to_string();
    assert!(error.starts_with("/nowhere/simulator: the world program cannot be started: "), "{error}");
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("world.json");
    std::fs::write(&file, r#"{"command": ["/nowhere/simulator"]}"#).unwrap();
    let error =
        ProcessPlatform::start(ProcessOptions::read_world_file(&file).unwrap(), Arc::new(|_: &str| ())).err().unwrap();
    let error = error.to_string();
    let field = ": field \"command\": the world program /nowhere/simulator cannot be started: ";
    assert!(error.starts_with(&format!("{}{field}", file.display())), "{error}");
}

#[test]
fn a_child_that_offers_other_things_after_a_restart_is_not_asked() {
    let folder = tempfile::tempdir().unwrap();
    let options = ProcessOptions { restarts: 2, ..options("changes", folder.path()) };
    let platform = ProcessPlatform::start(options, Arc::new(|_: &str| ())).unwrap();
    look(&platform, "good").unwrap();
    look(&platform, "bad").unwrap_err();
    for says in ["or other `offers` in its greeting", "or other `offers` in its greeting", "not started again"] {
        let error = look(&platform, "good").unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    }
}

#[test]
fn broken_answers_are_errors_or_views_and_never_the_end() {
    let options = ProcessOptions { restarts: 10_000, ..options("mutates", Path::new("/nowhere")) };
    let platform = ProcessPlatform::start(options, Arc::new(|_: &str| ())).unwrap();
    let mut refused = 0;
    for _ in 0..150 {
        refused += usize::from(look(&platform, "bad").is_err());
    }
    assert!(refused > 50, "hardly anything was broken: {refused}");
    // The rest of the last child's output, still in the pipe, may make one more request fail.
    assert!((0..2).any(|_| look(&platform, "good").is_ok()));
    assert_eq!(platform.list_scenes().unwrap().len(), 2);
}
