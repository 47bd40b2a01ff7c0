//! Checks the lines of a run folder that somebody may have edited: each item and each text has one line, and what a line
//! says of its own text and path fits them.

use super::{
    file,
    lines::{self, RecordLine},
    record::{line_key, text_name},
};
use crate::error::CommandError;
use serde::{Deserialize, de::IgnoredAny};
use std::{collections::BTreeMap, path::Path as FilePath};
use wayword_core::Path;

/// Refuses a folder in which an item or a text has two lines, or a line no longer fits its own text or path. Missing
/// files count as empty.
///
/// # Errors
/// When a file cannot be read, or for the first such line.
pub fn refuse_edited_lines(folder: &FilePath) -> Result<(), CommandError> {
    check_lines(folder, TextLine::refuse_misfit)
}

/// As [`refuse_edited_lines`], but texts may have been changed: for readers that show them, and say so.
///
/// # Errors
/// When a file cannot be read, or an item or a text has two lines.
pub fn refuse_repeated_lines(folder: &FilePath) -> Result<(), CommandError> {
    check_lines(folder, |_, _| Ok(()))
}

fn check_lines(
    folder: &FilePath,
    check_text: impl Fn(&TextLine, &RecordLine<'_>) -> Result<(), CommandError>,
) -> Result<(), CommandError> {
    let mut walks = LineNumbers::default();
    lines::each_line(&folder.join(file::WALKS), |line| {
        let WalkPath { path } = line.parse()?;
        walks.note_line(&line, path.id, "path")
    })?;
    let mut texts = LineNumbers::default();
    lines::each_line(&folder.join(file::INSTRUCTIONS), |line| {
        let read: TextLine = line.parse()?;
        check_text(&read, &line)?;
        texts.note_line(&line, line_key(&read.path.id, &text_name(&read.style, read.number)), "path, style and number")
    })?;
    let mut rejected = LineNumbers::default();
    lines::each_line(&folder.join(file::REJECTED), |line| {
        let RejectedLine { item, style, number } = line.parse()?;
        rejected.note_line(&line, line_key(&item, &text_name(&style, number)), "item, style and number")
    })
}

/// The numbers of a file's lines by their keys.
#[derive(Default)]
struct LineNumbers(BTreeMap<String, usize>);

impl LineNumbers {
    /// Refuses a line with the key of an earlier one.
    fn note_line(&mut self, line: &RecordLine<'_>, key: String, fields: &str) -> Result<(), CommandError> {
        match self.0.insert(key, line.number()) {
            None => Ok(()),
            Some(earlier) => Err(line.edited_line(format_args!("it has the same {fields} as line {earlier}"))),
        }
    }
}

/// A line of `walks.jsonl`, of which only the path is read.
#[derive(Deserialize)]
struct WalkPath {
    path: Path,
}

/// A line of `instructions.jsonl`: what names it, and what points into its text and path.
#[derive(Deserialize)]
struct TextLine {
    path: TextPath,
    style: String,
    #[serde(default)]
    number: usize,
    text: String,
    mentions: Vec<MentionPlace>,
    findings: Vec<FindingPlace>,
}

#[derive(Deserialize)]
struct TextPath {
    id: String,
    frames: Vec<IgnoredAny>,
}

#[derive(Deserialize)]
struct MentionPlace {
    span: [usize; 2],
    frame: usize,
}

#[derive(Deserialize)]
struct FindingPlace {
    #[serde(default)]
    span: Option<[usize; 2]>,
}

#[derive(Deserialize)]
struct RejectedLine {
    item: String,
    style: String,
    #[serde(default)]
    number: usize,
}

impl TextLine {
    /// Refuses a line with a place outside its text or path, as the reader of records does.
    fn refuse_misfit(&self, line: &RecordLine<'_>) -> Result<(), CommandError> {
        let fits = |[from, to]: [usize; 2]| self.text.get(from..to).is_some();
        let frames = self.path.frames.len();
        if let Some(at) = self.mentions.iter().position(|place| !fits(place.span) || place.frame >= frames) {
            return Err(line.edited_line(format_args!("mentions[{at}] points outside the text or the path")));
        }
        match self.findings.iter().position(|place| place.span.is_some_and(|span| !fits(span))) {
            None => Ok(()),
            Some(at) => Err(line.edited_line(format_args!("findings[{at}] points outside the text"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};
    use std::fs;

    fn walk(id: &str) -> Value {
        let pose = json!({"position": [0.0, 0.0, 1.5], "heading": 0.0, "elevation_rad": 0.0});
        json!({"path": {"id": id, "scene": "s", "frames": [{"pose": pose}]}, "observations": []})
    }

    fn text(id: &str, words: &str) -> Value {
        json!({"path": {"id": id, "frames": [0, 1]}, "style": "r2r", "text": words,
            "mentions": [{"span": [8, 12], "frame": 1}], "findings": [{"span": [0, 4]}, {}]})
    }

    /// The error about a folder with these lines, without the folder.
    fn refusal(walks: &[Value], texts: &[Value], rejected: &[Value]) -> Option<String> {
        let folder = tempfile::tempdir().unwrap();
        for (name, lines) in [(file::WALKS, walks), (file::INSTRUCTIONS, texts), (file::REJECTED, rejected)] {
            let lines: String = lines.iter().map(|line| format!("{line}\n")).collect();
            fs::write(folder.path().join(name), lines).unwrap();
        }
        let error = refuse_edited_lines(folder.path()).err()?.to_string();
        Some(error.replace(&format!("{}/", folder.path().display()), ""))
    }

    #[test]
    fn lines_of_their_own_are_accepted() {
        let second = json!({"item": "a", "style": "r2r", "number": 1});
        let rejected = [json!({"item": "a", "style": "r2r"}), second, json!({"item": "b", "style": "r2r"})];
        let texts = [text("a", "Walk to door."), text("b", "Walk to door.")];
        assert_eq!(refusal(&[walk("a"), walk("b")], &texts, &rejected), None);
        assert_eq!(refusal(&[], &[], &[]), None);
        let nowhere = tempfile::tempdir().unwrap();
        assert!(refuse_edited_lines(nowhere.path()).is_ok());
    }

    #[test]
    fn a_line_twice_is_refused_with_both_numbers() {
        let twice = refusal(&[walk("a"), walk("b"), walk("a")], &[], &[]).unwrap();
        assert!(twice.starts_with("walks.jsonl: line 3: it has the same path as line 1"), "{twice}");
        let other_words = [text("a", "Walk to door."), text("a", "Pass by door.")];
        let twice = refusal(&[], &other_words, &[]).unwrap();
        assert!(twice.starts_with("instructions.jsonl: line 2: it has the same path, style and number"), "{twice}");
        let rejected = json!({"item": "a", "style": "r2r", "number": 2});
        let twice = refusal(&[], &[], &[rejected.clone(), rejected]).unwrap();
        assert!(
            twice.starts_with("rejected.jsonl: line 2: it has the same item, style and number as line 1"),
            "{twice}"
        );
    }

    #[test]
    fn a_changed_text_is_left_to_readers_that_show_it_but_a_line_twice_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let write = |lines: &[Value]| {
            let lines: String = lines.iter().map(|line| format!("{line}\n")).collect();
            fs::write(folder.path().join(file::INSTRUCTIONS), lines).unwrap();
        };
        write(&[text("a", "Walk.")]);
        assert!(refuse_edited_lines(folder.path()).is_err());
        refuse_repeated_lines(folder.path()).unwrap();
        write(&[text("a", "Walk."), text("a", "Walk.")]);
        assert!(refuse_repeated_lines(folder.path()).is_err());
    }

    #[test]
    fn a_line_that_no_longer_fits_itself_is_refused() {
        let cut = refusal(&[], &[text("a", "Walk.")], &[]).unwrap();
        assert!(cut.starts_with("instructions.jsonl: line 1: mentions[0] points outside"), "{cut}");
        let mut no_frame = text("a", "Walk to door.");
        no_frame["mentions"][0]["frame"] = json!(2);
        assert!(refusal(&[], &[no_frame], &[]).unwrap().contains("mentions[0]"));
        let mut no_span = text("a", "Walk to door.");
        no_span["findings"][1]["span"] = json!([3, 99]);
        assert!(refusal(&[], &[no_span], &[]).unwrap().contains("findings[1]"));
        let mut no_place = walk("a");
        no_place["path"]["frames"][0]["pose"].as_object_mut().unwrap().remove("position");
        let told = refusal(&[no_place], &[], &[]).unwrap();
        assert!(told.starts_with("walks.jsonl: line 1: ") && told.contains("position"), "{told}");
    }
}
