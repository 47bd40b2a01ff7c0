//! A `path_id` names one path of a scan, as far as the format's own files keep to it.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common;
use serde_json::{Value, json};
use wayword_formats::{DatasetFormat, Episode, FormatError};

/// Reads the three items of a format, after `change`.
fn read_changed(format: DatasetFormat, change: impl Fn(&mut [Value])) -> Result<Vec<Episode>, FormatError> {
    let mut items = common::items(format);
    for item in &mut items {
        item["path_id"] = json!(7);
        item["path"] = json!(["hall", "door", "room"]);
        if format == DatasetFormat::Reverie {
            item["id"] = json!(format!("7_{}", item["id"].as_str().unwrap().split('_').next().unwrap()));
            item["objId"] = json!(item["id"].as_str().unwrap()[2..].parse::<u64>().unwrap());
        }
    }
    change(&mut items);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("data.json");
    std::fs::write(&file, common::text(format, &items)).unwrap();
    format.read_file(&file)
}

#[test]
fn items_may_share_a_path_and_scans_a_number() {
    for format in [DatasetFormat::Rxr, DatasetFormat::Reverie] {
        assert_eq!(read_changed(format, |_| {}).unwrap().len(), 3);
        let in_other_scan = |items: &mut [Value]| {
            items[2]["scan"] = json!("house2");
            items[2]["path"] = json!(["cellar", "stairs"]);
        };
        assert_eq!(read_changed(format, in_other_scan).unwrap().len(), 3);
    }
}

#[test]
fn a_path_id_of_two_different_paths_is_refused() {
    for (format, path, told) in [
        (DatasetFormat::Rxr, json!(["hall", "door"]), "line 3 (id 2): field \"path_id\": \"7\" was given to"),
        (DatasetFormat::Rxr, json!(["hall", "door", "attic"]), "with another path"),
        (DatasetFormat::Rxr, json!(["room", "door", "hall"]), "of scan house1"),
        (DatasetFormat::Reverie, json!(["door", "hall"]), "item 2 (id 7_2): field \"path_id\": \"7\" was given to"),
        (DatasetFormat::Reverie, json!(["cellar", "hall"]), "whose path starts at another viewpoint"),
    ] {
        let error = read_changed(format, |items| items[2]["path"] = path.clone()).unwrap_err().to_string();
        assert!(error.contains(told) && error.contains("a path_id of its own"), "{path}: {error}");
    }
}

#[test]
fn objects_of_one_path_may_have_ends_of_their_own_and_keep_them_in_rxr() {
    let episodes = read_changed(DatasetFormat::Reverie, |items| {
        items[1]["path"] = json!(["hall", "door", "room", "balcony"]);
        items[2]["path"] = json!(["hall", "door", "room", "balcony"]);
    })
    .unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("rxr.jsonl");
    wayword_formats::rxr::write_rxr_file(&file, &episodes).unwrap();
    let read = wayword_formats::rxr::read_rxr_file(&file).unwrap();
    let ids: Vec<_> = read.iter().map(|episode| (episode.path_id.as_str(), episode.viewpoints.len())).collect();
    assert_eq!(ids, [("7", 3), ("0", 4), ("0", 4)]);
    assert_eq!(read[1].extra["path_name"], "7");
}
