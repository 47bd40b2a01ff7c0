//! The language of each instruction comes with its item.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use serde_json::{Value, json};
use std::path::Path;
use wayword_formats::{DatasetFormat, Episode, read_any_format, rxr, vlnce};

#[test]
fn rxr_names_the_language_of_each_instruction() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/rxr_languages.jsonl");
    let episodes = read_any_format(&file).unwrap();
    let languages: Vec<Option<&str>> = episodes.iter().map(|episode| episode.language_of(0)).collect();
    assert_eq!(languages, [Some("en-US"), Some("en-IN"), Some("hi-IN"), Some("te-IN")]);
    assert!(episodes.iter().all(|episode| episode.instructions.len() == 1 && episode.language_of(1).is_none()));
}

#[test]
fn a_language_that_was_read_is_written_again() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/rxr_languages.jsonl");
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join("copy.jsonl");
    rxr::write_rxr_file(&copy, &rxr::read_rxr_file(&file).unwrap()).unwrap();
    assert_eq!(rxr::read_rxr_file(&copy).unwrap(), rxr::read_rxr_file(&file).unwrap());
}

#[test]
fn only_rxr_and_tagged_vlnce_episodes_have_a_language() {
    let folder = tempfile::tempdir().unwrap();
    let read_one = |format: DatasetFormat, item: Value| -> Episode {
        let file = folder.path().join(format.name());
        std::fs::write(&file, crate::common::text(format, &[item])).unwrap();
        format.read_file(&file).unwrap().remove(0)
    };
    for format in [DatasetFormat::R2r, DatasetFormat::Reverie, DatasetFormat::Vlnce, DatasetFormat::Wayword] {
        let episode = read_one(format, crate::common::items(format).remove(0));
        assert_eq!(episode.language_of(0), None, "{format}");
    }
    let mut item = crate::common::items(DatasetFormat::Vlnce).remove(0);
    item["instruction"]["language"] = json!("hi-IN");
    assert_eq!(read_one(DatasetFormat::Vlnce, item.clone()).language_of(0), Some("hi-IN"));
    item["instruction"]["language"] = json!(7);
    let file = folder.path().join("wrong");
    std::fs::write(&file, crate::common::text(DatasetFormat::Vlnce, &[item])).unwrap();
    let refused = vlnce::read_vlnce_file(&file).unwrap_err().to_string();
    assert!(refused.contains("instruction.language"), "{refused}");
}
