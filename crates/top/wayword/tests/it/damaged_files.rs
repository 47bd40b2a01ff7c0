//! A thousand damaged files for each reader of this crate. The program uses a file or refuses it with the file's name,
//! and never crashes. The readers of datasets and buildings have the same tests in their crates.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::Building;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use std::{
    fs,
    path::{Path, PathBuf},
};
use wayword_core::seeded_rng;
use wayword_run::{
    check::{CheckOptions, check_file},
    error::CommandError,
    generate::generate_into,
    output::CommandOutput,
    run_folder::{Journal, RunFolder, WalkRecord, read_lines, read_run_settings},
    settings::{AskedPlatform, AskedSettings, Draw, ProviderTables, RunJob, RunSettings, Service, Walks, Writing},
    styles,
};

const MUTATIONS: usize = 1000;

const STYLE: &str = r#"name = "mine"
references = [
    "Leave the pantry and turn left at the piano. Walk down the corridor and stop beside the coat rack.",
    "Cross the nursery, then make a right at the rocking horse. Wait near the bunk bed.",
]

[constraints]
min_sentences = 2
max_sentences = 5
fewer_words_than = 60
ends_in_task = false
"#;

/// A style with references that have no turns and ask for a task, so that it is written differently.
const COARSE_STYLE: &str = r#"name = "mine"
references = ["Go to the pantry and open the oven", "Head to the attic on level 2 and move the crib"]

[constraints]
max_sentences = 1
fewer_words_than = 20
ends_in_task = true
"#;

/// Damages a TOML or JSON text: cuts it, flips bytes, or replaces a value by a wrong one.
fn damaged(text: &str, rng: &mut ChaCha8Rng) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    let at = rng.random_range(0..bytes.len());
    match rng.random_range(0..6) {
        0 => bytes.truncate(at),
        1 => (0..rng.random_range(1..8)).for_each(|_| {
            let at = rng.random_range(0..bytes.len());
            bytes[at] = rng.random();
        }),
        2 => {
            let end = (at + rng.random_range(1..40)).min(bytes.len());
            bytes.drain(at..end);
        }
        3 => {
            let depth = rng.random_range(1..20_000);
            bytes.splice(at..at, "[".repeat(depth).into_bytes());
        }
        _ => return with_another_value(text, rng).into_bytes(),
    }
    bytes
}

/// The wrong values: wrong types, huge and negative numbers, names that lead elsewhere, long texts, deep nesting.
fn strange(rng: &mut ChaCha8Rng) -> String {
    let depth = rng.random_range(1..300);
    let values = [
        "0".into(),
        "-1".into(),
        "1".into(),
        "9223372036854775807".into(),
        "18446744073709551615".into(),
        "1e308".into(),
        "-1e-320".into(),
        "nan".into(),
        "inf".into(),
        "true".into(),
        "null".into(),
        "[]".into(),
        "{}".into(),
        "\"\"".into(),
        "\"../../x\"".into(),
        "\"/etc/passwd\"".into(),
        "\"\\u0000\\u001b[31m\"".into(),
        "\"\u{202e}\u{1f9ed}\"".into(),
        format!("\"{}\"", "a".repeat(100_000)),
        format!("{}{}", "[".repeat(depth), "]".repeat(depth)),
    ];
    values[rng.random_range(0..values.len())].clone()
}

/// The text with one of its values replaced. A value follows a `=` or a `:`, or is in a list.
fn with_another_value(text: &str, rng: &mut ChaCha8Rng) -> String {
    let marks: &[char] = if rng.random_bool(0.5) { &['=', ':'] } else { &['[', ','] };
    let starts: Vec<usize> = text.match_indices(marks).map(|(at, _)| at + 1).collect();
    let start = starts[rng.random_range(0..starts.len())];
    let length = text[start..].find([',', '\n', ']', '}']).unwrap_or(0);
    format!("{} {}{}", &text[..start], strange(rng), &text[start + length..])
}

/// Asserts that an error has the file's name, so that it helps the user.
fn assert_names(error: &CommandError, name: &str, input: &[u8]) {
    let told = error.to_string();
    assert!(told.contains(name), "{told}\nfor {}", String::from_utf8_lossy(&input[..input.len().min(2000)]));
}

struct Counts {
    used: usize,
    refused: usize,
}

/// Writes each damaged text to `file` and passes it to `used`, which returns whether it could be used.
fn for_each_damaged(file: &Path, text: &str, mut used: impl FnMut(usize, &[u8]) -> bool) -> Counts {
    let mut counts = Counts { used: 0, refused: 0 };
    let mut rng = seeded_rng(1, &["hostile", text]);
    for number in 0..MUTATIONS {
        let bytes = damaged(text, &mut rng);
        fs::write(file, &bytes).unwrap();
        if used(number, &bytes) {
            counts.used += 1;
        } else {
            counts.refused += 1;
        }
    }
    counts
}

/// Settings of a run over one episode of the building.
fn settings(building: &Building, style: &Path) -> RunSettings {
    let asked = AskedSettings {
        platform: AskedPlatform {
            platform: Some("matterport".into()),
            data: Some(building.data()),
            ..AskedPlatform::default()
        },
        walks: Walks { episodes: Some(building.reverie()), ..Walks::default() },
        writing: Writing { style: Some(vec![style.display().to_string()]), ..Writing::default() },
        draw: Draw { limit: Some(1), ..Draw::default() },
        ..AskedSettings::default()
    };
    asked.resolve().unwrap()
}

#[test]
fn damaged_styles_are_used_or_refused() {
    let building = Building::new();
    let file = building.path("mine.toml");
    let job = RunJob {
        settings: settings(&building, &file),
        service: Service::default(),
        providers: ProviderTables::new(),
        keeping: wayword_run::calls::CallKeeping::Machine,
    };
    let settings = &job.settings;
    let quiet = CommandOutput::new(true, true);
    for style in [STYLE, COARSE_STYLE] {
        let counts = for_each_damaged(&file, style, |number, bytes| {
            match styles::find_styles(&settings.style) {
                Err(error) => {
                    assert_names(&error, "mine", bytes);
                    false
                }
                Ok(_) => {
                    // An accepted file must also be usable: a whole item is written with it.
                    let run = building.path(&format!("run-{number}"));
                    let summary = generate_into(&run, &job, &quiet);
                    let summary = summary.unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(bytes)));
                    assert_eq!(
                        summary.passed + summary.rejected + summary.unverified,
                        1,
                        "{}",
                        String::from_utf8_lossy(bytes)
                    );
                    fs::remove_dir_all(run).unwrap();
                    true
                }
            }
        });
        assert!(counts.used > 50 && counts.refused > 300, "{} used, {} refused", counts.used, counts.refused);
    }
}

#[test]
fn damaged_run_configs_are_used_or_refused() {
    let building = Building::new();
    let settings = settings(&building, Path::new("r2r"));
    drop(RunFolder::open(&building.path("run"), &settings).unwrap());
    let file = building.path("run/config.toml");
    let whole = fs::read_to_string(&file).unwrap();
    let counts = for_each_damaged(&file, &whole, |_, bytes| {
        let read = read_run_settings(&building.path("run"));
        if let Err(error) = &read {
            assert_names(error, "config.toml", bytes);
        }
        // A run with other settings is left alone.
        match RunFolder::open(&building.path("run"), &settings) {
            // If the run's limit was smaller, the command asks for more items.
            Ok(_) => assert!(read.as_ref().is_ok_and(|read| read.raised_to(&settings) == settings)),
            Err(error) => assert_names(&error, "run", bytes),
        }
        if read.as_ref().is_ok_and(|read| read.limit == settings.limit) {
            assert_eq!(fs::read(&file).unwrap(), bytes);
        }
        read.is_ok()
    });
    assert!(counts.used > 50 && counts.refused > 300, "{} used, {} refused", counts.used, counts.refused);
}

#[test]
fn damaged_settings_files_are_used_or_refused() {
    let text = "platform = \"matterport\"\ndata = \"data\"\npaths = 3\nhops = \"2..3\"\nmetres = \"4..9.5\"\nscan = [\"a\"]\n\
        style = [\"r2r\", \"reverie\"]\nframes = \"panoramic\"\nperception = \"fixed\"\nquestions = 3\ntarget = \"free\"\n\
        repairs = 2\nseed = 5\nlimit = 7\n";
    let mut rng = seeded_rng(2, &["hostile settings"]);
    let (mut used, mut refused) = (0, 0);
    for _ in 0..MUTATIONS {
        let bytes = damaged(text, &mut rng);
        let Ok(text) = String::from_utf8(bytes) else { continue };
        match toml::from_str::<AskedSettings>(&text).map_err(|_| ()).and_then(|asked| asked.resolve().map_err(|_| ())) {
            Ok(settings) => {
                assert!(settings.paths <= 1_000_000 && settings.request.hops.start() <= settings.request.hops.end());
                assert!(settings.request.length_m.start() <= settings.request.length_m.end());
                used += 1;
            }
            Err(()) => refused += 1,
        }
    }
    assert!(used > 50 && refused > 300, "{used} used, {refused} refused");
}

/// Replaces a value somewhere in a JSON document.
fn spoil(value: &mut Value, rng: &mut ChaCha8Rng) {
    match value {
        Value::Object(fields) if !fields.is_empty() && rng.random_bool(0.9) => {
            let at = rng.random_range(0..fields.len());
            let (_, inner) = fields.iter_mut().nth(at).unwrap();
            spoil(inner, rng);
        }
        Value::Array(items) if !items.is_empty() && rng.random_bool(0.9) => {
            let at = rng.random_range(0..items.len());
            spoil(&mut items[at], rng);
        }
        value => {
            let strange = strange(rng);
            *value = serde_json::from_str(&strange).unwrap_or_else(|_| json!(strange));
        }
    }
}

/// One line of a run's file, damaged as a text or in one of its values.
fn damaged_line(line: &str, rng: &mut ChaCha8Rng) -> Vec<u8> {
    if rng.random_bool(0.5) {
        return damaged(line, rng);
    }
    let mut value: Value = serde_json::from_str(line).unwrap();
    (0..rng.random_range(1..3)).for_each(|_| spoil(&mut value, rng));
    format!("{value}\n").into_bytes()
}

fn first_line(file: &Path) -> String {
    fs::read_to_string(file).unwrap().lines().next().unwrap().to_owned() + "\n"
}

fn check_damaged_records(file: &Path, settings: &RunSettings, line: &str, count: usize) {
    let quiet = CommandOutput::new(true, true);
    let mut rng = seeded_rng(3, &["hostile records", &settings.platform]);
    let (mut used, mut refused) = (0, 0);
    for _ in 0..count {
        let bytes = damaged_line(line, &mut rng);
        fs::write(file, &bytes).unwrap();
        match check_file(file, settings, CheckOptions { style: Some("reverie"), ..CheckOptions::default() }, &quiet) {
            Ok(report) => used += report.passed + report.unverified + report.failed,
            Err(error) => {
                // The error about a path that does not fit its scene names the scene; that about an unreadable line
                // names the file.
                let told = error.to_string();
                assert!(
                    told.contains("told.jsonl") || told.contains("scene"),
                    "{told}: {}",
                    String::from_utf8_lossy(&bytes)
                );
                refused += 1;
            }
        }
    }
    assert!(used > count / 20 && refused > count / 4, "{used} used, {refused} refused");
}

#[test]
fn damaged_records_are_checked_or_refused() {
    let building = Building::new();
    building.run_over_episodes("run");
    let settings = settings(&building, Path::new("reverie"));
    let line = first_line(&building.path("run/instructions.jsonl"));
    check_damaged_records(&building.path("told.jsonl"), &settings, &line, MUTATIONS);
}

#[test]
fn a_house_is_not_looked_at_from_nowhere() {
    let building = Building::new();
    let ran = building.wayword(&["generate", "--paths", "1", "--metres", "5..6", "--scan", "house2-3", "--out", "run"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let mut line: Value = serde_json::from_str(&first_line(&building.path("run/instructions.jsonl"))).unwrap();
    line["path"]["frames"].as_array_mut().unwrap().truncate(1);
    line["mentions"] = json!([]);
    let settings = read_run_settings(&building.path("run")).unwrap();
    let file = building.path("told.jsonl");
    for (pointer, value) in [
        ("/path/frames/0/pose/position", json!([1e308, 0.0, 1.5])),
        ("/path/frames/0/pose/position", json!([-1e308, -1e308, -1e308])),
        ("/path/frames/0/pose/position", json!([1e9, 1e9, 1.5])),
        ("/path/frames/0/pose/position", json!([0.0, 0.0, 1e30])),
        ("/path/frames/0/pose/heading", json!(1e308)),
        ("/path/frames/0/pose/elevation_rad", json!(1e308)),
        ("/path/scene", json!("house2-18446744073709551616")),
        ("/path/scene", json!("house2--1")),
        ("/path/scene", json!("castle-3")),
        ("/path/scene", json!("house2-03")),
    ] {
        let mut changed = line.clone();
        *changed.pointer_mut(pointer).unwrap() = value.clone();
        fs::write(&file, format!("{changed}\n")).unwrap();
        // The line may be refused, or checked without a result; the command only has to end.
        if let Err(error) = check_file(&file, &settings, CheckOptions::default(), &CommandOutput::new(true, true)) {
            let told = error.to_string();
            assert!(told.contains("told.jsonl") || told.contains("scene"), "{pointer} = {value}: {told}");
        }
    }
}

#[test]
fn damaged_lines_of_a_run_are_refused_with_file_and_line() {
    let building = Building::new();
    building.run_over_episodes("run");
    let (walks, report) = (building.path("run/walks.jsonl"), building.path("report.html"));
    let whole = fs::read(&walks).unwrap();
    let line = first_line(&walks);
    let mut rng = seeded_rng(4, &["hostile walks"]);
    let mut refused = 0;
    for number in 0..MUTATIONS {
        let bytes = damaged_line(&line, &mut rng);
        fs::write(&walks, &bytes).unwrap();
        let read = read_lines::<WalkRecord>(&walks);
        if let Err(error) = &read {
            assert_names(error, "walks.jsonl", &bytes);
            refused += 1;
        }
        if let Err(error) = Journal::open(&walks, |value| Some(value.get("path")?.get("id")?.as_str()?.to_owned())) {
            assert_names(&error, "walks.jsonl", &bytes);
        }
        // Drawing a page takes longer than reading a line.
        if number % 10 == 0 && read.is_ok_and(|walks| !walks.is_empty()) {
            fs::write(&walks, &bytes).unwrap();
            if let Err(error) = wayword_report::pages::write_report(&building.path("run"), &report, 1) {
                assert_names(&error, "run", &bytes);
            }
        }
    }
    assert!(refused > 300, "{refused} refused");
    fs::write(&walks, whole).unwrap();
    wayword_report::pages::write_report(&building.path("run"), &report, 1).unwrap();
}

#[test]
fn a_style_or_settings_file_that_is_no_file_is_refused() {
    let building = Building::new();
    let folder: PathBuf = building.path("folder.toml");
    fs::create_dir(&folder).unwrap();
    assert_names(&styles::find_styles(&[folder.display().to_string()]).unwrap_err(), "folder.toml", b"");
    let huge = building.path("huge.toml");
    fs::File::create(&huge).unwrap().set_len(1 << 40).unwrap();
    assert_names(&styles::find_styles(&[huge.display().to_string()]).unwrap_err(), "huge.toml", b"");
}
