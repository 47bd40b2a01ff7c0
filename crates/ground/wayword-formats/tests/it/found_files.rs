//! Files as they are out there: read, or refused with what they are and what to do.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use serde_json::{Value, json};
use std::{fs, path::Path};
use wayword_formats::{
    DatasetFormat, Episode, detect_format, read_any_format,
    submission::{InstructionNaming, SubmissionReading, instr_id, name_as_episodes, read_submission},
    vlnce,
};

fn in_file<T>(contents: impl AsRef<[u8]>, look: impl FnOnce(&Path) -> T) -> T {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file.json");
    fs::write(&file, contents).unwrap();
    look(&file)
}

fn episodes(contents: impl AsRef<[u8]>) -> Vec<Episode> {
    in_file(contents, read_any_format).unwrap()
}

/// The error without the file's folder.
fn refusal(contents: impl AsRef<[u8]>) -> String {
    let told = in_file(contents, read_any_format).unwrap_err().to_string();
    told.split_once("file.json: ").unwrap().1.to_owned()
}

fn submission(contents: impl AsRef<[u8]>) -> SubmissionReading {
    in_file(contents, read_submission)
}

/// The problems of a submission, without its folder.
fn problems(contents: impl AsRef<[u8]>) -> Vec<String> {
    let told = submission(contents).problems.listed.into_iter().map(|problem| problem.to_string());
    told.map(|problem| problem.split_once("file.json: ").unwrap().1.to_owned()).collect()
}

fn lines(items: &[Value]) -> String {
    items.iter().map(|item| format!("{item}\n")).collect()
}

fn walk(name: &str) -> Value {
    json!({"instr_id": name, "trajectory": [["hall", 0.5, 0.0], ["door", 0.5, 0.0]]})
}

#[allow(clippy::needless_pass_by_value, reason = "short calls")]
fn with(mut item: Value, fields: Value) -> Value {
    item.as_object_mut().unwrap().extend(fields.as_object().unwrap().clone());
    item
}

#[test]
fn an_object_is_read_by_the_names_that_agents_give_it() {
    for field in ["predObjId", "pred_objid", "pred_obj_id", "predObjID", "pred_objId"] {
        let items =
            json!([with(walk("1_5_0"), json!({field: "5"})), with(walk("1_5_1"), json!({field: null})), walk("1_5_2")]);
        let read = submission(items.to_string());
        assert_eq!(read.problems.count(), 0, "{field}: {:?}", read.problems);
        let objects: Vec<_> = read.submitted.iter().map(|item| item.object.as_ref().map(ToString::to_string)).collect();
        assert_eq!(objects, [Some("5".to_owned()), None, None], "{field}");
    }
    let both = json!([with(walk("1_5_0"), json!({"pred_objid": 5, "predObjId": "5"}))]);
    assert_eq!(submission(both.to_string()).problems.count(), 0, "both say the same");
}

#[test]
fn names_of_objects_that_differ_are_refused_with_both() {
    let differs = json!([with(walk("1_5_0"), json!({"pred_objid": 5, "predObjId": 6}))]);
    let told = problems(differs.to_string());
    assert!(told.len() == 1 && told[0].contains("\"pred_objid\"") && told[0].contains("\"predObjId\""), "{told:?}");
    let mixed = json!([
        with(walk("1_5_0"), json!({"pred_objid": 5})),
        with(walk("1_5_1"), json!({"predObjId": 5})),
        with(walk("1_5_2"), json!({"predObjId": 5})),
    ]);
    let told = problems(mixed.to_string());
    assert_eq!(told.len(), 1, "told once: {told:?}");
    assert!(told[0].starts_with("item 1 (id 1_5_1)"), "{told:?}");
    assert!(told[0].contains("\"pred_objid\"") && told[0].contains("\"predObjId\""), "{told:?}");
    for field in ["objId", "pred_obj", "predicted_object_id"] {
        let other = json!([walk("1_5_0"), with(walk("1_5_1"), json!({field: 5}))]);
        let told = problems(other.to_string());
        assert!(told.len() == 1 && told[0].contains(&format!("field \"{field}\"")), "{told:?}");
        assert!(told[0].contains("rename it to \"predObjId\""), "{told:?}");
    }
    let beside = json!([with(walk("1_5_0"), json!({"objId": 5, "predObjId": 6, "pred_obj_direction": [0.1, 0.2]}))]);
    assert_eq!(submission(beside.to_string()).problems.count(), 0, "the object of the dataset may stand beside it");
}

#[test]
fn a_submission_may_be_json_lines() {
    let read = submission(lines(&[walk("1_0"), walk("1_1")]));
    assert_eq!((read.submitted.len(), read.problems.count(), read.is_whole), (2, 0, true));
    let told = problems(format!("{}{}", lines(&[walk("1_0")]), "{\"instr_id\": \"1_1\", \"trajectory\": [[\"a\""));
    assert!(told[0].starts_with("line 2: field \"trajectory[0]\": the file is cut off"), "{told:?}");
}

#[test]
fn submissions_of_other_kinds_are_told_once_by_what_they_are() {
    let of_soon = |name: &str| json!({"instr_id": name, "trajectory": {"path": [["a"], ["b"]], "obj_heading": [0.1]}});
    let at = json!({"position": [0.0, 0.1, 0.2], "heading": 0.0, "stop": false});
    let rxr_ce = json!({"instruction_id": 5, "path": [[0.0, 0.1, 0.2]]});
    for (contents, told) in [
        (json!([of_soon("1_0"), of_soon("1_1")]).to_string(), ["SOON", "its \"path\" as the trajectory"]),
        (
            json!({"1_0": [["a", 0, 0]], "1_1": [["b", 0, 0]]}).to_string(),
            ["from names of instructions to trajectories", "write a list"],
        ),
        (
            json!({"1_0": {"trajectory": [["a", 0, 0]]}}).to_string(),
            ["from names of instructions to trajectories", "write a list"],
        ),
        (json!({"0": [at], "1": [at]}).to_string(), ["VLN-CE's", "positions cannot be scored"]),
        (lines(&[rxr_ce.clone(), rxr_ce.clone()]), ["VLN-CE's", "positions cannot be scored"]),
        (json!([rxr_ce]).to_string(), ["VLN-CE's", "positions cannot be scored"]),
        (json!([{"instr_id": "1_0", "trajectory": [at]}]).to_string(), ["it is a position", "viewpoints"]),
        (json!([{"instr_id": "1_0", "trajectory": [[0.5, 0.1, 2.0]]}]).to_string(), ["it is a position", "viewpoints"]),
        (
            json!({"version": 1, "data": [walk("1_0")]}).to_string(),
            ["\"version\", \"data\", and the list is in \"data\"", "that list alone"],
        ),
        ("instr_id,trajectory\n1_0,a b\n".to_owned(), ["a table", "JSON"]),
        ("%PDF-1.7".to_owned(), ["a PDF", "give the file with the data"]),
        ("[{'instr_id': '1_0'}]".to_owned(), ["Python's own notation", "json.dump"]),
    ] {
        let found = problems(&contents);
        assert_eq!(found.len(), 1, "{contents}: {found:?}");
        assert!(told.iter().all(|told| found[0].contains(told)), "{contents}: {found:?}");
        assert!(!found[0].contains("fetch") && !found[0].contains("bracket"), "{found:?}");
    }
}

#[test]
fn numbers_that_json_lacks_are_named_with_their_field() {
    let item = crate::common::items(DatasetFormat::R2r).remove(0);
    for number in ["NaN", "Infinity", "-Infinity"] {
        for text in [json!([item]).to_string(), lines(std::slice::from_ref(&item))] {
            let told = refusal(text.replace("\"heading\":1.5", &format!("\"heading\":{number}")));
            assert!(told.contains("field \"heading\": it holds NaN or Infinity, which Python's json writes"), "{told}");
            assert!(told.ends_with("write a number there; null only where a value may be missing"), "{told}");
        }
    }
    let first = refusal(lines(&[item]).replace("7.5", "NaN"));
    assert!(first.contains("field \"distance\": it holds NaN"), "{first}");
    let told = problems(json!([walk("1_0")]).to_string().replace("0.5", "NaN"));
    assert!(told[0].contains("field \"trajectory[0]\": it holds NaN"), "{told:?}");
    let items = crate::common::items(DatasetFormat::Vlnce);
    let told = refusal(crate::common::text(DatasetFormat::Vlnce, &items).replacen("2.5,0.125", "NaN,0.125", 1));
    assert!(told.contains("field \"reference_path[1]\": it holds NaN"), "{told}");
}

#[test]
fn files_that_are_no_datasets_are_named() {
    let graph = json!([{"image_id": "a", "pose": [], "unobstructed": []}]);
    for (contents, told) in [
        (b"[]".as_slice(), "it is an empty list"),
        (json!([walk("1_0")]).to_string().as_bytes(), "what an agent walked"),
        (lines(&[walk("1_0")]).as_bytes(), "what an agent walked"),
        (json!({"1_0": [["a", 0, 0]]}).to_string().as_bytes(), "what an agent walked"),
        (graph.to_string().as_bytes(), "the viewpoint graph of a scene"),
        (json!([{"inst_idx": 1, "scan": "s"}]).to_string().as_bytes(), "CVDN"),
        (
            json!([{"id": 1, "scan": "s", "question": "?", "planner_path": []}]).to_string().as_bytes(),
            "CVDN's dialogues (NDH)",
        ),
        (json!([{"scan": "s", "end_panos": [], "start_pano": {}}]).to_string().as_bytes(), "CVDN's dialogues (NDH)"),
        (json!([{"scan": "s", "dialog_history": []}]).to_string().as_bytes(), "CVDN's dialogues (NDH)"),
        (b"name = \"mine\"\n", "it is TOML"),
        (json!({"data": crate::common::items(DatasetFormat::R2r)}).to_string().as_bytes(), "the list is in \"data\""),
        (b"[{\"scan\": \"caf\xe9\"}]", "it is not UTF-8"),
        (b"PK\x03\x04", "a zip archive"),
        (b"<html>", "a web page"),
        (b"path_id,scan,path\n1,s,\"a b\"\n", "a table"),
        (b"[\n{\"scan\": ", "the file is cut off"),
    ] {
        let found = refusal(contents);
        assert!(found.contains(told), "{found}");
        assert!(!found.contains("fetch") || told.contains("cut off"), "{found}");
    }
}

#[test]
fn items_may_stand_in_lines_or_in_a_list() {
    for format in [DatasetFormat::R2r, DatasetFormat::Reverie, DatasetFormat::Rxr] {
        let items = crate::common::items(format);
        let (list, in_lines) = (Value::from(items.clone()).to_string(), lines(&items));
        for text in [list.clone(), in_lines.clone(), format!("\n{in_lines}\n")] {
            assert_eq!(in_file(&text, detect_format).unwrap(), format, "{text}");
            assert_eq!(episodes(&text), episodes(&list), "{text}");
        }
    }
}

/// An item for each instruction, as loaders write them.
fn split_items(objects: bool) -> Vec<Value> {
    let item = |path: u64, place: u64| {
        let mut item = json!({
            "scan": "house1", "path_id": path, "path": ["hall", "door"], "heading": 1.5, "instruction": format!("Go {place}."),
            "instr_id": format!("{path}_{place}"), "instr_encoding": [101, 102],
        });
        if objects {
            item["objId"] = json!(66);
            item["id"] = json!(format!("{path}_66"));
            item["instr_id"] = json!(format!("{path}_66_{place}"));
        }
        item
    };
    vec![item(7, 0), item(7, 2), item(8, 1)]
}

#[test]
fn items_that_a_loader_has_split_are_read() {
    for (objects, ids) in [(false, ["7_0", "7_2", "8_1"]), (true, ["7_66_0", "7_66_2", "8_66_1"])] {
        let read = episodes(Value::from(split_items(objects)).to_string());
        assert_eq!(read.iter().map(|episode| episode.id.as_str()).collect::<Vec<_>>(), ids);
        assert_eq!(read[1].instructions, ["Go 2."]);
        assert_eq!((read[0].path_id.as_str(), read[2].path_id.as_str()), ("7", "8"));
        assert!(read.iter().all(|episode| !episode.extra.contains_key("instr_encoding")));
        let mut walked = submission(Value::from(ids.map(walk).to_vec()).to_string());
        assert_eq!(name_as_episodes(&mut walked, &read), InstructionNaming::Item);
        assert_eq!(walked.submitted[1].instr_id, instr_id(&read[1], 0));
    }
    let for_pre_training = json!([{"instr_id": "7_0", "path_id": 7, "scan": "house1", "path": ["hall"], "heading": 0, "instr_encoding": [1]}]);
    assert!(refusal(for_pre_training.to_string()).contains("the ids of the tokens alone"));
}

#[test]
fn names_of_instructions_are_understood_where_one_way_explains_them_all() {
    let rxr = episodes(lines(
        &(0..3_u64)
            .map(|n| {
                with(
                    crate::common::items(DatasetFormat::Rxr).remove(0),
                    json!({"instruction_id": 20 + n, "path_id": 5 + n / 2}),
                )
            })
            .collect::<Vec<_>>(),
    ));
    let renamed = |names: &[&str], episodes: &[Episode]| {
        let mut read = submission(Value::from(names.iter().map(|name| walk(name)).collect::<Vec<_>>()).to_string());
        let way = name_as_episodes(&mut read, episodes);
        (way, read.submitted.into_iter().map(|item| item.instr_id).collect::<Vec<_>>())
    };
    let own = ["20_0", "21_0", "22_0"];
    assert_eq!(renamed(&own, &rxr), (InstructionNaming::ItemAndPlace, own.map(str::to_owned).to_vec()));
    assert_eq!(renamed(&["20", "21", "22"], &rxr), (InstructionNaming::Item, own.map(str::to_owned).to_vec()));
    let of_hamt = ["5_20", "5_21", "6_22"];
    assert_eq!(renamed(&of_hamt, &rxr), (InstructionNaming::PathAndItem, own.map(str::to_owned).to_vec()));
    let mixed = ["5_20", "21", "6_22"];
    assert_eq!(renamed(&mixed, &rxr), (InstructionNaming::ItemAndPlace, mixed.map(str::to_owned).to_vec()));
    let mut named = crate::common::items(DatasetFormat::Reverie);
    named.iter_mut().enumerate().for_each(|(n, item)| item["id"] = json!(format!("{n}_66_x")));
    let named = episodes(Value::from(named).to_string());
    let expected = vec!["0_66_x_0".to_owned(), "1_66_x_0".to_owned()];
    assert_eq!(renamed(&["0_66_0", "1_66_0"], &named), (InstructionNaming::PathObjectAndPlace, expected));
}

#[test]
fn headings_in_degrees_are_asked_about() {
    for format in [DatasetFormat::R2r, DatasetFormat::Reverie, DatasetFormat::Rxr] {
        let with_headings = |headings: [f64; 3]| {
            let mut items = crate::common::items(format);
            items.iter_mut().zip(headings).for_each(|(item, heading)| item["heading"] = json!(heading));
            crate::common::text(format, &items)
        };
        for degrees in [[0.0, 180.0, 90.0], [-170.0, -5.0, 20.0], [1.0, 2.0, 270.0]] {
            let told = refusal(with_headings(degrees));
            assert!(told.contains("field \"heading\"") && told.contains("look like degrees"), "{told}");
        }
        for radians in [[0.0, 6.2, 7.0], [-3.1, 0.0, 3.1], [9.5, 0.0, 0.0]] {
            assert_eq!(episodes(with_headings(radians)).len(), 3);
        }
    }
}

/// An episode of RxR's VLN-CE.
fn rxr_ce(n: u64) -> Value {
    let mut item = crate::common::items(DatasetFormat::Vlnce).remove(0);
    item["episode_id"] = json!(n.to_string());
    item["instruction"] = json!({
        "instruction_id": (9_000 + n).to_string(), "instruction_text": format!("Walk to door {n}."), "language": "hi-IN",
        "annotator_id": "12", "edit_distance": 0.05, "timed_instruction": [{"word": "Walk", "start_time": 0.2}],
        "instruction_tokens": ["walk", "to", "door"],
    });
    item["info"] = json!({"role": "guide", "geodesic_distance": 6.2});
    item
}

#[test]
fn vln_ce_is_read_without_what_only_its_agents_use() {
    let file = json!({"episodes": [rxr_ce(0), rxr_ce(1)]}).to_string();
    let read = episodes(&file);
    assert_eq!(
        (read.len(), read[1].instructions[0].as_str(), read[1].language_of(0)),
        (2, "Walk to door 1.", Some("hi-IN"))
    );
    assert_eq!(read[0].floor_positions.len(), 3);
    let dataset = in_file(&file, vlnce::read_vlnce_file).unwrap();
    assert!(dataset.vocabulary.words().iter().any(|word| word == "door"), "a new vocabulary");
    // Numbers mean nothing without the list that numbers them.
    let mut numbered = rxr_ce(0);
    numbered["instruction"]["instruction_tokens"] = json!([7, 8, 9]);
    let dataset = in_file(json!({"episodes": [numbered]}).to_string(), vlnce::read_vlnce_file).unwrap();
    assert_ne!(dataset.vocabulary.tokens_of("Walk to door 0.")[..3], [7, 8, 9]);
}

#[test]
fn a_test_split_of_vln_ce_has_its_start_alone() {
    let mut hidden = rxr_ce(0);
    hidden["goals"] = Value::Null;
    hidden["reference_path"] = Value::Null;
    let mut bare = rxr_ce(1);
    for field in ["goals", "reference_path", "trajectory_id", "info"] {
        bare.as_object_mut().unwrap().shift_remove(field);
    }
    for read in episodes(json!({"episodes": [hidden, bare]}).to_string()) {
        assert_eq!((read.floor_positions.len(), read.viewpoints.len()), (1, 0), "{read:?}");
        assert!(read.start_heading.is_some());
    }
}
