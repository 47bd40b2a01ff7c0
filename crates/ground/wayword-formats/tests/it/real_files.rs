//! The field's own files, where they are available (`WAYWORD_DATA`), are written as they were read.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by panicking, and says what it skipped")]

use serde_json::Value;
use std::path::{Path, PathBuf};
use wayword_formats::{Episode, FormatError, r2r, reverie};

fn data(file: &str) -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../../shared/data");
    let file = std::env::var_os("WAYWORD_DATA").map_or_else(beside, PathBuf::from).join(file);
    if !file.is_file() {
        println!("skipped: there is no {}; set WAYWORD_DATA to the folder that has it", file.display());
        return None;
    }
    Some(file)
}

fn values(file: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap()
}

type Read = fn(&Path) -> Result<Vec<Episode>, FormatError>;
type Write = fn(&Path, &[Episode]) -> Result<(), FormatError>;

fn comes_back(file: &str, items: usize, read: Read, write: Write) {
    let Some(file) = data(file) else { return };
    let episodes = read(&file).unwrap();
    assert_eq!(episodes.len(), items);
    assert_eq!(
        wayword_formats::read_any_format(&file).unwrap(),
        episodes,
        "the format was not recognised by the content"
    );
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join("copy.json");
    write(&copy, &episodes).unwrap();
    assert!(values(&copy) == values(&file), "{} changed on its way through", file.display());
}

#[test]
fn reverie_comes_back_as_it_was() {
    comes_back("reverie/REVERIE_train.json", 4071, reverie::read_reverie_file, reverie::write_reverie_file);
    comes_back("reverie/REVERIE_val_seen.json", 501, reverie::read_reverie_file, reverie::write_reverie_file);
}

#[test]
fn r2r_comes_back_as_it_was() {
    comes_back("r2r/R2R_train.json", 4675, r2r::read_r2r_file, r2r::write_r2r_file);
    comes_back("r2r/R2R_val_seen.json", 340, r2r::read_r2r_file, r2r::write_r2r_file);
}
