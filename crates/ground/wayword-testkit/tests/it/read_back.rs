//! The files of the made-up building can be read by the readers for the real data sets, and are the same at each run.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use wayword_formats::{r2r, reverie};
use wayword_testkit::{SCAN, write_building, write_skyboxes};

fn files(folder: &std::path::Path) -> BTreeMap<std::path::PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            found.insert(path.clone(), std::fs::read(&path).unwrap());
        }
    }
    found
}

#[test]
fn the_episodes_are_read_by_the_formats_readers() {
    let folder = tempfile::tempdir().unwrap();
    write_building(folder.path()).unwrap();
    let with_targets = reverie::read_reverie_file(&folder.path().join("reverie/REVERIE_val_seen.json")).unwrap();
    let without = r2r::read_r2r_file(&folder.path().join("r2r/R2R_val_seen.json")).unwrap();
    assert_eq!((with_targets.len(), without.len()), (10, 10));
    for (with_target, without) in with_targets.iter().zip(&without) {
        assert_eq!(with_target.scene.as_str(), SCAN);
        assert_eq!(with_target.viewpoints, without.viewpoints);
        assert!(with_target.target_object.is_some() && without.target_object.is_none());
        assert!(with_target.instructions.iter().all(|text| text.split(' ').count() < 20));
        assert!(without.instructions.iter().all(|text| text.matches('.').count() >= 2));
    }
}

#[test]
fn the_same_bytes_are_written_each_time() {
    let folder = tempfile::tempdir().unwrap();
    let write = || {
        write_building(folder.path()).unwrap();
        write_skyboxes(folder.path()).unwrap();
        files(folder.path())
    };
    assert_eq!(write(), write());
}
