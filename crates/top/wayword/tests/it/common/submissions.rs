//! Shared by the tests of `wayword evaluate`: trajectories through the building, scored by the binary.

#![allow(dead_code, reason = "each test binary uses its own part")]

use crate::common::{Building, Ran};
use serde_json::{Value, json};
use std::fs;

/// The R2R episodes, from the building's folder.
pub(crate) const R2R: &str = "data/r2r/R2R_val_seen.json";

/// The items of a dataset.
pub(crate) fn items(building: &Building, episodes: &str) -> Vec<Value> {
    serde_json::from_slice(&fs::read(building.path(episodes)).unwrap()).unwrap()
}

/// An item's name in its dataset.
fn id(item: &Value) -> String {
    item["id"].as_str().map_or_else(|| item["path_id"].to_string(), str::to_owned)
}

/// The annotated path of every item, once for each of its two instructions.
pub(crate) fn annotated(building: &Building, episodes: &str) -> Vec<Value> {
    let walk = |item: &Value| {
        let pose = |viewpoint: &Value| json!([viewpoint, 0.5, 0.0]);
        let trajectory: Vec<Value> = item["path"].as_array().unwrap().iter().map(pose).collect();
        let object = item.get("objId").cloned();
        let of =
            |place| json!({"instr_id": format!("{}_{place}", id(item)), "trajectory": trajectory, "predObjId": object});
        [of(0), of(1)]
    };
    items(building, episodes).iter().flat_map(walk).collect()
}

/// `wayword evaluate` on these trajectories.
pub(crate) fn evaluate(building: &Building, submitted: &[Value], episodes: &str, args: &[&str]) -> Ran {
    building.write("submission.json", Value::from(submitted.to_vec()).to_string());
    evaluate_file(building, "submission.json", episodes, args)
}

/// `wayword evaluate` on a file.
pub(crate) fn evaluate_file(building: &Building, file: &str, episodes: &str, args: &[&str]) -> Ran {
    let mut all = vec!["evaluate", file, "--episodes", episodes, "--platform", "matterport", "--data", "data"];
    all.extend(args);
    building.wayword(&all)
}

/// The figures of a submission that was scored.
pub(crate) fn report(ran: &Ran) -> Value {
    assert_eq!(ran.code, Some(0), "{ran:?}");
    ran.json()
}

/// The problems of a submission that is refused: instruction and problem.
pub(crate) fn problems(ran: &Ran) -> Vec<(String, String)> {
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(ran.err.contains("nothing was scored") && ran.err.contains("hint:"), "{ran:?}");
    let found = ran.json();
    assert_eq!(found["scored"], 0);
    assert!(found.get("rules").is_none(), "half scored: {found}");
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let told = |problem: &Value| (text(&problem["instr_id"]), text(&problem["problem"]));
    found["problems"].as_array().unwrap().iter().map(told).collect()
}
