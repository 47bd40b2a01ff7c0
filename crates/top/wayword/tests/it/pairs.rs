//! `wayword check --by pictures`, its page for curators, exports that honour what they decided, and `wayword annotate`.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{Building, Ran};
use serde_json::Value;
use std::fs;

/// A run of two walks through a house, with two texts for each.
fn run(building: &Building) {
    let generate = "generate --paths 2 --scan house2-1 --metres 4..9 --style r2r --per-path 2 --out run"
        .split(' ')
        .collect::<Vec<_>>();
    let ran = building.wayword(&generate);
    assert_eq!(ran.code, Some(0), "{ran:?}");
}

fn check(building: &Building, more: &[&str]) -> Ran {
    let check = ["check", "run/instructions.jsonl", "--by", "pictures", "--platform", "house", "--see", "labels"];
    building.wayword(&[&check[..], more].concat())
}

fn pairs(building: &Building, folder: &str) -> Vec<Value> {
    building.lines(&format!("{folder}/pairs.jsonl"))
}

#[test]
fn pairs_are_judged_worst_first_and_a_stopped_check_goes_on() {
    let building = Building::new();
    run(&building);
    let ran = check(&building, &["--out", "pairs", "--json"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let report = ran.json();
    assert_eq!((report["films"].as_u64(), report["judged"].as_u64()), (Some(2), Some(4)), "{report}");
    let chances: Vec<f64> =
        pairs(&building, "pairs").iter().map(|pair| pair["chance_wrong"].as_f64().unwrap()).collect();
    assert_eq!(chances.len(), 4);
    assert!(chances.windows(2).all(|pair| pair[0] >= pair[1]), "{chances:?}");
    // One film is lost: only it is judged again, and the result is the same.
    let whole = fs::read_to_string(building.path("pairs/pairs.jsonl")).unwrap();
    let films = fs::read_to_string(building.path("pairs/films.jsonl")).unwrap();
    fs::write(building.path("pairs/films.jsonl"), &films[..films.len() - 20]).unwrap();
    let ran = check(&building, &["--out", "pairs"]);
    assert!(ran.code == Some(0) && ran.err.contains("continuing: 1 of 2 films"), "{ran:?}");
    assert_eq!(fs::read_to_string(building.path("pairs/pairs.jsonl")).unwrap(), whole);
    let other = check(&building, &["--out", "pairs", "--motion", "none"]);
    assert!(other.refused().contains("another check"), "{other:?}");
}

#[test]
fn a_wrong_text_is_more_suspicious_than_the_right_one() {
    let building = Building::new();
    run(&building);
    let records = fs::read_to_string(building.path("run/instructions.jsonl")).unwrap();
    let lines: Vec<Value> = records.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let mut lines = [lines[0].clone(), lines[0].clone()];
    lines[1]["text"] = "Go up the stairs and turn around. Walk past the bathtub. Stop at the treadmill.".into();
    lines[1]["number"] = 1.into();
    let text: String = lines.iter().map(|line| format!("{line}\n")).collect();
    building.write("two.jsonl", text);
    let ran = building.wayword(&[
        "check",
        "two.jsonl",
        "--by",
        "pictures",
        "--platform",
        "house",
        "--see",
        "labels",
        "--json",
    ]);
    let report = ran.json();
    let pairs = report["pairs"].as_array().unwrap();
    assert!(pairs[0]["text"].as_str().unwrap().contains("bathtub"), "{report}");
    let [worst, right] = [0, 1].map(|at| pairs[at]["chance_wrong"].as_f64().unwrap());
    assert!(worst > 0.5 && worst > right + 0.2, "{worst} {right}");
    let reasons = pairs[0]["parts"].to_string();
    assert!(
        reasons.contains("nobody saw a bathtub in this film") && reasons.contains("no such motion here: stairs up"),
        "{reasons}"
    );
}

#[test]
fn nobody_who_looks_and_odd_shares_are_refused() {
    let building = Building::new();
    run(&building);
    let check = ["check", "run/instructions.jsonl", "--by", "pictures", "--platform", "house"];
    let ran = building.wayword(&check);
    assert!(ran.refused().contains("nobody is named who looks"), "{ran:?}");
    let ran = building.wayword(&[&check[..], &["--see", "labels", "--base-rate", "1.5"]].concat());
    assert!(ran.refused().contains("--base-rate 1.5"), "{ran:?}");
}

#[test]
fn the_page_shows_each_pair_escaped_and_runs_one_script() {
    let building = Building::new();
    run(&building);
    let records = fs::read_to_string(building.path("run/instructions.jsonl")).unwrap();
    let mut line: Value = serde_json::from_str(records.lines().next().unwrap()).unwrap();
    line["text"] = "Turn left <script>alert(1)</script> and stop.".into();
    building.write("one.jsonl", format!("{line}\n"));
    let ran = building.wayword(&[
        "check",
        "one.jsonl",
        "--by",
        "pictures",
        "--platform",
        "house",
        "--see",
        "labels",
        "--out",
        "pairs",
    ]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let page = fs::read_to_string(building.path("pairs/index.html")).unwrap();
    assert!(!page.contains("<script>alert") && page.contains("&lt;script&gt;alert"), "text is not escaped");
    assert!(page.contains("script-src 'sha256-") && page.matches("<script>").count() == 1, "other scripts");
    assert!(page.contains("data-pair=") && page.contains("pictures/0_0.jpg"), "no pair or picture");
    assert!(building.path("pairs/pictures/0_0.jpg").is_file());
}

#[test]
fn exports_leave_out_what_curators_rejected() {
    let building = Building::new();
    run(&building);
    check(&building, &["--out", "pairs"]);
    let name = pairs(&building, "pairs")[0]["pair"].as_str().unwrap().to_owned();
    let decision =
        |decision: &str, at: &str| format!("{{\"pair\":{name:?},\"decision\":{decision:?},\"at\":{at:?}}}\n");
    building.write("first.jsonl", decision("accept", "2026-11-30T10:00:00Z"));
    building.write("second.jsonl", decision("reject", "2026-11-30T11:00:00Z"));
    let export = |files: &[&str]| {
        let export = ["export", "--run", "run", "--format", "wayword", "--out", "kept.jsonl"];
        let decisions: Vec<&str> = files.iter().flat_map(|file| ["--decisions", file]).collect();
        building.wayword(&[&export[..], &decisions].concat())
    };
    assert_eq!(export(&["second.jsonl", "first.jsonl"]).code, Some(0));
    assert_eq!(building.lines("kept.jsonl").len(), 3);
    assert_eq!(export(&["first.jsonl"]).code, Some(0));
    assert_eq!(building.lines("kept.jsonl").len(), 4);
    assert!(export(&["none.jsonl"]).refused().contains("there is no such file"));
    building.write("broken.jsonl", "{\"pair\":\"a\",\"decision\":\"perhaps\",\"at\":\"\"}\n");
    assert!(export(&["broken.jsonl"]).refused().contains("line 1"));
}

#[test]
fn somebodys_dataset_is_written_again_without_what_was_rejected() {
    let building = Building::new();
    run(&building);
    let ran = building.wayword(&["export", "--run", "run", "--style", "r2r", "--format", "r2r", "--out", "r2r.json"]);
    // Walks through houses have no viewpoints, so R2R's own format cannot hold them; the test's building has a file.
    assert_ne!(ran.code, Some(0), "{ran:?}");
    let source = building.r2r();
    let source = source.to_str().unwrap();
    let items: Vec<Value> = serde_json::from_slice(&fs::read(source).unwrap()).unwrap();
    let all: usize = items.iter().map(|item| item["instructions"].as_array().unwrap().len()).sum();
    let name = format!("{}_0", items[0]["path_id"]);
    building.write("decisions.jsonl", format!("{{\"pair\":{name:?},\"decision\":\"reject\",\"at\":\"1\"}}\n"));
    let ran = building.wayword(&[
        "export",
        "--pairs",
        source,
        "--decisions",
        "decisions.jsonl",
        "--out",
        "kept.json",
        "--json",
    ]);
    let written = ran.json();
    assert_eq!(written["rejected"], 1, "{ran:?}");
    assert_eq!(written["instructions"], all - 1);
}

#[cfg(all(feature = "habitat", feature = "parquet", feature = "video", feature = "lerobot"))]
#[test]
fn a_dataset_with_language_is_not_annotated_again() {
    let building = Building::new();
    run(&building);
    let export = ["export", "--run", "run", "--format", "lerobot", "--size-px", "32x32", "--out", "lerobot"];
    assert_eq!(building.wayword(&export).code, Some(0));
    let ran = building.wayword(&["annotate", "lerobot/train", "--out", "language"]);
    assert!(ran.refused().contains("has a column \"language_persistent\" already"), "{ran:?}");
    assert!(!building.path("language").exists(), "a refused command leaves no folder");
}
