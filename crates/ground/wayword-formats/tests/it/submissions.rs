//! Submissions: a written one can be read again, and the reader reports all problems.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use flate2::{Compression, write::GzEncoder};
use proptest::prelude::*;
use rand::Rng;
use serde_json::{Value, json};
use std::{fs, io::Write, path::Path};
use wayword_core::{Heading, ObjectId, SceneId, ViewpointId};
use wayword_formats::{
    Episode,
    submission::{
        SubmissionProblems, SubmissionReading, SubmittedTrajectory, TrajectoryPose, instr_id, read_submission,
        write_submission,
    },
};

fn in_file<T>(contents: impl AsRef<[u8]>, look: impl FnOnce(&Path) -> T) -> T {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("submission.json");
    fs::write(&file, contents).unwrap();
    look(&file)
}

/// All items of a file without problems.
fn whole(file: &Path) -> Vec<SubmittedTrajectory> {
    let SubmissionReading { submitted, flawed, problems, is_whole } = read_submission(file);
    assert!(problems.listed.is_empty() && flawed.is_empty() && is_whole, "{problems:?} {flawed:?}");
    submitted
}

fn good(items: &Value) -> Vec<SubmittedTrajectory> {
    in_file(items.to_string(), whole)
}

/// The problems of a file, without its name.
fn problems(contents: impl AsRef<[u8]>) -> Vec<String> {
    let SubmissionProblems { listed: told, unlisted_count: untold } = in_file(contents, read_submission).problems;
    assert_eq!(untold, 0);
    let bare = |text: String| text.split_once("submission.json: ").unwrap().1.to_owned();
    told.iter().map(|problem| bare(problem.to_string())).collect()
}

fn place(viewpoint: &str) -> TrajectoryPose {
    TrajectoryPose { viewpoint: ViewpointId::new(viewpoint).unwrap(), heading: Heading::NORTH, elevation_rad: 0.0 }
}

#[test]
fn both_datasets_submissions_are_read() {
    let found = good(&json!([
        {"instr_id": "4332_0", "trajectory": [["hall", 1.5, -0.25], ["door", 7.0, 0.0]]},
        {"instr_id": "4332_66_1", "trajectory": [["hall", 0, 0]], "predObjId": 66, "score": [1, 2]},
        {"instr_id": "4332_66_2", "trajectory": [["hall", 0, 0]], "predObjId": "66"},
        {"instr_id": "4332_66_3", "trajectory": [["hall", 0, 0]], "predObjId": null},
    ]));
    assert_eq!(found[0].instr_id, "4332_0");
    let turned = TrajectoryPose { heading: Heading::new(1.5).unwrap(), elevation_rad: -0.25, ..place("hall") };
    assert_eq!(found[0].trajectory[0], turned);
    assert!((found[0].trajectory[1].heading.rad() - (7.0 - std::f64::consts::TAU)).abs() < 1e-12);
    let object = ObjectId::new("66").unwrap();
    let objects: Vec<_> = found.iter().map(|submitted| submitted.object.as_ref()).collect();
    assert_eq!(objects, [None, Some(&object), Some(&object), None]);
}

#[test]
fn directions_may_be_absent_and_places_may_come_together() {
    let found = good(&json!([
        {"instr_id": "1_0", "trajectory": [["hall"], "door", ["stairs", "landing", "room"], ["desk", 0.5]]},
    ]));
    let mut expected: Vec<TrajectoryPose> = ["hall", "door", "stairs", "landing", "room", "desk"].map(place).into();
    expected[5].heading = Heading::new(0.5).unwrap();
    assert_eq!(found[0].trajectory, expected);
}

#[test]
fn gzip_is_recognised_by_its_bytes() {
    let mut zipped = GzEncoder::new(Vec::new(), Compression::fast());
    zipped.write_all(br#"[{"instr_id": "1_0", "trajectory": [["hall", 0, 0]]}]"#).unwrap();
    let found = in_file(zipped.finish().unwrap(), whole);
    assert_eq!(found[0].trajectory, [place("hall")]);
}

#[test]
fn read_lists_all_problems() {
    let found = problems(
        json!([
            {"instr_id": "1_0", "trajectory": [["hall", 0, 0]]},
            {"instr_id": "1_0", "trajectory": [["hall", 0, "up"], ["../hall", 0, 0], 5, []], "predObjId": [1]},
            7,
            {"trajectory": []},
            {"instr_id": "", "trajectory": "hall"},
            {"instr_id": "1_1"},
        ])
        .to_string(),
    );
    let starts = [
        "item 1 (id 1_0): field \"instr_id\": it was given to an earlier item",
        "item 1 (id 1_0): field \"trajectory[0][2]\": expected a finite number",
        "item 1 (id 1_0): field \"trajectory[1][0]\": viewpoint \"../hall\" could name another folder",
        "item 1 (id 1_0): field \"trajectory[2]\": expected [viewpoint, heading, elevation], found 5",
        "item 1 (id 1_0): field \"trajectory[3]\": expected [viewpoint, heading, elevation], found a list of 0",
        "item 1 (id 1_0): field \"predObjId\": expected a whole number, or a text",
        "item 2: expected an object, found 7",
        "item 3: field \"instr_id\": it is missing",
        "item 3: field \"trajectory\": it is empty",
        "item 4: field \"instr_id\": expected the name of an instruction",
        "item 4: field \"trajectory\": expected a list",
        "item 5 (id 1_1): field \"trajectory\": it is missing",
    ];
    assert_eq!(found.len(), starts.len(), "{found:#?}");
    for (found, start) in found.iter().zip(starts) {
        assert!(found.starts_with(start), "{found} does not begin with {start}");
    }
}

#[test]
fn read_returns_usable_items_together_with_problems() {
    let items = json!([
        {"instr_id": "1_0", "trajectory": ["hall", 5, "door"]},
        {"instr_id": "1_1", "trajectory": ["hall"]},
        {"instr_id": "1_1", "trajectory": []},
        {"instr_id": "1_0", "trajectory": ["hall"]},
        {"instr_id": "1_2", "trajectory": ["hall"], "predObjId": [1]},
        {"trajectory": ["hall"]},
        {"instr_id": "1_3", "trajectory": ["door"]},
    ]);
    let names =
        |reading: &SubmissionReading| reading.submitted.iter().map(|item| item.instr_id.clone()).collect::<Vec<_>>();
    let reading = in_file(items.to_string(), read_submission);
    assert_eq!(names(&reading), ["1_1", "1_3"]);
    assert_eq!((reading.flawed.as_slice(), reading.is_whole), (["1_0".to_owned(), "1_2".to_owned()].as_slice(), true));
    let broken = in_file(items.to_string().replace("{\"trajectory\"", "{"), read_submission);
    assert_eq!((names(&broken), broken.is_whole), (vec!["1_1".to_owned()], false));
}

#[test]
fn read_lists_problems_before_the_file_broke_off() {
    let found = problems(r#"[{"instr_id": "1_0"}, {"instr_id": "1_1", "trajectory": [["hall", 0"#);
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found[1].contains("the file is cut off"), "{found:?}");
}

#[test]
fn read_lists_a_thousand_problems_and_counts_the_rest() {
    let items: Vec<Value> = (0..1_500).map(|n| json!({"instr_id": format!("{n}_0")})).collect();
    let problems = in_file(Value::from(items).to_string(), read_submission).problems;
    assert_eq!((problems.listed.len(), problems.unlisted_count, problems.count()), (1_000, 500, 1_500));
}

#[test]
fn a_file_that_is_not_there_is_refused() {
    let SubmissionReading { problems, is_whole, .. } = read_submission(Path::new("nowhere/submission.json"));
    assert!(problems.listed[0].to_string().starts_with("nowhere/submission.json: cannot open it") && !is_whole);
}

#[test]
fn instructions_are_named_by_item_and_place() {
    let episode = Episode::new("4332_66", "4332", SceneId::new("house1").unwrap());
    assert_eq!(instr_id(&episode, 2), "4332_66_2");
}

#[test]
fn an_object_is_always_written() {
    in_file("", |file| {
        let of = |name: &str, object: Option<&str>| SubmittedTrajectory {
            instr_id: name.to_owned(),
            trajectory: vec![place("hall")],
            object: object.map(|object| ObjectId::new(object).unwrap()),
        };
        write_submission(file, &[of("1_0", Some("66")), of("1_1", None)]).unwrap();
        let items: Value = serde_json::from_slice(&fs::read(file).unwrap()).unwrap();
        assert_eq!(items[0], json!({"instr_id": "1_0", "trajectory": [["hall", 0.0, 0.0]], "predObjId": 66}));
        assert_eq!(items[1]["predObjId"], Value::Null);
        assert!(items[1].as_object().unwrap().contains_key("predObjId"));
    });
}

fn submitted() -> impl Strategy<Value = SubmittedTrajectory> {
    let posed = ("[0-9a-z]{1,32}", -10.0..10.0f64, -1.5..1.5f64).prop_map(|(viewpoint, heading, elevation_rad)| {
        TrajectoryPose { heading: Heading::new(heading).unwrap(), elevation_rad, ..place(&viewpoint) }
    });
    let object = prop::option::of("[0-9]{1,4}|0[0-9]|[a-z ]{1,9}");
    (prop::collection::vec(posed, 1..9), object).prop_map(|(trajectory, object)| SubmittedTrajectory {
        instr_id: String::new(),
        trajectory,
        object: object.map(|object| ObjectId::new(object).unwrap()),
    })
}

proptest! {
    #[test]
    fn submissions_come_back_as_written(mut all in prop::collection::vec(submitted(), 0..6), ending in "|[.]gz") {
        for (n, submitted) in all.iter_mut().enumerate() {
            submitted.instr_id = format!("{n}_0");
        }
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join(format!("submission.json{ending}"));
        write_submission(&file, &all).unwrap();
        prop_assert_eq!(whole(&file), all);
        prop_assert_eq!(fs::read(&file).unwrap().starts_with(&[0x1f, 0x8b]), !ending.is_empty());
    }
}

/// A thousand damaged files: each is read or refused with the file's name, and none makes the reader crash.
#[test]
fn the_reader_survives_damage() {
    let mut dice = wayword_core::seeded_rng(20_260_102, &["submission"]);
    let whole = json!([
        {"instr_id": "1_0", "trajectory": [["hall", 1.5, 0.0], ["door", 0.5, 0.25]], "predObjId": 5},
        {"instr_id": "1_1", "trajectory": [["hall", 1.5, 0.0], "door"], "predObjId": null},
    ])
    .to_string();
    let nested = "[".repeat(100_000);
    let many = format!("[{}0]", "0,".repeat(300_000));
    let parts = [
        "NaN",
        "1e999",
        "null",
        "-1",
        "\"..\"",
        "\"a/b\"",
        "\"\\u0000\"",
        "{}",
        "[[]]",
        "\"instr_id\":",
        &nested,
        &many,
    ];
    let mut refused = 0;
    for round in 0..1_000 {
        let mut bytes = whole.clone().into_bytes();
        let at = dice.random_range(0..bytes.len());
        match round % 4 {
            0 => bytes.truncate(at),
            1 => bytes[at] ^= 1 << dice.random_range(0..8),
            2 => {
                let value = bytes[at..].iter().position(|byte| b",]}".contains(byte)).map_or(at, |end| at + end);
                bytes.splice(at..value, parts[dice.random_range(0..parts.len())].bytes());
            }
            _ => {
                bytes.drain(at..bytes.len().min(at + dice.random_range(1..20)));
            }
        }
        in_file(&bytes, |file| {
            let problems = read_submission(file).problems;
            if problems.count() > 0 {
                refused += 1;
                let file = file.display().to_string();
                for problem in problems.listed.iter().map(ToString::to_string) {
                    assert!(problem.starts_with(&file), "does not name its file: {problem:.2000}");
                    assert!(problem.len() < 600, "rambles: {problem:.2000}");
                }
            }
        });
    }
    assert!(refused > 700, "only {refused} of 1,000 were refused");
}
