//! The real val_seen split of REVERIE in both styles. The data is in `WAYWORD_DATA`, or else in `../shared/data` next to the
//! workspace; none of it is in this repository.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by panicking, and says what it skipped")]

use serde_json::{Value, json};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};
use wayword_language::{
    lexicon::affords_task,
    reading::{EventContent, read_instruction},
};

pub(crate) fn data() -> Option<PathBuf> {
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
    let mut command = crate::common::command(&[
        "generate",
        "--platform",
        "matterport",
        "--json",
        "--style",
        "reverie",
        "--style",
        "r2r",
    ]);
    command.arg("--data").arg(&data).arg("--episodes").arg(data.join("reverie/REVERIE_val_seen.json"));
    let ran = crate::common::run(command.arg("--out").arg(folder.path().join("run")));
    assert!(matches!(ran.code, Some(0 | 3)), "{ran:?}");
    let summary = ran.json();
    let count = |key: &str| summary[key].as_u64().unwrap();
    assert_eq!((count("items"), count("passed") + count("unverified") + count("rejected")), (501, 1002), "{summary}");
    assert!(count("passed") * 100 >= 1002 * 99, "fewer than 99 % pass: {summary}");
}

/// The annotated path of each item, submitted for each of its instructions.
#[test]
fn annotated_paths_of_val_seen_end_where_they_should() {
    let Some(data) = data() else { return };
    let folder = tempfile::tempdir().unwrap();
    let episodes = data.join("reverie/REVERIE_val_seen.json");
    let items: Vec<Value> = serde_json::from_slice(&fs::read(&episodes).unwrap()).unwrap();
    let mut submitted = Vec::new();
    // How many instructions have a path that ends where their object is listed with a place in the picture.
    let mut visible = 0;
    for item in &items {
        let path = item["path"].as_array().unwrap();
        let instructions = item["instructions"].as_array().unwrap().len();
        let goal = path[path.len() - 1].as_str().unwrap();
        let boxes = data.join(format!("reverie/BBox/{}_{goal}.json", item["scan"].as_str().unwrap()));
        let boxes: Value = serde_json::from_slice(&fs::read(boxes).unwrap_or_else(|_| b"{}".to_vec())).unwrap();
        let places = &boxes[goal][item["objId"].to_string()]["visible_pos"];
        visible += if places.as_array().is_some_and(|places| !places.is_empty()) { instructions } else { 0 };
        for place in 0..instructions {
            let name = format!("{}_{place}", item["id"].as_str().unwrap());
            submitted.push(json!({"instr_id": name, "trajectory": path, "predObjId": item["objId"]}));
        }
    }
    let file = folder.path().join("submission.json");
    fs::write(&file, Value::from(submitted.clone()).to_string()).unwrap();
    let mut command = crate::common::command(&["evaluate", "--platform", "matterport", "--json", "--resamples", "100"]);
    let ran = crate::common::run(command.arg("--data").arg(&data).arg("--episodes").arg(&episodes).arg(&file));
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let found = ran.json();
    assert_eq!((&found["items"], &found["paths"]), (&json!(501), &json!(126)));
    assert_eq!(found["instructions"], submitted.len());
    let rate = |rule: usize| found["rules"][rule]["figures"]["success_rate"]["mean"].as_f64().unwrap();
    let expected = visible as f64 / submitted.len() as f64;
    println!("visible from the end of the annotated path: {visible} of {} instructions", submitted.len());
    assert!(expected > 0.99 && expected < 1.0, "the data is not what it was: {expected}");
    assert!((rate(0) - expected).abs() < 1e-9, "{} is not {expected}", rate(0));
    assert!((rate(1) - 1.0).abs() < 1e-12);
}

/// An agent that ignores its instruction is useless as a measure. So each agent must do better by people's instructions than by
/// chance, and worse by the instruction of another path.
#[test]
fn agents_follow_the_instructions_of_people_in_val_seen() {
    let Some(data) = data() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut command =
        crate::common::command(&["compare", "--platform", "matterport", "--json", "--swaps", "other-path"]);
    command.arg("--data").arg(&data).arg("--episodes").arg(data.join("reverie/REVERIE_val_seen.json"));
    command.arg("--out").arg(folder.path().join("walked"));
    let ran = crate::common::run(&mut command);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let found = ran.json();
    let rate = |agent: &str| {
        let row = found["rows"].as_array().unwrap().iter().find(|row| row["agent"] == agent).unwrap();
        let rate = &row["figures"]["success_rate"];
        (rate["low"].as_f64().unwrap(), rate["high"].as_f64().unwrap())
    };
    let chance = rate("random/10").1;
    for agent in ["clip-nav", "seq-clip-nav", "glip-nav"] {
        assert!(rate(agent).0 > chance, "{agent}: {:?}, chance {chance}", rate(agent));
        let swapped = found["swaps"].as_array().unwrap().iter().find(|swapped| swapped["agent"] == agent).unwrap();
        assert_eq!(swapped["listening"], "shown", "{swapped}");
    }
    assert_eq!(found["about"]["items"], 501);
}

/// The task on a thing that a text ends in, from its verb on, and the name of the thing.
fn task_on_thing(text: &str) -> Option<(String, String)> {
    let reading = read_instruction(text, &BTreeSet::new());
    let task = reading.task.as_ref()?;
    let object = &reading.events[task.object?];
    let EventContent::Place(place) = &object.what else { return None };
    let before = text[..object.span[0]].to_lowercase();
    let at = before.rfind(&*task.verb)?;
    Some((before[at..].trim().to_owned(), place.name.clone()))
}

#[test]
fn nearly_every_task_of_people_is_afforded() {
    let Some(data) = data() else { return };
    let Ok(bytes) = fs::read(data.join("reverie/REVERIE_train.json")) else {
        return println!("skipped: there is no reverie/REVERIE_train.json in {}", data.display());
    };
    let episodes: Vec<Value> = serde_json::from_slice(&bytes).unwrap();
    let texts = episodes.iter().filter_map(|episode| episode["instructions"].as_array()).flatten();
    let asked: Vec<_> = texts.filter_map(|text| task_on_thing(text.as_str()?)).collect();
    let mut refused: BTreeMap<String, usize> = BTreeMap::new();
    for (task, thing) in asked.iter().filter(|(task, thing)| !affords_task(task, thing)) {
        *refused.entry(format!("{task} {thing}")).or_default() += 1;
    }
    let count: usize = refused.values().sum();
    let mut most: Vec<_> = refused.into_iter().collect();
    most.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    most.truncate(40);
    println!("{count} of {} tasks are not afforded, most often {most:?}", asked.len());
    assert!(asked.len() > 5_000 && count * 20 < asked.len(), "{count} of {}", asked.len());
}
