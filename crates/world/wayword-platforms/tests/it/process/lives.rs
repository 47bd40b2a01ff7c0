//! A child starts and ends with its platform.

use super::{look, pid, started};
use std::{
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
    time::{Duration, Instant},
};
use wayword_platforms::{ProcessPlatform, process::ProcessOptions};

/// Whether a process still runs; one that waits to be reaped does not count.
fn runs(pid: u32) -> bool {
    let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
    stat.rsplit_once(") ").is_some_and(|(_, rest)| !rest.starts_with('Z'))
}

fn ends_soon(pid: u32) -> bool {
    (0..1000).any(|_| {
        std::thread::sleep(Duration::from_millis(10));
        !runs(pid)
    })
}

/// Whether the process table has an entry for it, running or not.
fn is_listed(pid: u32) -> bool {
    Path::new(&format!("/proc/{pid}")).exists()
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

/// A platform with a script that starts two servers first, as `xvfb-run` does, and the servers' process ids. One server
/// keeps the script's pipes open, the other does not.
fn with_servers(role: &str) -> (ProcessPlatform, [u32; 2]) {
    let folder = tempfile::tempdir().unwrap();
    let note = folder.path().join("pids");
    let mut options = super::options(role, folder.path());
    let servers = "sleep 1000 & first=$!; sleep 1000 <&- >&- 2>&- & echo $first $!";
    options.arguments[1] = format!("{servers} > '{}'\n{}", note.display(), options.arguments[1]);
    let platform = ProcessPlatform::start(options, Arc::new(|_: &str| ())).unwrap();
    look(&platform, "good").unwrap();
    let note = std::fs::read_to_string(note).unwrap();
    let pids: Vec<u32> = note.split_whitespace().map(|pid| pid.parse().unwrap()).collect();
    assert!(pids.iter().all(|pid| runs(*pid)));
    (platform, pids.try_into().unwrap())
}

#[test]
fn processes_of_a_child_end_with_it() {
    for role in ["behaves", "stays"] {
        let (platform, servers) = with_servers(role);
        drop(platform);
        // The kill goes to all processes at once, but the kernel may take a moment.
        assert!(servers.into_iter().all(ends_soon), "{role}: a process that it started outlived it");
    }
}

#[test]
fn processes_of_a_child_end_if_a_panic_drops_its_platform() {
    let (platform, servers) = with_servers("behaves");
    let thread = std::thread::spawn(move || {
        let _platform = platform;
        panic!("on purpose");
    });
    thread.join().unwrap_err();
    assert!(servers.into_iter().all(ends_soon));
}

#[test]
fn death_of_a_child_is_noticed_although_its_output_stays_open() {
    let (platform, servers) = with_servers("dies");
    let asked = Instant::now();
    let error = look(&platform, "bad").unwrap_err().to_string();
    assert!(error.contains("died (exit status: 3)"), "{error}");
    assert!(asked.elapsed() < Duration::from_secs(20), "the request waited although the child was dead");
    assert!(servers.into_iter().all(ends_soon), "a process that it started outlived it");
}

#[test]
fn a_guard_that_cannot_be_started_is_reported_and_does_no_harm() {
    let heard = Arc::new(Mutex::new(Vec::new()));
    let hear = Arc::clone(&heard);
    let options = ProcessOptions {
        guard: Some(PathBuf::from("/nowhere/guard").into()),
        ..super::options("behaves", Path::new("/nowhere"))
    };
    let platform =
        ProcessPlatform::start(options, Arc::new(move |line: &str| hear.lock().unwrap().push(line.to_owned())))
            .unwrap();
    look(&platform, "good").unwrap();
    let heard = heard.lock().unwrap().join("|");
    assert!(heard.contains("the guard cannot be started") && heard.contains("end the simulator yourself"), "{heard}");
}

#[test]
fn a_child_that_ended_after_its_answer_is_restarted_without_a_lost_request() {
    let platform = started("leaves").unwrap();
    let first = pid(&look(&platform, "bad").unwrap());
    // The child ends right after its answer. A request while it is ending may fail, so this waits.
    assert!(ends_soon(first));
    let second = pid(&look(&platform, "good").unwrap());
    assert_ne!(first, second);
}
