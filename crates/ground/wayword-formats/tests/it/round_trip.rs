//! A file that is read and written again is the same.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use proptest::prelude::*;
use serde_json::{Map, Value, json};
use std::path::Path;
use wayword_formats::{DatasetFormat, read_any_format};

fn number() -> impl Strategy<Value = Value> {
    prop_oneof![
        any::<i64>().prop_map(Value::from),
        (-1e9..1e9f64).prop_map(Value::from),
        any::<f32>()
            .prop_filter("JSON has no NaN", |number| number.is_finite())
            .prop_map(|number| Value::from(f64::from(number)))
    ]
}

fn any_json() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        number(),
        "\\PC{0,12}".prop_map(Value::from)
    ];
    leaf.prop_recursive(3, 16, 4, |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..4).prop_map(Value::from),
            prop::collection::vec(("\\PC{0,6}", inner), 0..4).prop_map(|entries| entries.into_iter().collect())
        ]
    })
}

/// Fields that no format names.
fn unknown() -> impl Strategy<Value = Vec<(String, Value)>> {
    prop::collection::vec(("x_\\PC{0,8}", any_json()), 0..5)
}

/// Changes to an item that keep it valid: other values of the fields that every item of this kind has.
#[derive(Debug, Clone)]
struct Change {
    scene: String,
    path: Vec<String>,
    heading: Value,
    text: String,
    unknown: Vec<(String, Value)>,
    reversed: bool,
}

fn change() -> impl Strategy<Value = Change> {
    let heading = prop_oneof![(-10.0..10.0f64).prop_map(Value::from), (-3i64..9).prop_map(Value::from)];
    let path = prop::collection::vec("[0-9a-f]{1,32}", 1..9);
    ("[A-Za-z0-9_]{1,12}", path, heading, "\\PC{0,60}", unknown(), any::<bool>()).prop_map(
        |(scene, path, heading, text, unknown, reversed)| Change { scene, path, heading, text, unknown, reversed },
    )
}

fn changed(format: DatasetFormat, n: usize, item: &Value, change: &Change) -> Value {
    let mut item = item.as_object().unwrap().clone();
    let scene =
        if format == DatasetFormat::Wayword || format == DatasetFormat::Vlnce { None } else { Some(&change.scene) };
    if let Some(scene) = scene {
        item["scan"] = json!(scene);
        item["path"] = json!(change.path);
        item["heading"] = change.heading.clone();
    }
    let text = json!(format!("{} {n}", change.text));
    match format {
        DatasetFormat::R2r | DatasetFormat::Reverie => item["instructions"] = json!([text, change.text]),
        DatasetFormat::Rxr => item["instruction"] = text,
        DatasetFormat::Vlnce => item["instruction"]["instruction_text"] = text,
        DatasetFormat::Wayword => {
            item["text"] = text;
            item["mentions"] = json!([]);
        }
        other => unreachable!("{other} holds recordings"),
    }
    let bears_unknown = format != DatasetFormat::Vlnce;
    item.extend(change.unknown.iter().filter(|_| bears_unknown).cloned());
    let entries: Vec<_> = item.into_iter().collect();
    let ordered: Map<_, _> =
        if change.reversed { entries.into_iter().rev().collect() } else { entries.into_iter().collect() };
    ordered.into()
}

fn unknown_keys(item: &Value) -> Vec<&String> {
    item.as_object().unwrap().keys().filter(|key| key.starts_with("x_")).collect()
}

fn comes_back(format: DatasetFormat, ending: &str, changes: &[Change]) {
    let items: Vec<_> = changes
        .iter()
        .zip(crate::common::items(format))
        .enumerate()
        .map(|(n, (change, item))| changed(format, n, &item, change))
        .collect();
    let folder = tempfile::tempdir().unwrap();
    let (file, copy) = (folder.path().join("file"), folder.path().join(format!("copy{ending}")));
    std::fs::write(&file, crate::common::text(format, &items)).unwrap();
    crate::common::copy(format, &file, &copy).unwrap();
    assert_eq!(read_any_format(&copy).unwrap(), read_any_format(&file).unwrap());
    if !ending.ends_with(".gz") {
        let back = crate::common::items_of(format, &copy);
        assert_eq!(back, items);
        for (back, item) in back.iter().zip(&items) {
            assert_eq!(unknown_keys(back), unknown_keys(item), "unknown fields changed their order");
        }
    }
    assert_no_leftovers(folder.path(), 2);
}

fn assert_no_leftovers(folder: &Path, files: usize) {
    assert_eq!(std::fs::read_dir(folder).unwrap().count(), files);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn r2r(changes in prop::collection::vec(change(), 1..4)) {
        comes_back(DatasetFormat::R2r, ".json", &changes);
    }

    #[test]
    fn reverie(changes in prop::collection::vec(change(), 1..4)) {
        comes_back(DatasetFormat::Reverie, ".json", &changes);
    }

    #[test]
    fn rxr(changes in prop::collection::vec(change(), 1..4)) {
        comes_back(DatasetFormat::Rxr, ".jsonl", &changes);
    }

    #[test]
    fn rxr_gz(changes in prop::collection::vec(change(), 1..4)) {
        comes_back(DatasetFormat::Rxr, ".jsonl.gz", &changes);
    }

    #[test]
    fn vlnce(changes in prop::collection::vec(change(), 1..4)) {
        comes_back(DatasetFormat::Vlnce, ".json", &changes);
    }

    #[test]
    fn vlnce_gz(changes in prop::collection::vec(change(), 1..4)) {
        comes_back(DatasetFormat::Vlnce, ".json.gz", &changes);
    }

    #[test]
    fn wayword(changes in prop::collection::vec(change(), 1..4)) {
        comes_back(DatasetFormat::Wayword, ".jsonl", &changes);
    }
}

/// Writes one item, reads it and writes it again.
fn copied(format: DatasetFormat, item: Value) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let (file, copy) = (folder.path().join("file"), folder.path().join("copy"));
    std::fs::write(&file, crate::common::text(format, &[item])).unwrap();
    assert_eq!(wayword_formats::detect_format(&file).unwrap(), format);
    crate::common::copy(format, &file, &copy).unwrap();
    crate::common::items_of(format, &copy).remove(0)
}

#[test]
fn reveries_first_release_comes_back_too() {
    let mut item = crate::common::items(DatasetFormat::Reverie).remove(0);
    item["distance"] = json!(11.25);
    item["ix"] = json!(3);
    item["instructions_l"] = json!(["Leave the hall.", "Walk on.", "Stop."]);
    assert_eq!(copied(DatasetFormat::Reverie, item.clone()), item);
}

#[test]
fn an_item_without_an_object_is_reverie_by_its_id() {
    let mut item = crate::common::items(DatasetFormat::Reverie).remove(0);
    item.as_object_mut().unwrap().shift_remove("objId");
    item["id"] = json!("0_free");
    assert_eq!(copied(DatasetFormat::Reverie, item.clone()), item);
}

#[test]
fn vlnce_drops_fields_that_crash_its_loader() {
    let item = crate::common::items(DatasetFormat::Vlnce).remove(0);
    let mut strange = item.clone();
    strange["style"] = json!("r2r");
    strange["instruction"]["language"] = json!("en-US");
    assert_eq!(copied(DatasetFormat::Vlnce, strange), item);
}

#[test]
fn a_vlnce_episode_of_a_test_split_has_neither_goal_nor_path() {
    let mut item = crate::common::items(DatasetFormat::Vlnce).remove(0);
    item["goals"] = Value::Null;
    item["reference_path"] = Value::Null;
    item["info"] = Value::Null;
    assert_eq!(copied(DatasetFormat::Vlnce, item.clone()), item);
}
