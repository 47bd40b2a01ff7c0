//! Texts in other languages than English are checked, aligned and followed.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::Building;
use serde_json::{Value, json};
use std::fs;

const WORLD: [&str; 4] = ["--platform", "matterport", "--data", "data"];
const RIGHT: &str = "往前直走，在走廊尽头停下。";
const UNREAD: &str = "往前直走，魑魅魍魉。";

/// Writes these texts for each item of the building's R2R, and returns their number.
fn write_texts(building: &Building, texts: &[&str]) -> usize {
    let file = building.change_items(&building.r2r(), |item| item["instructions"] = json!(texts), "zh.json");
    let items: Vec<Value> = serde_json::from_slice(&fs::read(building.path(&file)).unwrap()).unwrap();
    items.len() * texts.len()
}

#[test]
fn a_chinese_text_is_checked_and_its_findings_point_at_its_own_words() {
    let building = Building::new();
    let count = write_texts(&building, &[RIGHT, UNREAD]);
    let report = building.wayword(&[&["check", "zh.json", "--json"], &WORLD[..]].concat()).json();
    let coverage = &report["by_check"]["coverage"];
    assert_eq!((&coverage["passed"], &coverage["unverified"]), (&json!(count / 2), &json!(count / 2)), "{report}");
    let not_passed = report["not_passed"].as_array().unwrap();
    let unread = not_passed.iter().find(|text| text["text"] == UNREAD).unwrap();
    let findings = unread["findings"].as_array().unwrap();
    let finding = findings.iter().find(|finding| finding["check"] == "coverage").unwrap();
    let [from, to] = [0, 1].map(|at: usize| finding["span"][at].as_u64().unwrap() as usize);
    assert!(UNREAD.get(from..to).is_some_and(|words| words.contains("魑魅")), "{finding}");
}

#[test]
fn a_chinese_text_is_aligned_by_its_own_words() {
    let building = Building::new();
    let count = write_texts(&building, &[RIGHT]);
    let report = building.wayword(&[&["align", "zh.json", "--json"], &WORLD[..]].concat()).json();
    assert_eq!(report["aligned"], json!(count), "{report}");
    for text in report["texts"].as_array().unwrap() {
        for part in text["parts"].as_array().unwrap() {
            let [from, to] = [0, 1].map(|at: usize| part["span"][at].as_u64().unwrap() as usize);
            assert!(RIGHT.get(from..to).is_some_and(|words| !words.is_empty()), "{text}");
        }
    }
}
