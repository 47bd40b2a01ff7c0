//! Whole commands with detectors in process. The detectors are tiny and random: their finds have no meaning, but they run the
//! same code as real ones. Where a test needs finds or misses, it sets the score from which a box is a find in its file of
//! figures.

#![cfg(feature = "local")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::{Building, Ran, run};
use serde_json::{Value, json};
use std::{collections::BTreeSet, fs, path::Path};
use wayword_testkit::{SCAN, viewpoint_id};

const R2R: &str = "data/r2r/R2R_val_seen.json";

/// The name of a model in the fixtures of `wayword-local`.
fn fixture(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/wayword-local/fixtures");
    format!("hf/{}", folder.join(name).canonicalize().unwrap().display())
}

/// A detector that looks for each phrase by itself.
fn owl() -> String {
    fixture("owl")
}

/// A detector in one file that takes all phrases in one prompt.
fn glip() -> String {
    fixture("glip/glip.pth")
}

/// The building with photographs.
fn building() -> Building {
    let building = Building::new();
    wayword_testkit::write_distinct_skyboxes(&building.data()).unwrap();
    building
}

/// Removes everything that labels are read from.
fn remove_labels(building: &Building) {
    fs::remove_dir_all(building.path("data/reverie")).unwrap();
    fs::remove_dir_all(building.path(&format!("data/matterport/v1/scans/{SCAN}/house_segmentations"))).unwrap();
}

/// `wayword ARGS`, offline.
fn wayword(building: &Building, args: &[&str]) -> Ran {
    run(building.command(args).env("WAYWORD_OFFLINE", "1"))
}

/// `wayword generate` with a detector, over two paths and with one ledger unless the arguments say otherwise.
fn generate(building: &Building, detector: &str, out: &str, args: &[&str]) -> Ran {
    let mut all = vec!["generate", "--platform", "matterport", "--data", "data", "--hops", "3..7", "--style", "r2r"];
    all.extend(["--json", "--detector", detector, "--out", out]);
    for (flag, value) in [("--paths", "2"), ("--ledger", "ledger.db")] {
        all.extend(if args.contains(&flag) { None } else { Some([flag, value]) }.into_iter().flatten());
    }
    all.extend(args);
    wayword(building, &all)
}

/// The answers of a run that were computed, and those from the ledger.
fn spent(summary: &Value) -> (u64, u64) {
    let count = |name: &str| summary["spent"][name].as_u64().unwrap();
    (count("answered"), count("from_ledger"))
}

/// Figures of a detector that finds everything from every frame and is never wrong; a box is a find from that score on.
fn figures(building: &Building, file: &str, detector: &str, found_from: f32) {
    let rates =
        "shown = 1000\nfound = 1000\nabsent = 1000\nalarms = 0\nmissed_before = 0\nmissed_again = 0\nruns = [1]";
    let head = format!("detector = {detector:?}\nplatforms = [\"matterport\"]\nfound_from = {found_from:?}");
    building.write(file, format!("{head}\n\n[all]\n{rates}\n"));
}

/// The number of views that a run's walks hold.
fn looks(building: &Building, run: &str) -> u64 {
    let walks = building.lines(&format!("{run}/walks.jsonl"));
    let frames = walks.iter().flat_map(|walk| walk["observations"].as_array().unwrap());
    frames.map(|frame| frame["looks"].as_array().unwrap().len() as u64).sum()
}

/// All sightings of a run's walks.
fn sightings(building: &Building, run: &str) -> Vec<Value> {
    let mut all = Vec::new();
    for walk in building.lines(&format!("{run}/walks.jsonl")) {
        for observation in walk["observations"].as_array().unwrap() {
            for look in observation["looks"].as_array().unwrap() {
                all.extend(look["caption"]["sightings"].as_array().into_iter().flatten().cloned());
            }
        }
    }
    all
}

#[test]
fn each_view_is_searched_once_and_texts_name_the_detector() {
    let building = building();
    let owl = owl();
    let first = generate(&building, &owl, "first", &[]);
    let summary = first.json();
    assert_eq!((first.code, &summary["errors"]), (Some(0), &0.into()), "{first:?}");
    let (answered, kept) = spent(&summary);
    assert!(answered > 100 && summary["spent"]["usd"] == 0.0, "{summary}");
    let searched = &summary["detector"];
    assert!(
        searched["model"] == owl.as_str() && summary["roles"].as_str().unwrap().contains(&format!("finds by {owl},"))
    );
    assert_eq!(searched["views"], looks(&building, "first"), "{summary}");
    for line in building.lines("first/instructions.jsonl") {
        let told = line["provenance"]["detector"].as_str().unwrap();
        let (name, score) = told.split_once(" (").unwrap();
        assert!(name == owl && score.contains("sigmoid") && score.contains("a photo of a"), "{told}");
        assert_eq!(line["provenance"]["checked_against"], "labels", "labels win where there are any");
    }

    let second = generate(&building, &owl, "second", &[]).json();
    assert_eq!(spent(&second), (0, answered + kept), "{second}");
    assert_eq!(&second["detector"], searched, "what the ledger knows is counted too");
    for name in ["walks.jsonl", "instructions.jsonl"] {
        let read = |run: &str| fs::read_to_string(building.path(run).join(name)).unwrap();
        assert_eq!(read("first"), read("second"), "{name}");
    }
    // Another precision may find something else, so these are other calls.
    let half = generate(&building, &owl, "half", &["--precision", "bf16"]).json();
    assert!(spent(&half).0 > 100, "{half}");
    let page = wayword(&building, &["report", "--run", "first"]);
    assert_eq!(page.code, Some(0), "{page:?}");
    let page = fs::read_to_string(building.path("first/report.html")).unwrap();
    assert!(page.replace("&#x2f;", "/").contains(&owl));
}

#[test]
fn phrases_that_meet_are_searched_together() {
    let building = building();
    for name in [fixture("dino"), fixture("dino_mm"), glip()] {
        building.write("two.txt", "lamp\nsink\n");
        let out = name.rsplit('/').next().unwrap();
        let args = ["--paths", "1", "--evidence", "detector", "--see", "labels", "--proposals", "two.txt"];
        let ran = generate(&building, &name, out, &args);
        let summary = ran.json();
        assert_eq!(summary["errors"], 0, "{ran:?}");
        let (answered, kept) = spent(&summary);
        assert_eq!(answered + kept, looks(&building, out), "one call for each view: {summary}");
    }
}

#[test]
fn proposals_are_off_or_named_and_a_dry_run_counts_them() {
    let building = building();
    let owl = owl();
    let plan = |args: &[&str]| {
        let ran = generate(&building, &owl, "none", &[&["--dry-run"], args].concat());
        assert!(
            ran.code == Some(0) && !building.path("none").exists() && !building.path("ledger.db").exists(),
            "{ran:?}"
        );
        let plan = ran.json();
        assert_eq!(plan["detector"]["model"], owl, "{plan}");
        (plan["views"].as_u64().unwrap(), plan["detector"]["phrases"].as_u64().unwrap())
    };
    building.write("mine.txt", "# mine\nlamp\nsink # in the kitchen\n\nlamps\n");
    let (usual, off, mine) = (plan(&[]), plan(&["--proposals", "off"]), plan(&["--proposals", "mine.txt"]));
    assert!(usual.0 > 2 && usual.0 == off.0 && usual.0 == mine.0, "{usual:?} {off:?} {mine:?}");
    assert!(usual.1 > 40 && off.1 == 0 && mine.1 == 2, "{usual:?} {off:?} {mine:?}");
    let told = wayword(
        &building,
        &["generate", "--platform", "matterport", "--data", "data", "--paths", "2", "--dry-run", "--detector", &owl],
    );
    assert!(
        told.out.contains(&format!("{owl} looks for")) && told.out.contains(" things and what captions name"),
        "{told:?}"
    );

    // Every run has its own ledger, so that none finds the answers of another.
    let asked = |out: &str, args: &[&str]| {
        let ledger = format!("{out}.db");
        let ran = generate(&building, &owl, out, &[&["--ledger", &ledger], args].concat());
        assert_eq!(ran.json()["errors"], 0, "{ran:?}");
        let (answered, kept) = spent(&ran.json());
        answered + kept
    };
    let (all, none, two) =
        (asked("all", &[]), asked("nothing", &["--proposals", "off"]), asked("two", &["--proposals", "mine.txt"]));
    assert!(none > 0, "what captions name is looked for");
    assert!(
        none <= two && two <= none + 2 * usual.0 * 2 && two < all && all >= usual.0 * usual.1,
        "{none} {two} {all}"
    );

    let nothing = building.write("empty.txt", "# nothing\n").display().to_string();
    let ran = generate(&building, &owl, "empty", &["--proposals", &nothing]);
    assert!(ran.refused().contains("it names nothing"), "{ran:?}");
}

#[test]
fn finds_are_kept_with_boxes_and_misses_are_struck_out() {
    let building = building();
    let owl = owl();
    building.write("mine.txt", "umbrella\n");
    figures(&building, "all.toml", &owl, 0.0);
    figures(&building, "none.toml", &owl, 2.0);
    let args = ["--proposals", "mine.txt", "--detector-figures"];
    let summary = generate(&building, &owl, "all", &[&args[..], &["all.toml"]].concat()).json();
    assert_eq!(summary["errors"], 0, "{summary}");
    let seen = sightings(&building, "all");
    let umbrella: Vec<&Value> = seen.iter().filter(|seen| seen["name"] == "umbrella").collect();
    assert!(umbrella.iter().all(|seen| seen["by"] == owl.as_str() && seen["witness"] == "seen"), "{umbrella:?}");
    let score = umbrella[0]["spot"]["found"]["score"].as_f64().unwrap();
    assert!((0.0..=1.0).contains(&score), "{umbrella:?}");
    assert!(seen.iter().all(|seen| seen["witness"] != "denied" || seen["by"] == "labels"), "{seen:?}");

    let summary = generate(&building, &owl, "none", &[&args[..], &["none.toml"]].concat()).json();
    assert_eq!(spent(&summary).0, 0, "figures do not change what is looked for: {summary}");
    let seen = sightings(&building, "none");
    assert!(seen.iter().all(|seen| seen["name"] != "umbrella" && seen["spot"].is_null()), "{seen:?}");
    assert!(seen.iter().any(|seen| seen["witness"] == "denied" && seen["by"] == owl.as_str()), "{seen:?}");
    assert!(seen.iter().all(|seen| seen["witness"] == "denied" || seen["by"] == "labels"), "{seen:?}");

    // The same without figures: a missed thing is not taken to be absent.
    generate(&building, &owl, "unmeasured", &["--proposals", "mine.txt"]);
    assert!(
        sightings(&building, "unmeasured").iter().all(|seen| seen["by"] == "labels" || seen["witness"] != "denied")
    );
}

#[test]
fn run_is_continued_only_with_the_same_detector_settings() {
    let building = building();
    let owl = owl();
    building.write("mine.txt", "lamp\n");
    figures(&building, "figures.toml", &owl, 0.3);
    let args = ["--proposals", "mine.txt", "--detector-figures", "figures.toml"];
    let more = [&args[..], &["--paths", "3"]].concat();
    assert_eq!(generate(&building, &owl, "run", &args).json()["errors"], 0);
    let before = crate::common::files(&building.path("run"));
    assert_eq!(generate(&building, &owl, "run", &args).json()["spent"]["answered"], 0);
    assert!(crate::common::files(&building.path("run")) == before, "the same command again changes nothing");

    let files = ["figures.toml", "mine.txt"].map(|name| fs::read_to_string(building.path(name)).unwrap());
    figures(&building, "figures.toml", &owl, 0.4);
    let ran = generate(&building, &owl, "run", &more);
    assert!(ran.refused().contains("detector figures"), "{ran:?}");
    building.write("figures.toml", &files[0]);
    building.write("mine.txt", "lamp\nsink\n");
    let ran = generate(&building, &owl, "run", &more);
    assert!(ran.refused().contains("proposals"), "{ran:?}");
    building.write("mine.txt", &files[1]);
    let ran = generate(&building, &fixture("dino"), "run", &["--proposals", "mine.txt"]);
    assert!(ran.refused().contains("detector"), "{ran:?}");
    assert!(crate::common::files(&building.path("run")) == before, "a run that is refused is left alone");
    assert_eq!(generate(&building, &owl, "run", &more).json()["errors"], 0);
}

#[test]
fn detector_flags_without_a_detector_are_refused_and_leave_no_folder() {
    let building = building();
    let owl = owl();
    figures(&building, "of_owl.toml", &owl, 0.1);
    building.write("broken.toml", "detector = 3\n");
    let (dino, clip, bert) = (fixture("dino"), fixture("clip"), fixture("bert"));
    for (detector, args, told) in [
        ("ollama/x", &[][..], "detectors run inside this program"),
        ("owl", &[], "detectors run inside this program"),
        ("hf/org/name", &[], "config.json"),
        ("hf/org/name:model.gguf", &[], "GGUF"),
        (&clip, &[], "model_type clip"),
        (&bert, &[], "model_type bert"),
        (&dino, &["--detector-figures", "of_owl.toml"], "and not with"),
        (&owl, &["--detector-figures", "broken.toml"], "has no figures of a detector"),
        (&owl, &["--detector-figures", "nowhere.toml"], "nowhere.toml"),
        (&owl, &["--proposals", "nowhere.txt"], "nowhere.txt"),
        (&owl, &["--device", "cuda"], "--features cuda"),
        (&owl, &["--memory-gib", "0.1"], "GiB are left"),
    ] {
        let ran = generate(&building, detector, "run", args);
        assert!(ran.refused().contains(told), "{detector} {args:?}: {ran:?}");
        assert!(!building.path("run").exists(), "{detector} {args:?}: {ran:?}");
    }
    for args in [&["--evidence", "detector"], &["--detector-figures", "of_owl.toml"], &["--proposals", "off"]] {
        let ran = building.generate("run", &[&["--paths", "1"], &args[..]].concat());
        assert!(ran.refused().contains("has no effect without a detector"), "{args:?}: {ran:?}");
        assert!(!building.path("run").exists(), "{args:?}");
    }
    let ran = generate(&building, &owl, "run", &["--evidence", "labels,photographs"]);
    assert!(ran.code == Some(2) && ran.err.contains("none of labels, captions, detector"), "{ran:?}");
}

#[test]
fn generated_houses_are_searched_too() {
    let building = Building::new();
    let owl = owl();
    building.write("two.txt", "lamp\nbed\n");
    figures(&building, "all.toml", &owl, 0.0);
    let run = |out: &str| {
        let args = ["generate", "--platform", "house", "--paths", "1", "--scan", "house2-1", "--style", "r2r"];
        let more = ["--ledger", "ledger.db", "--json", "--detector", &owl, "--proposals", "two.txt", "--out", out];
        let how = ["--evidence", "captions,detector", "--detector-figures", "all.toml"];
        let ran = wayword(&building, &[&args[..], &more, &how].concat());
        assert_eq!(ran.json()["errors"], 0, "{ran:?}");
        spent(&ran.json())
    };
    let (answered, kept) = run("first");
    assert!(answered > 2, "{answered}");
    assert_eq!(run("second"), (0, answered + kept));
    let seen = sightings(&building, "first");
    assert!(seen.iter().any(|seen| seen["name"] == "bed" && seen["spot"]["found"]["score"].is_number()), "{seen:?}");
    let line = &building.lines("first/instructions.jsonl")[0];
    assert_eq!(line["provenance"]["checked_against"], "captions", "{line}");
}

/// `wayword perceive` on the building with a detector.
fn perceive(building: &Building, detector: &str, args: &[&str]) -> Ran {
    let all = ["perceive", "--platform", "matterport", "--data", "data", "--views", "6", "--perception", "dialogue"];
    let more = ["--ledger", "ledger.db", "--json", "--detector", detector];
    wayword(building, &[&all[..], &more, args].concat())
}

#[test]
fn figures_are_measured_kept_and_taken() {
    let building = building();
    let owl = owl();
    let ran = perceive(&building, &owl, &["--figures", "owl.toml"]);
    let measured = ran.json();
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let told = &measured["detector"];
    assert!(told["detector"] == owl.as_str() && told["platforms"] == json!(["matterport"]), "{told}");
    assert!(told["views"].as_u64().unwrap() >= 6 && told["scores"].as_str().unwrap().contains("sigmoid"), "{told}");
    let count = |name: &str| told["all"][name].as_u64().unwrap();
    assert!(count("shown") > 0 && count("absent") > 0, "{told}");
    assert!(count("found") <= count("shown") && count("alarms") <= count("absent"), "{told}");
    let with = &measured["rows"][0]["with_detector"];
    assert!(with["struck_out"].is_u64() && with["recall"].is_f64(), "{measured}");
    let kept: Value = toml::from_str(&fs::read_to_string(building.path("owl.toml")).unwrap()).unwrap();
    assert_eq!((&kept["detector"], &kept["all"]), (&told["detector"], &told["all"]));

    for args in [&["--evidence", "detector"][..], &[]] {
        let out = format!("run{}", args.len());
        let ran = generate(
            &building,
            &owl,
            &out,
            &[&["--proposals", "off", "--detector-figures", "owl.toml"], args].concat(),
        );
        assert_eq!(ran.json()["errors"], 0, "{ran:?}");
    }
    assert!(
        check(&building, &texts(&building, &[FINE]), &owl, &["--detector-figures", "owl.toml"]).json()["passed"]
            .is_u64()
    );
    let other = generate(&building, &fixture("dino"), "other", &["--detector-figures", "owl.toml"]);
    assert!(other.refused().contains("was measured with"), "{other:?}");

    // People read the same.
    let args = ["perceive", "--platform", "matterport", "--data", "data", "--views", "6", "--perception", "dialogue"];
    let more = ["--ledger", "ledger.db", "--detector", &owl];
    let ran = wayword(&building, &[&args[..], &more].concat());
    assert!(ran.out.contains("missed always") && ran.out.contains("with the detector"), "{ran:?}");
    assert!(ran.err.contains("models: 0 calls"), "what was asked once is in the ledger: {ran:?}");
}

#[test]
fn check_with_a_detector_looks_in_four_directions() {
    let building = building();
    let headings = |args: &[&str]| {
        let ran = perceive(&building, &owl(), &[&["--show", "6"], args].concat());
        let measured = ran.json();
        let shown = measured["shown"].as_array().unwrap().iter();
        let headings: BTreeSet<u64> = shown.map(|shown| shown["heading_deg"].as_f64().unwrap() as u64).collect();
        (headings, measured["detector"]["views"].as_u64().unwrap())
    };
    let compass: BTreeSet<u64> = [0, 90, 180, 270].into();
    let (around, views) = headings(&["--frames", "panoramic"]);
    assert!(around.len() > 1 && around.is_subset(&compass), "{around:?}");
    assert!(views % 4 == 0, "the detector looks in all directions, also where labels show nothing: {views}");
    let ahead = headings(&[]).0;
    assert!(!ahead.is_subset(&compass), "without the flag it looks along the headings: {ahead:?}");
}

#[test]
fn a_detector_is_measured_only_on_pictures_with_labels() {
    let without_pictures = Building::new();
    let ran = perceive(&without_pictures, &owl(), &["--figures", "owl.toml"]);
    assert!(ran.refused().contains("no view has both a picture and labels"), "{ran:?}");
    assert!(!without_pictures.path("owl.toml").exists());
    let ran = without_pictures.wayword(&["perceive", "--figures", "owl.toml"]);
    assert!(ran.code == Some(2) && ran.err.contains("--detector"), "{ran:?}");
}

/// From the refrigerator through the kitchen and the hallway to the entryway, and right into the living room.
const TO_THE_LAMP: [usize; 5] = [5, 4, 1, 0, 2];
const FINE: &str = "Leave the kitchen and walk to the entryway. Turn right at the coat rack and go into the living room. Stop at the lamp.";

/// A dataset of one path with these texts.
fn texts(building: &Building, texts: &[&str]) -> String {
    let path: Vec<String> = TO_THE_LAMP.iter().map(|index| viewpoint_id(*index)).collect();
    let item =
        json!({ "path_id": 1, "scan": SCAN, "path": path, "heading": 3.3, "distance": 12.0, "instructions": texts });
    building.write("texts.json", json!([item]).to_string()).display().to_string()
}

fn check(building: &Building, file: &str, detector: &str, args: &[&str]) -> Ran {
    let all = ["check", file, "--platform", "matterport", "--data", "data", "--style", "r2r", "--json"];
    wayword(building, &[&all[..], &["--ledger", "ledger.db", "--detector", detector], args].concat())
}

/// The numbers of texts that passed the check of landmarks, were unverified, or failed.
fn landmarks(report: &Value) -> [u64; 3] {
    ["passed", "unverified", "failed"].map(|verdict| report["by_check"]["landmarks"][verdict].as_u64().unwrap_or(0))
}

#[test]
fn anyones_texts_are_checked_against_what_a_detector_finds() {
    let building = building();
    let owl = owl();
    let file = texts(&building, &["Walk past the piano. Stop at the lamp."]);
    let against = |args: &[&str]| {
        let ran = check(&building, &file, &owl, args);
        assert!(matches!(ran.code, Some(0 | 3)), "{ran:?}");
        (ran.json()["checked_against"].clone(), ran.json())
    };
    let (labels, detector) = (json!(["labels"]), json!(["detector"]));
    assert_eq!(against(&[]).0, labels, "labels win where there are any");
    assert!(!building.path("ledger.db").exists() || ledger_calls(&building) == 0, "nothing was looked for");
    assert_eq!(against(&["--evidence", "labels,detector"]).0, labels);
    let (unmeasured, report) = against(&["--evidence", "detector"]);
    assert_eq!(unmeasured, detector, "{report}");
    // Five places, four views of each, two things.
    assert_eq!(ledger_calls(&building), 5 * 4 * 2);
    assert_eq!(landmarks(&report)[2], 0, "nothing that an unmeasured detector misses is absent: {report}");

    for (found_from, wanted) in [(0.0, [1, 0, 0]), (2.0, [0, 0, 1])] {
        figures(&building, "figures.toml", &owl, found_from);
        let (source, report) =
            against(&["--evidence", "detector", "--detector-figures", "figures.toml", "--world", "closed"]);
        assert_eq!((source, landmarks(&report)), (detector.clone(), wanted), "{found_from}: {report}");
    }
    assert_eq!(ledger_calls(&building), 5 * 4 * 2, "what was looked for once is in the ledger");

    remove_labels(&building);
    let (source, report) = against(&["--detector-figures", "figures.toml", "--world", "closed"]);
    assert_eq!((source, landmarks(&report)), (detector, [0, 0, 1]), "{report}");
    let without = wayword(&building, &["check", &file, "--platform", "matterport", "--data", "data", "--json"]);
    assert_eq!(without.json()["checked_against"], json!(["nothing"]), "{without:?}");
}

/// The number of calls that the ledger keeps.
fn ledger_calls(building: &Building) -> usize {
    let ran = wayword(building, &["ledger", "export", "--ledger", "ledger.db", "--out", "calls.jsonl"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    building.lines("calls.jsonl").len()
}

#[test]
fn a_check_refuses_what_does_not_fit_its_detector() {
    let building = building();
    let (owl, file) = (owl(), texts(&building, &[FINE]));
    figures(&building, "of_dino.toml", &fixture("dino"), 0.1);
    let ran = check(&building, &file, &owl, &["--detector-figures", "of_dino.toml"]);
    assert!(ran.refused().contains("and not with"), "{ran:?}");
    assert!(check(&building, &file, "ollama/x", &[]).refused().contains("detectors run inside this program"));
    assert!(check(&building, &file, &fixture("clip"), &[]).refused().contains("model_type clip"));
    let glip = glip();
    for (detector, args, told) in [
        (&owl, ["--memory-gib", "0.1"], "GiB are left"),
        (&owl, ["--memory-gib", "0"], "--memory-gib 0 is out of range"),
        (&glip, ["--trust", "0123"], "not 0123, which was given"),
    ] {
        let ran = check(&building, &file, detector, &args);
        assert!(ran.refused().contains(told), "{args:?}: {ran:?}");
    }
    let world = ["check", &file, "--platform", "matterport", "--data", "data"];
    let none = building.wayword(&[&world[..], &["--evidence", "detector"]].concat());
    assert!(none.refused().contains("no detector is named"), "{none:?}");
    for args in [["--detector-figures", "of_dino.toml"], ["--memory-gib", "8"], ["--trust", "0123"]] {
        let ran = building.wayword(&[&world[..], &args[..]].concat());
        assert!(ran.code == Some(2) && ran.err.contains("--detector <MODEL>"), "{args:?}: {ran:?}");
    }
    let unused = building.wayword(&[&world[..], &["--ledger", "ledger.db"]].concat());
    assert!(unused.refused().contains("--ledger has no effect"), "{unused:?}");
    let ran = building.wayword(&["check", &file, "--run", "run", "--detector", &owl]);
    assert!(ran.code == Some(2) && ran.err.contains("--run"), "{ran:?}");
}

/// `wayword compare` by people's texts, over two items.
fn compare(building: &Building, out: &str, args: &[&str]) -> Ran {
    let all = ["compare", "--platform", "matterport", "--data", "data", "--episodes", R2R, "--limit", "2"];
    let all = [&all[..], &["--rule", "distance"]].concat();
    let more = ["--swaps", "none", "--resamples", "200", "--ledger", "ledger.db", "--out", out];
    wayword(building, &[&all[..], &more, args].concat())
}

fn about(building: &Building, out: &str) -> Value {
    let text = fs::read_to_string(building.path(out).join("comparison.json")).unwrap();
    serde_json::from_str::<Value>(&text).unwrap()["about"].clone()
}

/// The agents that a comparison has walks of.
fn agents(building: &Building, out: &str) -> BTreeSet<String> {
    let walks = building.lines(&format!("{out}/walks.jsonl"));
    walks.iter().map(|walk| walk["agent"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn glip_nav_walks_by_the_boxes_of_glip() {
    let building = building();
    let glip = glip();
    let args = ["--grounder", &glip, "--agents", "glip-nav"];
    let ran = compare(&building, "walked", &args);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let told = about(&building, "walked");
    assert_eq!((&told["detector"], &told["grounder"]), (&glip.as_str().into(), &glip.as_str().into()), "{told}");
    assert!(told["detector_score"].as_str().unwrap().contains("centreness"), "{told}");
    assert!(agents(&building, "walked").contains("glip-nav"));
    assert!(ran.out.contains(&glip) || ran.out.contains("glip.pth"), "{ran:?}");

    // The walks again, from the answers in the ledger.
    let walks = fs::read(building.path("walked/walks.jsonl")).unwrap();
    fs::remove_file(building.path("walked/walks.jsonl")).unwrap();
    let again = compare(&building, "walked", &args);
    assert!(again.code == Some(0) && again.err.contains("models: 0 calls"), "{again:?}");
    assert!(fs::read(building.path("walked/walks.jsonl")).unwrap() == walks, "the walks differ");
    let other = compare(&building, "walked", &["--grounder", "detector", "--detector", &glip, "--agents", "glip-nav"]);
    assert!(other.code == Some(1) && other.err.contains("other settings: grounder"), "{other:?}");
    let page = wayword(&building, &["report", "--run", "walked"]);
    assert_eq!(page.code, Some(0), "{page:?}");
}

#[test]
fn glip_nav_walks_through_generated_houses() {
    let building = Building::new();
    let glip = glip();
    let args = ["generate", "--paths", "1", "--style", "reverie", "--scan", "house2-1", "--out", "houses"];
    assert_eq!(building.wayword(&args).code, Some(0));
    let args = ["compare", "--episodes", "houses/instructions.jsonl", "--grounder", &glip, "--agents", "glip-nav"];
    let more = ["--swaps", "none", "--resamples", "200", "--ledger", "ledger.db", "--out", "walked"];
    let ran = wayword(&building, &[&args[..], &more].concat());
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(agents(&building, "walked").contains("glip-nav"));
}

#[test]
fn all_agents_walk_by_one_detector_and_views_need_not_be_its() {
    let building = building();
    let (dino, owl) = (fixture("dino"), owl());
    let all = ["clip-nav", "seq-clip-nav", "glip-nav", "reader"].map(str::to_owned);
    let names = all.join(",");
    let args = ["--grounder", "detector", "--detector", &dino, "--agents", &names];
    let ran = compare(&building, "dino", &args);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert_eq!(about(&building, "dino")["detector"], dino, "{ran:?}");
    assert!(BTreeSet::from(all).is_subset(&agents(&building, "dino")));

    // Words score whole views, and a detector the boxes.
    let ran = compare(&building, "owl", &["--detector", &owl, "--agents", "clip-nav,glip-nav"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let told = about(&building, "owl");
    assert_eq!((&told["grounder"], &told["detector"]), (&"labels/lexical".into(), &owl.as_str().into()), "{told}");
    let clip = fixture("clip");
    let ran = compare(&building, "clip", &["--grounder", &clip, "--detector", &owl, "--agents", "clip-nav,glip-nav"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let told = about(&building, "clip");
    assert_eq!((&told["grounder"], &told["detector"]), (&clip.as_str().into(), &owl.as_str().into()), "{told}");
}

#[test]
fn agents_are_refused_a_detector_that_is_none_or_does_not_fit() {
    let building = building();
    let (clip, owl) = (fixture("clip"), owl());
    for (args, told) in [
        (vec!["--grounder", "detector"], "no detector is named"),
        (vec!["--grounder", "detector", "--detector", "ollama/x"], "detectors run inside this program"),
        (vec!["--grounder", "detector", "--detector", &clip], "model_type clip"),
        (vec!["--grounder", &clip], "glip-nav needs a detector"),
        (vec!["--grounder", "hf/org/name:none.pth"], "none.pth"),
        (vec!["--grounder", "detector", "--detector", &owl, "--memory-gib", "0.1"], "GiB are left"),
    ] {
        let ran = compare(&building, "walked", &args);
        assert!(ran.refused().contains(told), "{args:?}: {ran:?}");
        assert!(!building.path("walked").exists(), "{args:?}");
    }
}

#[test]
fn agents_of_a_detector_need_pictures() {
    let building = Building::new();
    let ran = compare(&building, "walked", &["--grounder", "detector", "--detector", &owl()]);
    assert!(ran.refused().contains("needs a picture"), "{ran:?}");
}
