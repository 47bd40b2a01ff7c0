//! `wayword check` as a user runs it: good texts pass, each kind of mistake is caught, and no text passes without evidence.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::{Building, Ran};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use wayword_checks::Evidence;
use wayword_run::{pipeline::path_panoramas, platforms, run_folder::read_run_settings};
use wayword_synthesis::style::built_in;
use wayword_testkit::{SCAN, viewpoint_id};

/// From the refrigerator through the kitchen and the hallway to the entryway, and right into the living room.
const TO_THE_LAMP: [usize; 5] = [5, 4, 1, 0, 2];
/// Looking along the first hop, radians.
const SOUTH: f64 = 3.3;
const COARSE: &str = "Go to the living room and dust the lamp";
const FINE: &str = "Leave the kitchen and walk to the entryway. Turn right at the coat rack and go into the living room. Stop at the lamp.";

/// A dataset of one path with these texts, in R2R's format or, with an object, in REVERIE's.
fn episodes(building: &Building, texts: &[&str], object: Option<u32>) -> String {
    let path: Vec<String> = TO_THE_LAMP.iter().map(|index| viewpoint_id(*index)).collect();
    let mut item =
        json!({ "path_id": 1, "scan": SCAN, "path": path, "heading": SOUTH, "distance": 12.0, "instructions": texts });
    if let Some(object) = object {
        item["id"] = format!("1_{object}").into();
        item["objId"] = object.into();
    }
    building.write("texts.json", json!([item]).to_string());
    "texts.json".to_owned()
}

fn check(building: &Building, file: &str, more: &[&str]) -> Ran {
    let mut arguments = vec!["check", file, "--platform", "matterport", "--data", "data"];
    arguments.extend(more);
    building.wayword(&arguments)
}

/// Checks one text in a closed world and returns its findings: check, verdict, and the words that it is about or its reason.
fn findings(building: &Building, text: &str, style: &str) -> (Option<i32>, Vec<(String, String, String)>) {
    let file = episodes(building, &[text], (style == "reverie").then_some(9));
    let ran = check(building, &file, &["--style", style, "--world", "closed", "--json"]);
    let report = ran.json();
    let of = |text: &Value| text["findings"].as_array().unwrap().clone();
    let told = |finding: Value| {
        let words = finding["span"]
            .as_array()
            .map_or("", |span| &text[span[0].as_u64().unwrap() as usize..span[1].as_u64().unwrap() as usize]);
        let reason = finding["reason"].as_str().unwrap();
        assert!(!reason.is_empty());
        (
            finding["check"].as_str().unwrap().to_owned(),
            finding["verdict"].as_str().unwrap().to_owned(),
            format!("{reason} [{words}]"),
        )
    };
    (ran.code, report["not_passed"].as_array().unwrap().iter().flat_map(of).map(told).collect())
}

#[test]
fn good_texts_pass() {
    let building = Building::new();
    assert_eq!(findings(&building, COARSE, "reverie"), (Some(0), vec![]));
    assert_eq!(findings(&building, FINE, "r2r"), (Some(0), vec![]));
}

#[test]
fn generated_texts_pass_an_open_world_check() {
    let building = Building::new();
    for style in ["reverie", "r2r"] {
        assert_eq!(building.generate(style, &["--episodes", crate::common::EPISODES, "--style", style]).code, Some(0));
        let ran = check(&building, &format!("{style}/instructions.jsonl"), &["--style", style, "--json"]);
        assert_eq!(
            (ran.code, &ran.json()["passed"], &ran.json()["failed"]),
            (Some(0), &10.into(), &0.into()),
            "{ran:?}"
        );
        let format = if style == "r2r" { "r2r" } else { "reverie" };
        building.wayword(&["export", "--run", style, "--style", style, "--format", format, "--out", "exported.json"]);
        let ran = check(&building, "exported.json", &["--style", style, "--json"]);
        assert_eq!((ran.code, &ran.json()["passed"]), (Some(0), &10.into()), "{ran:?}");
    }
}

#[test]
fn check_uses_the_platform_s_poses_where_a_file_claims_none() {
    let building = Building::new();
    let file = "run/instructions.jsonl";
    building.run_over_episodes("run");
    let held = |text: String| {
        building.write(file, text);
        let ran = check(&building, file, &["--json"]);
        (ran.code, ran.json())
    };
    let text = std::fs::read_to_string(building.path(file)).unwrap().replace("urn right", "urn left ");
    let unknown = text.replace("\"frames\":", "\"motion\":\"unknown\",\"frames\":");
    assert!(unknown != text);
    assert_eq!(held(text), held(unknown));
}

#[test]
fn each_kind_of_mistake_is_caught_with_its_words() {
    let copied = &built_in("r2r").unwrap().references[0];
    let copied: Vec<&str> = copied.split(' ').take(6).collect();
    let copied = format!("{}. {FINE}", copied.join(" "));
    let cases: [(&str, &str, String, &str, &str); 12] = [
        ("a turn flipped", "r2r", FINE.replace("right", "left"), "turns", "left"),
        ("an absent landmark", "r2r", FINE.replace("the lamp", "the piano"), "landmarks", "piano"),
        (
            "a room that the path does not touch",
            "r2r",
            FINE.replace("living room", "bathroom"),
            "landmarks",
            "bathroom",
        ),
        (
            "two rooms swapped",
            "r2r",
            FINE.replace("kitchen", "X").replace("living room", "kitchen").replace('X', "living room"),
            "order",
            "entryway",
        ),
        (
            "two landmarks swapped",
            "r2r",
            "Walk past the coat rack. Go on and pass the microwave, then stop.".into(),
            "order",
            "microwave",
        ),
        ("a reference's words", "r2r", copied, "leak", "pantry"),
        ("one sentence", "r2r", "Leave the kitchen and stop at the lamp.".into(), "form", "1 sentence "),
        (
            "a task on an object of another room",
            "reverie",
            COARSE.replace("dust the lamp", "open the refrigerator"),
            "task",
            "refrigerator",
        ),
        ("no task", "reverie", "Go to the living room".into(), "task", "does not end in a task"),
        ("a wrong floor", "reverie", COARSE.replace("living room", "living room on level 2"), "floors", "level 2"),
        (
            "stairs that nobody takes",
            "r2r",
            FINE.replace("Leave the kitchen", "Leave the kitchen, climb the stairs"),
            "floors",
            "up any stairs",
        ),
        (
            "too many words",
            "reverie",
            format!("{COARSE} with the soft old cloth that was left there by someone else long ago"),
            "form",
            "words",
        ),
    ];
    let building = Building::new();
    for (mistake, style, text, check, words) in cases {
        let (code, found) = findings(&building, &text, style);
        assert_eq!(code, Some(3), "{mistake}: {text}: {found:?}");
        let caught = found.iter().find(|(by, verdict, told)| by == check && verdict == "fail" && told.contains(words));
        assert!(caught.is_some(), "{mistake}: {text}: {found:?}");
    }
}

#[test]
fn check_uses_the_style_that_each_text_was_written_in() {
    let building = Building::new();
    let styles = ["--style", "reverie", "--style", "r2r"];
    let run = [&["--episodes", crate::common::EPISODES][..], &styles].concat();
    assert_eq!(building.generate("run", &run).code, Some(0));
    let mut lines = building.lines("run/instructions.jsonl");
    let ran = check(&building, "run/instructions.jsonl", &["--json"]);
    let (report, texts) = (ran.json(), lines.len() / 2);
    assert_eq!((ran.code, &report["styles"]), (Some(0), &json!({"reverie": texts, "r2r": texts})), "{report}");

    // A text of two sentences without a task is good in style r2r and fails in style reverie.
    let coarse = lines.iter().position(|line| line["style"] == "reverie").unwrap();
    lines[coarse]["text"] = "Walk on. Stop there.".into();
    (lines[coarse]["mentions"], lines[coarse]["findings"]) = (json!([]), json!([]));
    let all = |lines: &[Value]| lines.iter().map(|line| format!("{line}\n")).collect::<String>();
    building.write("told.jsonl", all(&lines));
    let report = check(&building, "told.jsonl", &["--json"]).json();
    let wrong = &report["not_passed"][0];
    assert_eq!((&report["failed"], &wrong["text"]), (&1.into(), &"Walk on. Stop there.".into()), "{report}");
    let failed: Vec<&Value> = wrong["findings"].as_array().unwrap().iter().map(|finding| &finding["check"]).collect();
    assert_eq!(failed, ["form", "task"]);

    // `--style` applies to all texts.
    lines.retain(|line| line["text"] == "Walk on. Stop there." || line["style"] == "r2r");
    building.write("told.jsonl", all(&lines));
    let report = check(&building, "told.jsonl", &["--style", "r2r", "--json"]).json();
    assert_eq!((&report["failed"], &report["styles"]), (&0.into(), &json!({"r2r": lines.len()})), "{report}");

    // The name alone does not identify a user's own style.
    for line in &mut lines {
        line["provenance"]["style_hash"] = "0123456789abcdef".into();
    }
    building.write("told.jsonl", all(&lines));
    let ran = check(&building, "told.jsonl", &[]);
    for (style, texts) in [("r2r", format!("{} texts", lines.len() - 1)), ("reverie", "1 text".to_owned())] {
        let told = format!(
            "style {style} in this file differs from the built-in one (it is your own, or of another version), so the form of \
             {texts} was not checked: name the style with --style"
        );
        assert!(ran.out.contains(&told), "{told}: {}", ran.out);
    }
}

#[test]
fn check_prints_text_check_and_reason() {
    let building = Building::new();
    let wrong = FINE.replace("the lamp", "the piano");
    let file = episodes(&building, &[FINE, &wrong], None);
    let closed = ["--style", "r2r", "--world", "closed"];
    let ran = check(&building, &file, &closed);
    assert_eq!(ran.code, Some(3));
    assert!(ran.out.contains(&wrong) && ran.out.contains("no frame of the path shows \"piano\""), "{}", ran.out);
    assert!(!ran.out.contains(FINE) && ran.out.contains("checked against: labels\nworld: closed (2)"), "{}", ran.out);
    let none = check(&building, &file, &[&closed[..], &["--show", "0"]].concat());
    assert!(!none.out.contains(&wrong) && none.code == Some(3), "{}", none.out);
}

#[test]
fn the_json_report_counts_texts_and_checks() {
    let building = Building::new();
    let wrong = FINE.replace("the lamp", "the piano");
    let file = episodes(&building, &[FINE, &wrong], None);
    let report = check(&building, &file, &["--style", "r2r", "--world", "closed", "--json"]).json();
    assert_eq!((&report["passed"], &report["unverified"], &report["failed"]), (&1.into(), &0.into(), &1.into()));
    assert_eq!((&report["worlds"], &report["not_passed"][0]["world"]), (&json!({"closed": 2}), &"closed".into()));
    assert_eq!(report["checked_against"], json!(["labels"]));
    assert_eq!(report["by_check"]["landmarks"], json!({"passed": 1, "unverified": 0, "failed": 1}));
    assert_eq!(report["by_check"]["form"], json!({"passed": 2, "unverified": 0, "failed": 0}));
    let not_passed = &report["not_passed"][0];
    assert_eq!(
        (&not_passed["path"], &not_passed["text"], &not_passed["verdict"]),
        (&"1".into(), &wrong.as_str().into(), &"fail".into())
    );
    let finding = &not_passed["findings"][0];
    let start = wrong.find("piano").unwrap();
    assert_eq!((&finding["check"], &finding["verdict"]), (&"landmarks".into(), &"fail".into()));
    let end = finding["span"][1].as_u64().unwrap() as usize;
    assert!(finding["span"][0].as_u64().unwrap() as usize <= start && end == start + "piano".len(), "{finding}");
}

#[test]
fn check_uses_a_closed_world_for_texts_from_labels_and_an_open_one_for_others() {
    let building = Building::new();
    let absent = FINE.replace("the lamp", "the piano");
    let file = episodes(&building, &[FINE, &absent], None);
    let ran = check(&building, &file, &["--style", "r2r", "--json"]);
    let report = ran.json();
    assert_eq!((ran.code, &report["worlds"]), (Some(0), &json!({"open": 2})), "{report}");
    assert_eq!(
        (&report["passed"], &report["unverified"]),
        (&1.into(), &1.into()),
        "labels that list no piano deny none"
    );
    assert!(check(&building, &file, &["--style", "r2r"]).out.contains("world: open (2)"));

    assert_eq!(building.generate("run", &["--episodes", crate::common::EPISODES, "--style", "r2r"]).code, Some(0));
    let mut line = building.lines("run/instructions.jsonl").remove(0);
    let mut worlds = |more: &[&str]| {
        building.write("told.jsonl", format!("{line}\n"));
        let worlds = check(&building, "told.jsonl", &[&["--json"], more].concat()).json()["worlds"].clone();
        line["provenance"]["checked_against"] = "captions".into();
        worlds
    };
    assert_eq!(worlds(&[]), json!({"closed": 1}));
    assert_eq!(worlds(&[]), json!({"open": 1}), "its evidence is not what is at hand");
    assert_eq!(worlds(&["--world", "closed"]), json!({"closed": 1}));
}

#[test]
fn another_text_about_the_path_is_a_witness() {
    let building = Building::new();
    let climbs = "Climb the stairs. Stop at the lamp.";
    let file = episodes(&building, &[climbs, "Go up the stairs to the lamp. Stop there."], None);
    let failed = |more: &[&str]| check(&building, &file, &[&["--json"], more].concat()).json()["failed"].clone();
    assert_eq!((failed(&[]), failed(&["--no-witnesses"])), (0.into(), 2.into()));
    let alone = episodes(&building, &[climbs, &climbs.replace('.', "!")], None);
    assert_eq!(check(&building, &alone, &["--json"]).json()["failed"], 2, "a copy is no witness");
}

#[test]
fn records_are_no_witnesses_for_each_other() {
    let building = Building::new();
    building.run_over_episodes("run");
    let line = building.lines("run/instructions.jsonl").remove(0);
    let told = ["Climb the stairs. Stop there.", "Go up the stairs and stop."].map(|text| {
        let mut line = line.clone();
        line["text"] = text.into();
        (line["mentions"], line["findings"]) = (json!([]), json!([]));
        format!("{line}\n")
    });
    building.write("told.jsonl", told.concat());
    let report = check(&building, "told.jsonl", &["--world", "open", "--no-route", "--json"]).json();
    assert_eq!(report["failed"], 2, "{report}");
}

#[test]
fn a_calibration_is_made_of_a_file_and_named_where_it_is_used() {
    let building = Building::new();
    let file = episodes(&building, &[FINE, "Walk past the piano to the lamp. Stop there."], None);
    let made = building.wayword(&[
        "calibrate",
        "--platform",
        "matterport",
        "--data",
        "data",
        "--from",
        &file,
        "--out",
        "calibration.toml",
    ]);
    assert_eq!(made.code, Some(0), "{made:?}");
    let written = std::fs::read_to_string(building.path("calibration.toml")).unwrap();
    assert!(written.contains("from = \"texts.json\"") && !written.contains("Walk past"), "{written}");
    let ran = check(&building, &file, &["--calibration", "calibration.toml"]);
    assert!(ran.out.contains("calibration: calibration.toml"), "{ran:?}");
    let refused = |text: &str| {
        building.write("calibration.toml", text);
        check(&building, &file, &["--calibration", "calibration.toml"]).refused().to_owned()
    };
    assert!(refused("words = 3").contains("is no calibration"));
    assert!(refused(&written.replace("\"matterport\"", "\"house\"")).contains("was made for platform house"));
    let infinite = "[names.piano]\nclose = inf\nfar = 0.0\nnowhere = 0.0\n";
    let head = &written[..written.find("[names").unwrap()];
    assert!(refused(&format!("{head}{infinite}")).contains("not finite"));
}

/// Leaves the building only its connectivity graph.
fn without_labels() -> Building {
    let building = Building::new();
    std::fs::rename(building.path("data/reverie"), building.path("reverie")).unwrap();
    std::fs::rename(building.path("data/r2r"), building.path("r2r")).unwrap();
    std::fs::remove_dir_all(building.path("data/matterport/v1")).unwrap();
    building
}

#[test]
fn check_passes_no_text_without_evidence() {
    let building = without_labels();
    for (file, style) in [("reverie/REVERIE_val_seen.json", "reverie"), ("r2r/R2R_val_seen.json", "r2r")] {
        let report = check(&building, file, &["--style", style, "--json"]).json();
        assert_eq!((&report["passed"], report["unverified"].as_u64() > Some(10)), (&0.into(), true), "{report}");
        assert_eq!(report["checked_against"], json!(["nothing"]));
    }
    for (text, style) in [(COARSE, "reverie"), (FINE, "r2r"), ("Walk ahead. Stop.", "r2r")] {
        let (code, found) = findings(&building, text, style);
        assert!(code == Some(0) && found.iter().any(|(_, verdict, _)| verdict == "unverified"), "{text}: {found:?}");
    }
    // A claim that the path alone shows to be wrong still fails.
    assert_eq!(findings(&building, &FINE.replace("right", "left"), "r2r").0, Some(3));
}

#[test]
fn run_without_evidence_claims_no_things() {
    let building = without_labels();
    let ran = building.generate("run", &["--episodes", "r2r/R2R_val_seen.json", "--style", "r2r", "--json"]);
    let summary = ran.json();
    assert_eq!(summary["passed"], 0, "{summary}");
}

#[test]
fn a_wrong_colour_is_caught_in_a_house() {
    let building = Building::new();
    let ran = building
        .wayword(&["generate", "--paths", "1", "--scan", "house2-3", "--seed", "3", "--style", "r2r", "--out", "run"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let record = building.records("run").remove(0);
    let platform = platforms::open_platform(&read_run_settings(&building.path("run")).unwrap()).unwrap();
    let views = path_panoramas(platform.as_ref(), &record.path).unwrap();
    let evidence = Evidence::from_labels(&record.path, &views).unwrap();
    let mut colours: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for thing in evidence.frames.iter().flat_map(|frame| &frame.things) {
        colours.entry(&thing.name).or_default().extend(thing.colour.as_deref());
    }
    let of_one_word = |name: &str| !name.contains(' ') && wayword_language::lexicon::find_thing(name).is_some();
    let (name, known) = colours.iter().find(|(name, colours)| of_one_word(name) && colours.len() == 1).unwrap();
    let right = known.first().unwrap();
    let wrong = ["purple", "orange", "green", "yellow"].into_iter().find(|colour| !right.contains(colour)).unwrap();

    let mut line = building.lines("run/instructions.jsonl").remove(0);
    let mut verdict = |colour: &str| {
        line["text"] = format!("Walk on until you see the {colour} {name}. Wait there.").into();
        (line["mentions"], line["findings"]) = (json!([]), json!([]));
        building.write("told.jsonl", format!("{line}\n"));
        building.wayword(&["check", "told.jsonl", "--platform", "house"])
    };
    // The text tells nothing else of its walk, so it fails for that as well.
    let mistake = |colour: &str| format!("no {name:?} along the path is {colour}");
    let (good, bad) = (verdict(right), verdict(wrong));
    assert!(!good.out.contains(&mistake(right)), "{}", good.out);
    assert!(bad.code == Some(3) && bad.out.contains(&mistake(wrong)), "{}", bad.out);
}

#[test]
fn check_with_labels_reads_no_photograph() {
    let building = Building::new();
    wayword_testkit::write_distinct_skyboxes(&building.data()).unwrap();
    let check = || check(&building, crate::common::EPISODES, &["--style", "reverie", "--json"]);
    let with = check();
    for name in crate::common::files(&building.data())
        .into_keys()
        .filter(|name| name.extension().is_some_and(|end| end == "jpg"))
    {
        std::fs::write(building.data().join(name), "no picture").unwrap();
    }
    let broken = check();
    assert_eq!((with.code, &with.out), (broken.code, &broken.out), "{broken:?}");
    assert!(with.json()["passed"].as_u64() > Some(0), "{with:?}");
}
