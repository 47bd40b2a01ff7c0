//! Files as they are out there, on the command line; and a terminal that is gone.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{
    Building, EPISODES,
    submissions::{R2R, annotated, evaluate, evaluate_file, problems, report},
};
use serde_json::{Value, json};
use std::fs;

/// The annotated walks, each changed.
fn changed(building: &Building, episodes: &str, change: impl Fn(&mut serde_json::Map<String, Value>)) -> Vec<Value> {
    let mut walks = annotated(building, episodes);
    walks.iter_mut().for_each(|walk| change(walk.as_object_mut().unwrap()));
    walks
}

#[test]
fn the_object_counts_under_the_name_that_vln_duet_gives_it() {
    let building = Building::new();
    let of_duet = changed(&building, EPISODES, |walk| {
        let object = walk.shift_remove("predObjId").unwrap();
        walk.insert("pred_objid".to_owned(), object.as_u64().map_or(object, |number| number.to_string().into()));
    });
    let official = report(&evaluate(&building, &annotated(&building, EPISODES), EPISODES, &["--json"]));
    let found = report(&evaluate(&building, &of_duet, EPISODES, &["--json"]));
    assert_eq!(found["rules"], official["rules"]);
    assert_eq!(found["whatever_the_rule"], official["whatever_the_rule"]);
    assert_eq!(found["whatever_the_rule"]["rgs"]["mean"], 1.0, "{found}");
    let mut mixed = of_duet;
    mixed.truncate(3);
    mixed.extend(annotated(&building, EPISODES).split_off(3));
    let told = problems(&evaluate(&building, &mixed, EPISODES, &["--json"]));
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].1.contains("\"pred_objid\"") && told[0].1.contains("\"predObjId\""), "{told:?}");
}

#[test]
fn submissions_of_other_benchmarks_are_told_once() {
    let building = Building::new();
    let of_soon = changed(&building, R2R, |walk| {
        let path = walk["trajectory"].take();
        walk.insert("trajectory".to_owned(), json!({"path": path, "obj_heading": [0.1], "obj_elevation": [0.2]}));
    });
    let told = problems(&evaluate(&building, &of_soon, R2R, &["--json"]));
    assert!(told.len() == 1 && told[0].1.contains("SOON"), "{told:?}");
    let by_name: serde_json::Map<String, Value> = annotated(&building, R2R)
        .into_iter()
        .map(|mut walk| (walk["instr_id"].as_str().unwrap().to_owned(), walk["trajectory"].take()))
        .collect();
    building.write("by_name.json", Value::from(by_name).to_string());
    let told = problems(&evaluate_file(&building, "by_name.json", R2R, &["--json"]));
    assert!(told.len() == 1 && told[0].1.contains("from names of instructions to trajectories"), "{told:?}");
    building.write("empty.json", "[]");
    assert!(evaluate_file(&building, "empty.json", R2R, &[]).refused().contains("it is an empty list"));
    building.write("walked.json", Value::from(annotated(&building, R2R)).to_string());
    let ran = building.wayword(&["check", "walked.json", "--platform", "matterport", "--data", "data"]);
    assert!(ran.refused().contains("what an agent walked"), "{ran:?}");
}

#[test]
fn walks_of_a_split_file_are_scored_by_the_names_of_its_items() {
    let building = Building::new();
    let items: Vec<Value> = serde_json::from_slice(&fs::read(building.r2r()).unwrap()).unwrap();
    let mut split = Vec::new();
    for item in &items {
        for (place, text) in item["instructions"].as_array().unwrap().iter().enumerate() {
            let mut one = item.clone();
            let fields = one.as_object_mut().unwrap();
            fields.shift_remove("instructions");
            fields.insert("instruction".to_owned(), text.clone());
            fields.insert("instr_id".to_owned(), json!(format!("{}_{place}", item["path_id"])));
            split.push(one);
        }
    }
    building.write("split.json", Value::from(split).to_string());
    let walks = annotated(&building, R2R);
    let whole = report(&evaluate(&building, &walks, R2R, &["--json"]));
    let ran = evaluate(&building, &walks, "split.json", &["--json"]);
    assert!(ran.err.contains("names an instruction by the item alone"), "{ran:?}");
    let found = report(&ran);
    assert_eq!((&found["instructions"], &found["paths"]), (&whole["instructions"], &whole["paths"]));
    assert_eq!(found["whatever_the_rule"], whole["whatever_the_rule"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_standard_error_that_is_full_or_closed_is_no_panic() {
    let building = Building::new();
    let refused = ["evaluate", "nowhere.json", "--episodes", R2R, "--platform", "matterport", "--data", "data"];
    let checked = ["check", R2R, "--platform", "matterport", "--data", "data"];
    for args in [&refused[..], &checked[..]] {
        let usual = building.wayword(args).code;
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        assert_eq!(building.command(args).stderr(full).status().unwrap().code(), usual, "{args:?}");
        let (reader, closed) = std::io::pipe().unwrap();
        drop(reader);
        let output = building.command(args).stderr(closed).output().unwrap();
        assert_eq!(output.status.code(), usual, "{args:?}");
    }
}

#[cfg(unix)]
#[test]
fn an_export_goes_through_a_pipe_and_leaves_it() {
    use std::os::unix::fs::FileTypeExt;
    let building = Building::new();
    building.run_over_episodes("run");
    let pipe = building.path("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reader = {
        let pipe = pipe.clone();
        std::thread::spawn(move || fs::read(pipe).unwrap())
    };
    let export =
        |out: &str| building.wayword(&["export", "--run", "run", "--style", "r2r", "--format", "r2r", "--out", out]);
    let ran = export("pipe");
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(!ran.err.contains("replaced") && !ran.out.contains("provenance in"), "{ran:?}");
    let through = reader.join().unwrap();
    assert!(fs::metadata(&pipe).unwrap().file_type().is_fifo());
    assert_eq!(export("file.json").code, Some(0));
    assert_eq!(fs::read(building.path("file.json")).unwrap(), through);
    let ran = export("-");
    assert!(ran.code == Some(0) && !building.path("-").exists(), "{ran:?}");
    assert_eq!(ran.out.as_bytes(), through);
}
