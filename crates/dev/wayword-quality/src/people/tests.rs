use super::*;
use crate::test_data::TestBuildingFolder;
use clap::Parser;
use serde_json::Value;
use std::path::PathBuf;
use wayword_core::{CheckFinding, CheckKind, Verdict};
use wayword_testkit::{SCAN, viewpoint_id};

/// A made-up text in HEAR's format, in which single spaces separate the tokens.
fn labelled(path: &[usize], text: &str, labels: &Value) -> Value {
    let numbered = text.split(' ').enumerate().map(|(number, word)| format!("{word} ({number})"));
    json!({
        "scan": SCAN, "path_id": "7", "path": path.iter().map(|at| viewpoint_id(*at)).collect::<Vec<_>>(), "heading": 1.5,
        "original_instr": text, "numbered_instruction": numbered.collect::<Vec<_>>().join(" "), "id2label": labels,
    })
}

#[derive(Parser)]
struct Line {
    #[command(flatten)]
    flags: JudgingArgs,
}

fn flags(file: &Path, data: &Path) -> JudgingArgs {
    let words =
        ["people".into(), file.to_owned(), "--platform".into(), "matterport".into(), "--data".into(), data.to_owned()];
    Line::try_parse_from(words).unwrap().flags
}

/// The figures of texts on the made-up building.
fn measured(texts: &Value) -> Result<SpanFigures, CommandError> {
    let building = TestBuildingFolder::new();
    let file = building.data_folder().join("hear.json");
    std::fs::write(&file, texts.to_string()).unwrap();
    held(&file, &building.data_folder())
}

fn held(file: &Path, data: &Path) -> Result<SpanFigures, CommandError> {
    let quiet = CommandOutput::new(true, true);
    let (texts, CheckedTexts { findings, .. }) = check_labelled_texts(flags(file, data), &quiet)?;
    let held: Vec<LabelledFindings<'_>> =
        texts.iter().zip(&findings).map(|(text, findings)| LabelledFindings { text, findings }).collect();
    Ok(span_figures(&held, 0))
}

fn count(share: Option<&crate::share::ClusteredShare>) -> (usize, usize) {
    share.map_or((0, 0), |share| (share.count, share.of))
}

/// The path climbs from the hallway to the upper hall, so one text is wrong about its stairs and the other right.
#[test]
fn findings_are_compared_with_the_labels_of_people() {
    let climb = [1, 6, 7, 8];
    let texts = json!({
        "wrong": labelled(&climb, "walk down the stairs . stop in the hall .", &json!({"0-3": -1, "5": 1})),
        "right": labelled(&climb, "walk up the stairs . stop in the hall .", &json!({"0-3": 1, "5": 1})),
    });
    let figures = measured(&texts).unwrap();
    assert_eq!(count(figures.all.recall.as_ref()), (1, 1));
    assert_eq!(count(figures.all.false_alarms.as_ref()), (0, 3));
    assert_eq!(count(figures.all.precision.as_ref()), (1, 1));
    let floors = figures.by_check.iter().find(|row| row.name == "floors").unwrap();
    assert_eq!(count(floors.recall.as_ref()), (1, 1));
    assert_eq!(count(figures.wrong_texts_that_fail.as_ref()), (1, 1));
    assert_eq!(count(figures.right_texts_that_fail.as_ref()), (0, 1));
}

#[test]
fn texts_on_unknown_paths_are_refused_by_their_names() {
    let good = labelled(&[0, 1], "walk .", &json!({"0": 1}));
    let refusal = |field: &str, value: Value| {
        let mut texts = json!({"first": good, "second": good});
        texts["second"][field] = value;
        measured(&texts).map(|_| ()).unwrap_err().to_string()
    };
    let refused = refusal("scan", json!("noSuchHouse"));
    assert!(refused.contains("hear.json: text second: field \"scan\": "), "{refused}");
    // The first is no viewpoint, and there is no edge between the others.
    for path in [vec!["nowhere".to_owned()], vec![viewpoint_id(0), viewpoint_id(5)]] {
        let refused = refusal("path", json!(path));
        assert!(refused.contains("hear.json: text second: field \"path\": "), "{refused}");
    }
    let refused = refusal("id2label", json!({"2": 1}));
    assert!(refused.contains("(id second): field \"id2label.2\": "), "{refused}");
}

/// "turn left . walk past the sofa in the hall": three spans are right, "past the sofa" is wrong.
fn by_hand(findings: &[(CheckKind, Verdict, &str)]) -> SpanFigures {
    let text = "turn left . walk past the sofa in the hall";
    let span = |words: &str| text.find(words).map(|from| [from, from + words.len()]);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("hear.json");
    let item = labelled(&[0], text, &json!({"0-1": 1, "3": 1, "4-6": 0, "9": 1}));
    std::fs::write(&file, json!({ "a": item }).to_string()).unwrap();
    let texts = hear_annotations::read_hear_file(&file).unwrap();
    let findings = findings.iter().map(|(check, verdict, words)| CheckFinding {
        check: *check,
        verdict: *verdict,
        reason: String::new(),
        span: span(words),
    });
    let findings: Vec<CheckFinding> = findings.collect();
    span_figures(&[LabelledFindings { text: &texts[0], findings: &findings }], 0)
}

#[test]
fn a_finding_counts_for_every_span_that_it_overlaps_and_only_for_its_check() {
    let figures = by_hand(&[
        (CheckKind::Landmarks, Verdict::Fail, "walk past the sofa"),
        (CheckKind::Turns, Verdict::Fail, "left"),
        (CheckKind::Turns, Verdict::Fail, "in"),
        (CheckKind::Form, Verdict::Fail, "no such words"),
    ]);
    assert_eq!(count(figures.all.recall.as_ref()), (1, 1));
    assert_eq!(count(figures.all.false_alarms.as_ref()), (2, 3), "turn left, and walk");
    assert_eq!(count(figures.all.precision.as_ref()), (1, 2), "the finding on walk past the sofa meets a wrong span");
    assert_eq!(figures.all.elsewhere, 2, "on a word without a label, and on no words");
    let names: Vec<&str> = figures.by_check.iter().map(|row| row.name.as_str()).collect();
    assert_eq!(names, ["form", "landmarks", "turns"]);
    let turns = &figures.by_check[2];
    assert_eq!((count(turns.recall.as_ref()), count(turns.false_alarms.as_ref())), ((0, 1), (1, 3)));
    let kinds: Vec<_> = figures.by_kind.iter().map(|row| count(row.false_alarms.as_ref())).collect();
    assert_eq!(kinds, [(1, 1), (0, 0), (0, 1), (1, 1)]);
}

#[test]
fn a_span_is_unverified_where_nothing_there_fails() {
    let figures = by_hand(&[
        (CheckKind::Landmarks, Verdict::Unverified, "sofa in the hall"),
        (CheckKind::Turns, Verdict::Unverified, "turn"),
        (CheckKind::Order, Verdict::Fail, "left"),
    ]);
    assert_eq!(count(figures.all.unverified_wrong.as_ref()), (1, 1));
    assert_eq!(count(figures.all.unverified_right.as_ref()), (1, 3));
    assert_eq!(count(figures.all.recall.as_ref()), (0, 1));
}

#[test]
fn the_table_has_a_line_for_each_check_each_kind_and_all() {
    let figures = by_hand(&[(CheckKind::Turns, Verdict::Fail, "left")]);
    let shown = figures_table(&figures, 1, &["checked against: labels".to_owned()]);
    let firsts: Vec<&str> = shown.lines().map(|line| line.split("  ").next().unwrap()).collect();
    assert_eq!(firsts[1..7], ["turns", "turns and sides", "stairs and floors", "rooms", "landmarks and verbs", "all"]);
    assert!(shown.contains("33.3 % [33.3, 33.3] (1/3)") && shown.ends_with("checked against: labels"), "{shown}");
    assert!(serde_json::to_string(&figures).unwrap().contains("\"false_alarms\":{\"count\":1,\"of\":3"));
}

/// Checks the number of spans in the real file, so that the figures in the documents are known to cover all of them.
#[test]
fn the_real_file_fits_the_real_buildings() {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../../shared/data");
    let data: PathBuf = std::env::var_os("WAYWORD_DATA").map_or_else(beside, PathBuf::from);
    let file = data.join("hear/t5_dev40_gold_highlights_corrected.json");
    if !file.is_file() {
        println!("skipped: there is no {}; set WAYWORD_DATA to the folder that has it", file.display());
        return;
    }
    let figures = held(&file, &data).unwrap();
    let [recall, false_alarms] = [&figures.all.recall, &figures.all.false_alarms].map(|share| count(share.as_ref()));
    assert_eq!((recall.1, false_alarms.1), (70, 306));
    let of_kinds: usize = figures.by_kind.iter().map(|row| count(row.recall.as_ref()).1).sum();
    assert_eq!(of_kinds, 70);
}
