//! A run that was killed continues where it stopped, and its files end up the same byte for byte.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::Building;
use rand::Rng;
use std::{fs, os::unix::process::ExitStatusExt, path::Path, process::Stdio};
use wayword_core::seeded_rng;

const FILES: [&str; 4] = ["config.toml", "walks.jsonl", "instructions.jsonl", "rejected.jsonl"];
/// Without repairs some texts are rejected, so that every file grows.
/// Ambiguous texts are rejected, so that there are rejected ones.
const RUN: &[&str] =
    &["--paths", "1600", "--hops", "3..7", "--repairs", "0", "--candidates", "1", "--reject-ambiguous", "--seed", "11"];
const KILLS: usize = 20;

fn contents(run: &Path) -> Vec<Vec<u8>> {
    FILES.iter().map(|name| fs::read(run.join(name)).unwrap()).collect()
}

fn size(file: &Path) -> u64 {
    fs::metadata(file).map_or(0, |metadata| metadata.len())
}

/// Starts the run and kills it once `file` has grown to `bytes`. Returns whether it was still running.
fn killed_at(building: &Building, file: &Path, bytes: u64) -> bool {
    let mut arguments = vec!["generate", "--platform", "matterport", "--data", "data", "--out", "killed", "--quiet"];
    arguments.extend(RUN);
    let mut run = building.command(&arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    while size(file) < bytes && run.try_wait().unwrap().is_none() {
        std::thread::yield_now();
    }
    run.kill().unwrap();
    run.wait().unwrap().signal() == Some(9)
}

#[test]
fn a_run_that_is_killed_twenty_times_ends_up_the_same() {
    let building = Building::new();
    assert_eq!(building.generate("whole", RUN).code, Some(3));
    let whole = contents(&building.path("whole"));
    assert!(whole.iter().all(|bytes| !bytes.is_empty()), "each file has something to lose");

    // A moment is a length of the file and not a time, because machines differ in speed.
    let grown = building.path("killed/walks.jsonl");
    let mut rng = seeded_rng(5, &["kills"]);
    let mut moments: Vec<u64> = (0..KILLS).map(|_| rng.random_range(1..whole[1].len() as u64 * 19 / 20)).collect();
    moments.sort_unstable();
    let mut at_work = 0;
    for moment in moments {
        let was_killed = killed_at(&building, &grown, moment);
        let left = size(&grown);
        at_work += usize::from(was_killed && left >= moment && left < whole[1].len() as u64);
    }
    assert!(at_work >= KILLS * 9 / 10, "only {at_work} of {KILLS} kills landed while it was at work");
    let last = building.generate("killed", RUN);
    assert_eq!(last.code, Some(3), "{last:?}");
    assert!(last.err.contains("continuing: "), "{last:?}");
    for (name, (killed, whole)) in FILES.iter().zip(contents(&building.path("killed")).iter().zip(&whole)) {
        assert!(killed == whole, "{name} differs");
    }
}

#[test]
fn torn_last_lines_are_cut_off_and_written_again() {
    let building = Building::new();
    let run: &[&str] = &["--paths", "12", "--hops", "3..7", "--seed", "2"];
    building.generate("whole", run);
    let whole = contents(&building.path("whole"));
    let mut rng = seeded_rng(6, &["tears"]);
    for _ in 0..10 {
        // A process dies while it writes one file. An item's line in walks.jsonl is complete before its texts are
        // written.
        building.generate("torn", run);
        let file = building.path("torn/instructions.jsonl");
        let bytes = fs::read(&file).unwrap();
        let last_line = bytes[..bytes.len() - 1].iter().rposition(|byte| *byte == b'\n').unwrap() + 1;
        fs::write(&file, &bytes[..rng.random_range(last_line..bytes.len())]).unwrap();
        building.generate("torn", run);
        assert!(contents(&building.path("torn")) == whole);
    }
}
