//! `wayword similarity` on a made-up building, with two people's descriptions of each item.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{Building, Ran};
use serde_json::Value;
use std::fs;

const REVERIE: &str = "data/reverie/REVERIE_val_seen.json";
const R2R: &str = "data/r2r/R2R_val_seen.json";

fn compare(building: &Building, a: &str, b: &str, args: &[&str]) -> Ran {
    let mut all = vec!["similarity", a, b, "--encoder", "words", "--resamples", "200"];
    all.extend(args);
    building.wayword(&all)
}

fn figures(building: &Building, a: &str, b: &str, args: &[&str]) -> Value {
    let ran = compare(building, a, b, &[args, &["--json"]].concat());
    assert_eq!(ran.code, Some(0), "{ran:?}");
    serde_json::from_str(&ran.out).unwrap()
}

fn mean(found: &Value, row: &str) -> f64 {
    found[row]["mean"].as_f64().unwrap()
}

#[test]
fn similarity_of_a_run_is_between_chance_and_identity() {
    let building = Building::new();
    let records = building.run_over_episodes("run");
    let of_style = records.iter().filter(|record| record.instruction.style == "reverie").count();
    let found = figures(&building, "run#reverie", REVERIE, &[]);
    assert_eq!(found["a"]["texts"], of_style);
    assert_eq!(found["figure"]["values"], of_style);
    assert_eq!(found["encoder"], "words");
    assert!(mean(&found, "figure") > mean(&found, "random_pairs"), "{found}");
    assert!(found["same_item"]["values"].as_u64() > Some(0));
    let same = figures(&building, "run", "run", &["--style", "reverie"]);
    assert!((mean(&same, "figure") - 1.0).abs() < 1e-6);
    assert!(same["same_item"].is_null(), "the run has one text per item: {same}");
    assert_eq!(same["single_in_b"], of_style);
}

#[test]
fn items_of_different_datasets_meet_by_their_path() {
    let building = Building::new();
    let by_item = compare(&building, REVERIE, R2R, &[]);
    assert_eq!(by_item.code, Some(1));
    assert!(by_item.err.contains("no item in common") && by_item.err.contains("--by path"), "{by_item:?}");
    let by_path = figures(&building, REVERIE, R2R, &["--by", "path"]);
    assert_eq!(by_path["figure"]["values"], by_path["figure"]["clusters"]);
}

#[test]
fn similarity_reports_items_of_one_side_only() {
    let building = Building::new();
    let mut items: Vec<Value> = serde_json::from_str(&fs::read_to_string(building.reverie()).unwrap()).unwrap();
    items.truncate(3);
    fs::write(building.path("three.json"), serde_json::to_string(&items).unwrap()).unwrap();
    let ran = compare(&building, REVERIE, "three.json", &[]);
    assert!(ran.out.contains("only in B: 0") && !ran.out.contains("only in A: 0"), "{ran:?}");
    assert!(ran.out.contains("no model"), "{ran:?}");
}

#[test]
fn styles_are_not_mixed_and_must_be_there() {
    let building = Building::new();
    building.run_over_episodes("run");
    for (a, told) in [("run", "several styles (r2r, reverie)"), ("run#mine", "no instruction of style mine")] {
        let ran = compare(&building, a, REVERIE, &[]);
        assert_eq!(ran.code, Some(1));
        assert!(ran.err.contains(told) && ran.err.contains("hint:"), "{ran:?}");
    }
    let of_dataset = compare(&building, REVERIE, &format!("{REVERIE}#r2r"), &[]);
    assert!(of_dataset.err.contains("have no style"), "{of_dataset:?}");
}

#[test]
fn metrics_are_between_another_person_and_another_path_and_name_their_protocol() {
    let building = Building::new();
    let ran = building.wayword(&["similarity", REVERIE, REVERIE, "--metrics", "--resamples", "100", "--json"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let found: Value = serde_json::from_str(&ran.out).unwrap();
    let protocol = &found["protocol"];
    assert_eq!((&protocol["tokens"], &protocol["references"]), (&"ptb".into(), &"item".into()));
    assert!(protocol["not_judged"].as_u64() > Some(0), "{protocol}");
    let figure = |row: &str| found[row]["cider_d"]["mean"].as_f64().unwrap();
    // A person's own text is among the references of "all", and not among those of the others.
    assert!(found["all"]["rouge_l"]["mean"].as_f64().unwrap() > 0.999, "{found}");
    assert_eq!(figure("rest"), figure("person"));
    assert!(figure("person") > figure("other_path"), "{found}");
    assert!(found["diversity"]["a"]["homogenisation"].as_f64().is_some());
}

#[test]
fn one_item_has_no_interval_and_no_figure_that_needs_several() {
    let building = Building::new();
    let items: Vec<Value> = serde_json::from_slice(&fs::read(building.reverie()).unwrap()).unwrap();
    building.write("one.json", Value::from(&items[..1]).to_string());
    let shown = building.wayword(&["similarity", "one.json", "one.json", "--metrics", "--resamples", "100"]);
    assert_eq!(shown.code, Some(0), "{shown:?}");
    assert!(shown.out.contains("no CIDEr-D: how rare a word is cannot be told from one item"), "{shown:?}");
    assert!(shown.out.contains("no intervals: all texts are about one path"), "{shown:?}");
    let row = shown.out.lines().find(|line| line.starts_with("A against all of B's texts ")).unwrap();
    assert!(row.trim_end().ends_with('-') && row.contains("100.0") && !row.contains("to"), "{row}");
    let found =
        building.wayword(&["similarity", "one.json", "one.json", "--metrics", "--resamples", "100", "--json"]).json();
    assert!(found["all"]["cider_d"].is_null(), "{found}");
    let cosine = compare(&building, "one.json", "one.json", &[]);
    assert!(cosine.out.contains("one path"), "{cosine:?}");
}

#[test]
fn metrics_need_no_model_and_texts_may_be_cut_off() {
    let building = Building::new();
    let metrics = |more: &[&str]| {
        let mut command = building.command(&[&["similarity", REVERIE, REVERIE, "--metrics"], more].concat());
        crate::common::run(command.env("WAYWORD_OFFLINE", "1"))
    };
    let cut = metrics(&["--tokens", "split", "--truncate-characters", "12"]);
    assert!(cut.out.contains("split tokens; references by item") && cut.out.contains("after 12 characters"), "{cut:?}");
    assert!(cut.out.contains("another person's text") && cut.out.contains("another path's text"), "{cut:?}");
    assert_ne!(cut.out, metrics(&["--tokens", "split"]).out);
    let alone = building.wayword(&["similarity", REVERIE, REVERIE, "--tokens", "split"]);
    assert!(alone.code == Some(2) && alone.err.contains("--metrics"), "{alone:?}");
}

/// A stand-in for Java: it answers as METEOR does, with half for each text and a quarter for all, or as SPICE does.
#[cfg(unix)]
const JAVA: &str = r#"#!/bin/sh
for word in "$@"; do
  if [ "$word" = -stdio ]; then
    count=0
    while read -r line; do
      case "$line" in
        SCORE*) count=$((count + 1)); echo "1.0 2.0" ;;
        EVAL*) while [ $count -gt 0 ]; do echo 0.5; count=$((count - 1)); done; echo 0.25 ;;
      esac
    done
    exit 0
  fi
done
[ "$1" = -Xmx8G ] || exit 3
count=$(grep -o image_id "$4" | wc -l)
echo "[" > "$8"
while [ $count -gt 1 ]; do echo '{"scores":{"All":{"f":0.75}}},' >> "$8"; count=$((count - 1)); done
echo '{"scores":{"All":{"f":0.75}}}]' >> "$8"
"#;

#[cfg(unix)]
#[test]
fn meteor_and_spice_are_asked_in_java() {
    use std::os::unix::fs::PermissionsExt;
    let building = Building::new();
    let java = building.path("java.sh");
    fs::write(&java, JAVA).unwrap();
    fs::set_permissions(&java, fs::Permissions::from_mode(0o755)).unwrap();
    fs::write(building.path("any.jar"), "").unwrap();
    let java = java.to_string_lossy().into_owned();
    let asked =
        |more: &[&str]| building.wayword(&[&["similarity", REVERIE, REVERIE, "--metrics", "--json"], more].concat());
    let ran = asked(&["--meteor-jar", "any.jar", "--spice-jar", "any.jar", "--java", &java]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let found: Value = serde_json::from_str(&ran.out).unwrap();
    let expected = serde_json::json!([
        { "name": "METEOR", "all": 0.25, "rest": 0.25, "person": 0.25, "other_path": 0.25 },
        { "name": "SPICE", "all": 0.75, "rest": 0.75, "person": 0.75, "other_path": 0.75 },
    ]);
    assert_eq!(found["outside"], expected);
    let missing = asked(&["--meteor-jar", "none.jar"]);
    assert!(missing.code == Some(1) && missing.err.contains("none.jar: there is no such file"), "{missing:?}");
    let silent = asked(&["--meteor-jar", "any.jar", "--java", "true"]);
    assert!(silent.code == Some(1) && silent.err.contains("did not answer as METEOR does"), "{silent:?}");
    let absent = asked(&["--spice-jar", "any.jar", "--java", "no-such-java"]);
    assert!(absent.code == Some(1) && absent.err.contains("--java PROGRAM"), "{absent:?}");
}

#[test]
fn missing_encoder_is_reported() {
    let building = Building::new();
    let mut command = building.command(&["similarity", REVERIE, REVERIE]);
    command.env("WAYWORD_OFFLINE", "1").env("HF_HUB_CACHE", building.path("empty"));
    let ran = crate::common::run(&mut command);
    assert_eq!(ran.code, Some(1));
    // A build without models in process suggests the encoder that needs none; a build with them names the missing file and its
    // place.
    let hints = ran.err.contains("--encoder words") || ran.err.contains("config.json");
    assert!(hints && ran.err.contains("all-MiniLM-L6-v2"), "{ran:?}");
}
