//! The real val_seen split of REVERIE in both styles, where the data lies: `WAYWORD_DATA`, or `../shared/data` beside the
//! workspace. None of it is in this repository.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by panicking, and says what it skipped")]

mod common;

use std::path::{Path, PathBuf};

fn data() -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../../shared/data");
    let data = std::env::var_os("WAYWORD_DATA").map_or_else(beside, PathBuf::from);
    let is_there = data.join("reverie/REVERIE_val_seen.json").is_file();
    if !is_there {
        println!("skipped: no REVERIE data in {}; name its folder in WAYWORD_DATA", data.display());
    }
    is_there.then_some(data)
}

#[test]
fn nearly_all_of_val_seen_passes_every_check_in_both_styles() {
    let Some(data) = data() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut command =
        common::command(&["generate", "--platform", "matterport", "--json", "--style", "reverie", "--style", "r2r"]);
    command.arg("--data").arg(&data).arg("--episodes").arg(data.join("reverie/REVERIE_val_seen.json"));
    let ran = common::run(command.arg("--out").arg(folder.path().join("run")));
    assert!(matches!(ran.code, Some(0 | 3)), "{ran:?}");
    let summary = ran.json();
    let count = |key: &str| summary[key].as_u64().unwrap();
    assert_eq!((count("items"), count("passed") + count("unverified") + count("rejected")), (501, 1002), "{summary}");
    assert!(count("passed") * 100 >= 1002 * 99, "fewer than 99 % pass: {summary}");
}
