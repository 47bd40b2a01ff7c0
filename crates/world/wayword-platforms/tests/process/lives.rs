//! Children come and go with their platform.

use super::{look, pid, started};

/// Whether a process still runs: one that waits to be reaped does not.
fn runs(pid: u32) -> bool {
    let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
    stat.rsplit_once(") ").is_some_and(|(_, rest)| !rest.starts_with('Z'))
}

fn ends_soon(pid: u32) -> bool {
    (0..1000).any(|_| {
        std::thread::sleep(std::time::Duration::from_millis(10));
        !runs(pid)
    })
}

/// Whether there is an entry for it in the process table, dead or alive.
fn is_listed(pid: u32) -> bool {
    std::path::Path::new(&format!("/proc/{pid}")).exists()
}

#[test]
fn no_child_outlives_its_platform_and_none_stays_as_a_zombie() {
    for role in ["behaves", "stays"] {
        let platform = started(role).unwrap();
        let child = pid(&look(&platform, "good").unwrap());
        assert!(runs(child));
        drop(platform);
        assert!(!is_listed(child), "{role}: the child is still there");
    }
    let platform = started("dies").unwrap();
    let child = pid(&look(&platform, "good").unwrap());
    look(&platform, "bad").unwrap_err();
    assert!(!is_listed(child), "a child that died was not reaped");
}

#[test]
fn what_a_child_has_started_ends_with_it() {
    use std::{path::Path, sync::Arc, time::Duration};
    use wayword_platforms::{ProcessPlatform, process::ProcessOptions};
    // A script that starts a server for its simulator, and waits for both: as `xvfb-run` does.
    let folder = tempfile::tempdir().unwrap();
    let options = super::options("stays", folder.path());
    let mut arguments = options.arguments.clone();
    let note = folder.path().join("pid");
    arguments[1] = format!("sleep 1000 <&- >&- 2>&- & echo $! > '{}'\n{}", note.display(), arguments[1]);
    let options = ProcessOptions { arguments, answer_within: Duration::from_secs(60), ..options };
    let platform = ProcessPlatform::start(options, Arc::new(|_: &str| ())).unwrap();
    look(&platform, "good").unwrap();
    let helper: u32 = std::fs::read_to_string(Path::new(&note)).unwrap().trim().parse().unwrap();
    assert!(runs(helper));
    drop(platform);
    // The kill reaches both at once, but the kernel may take a moment.
    assert!(ends_soon(helper), "the helper outlived its child");
}

#[test]
fn a_child_that_left_after_its_answer_is_started_again_and_nobody_loses_anything() {
    let platform = started("leaves").unwrap();
    let first = pid(&look(&platform, "bad").unwrap());
    // It leaves right after the answer; whoever asks while it is leaving is unlucky.
    assert!(ends_soon(first));
    let second = pid(&look(&platform, "good").unwrap());
    assert_ne!(first, second);
}
