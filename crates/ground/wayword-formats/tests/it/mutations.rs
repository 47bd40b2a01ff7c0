//! A thousand damaged files per reader: each is read or refused with the file's name, and none makes the reader crash.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use rand::Rng;
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};
use wayword_formats::{DatasetFormat, FormatError, read_any_format};

/// Choices that are the same in every run.
struct Dice(ChaCha8Rng);

impl Dice {
    fn roll(&mut self, below: usize) -> usize {
        self.0.random_range(0..below)
    }

    fn pick<T: Clone>(&mut self, from: &[T]) -> T {
        from[self.roll(from.len())].clone()
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Damage {
    Truncated,
    ByteFlipped,
    OtherType,
    NotANumber,
    ManyNodes,
    OutsideName,
    KeyTwice,
    Nested,
    FieldGone,
    ItemTwice,
}

const ALL: [Damage; 10] = [
    Damage::Truncated,
    Damage::ByteFlipped,
    Damage::OtherType,
    Damage::NotANumber,
    Damage::ManyNodes,
    Damage::OutsideName,
    Damage::KeyTwice,
    Damage::Nested,
    Damage::FieldGone,
    Damage::ItemTwice,
];

/// Fields that every item needs. An item that has one of them wrong must be refused.
fn needed(format: DatasetFormat) -> &'static [&'static str] {
    match format {
        DatasetFormat::R2r => &["/path_id", "/scan", "/path", "/heading", "/instructions"],
        DatasetFormat::Reverie => &["/id", "/path_id", "/scan", "/path", "/heading", "/instructions"],
        DatasetFormat::Rxr => &["/instruction_id", "/path_id", "/scan", "/path", "/heading", "/instruction"],
        DatasetFormat::Vlnce => &[
            "/episode_id",
            "/trajectory_id",
            "/scene_id",
            "/start_position",
            "/start_rotation",
            "/goals",
            "/instruction",
        ],
        DatasetFormat::Wayword => {
            &["/format", "/platform", "/path", "/text", "/style", "/mentions", "/verdict", "/findings", "/provenance"]
        }
        other => unreachable!("{other} holds recordings"),
    }
}

fn names(format: DatasetFormat) -> &'static [&'static str] {
    match format {
        DatasetFormat::R2r => &["/path_id", "/scan", "/path/1"],
        DatasetFormat::Reverie => &["/id", "/path_id", "/scan", "/path/0", "/objId"],
        DatasetFormat::Rxr => &["/instruction_id", "/path_id", "/scan", "/path/2", "/split"],
        DatasetFormat::Vlnce => &["/episode_id", "/trajectory_id", "/scene_id"],
        DatasetFormat::Wayword => &["/path/id", "/path/scene", "/path/frames/1/viewpoint", "/platform"],
        other => unreachable!("{other} holds recordings"),
    }
}

fn places(format: DatasetFormat) -> &'static str {
    match format {
        DatasetFormat::R2r | DatasetFormat::Reverie | DatasetFormat::Rxr => "/path",
        DatasetFormat::Vlnce => "/reference_path",
        DatasetFormat::Wayword => "/path/frames",
        other => unreachable!("{other} holds recordings"),
    }
}

fn number_place(format: DatasetFormat) -> &'static str {
    match format {
        DatasetFormat::R2r | DatasetFormat::Reverie | DatasetFormat::Rxr => "/heading",
        DatasetFormat::Vlnce => "/start_position/1",
        DatasetFormat::Wayword => "/path/frames/0/pose/position/2",
        other => unreachable!("{other} holds recordings"),
    }
}

/// A damaged file, and whether a reader may accept it.
fn damaged(format: DatasetFormat, damage: Damage, dice: &mut Dice) -> (Vec<u8>, bool) {
    let mut items = crate::common::items(format);
    let index = dice.roll(items.len());
    let lines = matches!(format, DatasetFormat::Rxr | DatasetFormat::Wayword);
    let marked = |items: &mut Vec<Value>, place: &str| *items[index].pointer_mut(place).unwrap() = json!("MARK");
    let render =
        |items: &[Value], with: &str| crate::common::text(format, items).replace("\"MARK\"", with).into_bytes();
    match damage {
        Damage::Truncated => {
            let mut text = crate::common::text(format, &items).into_bytes();
            text.truncate(dice.roll(text.len() - 1));
            // A file of lines may end after any of them, and a line without its end may still be whole.
            let whole = lines && (text.is_empty() || text.ends_with(b"\n") || text.ends_with(b"}"));
            (text, whole)
        }
        Damage::ByteFlipped => {
            let mut text = crate::common::text(format, &items).into_bytes();
            let place = dice.roll(text.len());
            text[place] ^= 1 << dice.roll(8);
            (text, true)
        }
        Damage::OtherType => {
            let swaps = [json!(true), json!({}), json!([]), json!(-1.5), json!([[[]]]), json!("\u{0}")];
            let place = dice.pick(needed(format));
            let swap = dice.pick(&swaps);
            // These swaps are valid values in some of the fields.
            let may_pass = swap == json!([])
                || (swap == json!(-1.5) && place == "/heading")
                || place == "/style"
                || swap == json!("\u{0}");
            *items[index].pointer_mut(place).unwrap() = swap;
            (render(&items, ""), may_pass)
        }
        Damage::NotANumber => {
            marked(&mut items, number_place(format));
            (render(&items, dice.pick(&["NaN", "-Infinity", "1e999", "-1e400", "null", "\"abc\"", "0x10"])), false)
        }
        Damage::ManyNodes => {
            marked(&mut items, places(format));
            let count = [1_001, 50_000, 300_000][dice.roll(3)];
            (render(&items, &format!("[{}0]", "0,".repeat(count))), false)
        }
        Damage::OutsideName => {
            let long = "x".repeat(200);
            let name = dice.pick(&["../../etc/passwd", "..", "a\\b", "/abs/x", "line\nbreak", "", long.as_str()]);
            let place = dice.pick(names(format));
            *items[index].pointer_mut(place).unwrap() = json!(name);
            (render(&items, ""), false)
        }
        Damage::KeyTwice => {
            let text = crate::common::text(format, &items);
            let keys = ["\"path\":", "\"heading\":", "\"info\":", "\"text\":", "\"scan\":", "\"goals\":"];
            let key = keys.iter().find(|key| text.contains(**key)).unwrap();
            (text.replacen(key, &format!("{key} 1, {key}"), 1).into_bytes(), false)
        }
        Damage::Nested => {
            marked(&mut items, dice.pick(needed(format)));
            let depth = [200, 5_000, 100_000][dice.roll(3)];
            (render(&items, &"[".repeat(depth)), false)
        }
        Damage::FieldGone => {
            let field = dice.pick(needed(format)).trim_start_matches('/');
            items[index].as_object_mut().unwrap().shift_remove(field);
            // VLN-CE's loader fills these in.
            (render(&items, ""), format == DatasetFormat::Vlnce && ["trajectory_id", "goals"].contains(&field))
        }
        Damage::ItemTwice => {
            items.push(items[index].clone());
            (render(&items, ""), false)
        }
    }
}

fn survives(format: DatasetFormat) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("damaged.json");
    let mut dice = Dice(wayword_core::seeded_rng(20_260_101, &[format.name()]));
    let mut refused = 0;
    for round in 0..1_000 {
        let damage = ALL[round % ALL.len()];
        let (bytes, may_pass) = damaged(format, damage, &mut dice);
        std::fs::write(&file, &bytes).unwrap();
        let shown = || String::from_utf8_lossy(&bytes[..bytes.len().min(2_000)]).into_owned();
        match format.read_file(&file) {
            Ok(_) => assert!(may_pass, "{format}: {damage:?} was accepted: {}", shown()),
            Err(error) => {
                refused += 1;
                assert_clear(&error, &file);
            }
        }
        // Whatever format it is taken for, the reader must not crash.
        let _ = read_any_format(&file);
    }
    assert!(refused > 700, "only {refused} of 1,000 were refused");
}

fn assert_clear(error: &FormatError, file: &std::path::Path) {
    let text = error.to_string();
    assert!(text.starts_with(&file.display().to_string()), "does not name its file: {text}");
    assert!(text.len() < 600, "rambles: {text}");
    if let FormatError::Item(item) = error {
        assert!(!item.field.is_empty() && !item.problem.is_empty(), "names no field: {text}");
    }
}

#[test]
fn r2r_reader_survives() {
    survives(DatasetFormat::R2r);
}

#[test]
fn reverie_reader_survives() {
    survives(DatasetFormat::Reverie);
}

#[test]
fn rxr_reader_survives() {
    survives(DatasetFormat::Rxr);
}

#[test]
fn vlnce_reader_survives() {
    survives(DatasetFormat::Vlnce);
}

#[test]
fn wayword_reader_survives() {
    survives(DatasetFormat::Wayword);
}
