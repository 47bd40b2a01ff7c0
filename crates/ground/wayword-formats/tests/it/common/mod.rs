//! Small datasets for the tests, one per format, as JSON values.

#![allow(clippy::unwrap_used, dead_code, reason = "a test fails by panicking; not every test uses all of this")]

use serde_json::{Value, json};
use std::path::Path;
use wayword_formats::{DatasetFormat, FormatError, jsonl, r2r, reverie, rxr, vlnce};

/// Three items of a format, with the fields that every item has.
pub(crate) fn items(format: DatasetFormat) -> Vec<Value> {
    (0..3).map(|n| item(format, n)).collect()
}

fn item(format: DatasetFormat, n: u64) -> Value {
    let path = json!(["hall", "door", format!("room{n}")]);
    match format {
        DatasetFormat::R2r => json!({
            "distance": 7.5, "scan": "house1", "path_id": n, "path": path, "heading": 1.5,
            "instructions": ["Leave the hall.", "Walk through the door.", "Go to the room and stop."],
        }),
        DatasetFormat::Reverie => json!({
            "id": format!("{n}_66"), "scan": "house1", "path_id": n, "path": path, "objId": 66, "heading": 1.5,
            "instructions": ["Go to the room and water the plant"],
        }),
        DatasetFormat::Rxr => json!({
            "split": "val_seen", "instruction_id": n, "annotator_id": 7, "language": "en-IN", "path_id": n,
            "scan": "house1", "path": path, "heading": 1.5, "instruction": "You are in a hall.",
            "timed_instruction": [{"word": "You", "start_time": 0.5, "end_time": 0.75}, {"word": "are"}],
            "edit_distance": 0.25,
        }),
        DatasetFormat::Vlnce => json!({
            "episode_id": n, "trajectory_id": n, "scene_id": "mp3d/house1/house1.glb",
            "start_position": [1.5, 0.125, -2.5], "start_rotation": [0.0, -0.6816387600233341, 0.0, 0.7316888688738209],
            "goals": [{"position": [4.0, 0.125, -2.5], "radius": 3.0}],
            "reference_path": [[1.5, 0.125, -2.5], [2.5, 0.125, -2.5], [4.0, 0.125, -2.5]],
            "instruction": {"instruction_text": format!("Walk to door {n}."), "instruction_tokens": [4, 3, 2, 1, 0, 0]},
            "info": {"geodesic_distance": 2.5},
        }),
        DatasetFormat::Wayword => json!({
            "format": "wayword/1", "platform": "house", "split": "train",
            "path": {"id": format!("house2-{n}"), "scene": "house1", "frames": [
                {"pose": {"position": [0.0, 0.0, 1.5], "heading": 0.0, "elevation_rad": 0.0}, "viewpoint": "hall", "level": 1},
                {"pose": {"position": [0.0, 2.0, 1.5], "heading": 0.0, "elevation_rad": 0.0}, "viewpoint": "door", "level": 1},
            ]},
            "text": "Walk to the door and stop.", "style": "r2r",
            "mentions": [{"span": [12, 16], "kind": "landmark", "frame": 1}], "verdict": "pass",
            "findings": [{"check": "landmarks", "verdict": "pass"}],
            "provenance": {"wayword": "0.1.0", "asker": "rules", "answerer": "labels", "summariser": "rules",
                "writer": "rules", "checked_against": "labels", "seed": 1, "style_hash": "0f", "repairs": 0},
        }),
        other => unreachable!("{other} holds recordings"),
    }
}

/// The text of a file with these items.
pub(crate) fn text(format: DatasetFormat, items: &[Value]) -> String {
    let lines = items.iter().map(|item| format!("{item}\n")).collect();
    match format {
        DatasetFormat::R2r | DatasetFormat::Reverie => Value::from(items.to_vec()).to_string(),
        DatasetFormat::Rxr | DatasetFormat::Wayword => lines,
        DatasetFormat::Vlnce => {
            let words = ["<pad>", "<unk>", "door", "to", "walk"];
            json!({"episodes": items, "instruction_vocab": {"word_list": words}}).to_string()
        }
        other => unreachable!("{other} holds recordings"),
    }
}

/// The items of a file.
pub(crate) fn items_of(format: DatasetFormat, file: &Path) -> Vec<Value> {
    let text = std::fs::read_to_string(file).unwrap();
    match format {
        DatasetFormat::Rxr | DatasetFormat::Wayword => {
            text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
        }
        DatasetFormat::R2r | DatasetFormat::Reverie => serde_json::from_str(&text).unwrap(),
        DatasetFormat::Vlnce => {
            let mut dataset: Value = serde_json::from_str(&text).unwrap();
            serde_json::from_value(dataset["episodes"].take()).unwrap()
        }
        other => unreachable!("{other} holds recordings"),
    }
}

/// Reads a file and writes what was read to another.
pub(crate) fn copy(format: DatasetFormat, from: &Path, to: &Path) -> Result<(), FormatError> {
    match format {
        DatasetFormat::R2r => r2r::write_r2r_file(to, &r2r::read_r2r_file(from)?),
        DatasetFormat::Reverie => reverie::write_reverie_file(to, &reverie::read_reverie_file(from)?),
        DatasetFormat::Rxr => rxr::write_rxr_file(to, &rxr::read_rxr_file(from)?),
        DatasetFormat::Vlnce => vlnce::write_vlnce_file(to, &vlnce::read_vlnce_file(from)?),
        DatasetFormat::Wayword => jsonl::write_records(to, &jsonl::read_records(from)?),
        other => unreachable!("{other} holds recordings"),
    }
}
