//! HEAR's annotations: which words a key names, and which files are refused.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by panicking, and says what it skipped")]

use serde_json::{Value, json};
use std::path::Path;
use wayword_formats::{
    FormatError,
    hear_annotations::{self, LabelledText},
};

/// Two texts of ours.
fn file() -> Value {
    let item = |text: &str, numbered: &str, labels: Value| {
        json!({
            "scan": "house1", "path_id": "7", "path": ["hall", "door"], "heading": 1.5, "distance": 3.0,
            "original_instr": text, "numbered_instruction": numbered, "id2label": labels, "id2gold_alternative": {},
        })
    };
    json!({
        "7_0": item(
            "turn left at the old piano . stop .",
            "turn (0) left (1) at (2) the (3) old (4) piano (5) . (6) stop (7) . (8)",
            json!({"0-1": 1, "4-5": -1, "7": 0, "2-3-4": 1}),
        ),
        "7_1": item("wait  here", "wait (0) here (1)", json!({})),
    })
}

fn read(value: &str) -> Result<Vec<LabelledText>, FormatError> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("hear.json");
    std::fs::write(&file, value).unwrap();
    hear_annotations::read_hear_file(&file)
}

/// The refusal of the file with one field of its first text changed.
fn refusal(field: &str, value: Value) -> String {
    let mut file = file();
    file["7_0"][field] = value;
    let error = read(&file.to_string()).unwrap_err().to_string();
    error.split_once("hear.json: ").unwrap().1.to_owned()
}

#[test]
fn a_key_names_the_words_from_its_first_token_to_its_last() {
    let texts = read(&file().to_string()).unwrap();
    let first = &texts[0];
    let told = first.spans.iter().map(|span| (&first.text[span.span[0]..span.span[1]], span.is_right));
    assert_eq!(
        told.collect::<Vec<_>>(),
        [("turn left", true), ("old piano", false), ("stop", false), ("at the old", true)]
    );
    assert_eq!((first.name.as_str(), first.episode.path_id.as_str()), ("7_0", "7"));
    assert_eq!(first.episode.instructions, [first.text.as_str()]);
    assert_eq!((texts.len(), texts[1].spans.len()), (2, 0));
}

#[test]
fn corrections_are_words_between_slashes_or_remove() {
    let corrections = |told: Value| {
        let mut file = file();
        file["7_0"]["id2gold_alternative"] = told;
        let texts = read(&file.to_string()).unwrap();
        texts[0].spans.iter().map(|span| span.corrections.clone()).collect::<Vec<_>>()
    };
    let told = corrections(json!({"4-5": "REMOVE/old table / sofa", "7": "stop", "99": "none"}));
    let words = |told: &str| Some(told.to_owned());
    assert_eq!(told, [vec![], vec![None, words("old table"), words("sofa")], vec![words("stop")], vec![]]);
    assert_eq!(corrections(json!({})).concat(), []);
    assert!(refusal("id2gold_alternative", json!([1])).contains("expected an object"));
    let refused = refusal("id2gold_alternative", json!({"4-5": 3}));
    assert!(refused.starts_with("item 0 (id 7_0): field \"id2gold_alternative.4-5\": expected a string"), "{refused}");
}

#[test]
fn tokens_that_are_not_those_of_the_text_are_refused() {
    for (numbered, problem) in [
        ("turn (0) right (1)", "token 1 (\"right\") is not the next word of original_instr"),
        ("turn (0) at (1)", "token 1 (\"at\") is not the next word of original_instr"),
        ("turn (0) left (2)", "token 1 (\"left\") is not followed by its number"),
        ("turn left", "token 0 (\"turn\") is not followed by its number"),
        ("turn (0) left", "token 1 (\"left\") is not followed by its number"),
        ("turn (0) left (1) at (2)", "it ends before byte 12 of original_instr"),
        ("", "it ends before byte 0 of original_instr"),
    ] {
        let refusal = refusal("numbered_instruction", numbered.into());
        let expected = format!("item 0 (id 7_0): field \"numbered_instruction\": {problem}; ");
        assert!(refusal.starts_with(&expected), "{refusal}");
    }
}

#[test]
fn read_refuses_unusable_keys_and_labels_by_name() {
    for (key, label, problem) in [
        ("9", json!(1), "it names token 9, but the text has 9"),
        ("5-99999999999", json!(1), "it names token 99999999999, but the text has 9"),
        ("", json!(1), "the key is neither"),
        ("5-", json!(1), "the key is neither"),
        ("6-5", json!(1), "the key is neither"),
        ("5-5", json!(1), "the key is neither"),
        ("+5", json!(1), "the key is neither"),
        ("five", json!(1), "the key is neither"),
        ("99999999999999999999999", json!(1), "the key is neither"),
        ("5", json!(2), "expected 1, 0 or -1, found 2"),
        ("5", json!("1"), "expected 1, 0 or -1, found \"1\""),
        ("5", json!(0.5), "expected 1, 0 or -1, found 0.5"),
        ("5", json!(null), "expected 1, 0 or -1, found null"),
    ] {
        let refusal = refusal("id2label", json!({"0": 1, key: label}));
        assert!(refusal.starts_with(&format!("item 0 (id 7_0): field \"id2label.{key}\": {problem}")), "{refusal}");
    }
    assert!(refusal("id2label", json!([1])).contains("field \"id2label\": expected an object"));
}

#[test]
fn fields_that_break_a_limit_are_refused() {
    assert!(refusal("path", json!([])).contains("field \"path\": it is empty"));
    assert!(refusal("path", vec!["hall"; 1001].into()).contains("it has 1001 entries"));
    assert!(refusal("scan", json!("../x")).contains("field \"scan\""));
    assert!(refusal("original_instr", "a".repeat(20_001).into()).contains("it has 20001 bytes"));
    assert!(refusal("numbered_instruction", "a ".repeat(10_001).into()).contains("it has 20002 bytes"));
    assert!(refusal("heading", json!("north")).contains("field \"heading\""));
}

#[test]
fn read_refuses_a_file_that_is_not_an_object_of_items() {
    for (text, problem) in [
        ("{}", "it holds no text"),
        ("[]", "it is not a JSON object"),
        ("{\"a\": 1}", "item 0: expected an object, found 1"),
        ("{\"a\": {}, \"a\": {}}", "field \"a\": it is given twice"),
        ("{\"a\": {\"id2label\": {\"1\": 1, \"1\": 0}}}", "field \"a.id2label.1\": it is given twice"),
        ("{\"a\": ", "the file is cut off (line 1, column 6)"),
        ("{\"a/b\": {}}", "field \"its name\""),
    ] {
        let error = read(text).unwrap_err().to_string();
        assert!(error.contains(problem), "{text}: {error}");
    }
    let many = format!("{{\"a\": [{}0]}}", "0,".repeat(200_000));
    assert!(read(&many).unwrap_err().to_string().contains("it has more than 200,000 values"));
}

#[test]
fn the_real_file_is_read_whole() {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../../shared/data");
    let data = std::env::var_os("WAYWORD_DATA").map_or_else(beside, Into::into);
    let file = data.join("hear/t5_dev40_gold_highlights_corrected.json");
    if !file.is_file() {
        println!("skipped: there is no {}; set WAYWORD_DATA to the folder that has it", file.display());
        return;
    }
    let texts = hear_annotations::read_hear_file(&file).unwrap();
    let spans: Vec<_> = texts.iter().flat_map(|text| &text.spans).collect();
    let wrong = spans.iter().filter(|span| !span.is_right).count();
    assert_eq!((texts.len(), spans.len(), wrong), (40, 376, 70));
}
