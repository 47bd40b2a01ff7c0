//! The follower's part in the commands: wrong turns and texts that lead elsewhere in `check`, ambiguity in the records of
//! `generate`, languages, and calibrations.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::{Building, EPISODES, Ran};
use serde_json::{Value, json};
use std::path::Path;
use wayword_core::{MentionKind, Side, TurnKind};
use wayword_testkit::{SCAN, viewpoint_id};

/// From the refrigerator through the kitchen and the hallway to the entryway, and right into the living room.
const TO_THE_LAMP: [usize; 5] = [5, 4, 1, 0, 2];
/// Looking along the first hop, radians.
const SOUTH: f64 = 3.3;
const GOOD: &str = "Leave the kitchen and walk to the entryway. Turn right at the coat rack and go into the living room. Stop at the lamp.";
const ELSEWHERE: &str = "Leave the kitchen and walk into the hallway. Turn left and go up the stairs. At the top turn right into the \
                         bathroom and stop by the toilet.";

fn path() -> Vec<String> {
    TO_THE_LAMP.iter().map(|index| viewpoint_id(*index)).collect()
}

/// Checks texts about the path to the lamp.
fn check(building: &Building, texts: &[&str], more: &[&str]) -> Value {
    let item = json!({ "path_id": 1, "scan": SCAN, "path": path(), "heading": SOUTH, "distance": 12.0, "instructions": texts });
    building.write("texts.json", json!([item]).to_string());
    check_file(building, "texts.json", more).json()
}

fn check_file(building: &Building, file: &str, more: &[&str]) -> Ran {
    let mut arguments = vec!["check", file, "--platform", "matterport", "--data", "data", "--json"];
    arguments.extend(more);
    building.wayword(&arguments)
}

/// The findings of a check in a report: verdict, reason, and the words that they are about.
fn of_check(report: &Value, check: &str) -> Vec<[String; 3]> {
    let texts = report["not_passed"].as_array().unwrap();
    let findings = texts.iter().flat_map(|text| {
        let words = text["text"].as_str().unwrap();
        text["findings"].as_array().unwrap().iter().map(move |finding| (words, finding))
    });
    let told = |(words, finding): (&str, &Value)| {
        let span = finding["span"].as_array();
        let at = |span: &Vec<Value>, end: usize| span[end].as_u64().unwrap() as usize;
        let about = span.map_or("", |span| &words[at(span, 0)..at(span, 1)]);
        [finding["verdict"].as_str().unwrap(), finding["reason"].as_str().unwrap_or(""), about].map(str::to_owned)
    };
    findings.filter(|(_, finding)| finding["check"] == check).map(told).collect()
}

#[test]
fn a_wrong_turn_fails_at_its_word() {
    let building = Building::new();
    let wrong = GOOD.replace("right", "left");
    let report = check(&building, &[&wrong], &["--world", "open"]);
    let turns = of_check(&report, "turns");
    assert!(turns.iter().any(|[verdict, _, about]| verdict == "fail" && about.contains("left")), "{report}");
    let report = check(&building, &[GOOD], &["--world", "open"]);
    assert_eq!((&report["failed"], of_check(&report, "turns")), (&json!(0), vec![]), "{report}");
}

#[test]
fn turns_that_are_not_judged_are_unverified_with_the_reason() {
    let building = Building::new();
    let wrong = GOOD.replace("right", "left");
    let report = check(&building, &[&wrong], &["--world", "open", "--no-route"]);
    let turns = of_check(&report, "turns");
    assert!(
        matches!(&turns[..], [[verdict, reason, about]]
            if verdict == "unverified" && reason.contains("not followed") && about.contains("left")),
        "{report}"
    );
    let standing = json!([{ "path_id": 1, "scan": SCAN, "path": [viewpoint_id(5)], "heading": SOUTH, "distance": 0.0,
        "instructions": ["Turn left, then turn right twice."] }]);
    building.write("standing.json", standing.to_string());
    let report = check_file(&building, "standing.json", &[]).json();
    assert_eq!(report["by_check"]["turns"], json!({ "passed": 0, "unverified": 1, "failed": 0 }), "{report}");
    for finding in of_check(&report, "turns").iter().chain(&of_check(&report, "route")) {
        assert!(finding[1].contains("one place"), "{finding:?}");
    }
}

#[test]
fn route_fails_for_a_text_that_leads_elsewhere_unless_no_route() {
    let building = Building::new();
    let report = check(&building, &[ELSEWHERE], &["--world", "open"]);
    let route = of_check(&report, "route");
    assert!(route.iter().any(|[verdict, reason, _]| verdict == "fail" && reason.contains("elsewhere")), "{report}");
    assert_eq!(report["by_check"]["route"]["failed"], 1);
    let report = check(&building, &[ELSEWHERE], &["--world", "open", "--no-route"]);
    assert_eq!((of_check(&report, "route"), &report["by_check"]["route"]), (vec![], &Value::Null), "{report}");
    // In a closed world a text of ours is followed too.
    let report = check(&building, &[ELSEWHERE], &["--world", "closed"]);
    assert_eq!(report["by_check"]["route"]["failed"], 1, "{report}");
}

#[test]
fn a_text_that_is_not_understood_is_not_followed() {
    let building = Building::new();
    for text in
        ["Gehe ins Bad.", "Gehen Sie durch die Küche und dann links ins Bad.", "Xyzzy plugh bathroom frobnicate."]
    {
        let report = check(&building, &[text], &["--world", "open"]);
        assert_eq!((&report["failed"], &report["unverified"]), (&json!(0), &json!(1)), "{text}: {report}");
        let route = of_check(&report, "route");
        let is_said = |[verdict, reason, _]: &[String; 3]| verdict == "unverified" && reason.contains("not understand");
        assert!(route.iter().all(is_said) && !route.is_empty(), "{text}: {report}");
    }
}

#[test]
fn texts_about_houses_are_followed_on_the_graph_of_the_house() {
    let building = Building::new();
    let house = ["--paths", "1", "--scan", "house2-3", "--seed", "3", "--style", "r2r", "--no-pictures"];
    let ran = building.wayword(&[&["generate", "--out", "run", "--json"], &house[..]].concat());
    let summary = ran.json();
    assert_eq!((ran.code, &summary["passed"], &summary["unfollowed"]), (Some(0), &json!(1), &json!(0)), "{summary}");
    let record = building.lines("run/instructions.jsonl").remove(0);
    let finding = record["findings"].as_array().unwrap().iter().find(|finding| finding["check"] == "route").unwrap();
    assert_eq!((&finding["verdict"], &record["verdict"]), (&json!("pass"), &json!("pass")), "{record}");
    assert!(record["ambiguity"]["ends"].as_u64().is_some_and(|ends| ends >= 1), "{record}");
    for world in ["open", "closed"] {
        let report = building.wayword(&["check", "run/instructions.jsonl", "--world", world, "--json"]).json();
        assert_eq!(report["by_check"]["route"]["passed"], json!(1), "{world}: {report}");
    }
}

#[test]
fn records_carry_what_check_finds_of_their_ambiguity() {
    let building = Building::new();
    let records = building.run_over_episodes("run");
    let checked = check_file(&building, "run/instructions.jsonl", &[]).json();
    let ambiguous = |record: &&wayword_formats::jsonl::InstructionRecord| {
        record.instruction.ambiguity.as_ref().is_some_and(wayword_core::TextAmbiguity::is_ambiguous)
    };
    let number = records.iter().filter(ambiguous).count();
    assert!(number > 0 && number < records.len(), "{number}");
    assert_eq!(checked["ambiguous"], number);
    let listed: Vec<&str> =
        checked["ambiguous_texts"].as_array().unwrap().iter().map(|text| text["text"].as_str().unwrap()).collect();
    let told = records.iter().filter(ambiguous).map(|record| record.instruction.text.as_str());
    assert_eq!(listed, told.collect::<Vec<_>>(), "each is listed, also where it passed");
    assert!(
        checked["ambiguous_texts"][0]["path"].is_string() && checked["ambiguous_texts"][0]["ambiguity"].is_object()
    );
    assert!(records.iter().all(|record| record.instruction.ambiguity.as_ref().unwrap().ends.is_some()));

    let summary = building.generate("run", &["--episodes", EPISODES, "--style", "reverie", "--style", "r2r", "--json"]);
    assert_eq!(summary.json()["ambiguous"], number);
    assert_eq!(building.wayword(&["report", "--run", "run"]).code, Some(0));
    let page = std::fs::read_to_string(building.path("run/report.html")).unwrap();
    assert!(page.contains("the text is ambiguous") && page.contains(">ambiguous</th>"));
}

#[test]
fn ambiguous_texts_are_rejected_where_that_is_asked() {
    let building = Building::new();
    building.generate("run", &["--episodes", EPISODES, "--reject-ambiguous"]);
    let kept = building.records("run");
    assert!(!kept.is_empty());
    assert!(kept.iter().all(|record| !record.instruction.ambiguity.as_ref().unwrap().is_ambiguous()));
    let rejected = building.lines("run/rejected.jsonl");
    let by_that = |line: &&Value| line["reason"].as_str().unwrap().contains("ambiguous");
    let line = rejected.iter().find(by_that).unwrap();
    assert!(line["last"]["ambiguity"]["objects"].is_number(), "{line}");
    let both = building.generate("both", &["--episodes", EPISODES, "--reject-ambiguous", "--no-route"]);
    assert!(both.refused().contains("cannot be combined"));
}

#[test]
fn records_of_older_versions_are_read_without_it() {
    let building = Building::new();
    building.run_over_episodes("run");
    let mut lines = building.lines("run/instructions.jsonl");
    for line in &mut lines {
        assert!(line.as_object_mut().unwrap().remove("ambiguity").is_some());
        let findings = line["findings"].as_array_mut().unwrap();
        findings.retain(|finding| finding["check"] != "route");
    }
    let older: String = lines.iter().map(|line| format!("{line}\n")).collect();
    building.write("run/instructions.jsonl", older);
    assert!(building.records("run").iter().all(|record| record.instruction.ambiguity.is_none()));
    assert_eq!(check_file(&building, "run/instructions.jsonl", &[]).code, Some(0));
    assert_eq!(building.wayword(&["report", "--run", "run"]).code, Some(0));
    let exported = building.wayword(&["export", "--run", "run", "--format", "wayword", "--out", "out.jsonl"]);
    assert_eq!(exported.code, Some(0), "{exported:?}");
    let wrong = std::fs::read_to_string(building.path("out.jsonl")).unwrap().replacen("{", "{\"ambiguity\":7,", 1);
    building.write("wrong.jsonl", wrong);
    let refused = building.wayword(&["check", "wrong.jsonl", "--platform", "matterport", "--data", "data"]);
    assert!(refused.refused().contains("ambiguity"));
}

/// The turns in a text are turns of the path, in their order. Most turns of 55 degrees or more are mentioned; one at the start,
/// or one that follows from a room or stairs, may be left out ("leave the hall", "go down the stairs").
#[test]
fn texts_mention_turns_in_order_and_most_large_ones() {
    let building = Building::new();
    building.generate("run", &["--paths", "40", "--style", "r2r"]);
    let (mut turns, mut told_turns) = (0, 0);
    for record in building.records("run") {
        let text = &record.instruction.text;
        let words = record.instruction.mentions.iter().filter(|mention| mention.kind == MentionKind::Turn);
        let words: Vec<&str> = words.map(|mention| &text[mention.span[0]..mention.span[1]]).collect();
        let told = words.iter().filter_map(|words| match words.to_lowercase() {
            words if words.contains("left") => Some(Side::Left),
            words if words.contains("right") => Some(Side::Right),
            _ => None,
        });
        let told: Vec<Side> = told.collect();
        let moves = record.path.moves();
        // A bend of several moves may be mentioned as one turn.
        let bends = moves.iter().filter(|step| step.turn_rad.to_degrees().abs() >= 10.0);
        let mut bends = bends.map(|step| if step.turn_rad > 0.0 { Side::Right } else { Side::Left });
        assert!(told.iter().all(|side| bends.any(|bend| bend == *side)), "{text}: {moves:?}");
        let real: Vec<Side> = moves
            .iter()
            .map(|step| step.turn())
            .filter(|turn| matches!(turn, TurnKind::Left | TurnKind::Right))
            .filter_map(TurnKind::side)
            .collect();
        let count = |sides: &[Side], side| sides.iter().filter(|other| **other == side).count();
        told_turns +=
            [Side::Left, Side::Right].map(|side| count(&told, side).min(count(&real, side))).iter().sum::<usize>();
        turns += real.len();
    }
    assert!(turns > 20 && 2 * told_turns > turns, "{told_turns} of {turns}");
}

#[test]
fn english_is_read_and_other_languages_are_named() {
    let building = Building::new();
    let fixture =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../ground/wayword-formats/tests/data/rxr_languages.jsonl");
    let lines = std::fs::read_to_string(fixture).unwrap();
    let lines = lines.lines().enumerate().map(|(at, line)| {
        let mut item: Value = serde_json::from_str(line).unwrap();
        (item["scan"], item["path"], item["path_id"]) = (json!(SCAN), json!(path()), json!(at));
        item.to_string() + "\n"
    });
    building.write("rxr.jsonl", lines.collect::<String>());
    let report = check_file(&building, "rxr.jsonl", &["--no-witnesses"]).json();
    let texts = report["not_passed"].as_array().unwrap();
    for (language, words) in [("Hindi", "आप"), ("Telugu", "మీరు")] {
        let text = texts.iter().find(|text| text["text"].as_str().unwrap().starts_with(words)).unwrap();
        assert_eq!(text["verdict"], "unverified", "{text}");
        assert!(text["findings"].to_string().contains(language), "{text}");
    }
    // The English texts are read: they name turns that this path does not have, or things that are not listed there.
    let english: Vec<&Value> = texts.iter().filter(|text| text["text"].as_str().unwrap().is_ascii()).collect();
    assert!(!english.is_empty());
    for text in english {
        assert!(!text["findings"].to_string().contains("language"), "{text}");
    }
}

#[test]
fn calibration_is_refused_where_it_has_no_effect() {
    let building = Building::new();
    let head = "platform = \"matterport\"\nfrom = \"texts.json\"\ntexts = 1\n[names]\n";
    building.write("names.toml", head);
    building.write("other.toml", head.replace("matterport", "habitat"));
    let asked =
        |out: &str, file: &str| building.generate(out, &["--episodes", EPISODES, "--calibration", file, "--json"]);
    let ran = asked("run", "names.toml");
    assert_eq!((ran.code, &ran.json()["calibration"]), (Some(0), &json!("names.toml")), "{ran:?}");
    assert!(asked("other", "other.toml").refused().contains("was made for platform habitat"));
    building.write("names.toml", format!("{head}bed = {{ close = 1.0, far = 0.0, nowhere = 0.0 }}\n"));
    assert!(asked("run", "names.toml").refused().contains("calibration"), "a run is not continued with another one");
    let house = ["generate", "--paths", "1", "--out", "house", "--calibration", "names.toml"];
    assert!(building.wayword(&house).refused().contains("list everything"));
    let compare = ["compare", "--platform", "matterport", "--data", "data", "--episodes", EPISODES, "--out", "walked"];
    let ran = building.wayword(&[&compare[..], &["--calibration", "names.toml"]].concat());
    assert!(ran.refused().contains("no agent") && !building.path("walked").exists());
}
