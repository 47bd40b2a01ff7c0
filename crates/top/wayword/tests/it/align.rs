//! `wayword align`: the frames that each part of a text describes, for generated houses and for Matterport3D's formats.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{Building, EPISODES, Ran};
use serde_json::{Value, json};
use std::{collections::BTreeMap, fs};
use wayword_testkit::{SCAN, viewpoint_id};

/// From the refrigerator through the kitchen and the hallway to the entryway, and right into the living room.
const TO_THE_LAMP: [usize; 5] = [5, 4, 1, 0, 2];
/// Looking along the first hop, radians.
const SOUTH: f64 = 3.3;

/// Aligns a file of texts about the made-up building.
fn align_in_building(building: &Building, file: &str, more: &[&str]) -> Ran {
    let mut arguments = vec!["align", file, "--platform", "matterport", "--data", "data"];
    arguments.extend(more);
    building.wayword(&arguments)
}

fn pair(value: &Value) -> [usize; 2] {
    [0, 1].map(|at: usize| value[at].as_u64().unwrap() as usize)
}

/// Asserts that the parts of an aligned text cover a path of this many frames, and that each has its own words.
fn assert_parts_cover(text: &Value, frames: usize) {
    let words = text["text"].as_str().unwrap();
    let parts = text["parts"].as_array().unwrap();
    assert!(!parts.is_empty() && text.get("unaligned").is_none(), "{text}");
    let (mut begin, mut words_end) = (0, 0);
    for part in parts {
        let ([first, last], [from, to]) = (pair(&part["frames"]), pair(&part["span"]));
        assert!(first == begin && last >= first, "{text}");
        assert!(from >= words_end && to > from && words.get(from..to).is_some(), "{text}");
        let confidence = part["confidence"].as_f64().unwrap();
        assert!((0.0..=1.0 + 1e-9).contains(&confidence), "{text}");
        (begin, words_end) = (last, to);
    }
    assert_eq!(begin, frames - 1, "{text}");
}

/// Asserts that a report for a terminal names every text of the same report as JSON, with a line for each part.
fn assert_names_every_text(plain: &Ran, report: &Value) {
    assert_eq!(plain.code, Some(0), "{plain:?}");
    let texts = report["texts"].as_array().unwrap();
    let mut texts_of: BTreeMap<&str, usize> = BTreeMap::new();
    for text in texts {
        *texts_of.entry(text["path"].as_str().unwrap()).or_default() += 1;
        let words = text["text"].as_str().unwrap();
        for part in text["parts"].as_array().unwrap() {
            let [from, to] = pair(&part["span"]);
            assert!(plain.out.contains(&words[from..to]), "{text}: {plain:?}");
        }
    }
    for (path, count) in texts_of {
        assert_eq!(plain.out.lines().filter(|line| *line == path).count(), count, "{path}: {plain:?}");
    }
    let parts: usize = texts.iter().map(|text| text["parts"].as_array().unwrap().len()).sum();
    assert_eq!(plain.out.lines().filter(|line| line.starts_with("  frames ")).count(), parts, "{plain:?}");
    let last = format!("{} of {} texts aligned", report["aligned"], texts.len());
    assert_eq!(plain.out.lines().next_back(), Some(last.as_str()), "{plain:?}");
}

#[test]
fn align_gives_the_parts_of_texts_about_generated_houses_their_frames() {
    let building = Building::new();
    let ran = building.wayword(&["generate", "--paths", "2", "--seed", "1", "--style", "r2r", "--out", "run"]);
    assert!(matches!(ran.code, Some(0 | 3)), "{ran:?}");
    let records = building.records("run");
    assert!(!records.is_empty());
    let align = ["align", "run/instructions.jsonl", "--platform", "house"];
    let ran = building.wayword(&[&align[..], &["--json"]].concat());
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let report = ran.json();
    let texts = report["texts"].as_array().unwrap();
    assert_eq!((&report["aligned"], texts.len()), (&json!(records.len()), records.len()), "{report}");
    for (text, record) in texts.iter().zip(&records) {
        assert_eq!(text["path"], record.path.id.as_str(), "the texts are in the order of the file");
        assert_eq!(text["text"], record.instruction.text.as_str());
        assert_parts_cover(text, record.path.frames.len());
    }
    assert!(texts.iter().any(|text| text["parts"].as_array().unwrap().len() > 1), "{report}");
    assert_names_every_text(&building.wayword(&align), &report);
    assert_eq!(building.wayword(&[&align[..], &["--json"]].concat()).json(), report, "it is the same every time");
}

#[test]
fn align_gives_the_parts_of_texts_along_viewpoints_their_frames() {
    let building = Building::new();
    for file in [EPISODES, "data/r2r/R2R_val_seen.json"] {
        let items: Vec<Value> = serde_json::from_slice(&fs::read(building.path(file)).unwrap()).unwrap();
        let frames = items.iter().flat_map(|item| {
            let count = item["path"].as_array().unwrap().len();
            item["instructions"].as_array().unwrap().iter().map(move |words| (words, count))
        });
        let report = align_in_building(&building, file, &["--json"]).json();
        let texts = report["texts"].as_array().unwrap();
        assert_eq!(texts.len(), frames.clone().count());
        for (text, (words, count)) in texts.iter().zip(frames) {
            assert_eq!(text["text"], *words);
            assert_parts_cover(text, count);
        }
        assert_eq!(report["aligned"], texts.len());
        assert_names_every_text(&align_in_building(&building, file, &[]), &report);
    }
}

#[test]
fn align_names_texts_that_it_does_not_understand() {
    let building = Building::new();
    let path: Vec<String> = TO_THE_LAMP.iter().map(|index| viewpoint_id(*index)).collect();
    let texts = ["Leave the kitchen. Turn right and stop at the lamp.", "Gehe ins Bad."];
    let item =
        json!({ "path_id": 1, "scan": SCAN, "path": path, "heading": SOUTH, "distance": 12.0, "instructions": texts });
    building.write("texts.json", json!([item]).to_string());
    let report = align_in_building(&building, "texts.json", &["--json"]).json();
    assert_eq!((&report["aligned"], report["texts"].as_array().unwrap().len()), (&json!(1), 2), "{report}");
    assert_parts_cover(&report["texts"][0], TO_THE_LAMP.len());
    let foreign = &report["texts"][1];
    assert_eq!((&foreign["text"], &foreign["parts"]), (&json!(texts[1]), &json!([])), "{report}");
    assert!(foreign["unaligned"].as_str().unwrap().contains("not understand"), "{report}");
    let plain = align_in_building(&building, "texts.json", &[]);
    assert_names_every_text(&plain, &report);
    let line = plain.out.lines().find(|line| line.contains("not aligned")).unwrap();
    assert!(line.contains("not understand") && line.contains(texts[1]), "{plain:?}");
}

#[test]
fn align_refuses_a_file_that_is_not_there() {
    let building = Building::new();
    assert!(align_in_building(&building, "missing.json", &[]).refused().contains("missing.json"));
}

/// Some of the real paths of REVERIE's val_seen split.
#[test]
fn align_gives_the_parts_of_people_s_texts_their_frames() {
    const ITEMS: usize = 20;
    let Some(data) = crate::real_data::data() else { return };
    let episodes = fs::read(data.join("reverie/REVERIE_val_seen.json")).unwrap();
    let mut items: Vec<Value> = serde_json::from_slice(&episodes).unwrap();
    items.truncate(ITEMS);
    let building = Building::new();
    let file = building.write("some.json", json!(items).to_string());
    let mut command = crate::common::command(&["align", "--platform", "matterport", "--json"]);
    let ran = crate::common::run(command.arg("--data").arg(&data).arg(file));
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let report = ran.json();
    let texts = report["texts"].as_array().unwrap();
    let frames = items.iter().flat_map(|item| {
        let count = item["path"].as_array().unwrap().len();
        item["instructions"].as_array().unwrap().iter().map(move |_| count)
    });
    assert_eq!(texts.len(), frames.clone().count());
    let aligned: Vec<(&Value, usize)> =
        texts.iter().zip(frames).filter(|(text, _)| text.get("unaligned").is_none()).collect();
    assert_eq!(report["aligned"], aligned.len());
    assert!(2 * aligned.len() > texts.len(), "{} of {}", aligned.len(), texts.len());
    for (text, count) in aligned {
        assert_parts_cover(text, count);
    }
}
