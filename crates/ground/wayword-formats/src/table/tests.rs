//! Tests of the Parquet table: what is written is read back by the `parquet` crate.

use super::*;
use crate::jsonl;
use parquet::file::reader::{FileReader, SerializedFileReader};
use serde_json::{Value, json};
use std::fs::{self, File};

fn record(number: usize) -> Value {
    let frame = |viewpoint: &str, y: f64| json!({"pose": {"position": [0.5, y, 1.5], "heading": 0.25, "elevation_rad": 0.0}, "viewpoint": viewpoint});
    json!({
        "format": "wayword/1", "platform": "house",
        "path": {"id": format!("p{number}"), "scene": "house2-1", "frames": [frame("hall", 1.0), frame("door", 3.0)],
            "target": {"object": "7", "name": "plant"}},
        "text": format!("Walk to door {number}."), "style": "r2r", "mentions": [], "verdict": "unverified",
        "findings": [{"check": "turns", "verdict": "pass"}, {"check": "route", "verdict": "unverified", "reason": "no map"}],
        "ambiguity": {"ends": 2, "objects": 0, "told_apart_by": null},
        "provenance": {"wayword": "0.1.0", "asker": "rules", "answerer": "labels", "summariser": "rules", "writer": "rules",
            "checked_against": "labels", "seed": u64::MAX, "style_hash": "0f", "repairs": 1},
    })
}

fn records(lines: &[Value]) -> Vec<InstructionRecord> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("records.jsonl");
    fs::write(&file, lines.iter().map(|line| format!("{line}\n")).collect::<String>()).unwrap();
    jsonl::read_records(&file).unwrap()
}

/// The rows of a table, as JSON.
fn table_of(records: &[InstructionRecord]) -> Vec<Value> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("table.parquet");
    let rows: Vec<ParquetRow<'_>> = records.iter().map(|record| ParquetRow { record, split: "train" }).collect();
    write_table(&file, &rows).unwrap();
    let reader = SerializedFileReader::new(File::open(&file).unwrap()).unwrap();
    let told = |row: parquet::record::Row| {
        let columns = row.get_column_iter().map(|(name, field)| (name.clone(), json!(field.to_string())));
        Value::Object(columns.collect())
    };
    reader.get_row_iter(None).unwrap().map(|row| told(row.unwrap())).collect()
}

#[test]
fn a_row_has_the_values_of_its_record() {
    let rows = table_of(&records(&[record(0), record(1)]));
    assert_eq!(rows.len(), 2);
    let row = &rows[1];
    for (column, expected) in [
        ("platform", "\"house\""),
        ("path_id", "\"p1\""),
        ("split", "\"train\""),
        ("text", "\"Walk to door 1.\""),
        ("language", "\"en\""),
        ("verdict", "\"unverified\""),
        ("viewpoints", "[\"hall\", \"door\"]"),
        ("positions", "[[0.5, 1.0, 1.5], [0.5, 3.0, 1.5]]"),
        ("headings", "[0.25, 0.25]"),
        ("length_m", "2.0"),
        ("target_object", "\"7\""),
        ("target_name", "\"plant\""),
        ("ambiguous", "true"),
        ("ends", "2"),
        ("answerer", "\"labels\""),
        ("detector", "null"),
        ("seed", "18446744073709551615"),
        ("repairs", "1"),
        (
            "checks",
            "[{check: \"turns\", verdict: \"pass\", reason: \"\"}, {check: \"route\", verdict: \"unverified\", reason: \"no map\"}]",
        ),
    ] {
        assert_eq!(row[column], expected, "{column}");
    }
}

#[test]
fn unknown_cells_are_null_and_empty_lists_stay_empty() {
    let mut blind = record(0);
    blind["path"]["motion"] = json!("unknown");
    blind["path"].as_object_mut().unwrap().remove("target");
    blind["findings"] = json!([]);
    blind.as_object_mut().unwrap().remove("ambiguity");
    let mut nameless = record(1);
    nameless["path"]["frames"][1].as_object_mut().unwrap().remove("viewpoint");
    let rows = table_of(&records(&[blind, nameless, record(2)]));
    for column in ["viewpoints", "positions", "headings", "length_m", "target_object", "ambiguous", "ends", "objects"] {
        assert_eq!(rows[0][column], "null", "{column}");
    }
    assert_eq!((&rows[0]["checks"], &rows[1]["viewpoints"]), (&json!("[]"), &json!("null")));
    assert_eq!(rows[1]["headings"], "[0.25, 0.25]");
    // A null before does not shift what comes after.
    assert_eq!(
        (&rows[2]["viewpoints"], &rows[2]["positions"]),
        (&json!("[\"hall\", \"door\"]"), &rows[1]["positions"])
    );
}

#[test]
fn rows_go_on_beyond_a_group() {
    let lines: Vec<Value> = (0..GROUP_ROWS + 3).map(record).collect();
    let rows = table_of(&records(&lines));
    assert_eq!(rows.len(), GROUP_ROWS + 3);
    assert_eq!(rows[GROUP_ROWS + 2]["text"], format!("\"Walk to door {}.\"", GROUP_ROWS + 2));
    assert_eq!(rows[GROUP_ROWS]["viewpoints"], "[\"hall\", \"door\"]");
}

#[test]
fn equal_rows_give_equal_bytes() {
    let records = records(&[record(0), record(1)]);
    let rows: Vec<ParquetRow<'_>> = records.iter().map(|record| ParquetRow { record, split: "train" }).collect();
    assert_eq!(encode_table(&rows).unwrap(), encode_table(&rows).unwrap());
    // A table without rows is one all the same.
    assert!(!encode_table(&[]).unwrap().is_empty());
}
