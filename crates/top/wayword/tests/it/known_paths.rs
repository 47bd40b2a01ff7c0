//! A path is known, or nothing is judged: test splits that hide the way, and VLN-CE's positions in place of viewpoints.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{Building, Ran, command, run, submissions};
use serde_json::{Value, json};
use std::{collections::BTreeMap, fs};
use submissions::{R2R, annotated, evaluate, report};
use wayword_formats::{Episode, vlnce::VlnceDataset};
use wayword_platforms::MatterportPlatform;
use wayword_run::episode_paths::path_for_episode;

const WORLD: [&str; 4] = ["--platform", "matterport", "--data", "data"];

/// The building's R2R episodes; of every item that `hides` chooses, the path is its start alone.
fn test_split(building: &Building, hides: impl Fn(usize) -> bool) -> &'static str {
    let mut items: Vec<Value> = serde_json::from_slice(&fs::read(building.r2r()).unwrap()).unwrap();
    for (_, item) in items.iter_mut().enumerate().filter(|(at, _)| hides(*at)) {
        item["path"].as_array_mut().unwrap().truncate(1);
    }
    building.write("split.json", Value::from(items).to_string());
    "split.json"
}

fn on_building(building: &Building, args: &[&str]) -> Ran {
    building.wayword(&[args, &WORLD].concat())
}

#[test]
fn agents_and_writers_get_nothing_from_a_split_that_hides_the_way() {
    let building = Building::new();
    let split = test_split(&building, |_| true);
    let submitted = annotated(&building, R2R);
    let scored = evaluate(&building, &submitted, split, &[]);
    let compared = on_building(&building, &["compare", "--episodes", split, "--agents", "reader", "--out", "table"]);
    let written = on_building(&building, &["generate", "--episodes", split, "--style", "r2r", "--out", "run"]);
    for ran in [&scored, &compared, &written] {
        let said = ran.refused();
        assert!(said.contains("one place, as in a test split, whose way is hidden"), "{said}");
        assert!(said.contains("give a split") || said.contains("leaderboard"), "{said}");
    }
    assert!(scored.err.contains("10 of 10 items") && scored.err.contains("the first is item"), "{scored:?}");
    // There is nothing that --partial could score.
    evaluate(&building, &submitted, split, &["--partial"]).refused();
}

#[test]
fn where_some_ways_are_hidden_the_others_are_scored_with_partial_alone() {
    let building = Building::new();
    let split = test_split(&building, |at| at % 2 == 0);
    let submitted = annotated(&building, R2R);
    assert!(evaluate(&building, &submitted, split, &[]).refused().contains("5 of 10 items"));
    let shown = evaluate(&building, &submitted, split, &["--partial"]);
    assert!(shown.out.contains("5 items of split.json not scored"), "{shown:?}");
    let found = report(&evaluate(&building, &submitted, split, &["--partial", "--json"]));
    assert_eq!((&found["items"], &found["hidden_items"]), (&json!(5), &json!(5)), "{found}");
    assert_eq!(found["rules"][0]["figures"]["success_rate"]["mean"], 1.0, "{found}");
    let written = on_building(&building, &["generate", "--episodes", split, "--style", "r2r", "--out", "run"]);
    assert_eq!(written.code, Some(3), "{written:?}");
    assert_eq!(building.records("run").len(), 5);
    let failed = building.lines("run/errors.jsonl");
    assert!(failed.iter().all(|line| line.to_string().contains("test split")) && failed.len() == 5, "{failed:?}");
}

#[test]
fn check_leaves_every_question_about_a_hidden_way_open() {
    let building = Building::new();
    let split = test_split(&building, |_| true);
    for world in ["open", "closed"] {
        let found = on_building(&building, &["check", split, "--json", "--world", world]).json();
        assert_eq!((&found["failed"], &found["passed"]), (&json!(0), &json!(0)), "{found}");
        for text in found["not_passed"].as_array().unwrap() {
            assert!(text.to_string().contains("one place"), "{text}");
        }
    }
}

/// Texts of a run, half of them with left and right swapped, written as R2R and as VLN-CE.
fn write_both_formats(building: &Building) {
    building.run_over_episodes("run");
    for (format, file) in [("r2r", "own.json"), ("vlnce", "own_ce.json.gz")] {
        let ran = building.wayword(&["export", "--run", "run", "--style", "r2r", "--format", format, "--out", file]);
        assert_eq!(ran.code, Some(0), "{ran:?}");
    }
    let mut r2r = wayword_formats::read_any_format(&building.path("own.json")).unwrap();
    let mut vlnce = wayword_formats::vlnce::read_vlnce_file(&building.path("own_ce.json.gz")).unwrap();
    r2r.iter_mut().step_by(2).for_each(swap_sides);
    vlnce.episodes.iter_mut().step_by(2).for_each(swap_sides);
    wayword_formats::r2r::write_r2r_file(&building.path("own.json"), &r2r).unwrap();
    wayword_formats::vlnce::write_vlnce_file(&building.path("own_ce.json.gz"), &vlnce).unwrap();
}

fn swap_sides(episode: &mut Episode) {
    for text in &mut episode.instructions {
        *text = text.replace("left", "RIGHT").replace("right", "left").replace("RIGHT", "right");
    }
}

/// The verdict of every text that did not pass, by its words.
fn verdicts(ran: &Ran) -> BTreeMap<String, String> {
    let found = ran.json();
    let texts = found["not_passed"].as_array().unwrap();
    texts.iter().map(|text| (text["text"].to_string(), text["verdict"].to_string())).collect()
}

#[test]
fn a_text_gets_the_verdict_of_r2r_where_vln_ce_gives_positions() {
    let building = Building::new();
    write_both_formats(&building);
    let [r2r, vlnce] =
        ["own.json", "own_ce.json.gz"].map(|file| verdicts(&on_building(&building, &["check", file, "--json"])));
    assert!(r2r.values().any(|verdict| verdict.contains("fail")), "swapped sides must fail: {r2r:?}");
    assert_eq!(r2r, vlnce);
    // Episodes of VLN-CE are paths to write for, and their way is followed over the viewpoints.
    let written =
        on_building(&building, &["generate", "--episodes", "own_ce.json.gz", "--style", "r2r", "--out", "again"]);
    assert_eq!(written.code, Some(0), "{written:?}");
    let walked = |run: &str| -> Vec<Vec<Value>> {
        let frames = |record: &Value| record["path"]["frames"].as_array().unwrap().clone();
        building.lines(&format!("{run}/instructions.jsonl")).iter().map(frames).collect()
    };
    let again = walked("again");
    assert!(!again.is_empty() && again.iter().all(|frames| frames.iter().all(|frame| frame["viewpoint"].is_string())));
}

/// People's texts on people's paths, each file read by its own format.
#[test]
fn people_s_texts_get_the_verdicts_of_r2r_where_vln_ce_gives_positions() {
    let Some(data) = crate::real_data::data() else { return };
    let platform = MatterportPlatform::open(&data).unwrap();
    let mut r2r = wayword_formats::read_any_format(&data.join("r2r/R2R_val_seen.json")).unwrap();
    r2r.truncate(100);
    let on_floor = |episode: &Episode| {
        let path = path_for_episode(&platform, episode).unwrap();
        episode.clone().with_floor_positions(&path, 1.4)
    };
    let vlnce = VlnceDataset::from_episodes(r2r.iter().map(on_floor).collect());
    let folder = tempfile::tempdir().unwrap();
    let files = [folder.path().join("r2r.json"), folder.path().join("vlnce.json.gz")];
    wayword_formats::r2r::write_r2r_file(&files[0], &r2r).unwrap();
    wayword_formats::vlnce::write_vlnce_file(&files[1], &vlnce).unwrap();
    let [as_r2r, as_vlnce] = files.map(|file| {
        let mut command = command(&["check", "--platform", "matterport", "--json"]);
        verdicts(&run(command.arg("--data").arg(&data).arg(file)))
    });
    let differ = as_r2r.iter().filter(|(text, verdict)| as_vlnce.get(*text) != Some(*verdict)).count();
    assert!(!as_r2r.is_empty() && differ * 50 <= as_r2r.len(), "{differ} of {} verdicts differ", as_r2r.len());
}

#[test]
fn check_refuses_items_without_instructions() {
    let building = Building::new();
    let mut items: Vec<Value> = serde_json::from_slice(&fs::read(building.r2r()).unwrap()).unwrap();
    items.iter_mut().for_each(|item| item["instructions"] = json!([]));
    building.write("bare.json", Value::from(items).to_string());
    let said = on_building(&building, &["check", "bare.json"]);
    assert!(said.refused().contains("bare.json: 10 items without an instruction"), "{said:?}");
}

#[test]
fn an_episode_whose_own_way_jumps_is_named_and_scores_nobody() {
    let building = Building::new();
    let submitted = annotated(&building, R2R);
    let mut items: Vec<Value> = serde_json::from_slice(&fs::read(building.r2r()).unwrap()).unwrap();
    items[1]["path"] = json!([wayword_testkit::viewpoint_id(5), wayword_testkit::viewpoint_id(2)]);
    building.write("jump.json", Value::from(items).to_string());
    let jumped = on_building(&building, &["check", "jump.json"]);
    for said in [evaluate(&building, &submitted, "jump.json", &[]).refused(), jumped.refused()] {
        assert!(said.contains("jump.json: item") && said.contains("there is no edge from"), "{said}");
        assert!(said.contains("leave the item out"), "{said}");
    }
}
