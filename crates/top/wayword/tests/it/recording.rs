//! Recordings from end to end: pictures with poses, pictures without poses, and files that other programs made. A model
//! of the test sees, because recordings have no labels.

#![cfg(all(feature = "mcap", feature = "video"))]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::models as stage;

use crate::common::{Ran, run};
use image::{Rgb, RgbImage};
use stage::{KEY, KEY_ENV, Stage, cast};
use std::{fs, path::Path};
use wayword_core::{CheckKind, Verdict};

/// Nine pictures with a pattern each; with poses they are a metre apart, four to the north and four to the east.
fn walk(stage: &Stage, poses: bool) {
    let folder = stage.building.path("walk");
    fs::create_dir(&folder).unwrap();
    let mut csv = String::from("image,x,y,z,heading_deg\n");
    for at in 0..=8_u32 {
        let pixel = |x: u32, y: u32| {
            Rgb([if ((x + 13 * at) / 16).is_multiple_of(2) { 210 } else { 30 }, (y / 2) as u8, 20 * at as u8])
        };
        RgbImage::from_fn(320, 240, pixel).save(folder.join(format!("{at}.png"))).unwrap();
        let (north, east) = (at.min(4), at.saturating_sub(4));
        csv += &format!("{at}.png,{east},{north},1.5,{}\n", if at > 4 { 90 } else { 0 });
    }
    if poses {
        fs::write(folder.join("poses.csv"), csv).unwrap();
    } else {
        fs::write(folder.join("recording.toml"), "interval_s = 1").unwrap();
    }
}

/// Instructions for one path through a recording, written by the models of the test.
fn generate(stage: &Stage, data: &str, args: &[&str]) -> Ran {
    let models = stage.models();
    let mut all = vec!["generate", "--platform", "recording", "--data", data, "--out", "run", "--json"];
    all.extend(["--style", "r2r", "--hops", "1..1000"]);
    all.extend(if args.contains(&"--paths") { &[][..] } else { &["--paths", "1"] });
    all.extend(models.iter().map(String::as_str));
    all.extend(args);
    run(stage.building.command(&all).env(KEY_ENV, KEY))
}

/// Whether a text mentions a turn or a storey.
fn tells_motion(text: &str) -> bool {
    let words = ["left", "right", "turn", "turns", "around", "upstairs", "downstairs", "stairs", "straight"];
    text.to_lowercase().split(|c: char| !c.is_alphabetic()).any(|word| words.contains(&word))
}

#[test]
fn a_walk_with_poses_becomes_instructions_with_turns_that_hold() {
    let stage = Stage::new(cast());
    walk(&stage, true);
    let ran = generate(&stage, "walk", &[]);
    assert!(ran.err.contains("recording walk: 9 pictures, 9 frames"), "{ran:?}");
    assert_eq!((ran.code, &ran.json()["rejected"]), (Some(0), &0.into()), "{ran:?}");
    let record = stage.building.records("run").remove(0);
    // Where the scripted eye is not sure, landmarks are unverified; the turns are measured.
    let turns = record.instruction.findings.iter().filter(|finding| finding.check == CheckKind::Turns);
    assert!(turns.clone().count() > 0 && turns.into_iter().all(|finding| finding.verdict == Verdict::Pass));
    assert!(record.instruction.text.contains("right"), "{}", record.instruction.text);
    let page = stage.building.wayword(&["report", "--run", "run"]);
    assert_eq!(page.code, Some(0), "{page:?}");
    let page = fs::read_to_string(stage.building.path("run/report.html")).unwrap();
    assert!(page.contains("8.0 m") && page.contains("src=\"report-files/"));
}

#[test]
fn looking_around_confirms_the_things_that_the_camera_saw() {
    let stage = Stage::new(cast());
    walk(&stage, true);
    let ran = generate(&stage, "walk", &["--frames", "panoramic"]);
    assert_eq!(ran.json()["errors"], 0, "{ran:?}");
    let walked = stage.building.lines("run/walks.jsonl").remove(0);
    for observation in walked["observations"].as_array().unwrap() {
        assert_eq!(observation["looks"].as_array().unwrap().len(), 1);
    }
}

#[test]
fn a_walk_without_poses_claims_no_turn() {
    let mut texts = Vec::new();
    for seed in ["1", "2", "3"] {
        let stage = Stage::new(cast());
        walk(&stage, false);
        let ran = generate(&stage, "walk", &["--seed", seed]);
        assert!(ran.err.contains("no poses, so no turns and distances"), "{ran:?}");
        assert!(matches!(ran.code, Some(0 | 3)), "{ran:?}");
        for record in stage.building.records("run") {
            let text = &record.instruction.text;
            assert!(!tells_motion(text), "{text}");
            texts.push(text.clone());
        }
        let page = stage.building.wayword(&["report", "--run", "run"]);
        assert_eq!(page.code, Some(0), "{page:?}");
        let page = fs::read_to_string(stage.building.path("run/report.html")).unwrap();
        assert!(page.contains("has no poses") && !page.contains("0.0 m"), "the page claims to know the way");
    }
    assert!(!texts.is_empty(), "nothing was written at all");
}

#[test]
fn recording_without_a_model_that_sees_is_refused() {
    let stage = Stage::new(cast());
    walk(&stage, true);
    let ran = stage.building.wayword(&[
        "generate",
        "--platform",
        "recording",
        "--data",
        "walk",
        "--paths",
        "1",
        "--out",
        "run",
    ]);
    assert_eq!(ran.code, Some(3), "{ran:?}");
    assert!(ran.out.contains("name a model that sees"), "{ran:?}");
    assert!(stage.building.records("run").is_empty());
}

/// Files that ffmpeg and the Python library of MCAP have written (`fixtures/make_*.py` of wayword-recording).
#[test]
fn files_of_other_programs_become_instructions() {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../world/wayword-recording/fixtures");
    for (file, poses) in [("video/high.mp4", false), ("video/av1.mp4", false), ("mcap/tree_chunks.mcap", true)] {
        let stage = Stage::new(cast());
        let name = Path::new(file).file_name().unwrap().to_str().unwrap();
        fs::copy(fixtures.join(file), stage.building.path(name)).unwrap();
        stage.building.write("recording.toml", "interval_s = 0.1\ninterval_m = 0.1");
        let ran = generate(&stage, name, &["--metres", "0.1..1000"]);
        assert!(matches!(ran.code, Some(0 | 3)), "{file}: {ran:?}");
        assert_eq!(ran.err.contains("no poses"), !poses, "{file}: {ran:?}");
        assert_eq!(ran.json()["errors"], 0, "{file}: {ran:?}");
        let walked = stage.building.lines("run/walks.jsonl").remove(0);
        assert!(walked["path"]["frames"].as_array().unwrap().len() > 1, "{file}");
        assert_eq!(walked["has_pictures"], true, "{file}");
    }
}

/// A run over a folder in which one recording cannot be read: an error that the user can correct, before a file is made.
#[test]
fn a_recording_that_cannot_be_read_ends_the_run_before_it_begins() {
    let stage = Stage::new(cast());
    walk(&stage, true);
    let shelf = stage.building.path("shelf");
    fs::create_dir(&shelf).unwrap();
    fs::rename(stage.building.path("walk"), shelf.join("walk")).unwrap();
    fs::write(shelf.join("empty.mp4"), "").unwrap();
    fs::write(shelf.join("bag.mcap"), "#ROSBAG V2.0\n").unwrap();
    fs::create_dir(shelf.join("phone")).unwrap();
    fs::write(shelf.join("phone/1.jpg"), b"RIFF\x24\0\0\0WEBPVP8 ").unwrap();
    let ran = generate(&stage, "shelf", &["--paths", "4"]);
    // Messages about the readable recording come before the error.
    assert_eq!((ran.code, ran.out.as_str()), (Some(1), ""), "{ran:?}");
    let told = &ran.err;
    for words in ["3 of 4 recordings", "empty.mp4: is empty", "a ROS 1 bag", "a WebP picture", "--scan"] {
        assert!(told.contains(words), "{words}: {told}");
    }
    assert!(!stage.building.path("run").exists());
    for (data, words) in [("shelf/empty.mp4", "is empty"), ("shelf/phone", "1.jpg: is a WebP picture")] {
        let ran = generate(&stage, data, &[]);
        assert!(ran.refused().contains(words), "{ran:?}");
        assert!(!stage.building.path("run").exists());
    }
    let ran = generate(&stage, "shelf", &["--scan", "walk"]);
    assert!(matches!(ran.code, Some(0 | 3)) && ran.json()["errors"] == 0, "{ran:?}");
}
