//! Inputs that once passed in silence: lengths that no text has, objects that no scene has, texts in other languages, and files
//! that are no texts.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{Building, EPISODES};
use serde_json::{Value, json};

const WORLD: [&str; 4] = ["--platform", "matterport", "--data", "data"];
const GERMAN: &str = "Gehe an der Lampe vorbei und warte am Schreibtisch in der Küche.";
const HINDI: &str = "दाएँ मुड़ें और सीढ़ियों से ऊपर जाएँ।";
const CHINESE: &str = "走出卫生间沿着床左转走出卧室，绕过圆桌走到沙发旁。";

#[test]
fn texts_far_from_the_lengths_of_their_style_are_told() {
    let building = Building::new();
    let style = |words: &str| {
        format!("name = \"w\"\nreferences = [\"Walk past the lamp. Wait at the desk.\"]\nwords = {words}\n")
    };
    building.write("long.toml", style("[60]"));
    building.write("some.toml", style("[10, 20, 30, 40]"));
    let args = |file| ["--episodes", EPISODES, "--style", file, "--no-pictures"];
    let told = building.generate("long", &args("long.toml"));
    assert_eq!(told.code, Some(0), "{told:?}");
    assert!(told.out.contains("0 instructions passed every check, 10 unverified, 0 rejected"), "{told:?}");
    let lines = |out: &str| out.lines().filter(|line| line.contains("far from the length")).count();
    assert_eq!(lines(&told.out), 1, "{told:?}");
    assert!(
        told.out.contains("10 instructions; the first: the text has ") && told.out.contains("asks for 60"),
        "{told:?}"
    );
    let some = building.generate("some", &args("some.toml"));
    assert!(lines(&some.out) == 0 && some.out.contains("10 instructions passed every check"), "{some:?}");
    let check = |run: &str, style: &str| {
        let file = format!("{run}/instructions.jsonl");
        building.wayword(&[&["check", &file, "--style", style, "--json"], &WORLD[..]].concat()).json()["by_check"]["form"].clone()
    };
    assert_eq!(check("long", "long.toml")["unverified"], 10);
    assert_eq!(check("some", "long.toml")["passed"], 0);
    assert_eq!(check("some", "some.toml")["passed"], 10);
}

#[test]
fn an_object_that_the_scene_lacks_is_named() {
    let building = Building::new();
    let change = |item: &mut Value| {
        item["objId"] = json!(99999);
        item["id"] = json!(format!("{}_99999", item["path_id"]));
    };
    let file = building.change_items(&building.reverie(), change, "texts.json");
    let check = |file: &str| building.wayword(&[&["check", file, "--json"], &WORLD[..]].concat());
    let found = check(&file);
    assert_eq!(found.code, Some(3), "{found:?}");
    let report = found.json();
    assert_eq!((&report["passed"], &report["unverified"]), (&json!(0), &json!(0)), "{report}");
    let reasons: Vec<&str> = report["not_passed"][0]["findings"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|finding| finding["check"] == "task")
        .map(|finding| finding["reason"].as_str().unwrap())
        .collect();
    assert_eq!(reasons.len(), 1, "{report}");
    assert!(
        reasons[0].contains("_99999 names the object 99999, and scene ") && reasons[0].contains("has none of that id")
    );
    let known = check("data/reverie/REVERIE_val_seen.json").json();
    assert!(!known.to_string().contains("has none of that id"), "{known}");
}

#[test]
fn texts_in_another_language_are_no_zeros_in_a_table() {
    let building = Building::new();
    let in_language = |text: &'static str, name: &str| {
        building.change_items(&building.r2r(), |item| item["instructions"] = json!([text, text]), name)
    };
    let (german, chinese) = (in_language(GERMAN, "de.json"), in_language(CHINESE, "zh.json"));
    let english = "data/r2r/R2R_val_seen.json";
    let similarity = |a: &str, b: &str, more: &[&str]| {
        building.wayword(&[&["similarity", a, b, "--resamples", "100"], more].concat())
    };
    for more in [&["--metrics"][..], &["--encoder", "words"]] {
        for (a, b, language) in
            [(&*german, english, "German"), (english, &chinese, "Chinese"), (&german, &chinese, "German")]
        {
            let told = similarity(a, b, more);
            assert!(
                told.refused().contains(&format!("in {language}")) && told.err.contains("one language"),
                "{told:?}"
            );
        }
        let same = similarity(&german, &german, more);
        assert!(same.code == Some(0) && same.err.contains("warning: the texts are in German"), "{same:?}");
        let itself = similarity(english, english, more).err;
        assert!(itself.starts_with("warning: A and B are the same texts") && itself.lines().count() == 1, "{itself}");
    }
    for command in [&["align"][..], &["check"]] {
        let told = building.wayword(&[command, &[&chinese], &WORLD[..]].concat());
        assert!(told.err.contains("note: most of the texts are in Chinese"), "{told:?}");
        let told = building.wayword(&[command, &[&german], &WORLD[..]].concat());
        assert!(told.err.contains("warning: most of the texts are in German"), "{told:?}");
        let plain = building.wayword(&[command, &[english], &WORLD[..]].concat());
        assert!(!plain.err.contains("warning"), "{plain:?}");
    }
}

#[test]
fn a_style_in_another_language_is_refused_where_rules_write() {
    let building = Building::new();
    building.write("german.toml", format!("name = \"de\"\nreferences = [{GERMAN:?}]"));
    building.change_items(&building.r2r(), |item| item["instructions"] = json!([HINDI]), "hi.json");
    for (style, told) in
        [("german.toml", "are in German, such as \"Gehe an der Lampe"), ("r2r=hi.json", "are in Hindi")]
    {
        let args = ["--episodes", EPISODES, "--style", style, "--no-pictures"];
        let refused = building.generate("run", &args);
        assert!(refused.refused().contains(&format!("{style}: its reference texts {told}")), "{refused:?}");
        assert!(refused.err.contains("--write"), "{refused:?}");
        assert!(!building.path("run").exists());
    }
}

#[test]
fn files_that_are_no_texts_are_named() {
    let building = Building::new();
    building.write("settings.toml", "# of a run\nplatform = \"house\"\n");
    building.write("style.toml", "[constraints]\nmin_sentences = 2\n");
    let dialogue = json!([{ "scan": "s", "question": "?", "answer": "Yes.", "planner_path": ["a", "b"] }]);
    building.write("ndh.json", dialogue.to_string());
    for command in ["check", "align"] {
        for (file, told) in [
            ("-", "standard input is not read; give a file"),
            ("settings.toml", "it is TOML (settings, or a style), which has no texts of paths"),
            ("style.toml", "it is TOML"),
            ("ndh.json", "CVDN's dialogues (NDH)"),
        ] {
            let ran = building.wayword(&[&[command, file], &WORLD[..]].concat());
            assert!(ran.refused().contains(told), "{ran:?}");
        }
    }
}

#[test]
fn labels_need_no_detector_and_captions_need_a_run() {
    let building = Building::new();
    let check = |evidence: &str| {
        let file = "data/r2r/R2R_val_seen.json";
        building.wayword(&[&["check", file, "--evidence", evidence, "--json"], &WORLD[..]].concat())
    };
    let labels = check("labels");
    assert_eq!(labels.json()["checked_against"], json!(["labels"]), "{labels:?}");
    let captions = check("captions");
    assert!(
        captions.refused().contains("without --run there are no captions")
            && captions.err.contains("--evidence labels")
    );
    assert!(check("detector").refused().contains("no detector is named"));
}
