//! `wayword evaluate` on trajectories through a made-up building.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::submissions;

use crate::common::{Building, EPISODES};
use serde_json::{Value, json};
use std::fs;
use submissions::{R2R, annotated, evaluate, evaluate_file, items, problems, report};
use wayword_formats::submission;

/// Items of the building, each with two instructions.
const ITEMS: usize = 10;

fn mean(figures: &Value, metric: &str) -> f64 {
    figures[metric]["mean"].as_f64().unwrap()
}

#[track_caller]
fn is(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9, "{found} is not {expected}");
}

/// The building's graph, read from its file without the program's code.
struct Graph {
    names: Vec<String>,
    at: Vec<[f64; 3]>,
    open: Vec<Vec<bool>>,
}

impl Graph {
    fn of(building: &Building) -> Self {
        let name = format!("{}_connectivity.json", wayword_testkit::SCAN);
        let file = fs::read(building.data().join("matterport/connectivity").join(name)).unwrap();
        let nodes: Vec<Value> = serde_json::from_slice(&file).unwrap();
        let open = |node: &Value| serde_json::from_value(node["unobstructed"].clone()).unwrap();
        Self {
            names: nodes.iter().map(|node| node["image_id"].as_str().unwrap().to_owned()).collect(),
            at: nodes.iter().map(|node| [3, 7, 11].map(|place| node["pose"][place].as_f64().unwrap())).collect(),
            open: nodes.iter().map(open).collect(),
        }
    }

    fn hop_m(&self, a: usize, b: usize) -> f64 {
        (0..3).map(|axis| (self.at[a][axis] - self.at[b][axis]).powi(2)).sum::<f64>().sqrt()
    }

    fn places(&self, trajectory: &Value) -> Vec<usize> {
        let place = |pose: &Value| self.names.iter().position(|name| *name == pose[0]).unwrap();
        trajectory.as_array().unwrap().iter().map(place).collect()
    }

    fn length_m(&self, trajectory: &Value) -> f64 {
        self.places(trajectory).windows(2).map(|pair| self.hop_m(pair[0], pair[1])).sum()
    }

    /// The length of the shortest way from a trajectory's start to its end (Bellman and Ford).
    fn shortest_m(&self, trajectory: &Value) -> f64 {
        let places = self.places(trajectory);
        let mut far_m = vec![f64::INFINITY; self.names.len()];
        far_m[places[0]] = 0.0;
        for _ in 0..far_m.len() {
            for (a, b) in (0..far_m.len()).flat_map(|a| (0..self.names.len()).map(move |b| (a, b))) {
                if self.open[a][b] {
                    far_m[b] = far_m[b].min(far_m[a] + self.hop_m(a, b));
                }
            }
        }
        far_m[places[places.len() - 1]]
    }

    /// Path length weight of a success.
    fn weight(&self, item: &Value) -> f64 {
        let (walked_m, shortest_m) = (self.length_m(&item["trajectory"]), self.shortest_m(&item["trajectory"]));
        shortest_m / walked_m.max(shortest_m)
    }
}

fn average(values: impl Iterator<Item = f64>) -> f64 {
    values.sum::<f64>() / (2 * ITEMS) as f64
}

#[test]
fn annotated_paths_succeed_by_both_rules() {
    let building = Building::new();
    let graph = Graph::of(&building);
    let submitted = annotated(&building, EPISODES);
    let found = report(&evaluate(&building, &submitted, EPISODES, &["--json"]));
    let numbers = [&found["instructions"], &found["items"], &found["paths"]];
    assert_eq!(numbers, [&json!(2 * ITEMS), &json!(ITEMS), &json!(ITEMS)]);
    let spl = average(submitted.iter().map(|item| graph.weight(item)));
    assert!(spl < 1.0, "some annotated paths of the building are not the shortest");
    let rules = found["rules"].as_array().unwrap();
    for (rule, (name, word)) in rules.iter().zip([("visible", "official"), ("distance", "lenient")]) {
        assert_eq!(rule["rule"], name);
        assert!(rule["words"].as_str().unwrap().contains(word), "{rule}");
        for (metric, expected) in [("success_rate", 1.0), ("oracle_success_rate", 1.0), ("spl", spl), ("sdtw", 1.0)] {
            is(mean(&rule["figures"], metric), expected);
        }
        assert_eq!(rule["figures"]["spl"]["clusters"], ITEMS, "intervals are clustered by path");
    }
    assert_eq!(rules.len(), 2);
    let others = &found["whatever_the_rule"];
    for (metric, expected) in [("navigation_error_m", 0.0), ("ndtw", 1.0), ("cls", 1.0), ("rgs", 1.0), ("rgspl", spl)] {
        is(mean(others, metric), expected);
    }
    is(mean(others, "trajectory_length_m"), average(submitted.iter().map(|item| graph.length_m(&item["trajectory"]))));
}

#[test]
fn detours_cost_path_length_and_those_who_stay_fail() {
    let building = Building::new();
    let graph = Graph::of(&building);
    let mut submitted = annotated(&building, R2R);
    let first = submitted[0]["trajectory"].as_array_mut().unwrap();
    let (before, last) = (first[first.len() - 2].clone(), first[first.len() - 1].clone());
    first.extend([before, last]);
    submitted[3]["trajectory"].as_array_mut().unwrap().truncate(1);
    let found = report(&evaluate(&building, &submitted, R2R, &["--json"]));
    let [rule] = found["rules"].as_array().unwrap().as_slice() else { panic!("{found}") };
    assert_eq!(rule["rule"], "distance");
    assert!(rule["words"].as_str().unwrap().contains("R2R's official"), "{found}");
    let stays = |place: &usize| *place == 3;
    let rate = average((0..2 * ITEMS).map(|place| if stays(&place) { 0.0 } else { 1.0 }));
    is(mean(&rule["figures"], "success_rate"), rate);
    is(mean(&rule["figures"], "oracle_success_rate"), rate);
    assert!(graph.weight(&submitted[0]) < 0.9, "no detour");
    let walked = submitted.iter().enumerate().filter(|(place, _)| !stays(place)).map(|(_, item)| item);
    is(mean(&rule["figures"], "spl"), average(walked.map(|item| graph.weight(item))));
    assert!(found["whatever_the_rule"].get("rgs").is_none(), "R2R names no objects: {found}");
}

#[test]
fn a_rule_can_be_chosen_where_it_applies() {
    let building = Building::new();
    let submitted = annotated(&building, EPISODES);
    let found = report(&evaluate(&building, &submitted, EPISODES, &["--rule", "distance", "--json"]));
    assert_eq!(found["rules"].as_array().unwrap().len(), 1);
    let refused = evaluate(&building, &annotated(&building, R2R), R2R, &["--rule", "visible"]);
    assert!(refused.refused().contains("names an object") && refused.err.contains("--rule distance"), "{refused:?}");
}

#[test]
fn the_table_names_rules_intervals_and_numbers() {
    let building = Building::new();
    let mut submitted = annotated(&building, EPISODES);
    for item in &mut submitted {
        item["predObjId"] = Value::Null;
    }
    let ran = evaluate(&building, &submitted, EPISODES, &[]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    for told in [
        "20 instructions of 10 items on 10 paths",
        "REVERIE's official rule",
        "the lenient rule",
        "SR       100.0 %    100.0 to 100.0 %",
        "NE (m)     0.00     0.00 to 0.00",
        "no trajectory names an object",
        "with 95 % intervals, clustered by path",
    ] {
        assert!(ran.out.contains(told), "{told:?} is not in\n{}", ran.out);
    }
}

#[test]
fn intervals_and_figures_of_instructions_are_the_same_each_time() {
    let building = Building::new();
    let mut submitted = annotated(&building, EPISODES);
    for item in submitted.iter_mut().step_by(3) {
        item["trajectory"].as_array_mut().unwrap().truncate(2);
    }
    let with = |args: &[&str]| evaluate(&building, &submitted, EPISODES, &[&["--json"], args].concat()).out;
    assert_eq!(with(&["--seed", "4"]), with(&["--seed", "4"]));
    assert_ne!(with(&["--seed", "4"]), with(&["--seed", "5"]));
    with(&["--per-item", "scores.jsonl"]);
    let lines = building.lines("scores.jsonl");
    let ids = |items: &[Value]| items.iter().map(|item| item["instr_id"].clone()).collect::<Vec<_>>();
    assert_eq!(ids(&lines), ids(&submitted));
    assert_eq!(lines[1]["distance"]["success"], true);
    assert_eq!((&lines[0]["distance"]["success"], &lines[0]["visible"]["spl"]), (&json!(false), &json!(0.0)));
    assert_eq!(lines[0]["item"], items(&building, EPISODES)[0]["id"]);
}

#[test]
fn gzip_and_bare_viewpoints_are_read() {
    let building = Building::new();
    let mut submitted = annotated(&building, R2R);
    for item in &mut submitted {
        let bare = item["trajectory"].as_array().unwrap().iter().map(|pose| json!([pose[0]])).collect();
        item["trajectory"] = bare;
        item.as_object_mut().unwrap().shift_remove("predObjId");
    }
    let plain = building.write("plain.json", Value::from(submitted).to_string());
    submission::write_submission(&building.path("submission.json.gz"), &submission::read_submission(&plain).submitted)
        .unwrap();
    assert!(fs::read(building.path("submission.json.gz")).unwrap().starts_with(&[0x1f, 0x8b]));
    let bare = report(&evaluate_file(&building, "plain.json", R2R, &["--json"]));
    let found = report(&evaluate_file(&building, "submission.json.gz", R2R, &["--json"]));
    is(mean(&found["rules"][0]["figures"], "success_rate"), 1.0);
    assert_eq!(found["rules"], bare["rules"]);
}

#[test]
fn records_over_a_dataset_are_clustered_by_its_paths() {
    let building = Building::new();
    let ran = building.generate("run", &["--episodes", EPISODES, "--style", "reverie"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let mut records = building.lines("run/instructions.jsonl");
    for (place, record) in records.iter_mut().enumerate() {
        record["path_id"] = if place % 2 == 0 { json!(7) } else { json!("8") };
    }
    building.write("records.jsonl", records.iter().map(|record| format!("{record}\n")).collect::<String>());
    let walk = |record: &Value| {
        let frames = record["path"]["frames"].as_array().unwrap().iter();
        let trajectory: Vec<Value> = frames.map(|frame| json!([frame["viewpoint"]])).collect();
        json!({"instr_id": format!("{}_0", record["path"]["id"].as_str().unwrap()), "trajectory": trajectory})
    };
    let submitted: Vec<Value> = records.iter().map(walk).collect();
    let found = report(&evaluate(&building, &submitted, "records.jsonl", &["--json", "--per-item", "scores.jsonl"]));
    assert_eq!((&found["items"], &found["paths"]), (&json!(ITEMS), &json!(2)));
    assert_eq!(found["rules"][0]["figures"]["spl"]["clusters"], 2);
    assert!(building.lines("scores.jsonl")[1]["path"].as_str().unwrap().ends_with("/8"));
}

#[test]
fn evaluate_reports_every_problem_and_scores_no_item() {
    let building = Building::new();
    let mut submitted = annotated(&building, R2R);
    let names: Vec<String> = submitted.iter().map(|item| item["instr_id"].as_str().unwrap().to_owned()).collect();
    let goal = submitted[2]["trajectory"].as_array().unwrap().last().unwrap().clone();
    submitted[0]["instr_id"] = json!("999_0");
    submitted[2]["trajectory"].as_array_mut().unwrap().reverse();
    submitted[4]["trajectory"].as_array_mut().unwrap().remove(2);
    submitted[6]["trajectory"][1] = json!(["nowhere", 0, 0]);
    submitted[8]["trajectory"] = json!([goal, ["nowhere", 0, 0], ["elsewhere", 0, 0]]);
    submitted.pop();
    let ran = evaluate(&building, &submitted, R2R, &["--json", "--per-item", "scores.jsonl"]);
    let found = problems(&ran);
    let of = |name: &str| -> Vec<&str> {
        found.iter().filter(|(id, _)| id == name).map(|(_, problem)| problem.as_str()).collect()
    };
    let one = |name: &str, part: &str| {
        let told = of(name);
        assert!(told.len() == 1 && told[0].contains(part), "{name}: {part:?} is not what is told: {told:?}");
    };
    one("999_0", "no such instruction");
    one(&names[0], "has no trajectory");
    one(&names[2], "starts at");
    one(&names[4], "no edge");
    one(&names[6], "nowhere");
    one(&names[names.len() - 1], "has no trajectory");
    let several = of(&names[8]).join("; ");
    for part in ["starts at", "nowhere", "elsewhere"] {
        assert!(several.contains(part), "{several}");
    }
    assert_eq!(found.len(), 6 + of(&names[8]).len(), "{found:#?}");
    assert!(!building.path("scores.jsonl").exists());
}

#[test]
fn evaluate_reports_a_malformed_file_item_by_item() {
    let building = Building::new();
    let mut submitted = annotated(&building, R2R);
    let second = submitted[1]["instr_id"].as_str().unwrap().to_owned();
    submitted[1]["instr_id"] = submitted[0]["instr_id"].clone();
    submitted[5]["trajectory"] = json!([]);
    submitted[7].as_object_mut().unwrap().shift_remove("trajectory");
    let found = problems(&evaluate(&building, &submitted, R2R, &["--json"]));
    let told: Vec<&str> = found.iter().map(|(_, problem)| problem.as_str()).collect();
    assert_eq!(told.len(), 4, "{told:#?}");
    let is_missing = |(id, problem): &(String, String)| *id == second && problem.contains("has no trajectory");
    assert!(is_missing(&found[3]), "{found:#?}");
    for (told, parts) in told.iter().zip([["item 1", "earlier item"], ["item 5", "empty"], ["item 7", "missing"]]) {
        assert!(parts.iter().all(|part| told.contains(part)) && told.contains("submission.json"), "{told}");
    }
    building.write("broken.json", r#"[{"\u001b[31mred": [}]"#);
    assert_eq!(problems(&evaluate_file(&building, "broken.json", R2R, &["--json"])).len(), 1);
    let shown = evaluate_file(&building, "broken.json", R2R, &[]);
    assert!(shown.out.contains("[31mred") && !shown.out.contains('\u{1b}'), "{shown:?}");
}

#[test]
fn the_screen_shows_twenty_problems_and_counts_the_others() {
    let building = Building::new();
    let submitted: Vec<Value> = (0..25).map(|n| json!({"instr_id": format!("x{n}_0"), "trajectory": ["a"]})).collect();
    let ran = evaluate(&building, &submitted, R2R, &[]);
    assert_eq!(ran.code, Some(1));
    assert_eq!(ran.out.lines().count(), 21, "{ran:?}");
    assert!(ran.out.ends_with("and 25 more\n") && ran.err.contains("45 problems"), "{ran:?}");
}

#[test]
fn positions_of_another_scene_are_refused() {
    let building = Building::new();
    let write = |scene: &str| {
        building.write(
            "vlnce.json",
            json!({"episodes": [{
                "episode_id": 1, "trajectory_id": 1, "scene_id": format!("mp3d/{scene}/{scene}.glb"),
                "start_position": [40.0, 0.0, 0.0], "start_rotation": [0.0, 0.0, 0.0, 1.0],
                "goals": [{"position": [41.0, 0.0, 0.0], "radius": 3.0}],
                "reference_path": [[40.0, 0.0, 0.0], [41.0, 0.0, 0.0]],
                "instruction": {"instruction_text": "Go.", "instruction_tokens": [2]}, "info": {"geodesic_distance": 1.0},
            }], "instruction_vocab": {"word_list": ["<pad>", "<unk>", "go"]}})
            .to_string(),
        );
        evaluate(&building, &annotated(&building, R2R), "vlnce.json", &[])
    };
    assert!(write("x").refused().contains("there is no scene x"));
    let far = write(wayword_testkit::SCAN);
    assert!(far.refused().contains("path 1: its place at 40.00, 0.00, 1.50") && far.err.contains("hint:"), "{far:?}");
}

#[test]
fn evaluate_reports_problems_of_form_and_way_together() {
    let building = Building::new();
    let mut submitted = annotated(&building, R2R);
    let names: Vec<String> = submitted.iter().map(|item| item["instr_id"].as_str().unwrap().to_owned()).collect();
    submitted[0]["trajectory"] = json!([5]);
    submitted[2]["trajectory"].as_array_mut().unwrap().reverse();
    submitted[4]["trajectory"].as_array_mut().unwrap().remove(2);
    submitted[6]["instr_id"] = json!("999_0");
    submitted[8]["instr_id"] = json!("998_0");
    submitted[8]["trajectory"] = json!([]);
    let found = problems(&evaluate(&building, &submitted, R2R, &["--json"]));
    let expected = [
        ("", "item 0"),
        ("", "item 8"),
        ("999_0", "no such instruction"),
        ("998_0", "no such instruction"),
        (names[2].as_str(), "starts at"),
        (&names[4], "no edge"),
        (&names[6], "has no trajectory"),
        (&names[8], "has no trajectory"),
    ];
    assert_eq!(found.len(), expected.len(), "{found:#?}");
    for ((id, problem), (expected_id, part)) in found.iter().zip(expected) {
        assert!(id == expected_id && problem.contains(part), "{id}: {problem}: {part:?} of {expected_id:?} expected");
    }
    let whole = Value::from(submitted).to_string();
    building.write("cut.json", &whole[..whole.len() - 2]);
    let found = problems(&evaluate_file(&building, "cut.json", R2R, &["--json"]));
    assert!(found.iter().any(|(_, problem)| problem.contains("the file is cut off")), "{found:#?}");
    assert!(found.iter().any(|(id, problem)| *id == names[2] && problem.contains("starts at")), "{found:#?}");
    assert!(!found.iter().any(|(_, problem)| problem.contains("has no trajectory")), "{found:#?}");
}

#[test]
fn figures_of_instructions_never_take_the_place_of_an_input() {
    let building = Building::new();
    let submitted = annotated(&building, R2R);
    let before = fs::read(building.path(R2R)).unwrap();
    fs::create_dir(building.path("other")).unwrap();
    for (per_item, input) in [
        ("submission.json", "submission.json"),
        ("other/../submission.json", "submission.json"),
        ("data/../data/r2r/R2R_val_seen.json", R2R),
    ] {
        let ran = evaluate(&building, &submitted, R2R, &["--per-item", per_item]);
        let told = format!("--per-item would overwrite {input}");
        assert!(ran.refused().contains(&told) && ran.err.contains("hint:"), "{ran:?}");
        let kept = fs::read(building.path("submission.json")).unwrap();
        assert_eq!(kept, Value::from(submitted.clone()).to_string().into_bytes());
        assert_eq!(fs::read(building.path(R2R)).unwrap(), before);
    }
    for _ in 0..2 {
        assert_eq!(evaluate(&building, &submitted, R2R, &["--per-item", "scores.jsonl"]).code, Some(0));
    }
}

#[test]
fn a_limit_takes_the_first_items_alone() {
    let building = Building::new();
    let mut submitted = annotated(&building, R2R);
    submitted[8]["trajectory"].as_array_mut().unwrap().reverse();
    submitted.pop();
    assert_eq!(evaluate(&building, &submitted, R2R, &[]).code, Some(1));
    let found = report(&evaluate(&building, &submitted, R2R, &["--limit", "3", "--json"]));
    let numbers = ["instructions", "items", "limit", "left_out"].map(|name| found[name].as_u64().unwrap());
    assert_eq!(numbers, [6, 3, 3, 13]);
    let shown = evaluate(&building, &submitted, R2R, &["--limit", "3"]);
    let told =
        format!("only the first 3 items of {R2R} count; left out, because they are for other items: 13 trajectories");
    assert!(shown.out.lines().nth(1).is_some_and(|line| line == told), "{shown:?}");
    let alone = report(&evaluate(&building, &submitted[..6], R2R, &["--limit", "3", "--json"]));
    assert_eq!((&alone["rules"], &alone["left_out"]), (&found["rules"], &json!(0)));
    submitted[12]["instr_id"] = json!("999_0");
    assert_eq!(problems(&evaluate(&building, &submitted, R2R, &["--limit", "3", "--json"])).len(), 1);
    assert_eq!(evaluate(&building, &submitted, R2R, &["--limit", "0"]).code, Some(2));
}

#[test]
fn evaluate_recognises_a_dataset_or_a_folder_in_place_of_a_submission() {
    let building = Building::new();
    building.run_over_episodes("run");
    fs::create_dir_all(building.path("table/submissions")).unwrap();
    for (given, told) in [
        (R2R, "it is a dataset (format r2r), not a submission"),
        (EPISODES, "it is a dataset (format reverie), not a submission"),
        ("run/instructions.jsonl", "it is a dataset (format wayword), not a submission"),
        ("run", "it is a folder, not a submission"),
        ("table", "name one of the files in table/submissions"),
    ] {
        let ran = evaluate_file(&building, given, R2R, &[]);
        assert!(ran.refused().contains(told) && ran.err.contains("hint:"), "{ran:?}");
    }
}
