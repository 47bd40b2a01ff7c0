//! Records of several platforms in one dataset, split by scene.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use proptest::prelude::*;
use serde_json::{Value, json};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};
use wayword_formats::{
    DatasetFormat,
    jsonl::{self, DatasetSplit, InstructionRecord},
    split_by_scene,
    text_hash::add_text_hash,
};

fn records(folder: &Path, platform: &str, scenes: &[usize]) -> PathBuf {
    let template = &crate::common::items(DatasetFormat::Wayword)[0];
    let record = |(n, scene): (usize, &usize)| {
        let mut record = template.clone();
        record.as_object_mut().unwrap().shift_remove("split");
        record["platform"] = json!(platform);
        record["path"]["id"] = json!(format!("p{n}"));
        record["path"]["scene"] = json!(format!("scene{scene}"));
        record
    };
    let records: Vec<Value> = scenes.iter().enumerate().map(record).collect();
    let file = folder.join(format!("{platform}.jsonl"));
    std::fs::write(&file, crate::common::text(DatasetFormat::Wayword, &records)).unwrap();
    file
}

fn splits_of_scenes(records: &[InstructionRecord]) -> BTreeMap<(&str, &str), BTreeSet<DatasetSplit>> {
    let mut scenes: BTreeMap<_, BTreeSet<_>> = BTreeMap::new();
    for record in records {
        let key = (record.platform.as_str(), record.path.scene.as_str());
        scenes.entry(key).or_default().insert(record.split.unwrap());
    }
    scenes
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn a_scene_is_in_one_split_and_each_platform_in_both(
        a in prop::collection::vec(0usize..9, 1..24),
        b in prop::collection::vec(0usize..9, 1..24),
        share in 0.05..0.95f64,
        seed in any::<u64>(),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let files = [records(folder.path(), "house", &a), records(folder.path(), "matterport", &b)];
        let mut merged = jsonl::merge_records(&files).unwrap();
        prop_assert_eq!(merged.len(), a.len() + b.len());
        split_by_scene(&mut merged, share, seed);
        let scenes = splits_of_scenes(&merged);
        prop_assert!(scenes.values().all(|splits| splits.len() == 1));
        for platform in ["house", "matterport"] {
            let of_platform: Vec<_> = scenes.iter().filter(|((name, _), _)| *name == platform).collect();
            let in_val = of_platform.iter().filter(|(_, splits)| splits.contains(&DatasetSplit::Val)).count();
            prop_assert!(of_platform.len() < 2 || (1..of_platform.len()).contains(&in_val));
        }

        let mut backwards = jsonl::merge_records(&[&files[1], &files[0]]).unwrap();
        backwards.reverse();
        split_by_scene(&mut backwards, share, seed);
        prop_assert_eq!(splits_of_scenes(&backwards), scenes);

        let file = folder.path().join("all.jsonl.gz");
        jsonl::write_records(&file, &merged).unwrap();
        prop_assert_eq!(jsonl::read_records(&file).unwrap(), merged);
    }
}

#[test]
fn another_seed_chooses_other_scenes() {
    let folder = tempfile::tempdir().unwrap();
    let file = records(folder.path(), "house", &(0..40).collect::<Vec<_>>());
    let val = |seed| {
        let mut records = jsonl::read_records(&file).unwrap();
        split_by_scene(&mut records, 0.25, seed);
        records
            .into_iter()
            .filter(|record| record.split == Some(DatasetSplit::Val))
            .map(|record| record.path.scene)
            .collect::<Vec<_>>()
    };
    assert_eq!((val(1).len(), val(2).len()), (10, 10));
    assert_ne!(val(1), val(2));
}

#[test]
fn merge_refuses_records_that_cannot_be_together() {
    let folder = tempfile::tempdir().unwrap();
    let file = records(folder.path(), "house", &[1, 1]);
    let twice = jsonl::merge_records(&[&file, &file]).unwrap_err().to_string();
    assert!(twice.contains("line 1 (id p0): field \"text\": path \"p0\" already has the same instruction"), "{twice}");

    let mut records = jsonl::read_records(&file).unwrap();
    records[0].split = Some(DatasetSplit::Train);
    records[1].split = Some(DatasetSplit::Val);
    let leak = jsonl::write_records(&file, &records).unwrap_err().to_string();
    assert!(leak.contains("scene scene1 is in train and in val"), "{leak}");

    records[1].split = None;
    records[1].path.id = records[0].path.id.clone();
    records[1].path.frames.truncate(1);
    let other = jsonl::write_records(&file, &records).unwrap_err().to_string();
    assert!(other.contains("a different path with the name \"p0\""), "{other}");
    assert_eq!(jsonl::read_records(&file).unwrap().len(), 2, "a refused write touched the file");
}

#[test]
fn what_points_into_a_text_is_dropped_once_somebody_edits_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = records(folder.path(), "house", &[1]);
    let mut written = jsonl::read_records(&file).unwrap();
    let text = written[0].instruction.text.clone();
    add_text_hash(&mut written[0].extra, &text);
    jsonl::write_records(&file, &written).unwrap();
    assert_eq!(jsonl::read_records(&file).unwrap()[0].instruction, written[0].instruction);
    let whole = std::fs::read_to_string(&file).unwrap();
    assert!(!written[0].instruction.mentions.is_empty());
    std::fs::write(&file, whole.replace(&text, "Go on.")).unwrap();
    let edited = &jsonl::read_records(&file).unwrap()[0].instruction;
    assert_eq!((edited.text.as_str(), edited.mentions.len(), edited.parts.len()), ("Go on.", 0, 0));
    std::fs::write(&file, whole.replace(&text, " ")).unwrap();
    let empty = jsonl::read_records(&file).unwrap_err().to_string();
    assert!(empty.contains("field \"text\": it is empty"), "{empty}");
}

#[test]
fn a_record_of_a_later_format_is_refused_with_the_version_that_wrote_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = records(folder.path(), "house", &[1]);
    let later =
        std::fs::read_to_string(&file).unwrap().replace("wayword/1", "wayword/2").replace("\"0.1.0\"", "\"7.0.3\"");
    std::fs::write(&file, later).unwrap();
    let told = jsonl::read_records(&file).unwrap_err().to_string();
    assert!(["\"wayword/2\"", "7.0.3", "expected \"wayword/1\""].iter().all(|part| told.contains(part)), "{told}");
}

#[test]
fn parts_of_a_text_are_kept_until_it_is_edited() {
    let folder = tempfile::tempdir().unwrap();
    let file = records(folder.path(), "house", &[1]);
    let mut records = jsonl::read_records(&file).unwrap();
    let text = records[0].instruction.text.len();
    let part = |span, frames| wayword_core::InstructionPart { span, frames, confidence: Some(0.5) };
    for (part, is_kept) in [
        (part([0, text], [0, 1]), true),
        (part([0, text + 1], [0, 1]), false),
        (part([0, text], [0, 99]), false),
        (part([0, text], [1, 0]), false),
    ] {
        records[0].instruction.parts = vec![part.clone()];
        jsonl::write_records(&file, &records).unwrap();
        let read = jsonl::read_records(&file).unwrap().remove(0).instruction.parts;
        assert_eq!(read, if is_kept { vec![part] } else { Vec::new() });
    }
}

#[test]
fn records_come_to_one_episode_per_path() {
    let folder = tempfile::tempdir().unwrap();
    let file = records(folder.path(), "house", &[1, 2]);
    let mut records = jsonl::read_records(&file).unwrap();
    let mut other = records[0].clone();
    other.instruction.style = "reverie".into();
    other.instruction.text = "Go to the door".into();
    other.instruction.mentions.clear();
    records.push(other);
    let episodes = jsonl::episodes_from_records(&records);
    assert_eq!(episodes.len(), 2);
    assert_eq!(episodes[0].instructions, ["Walk to the door and stop.", "Go to the door"]);
    assert_eq!(episodes[0].viewpoints.len(), 2);
}

#[test]
fn items_on_one_path_of_a_dataset_keep_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("records.jsonl");
    let record = |(item, path_id): (&str, Option<Value>)| {
        let mut record = crate::common::items(DatasetFormat::Wayword)[0].clone();
        record["path"]["id"] = json!(item);
        if let Some(path_id) = path_id {
            record["path_id"] = path_id;
        }
        record
    };
    let write = |items: Vec<(&str, Option<Value>)>| {
        let items: Vec<Value> = items.into_iter().map(record).collect();
        std::fs::write(&file, crate::common::text(DatasetFormat::Wayword, &items)).unwrap();
    };
    write(vec![("12_3", Some(json!("12"))), ("12_4", Some(json!(12))), ("13_5", None)]);
    let path_ids: Vec<_> =
        DatasetFormat::Wayword.read_file(&file).unwrap().into_iter().map(|episode| episode.path_id).collect();
    assert_eq!(path_ids, ["12", "12", "13_5"]);
    for bad in [json!("../12"), json!("x".repeat(129)), json!(1.5), json!(null), json!(["12"])] {
        write(vec![("12_3", Some(bad.clone()))]);
        let refused = jsonl::read_records(&file).unwrap_err().to_string();
        assert!(refused.contains("line 1 (id 12_3): field \"path_id\": expected a whole number"), "{bad}: {refused}");
    }
}

/// Scenes that are officially held out are never for training, whatever the share and the seed.
#[test]
fn scenes_that_are_officially_held_out_are_for_val() {
    let folder = tempfile::tempdir().unwrap();
    let file = records(folder.path(), "matterport", &[0, 1, 2, 3]);
    let scenes = ["17DRP5sb8fy", "2azQ1b91cZZ", "2t7WUuJeko7", "5q7pvUzZiYa"];
    for (share, seed) in [(0.0, 0), (0.25, 1), (0.5, 2), (0.75, 3), (1.0, 4)] {
        let mut records = jsonl::read_records(&file).unwrap();
        for (record, scene) in records.iter_mut().zip(scenes) {
            record.path.scene = wayword_core::SceneId::new(scene).unwrap();
        }
        split_by_scene(&mut records, share, seed);
        let val: Vec<bool> = records.iter().map(|record| record.split == Some(DatasetSplit::Val)).collect();
        assert!(val[1] && val[2], "{share}: {val:?}");
        let expected = (share * 4.0_f64).round().max(2.0) as usize;
        assert_eq!(val.iter().filter(|is_val| **is_val).count(), expected, "{share}");
    }
}
