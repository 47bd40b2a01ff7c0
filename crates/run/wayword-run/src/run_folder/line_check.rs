//! Checks the lines of a run folder that somebody may have edited: each item and each text has one line, and what a line
//! says of its own text and path fits them.

use super::{
    file,
    lines::{self, RecordLine},
    record::{FailedItem, RejectedText, WalkRecord, line_key, text_name},
};
use crate::error::CommandError;
use serde::{Deserialize, de::IgnoredAny};
use std::{collections::BTreeMap, fs, path::Path as FilePath};

/// Refuses a folder in which an item or a text has two lines, or a line no longer fits its own text or path, or cannot be read.
/// Missing files count as empty.
///
/// # Errors
/// When a file cannot be read, or for the first such line.
pub fn refuse_edited_lines(folder: &FilePath) -> Result<(), CommandError> {
    check_lines(folder, TextPlaces::refuse_misfit)
}

/// As [`refuse_edited_lines`], but texts may have been changed: for readers that show them, and say so.
///
/// # Errors
/// When a file cannot be read, or an item or a text has two lines.
pub fn refuse_repeated_lines(folder: &FilePath) -> Result<(), CommandError> {
    check_lines(folder, |_, _, _| Ok(()))
}

fn check_lines(
    folder: &FilePath,
    check_text: impl Fn(&TextPlaces, &RecordLine<'_>, usize) -> Result<(), CommandError>,
) -> Result<(), CommandError> {
    let mut walks = LineNumbers::default();
    let mut frames: BTreeMap<String, usize> = BTreeMap::new();
    lines::each_line(&folder.join(file::WALKS), |line| {
        let WalkRecord { path, .. } = line.parse()?;
        frames.insert(path.id.clone(), path.frames.len());
        walks.note_line(&line, path.id, "path")
    })?;
    let mut texts = LineNumbers::default();
    lines::each_line(&folder.join(file::INSTRUCTIONS), |line| {
        let read: TextLine = line.parse()?;
        check_text(&line.parse()?, &line, read.path.frames.len())?;
        texts.note_line(&line, line_key(&read.path.id, &text_name(&read.style, read.number)), "path, style and number")
    })?;
    let mut rejected = LineNumbers::default();
    lines::each_line(&folder.join(file::REJECTED), |line| {
        // Read as a whole: a report shows every field of it.
        let RejectedText { item, style, number, .. } = line.parse()?;
        if let RejectedPlaces { last: Some(last) } = line.parse()? {
            check_text(&last, &line, frames.get(&item).copied().unwrap_or(usize::MAX))?;
        }
        rejected.note_line(&line, line_key(&item, &text_name(&style, number)), "item, style and number")
    })?;
    let mut errors = LineNumbers::default();
    lines::each_line(&folder.join(file::ERRORS), |line| {
        let FailedItem { item, .. } = line.parse()?;
        errors.note_line(&line, item, "item")
    })
}

/// Refuses a run with a last instruction that was only half written, for readers that do not pass over it.
///
/// # Errors
/// When it was, or the file cannot be read.
pub fn refuse_torn_line(folder: &FilePath) -> Result<(), CommandError> {
    let (path, mut bytes) = (folder.join(file::INSTRUCTIONS), 0);
    let Ok(length) = fs::metadata(&path).map(|about| about.len()) else { return Ok(()) };
    lines::each_line(&path, |line| {
        bytes += line.byte_count() as u64;
        Ok(())
    })?;
    if length <= bytes {
        return Ok(());
    }
    Err(CommandError::usage(
        format!("{}: its last line is not whole, because the run was killed while it wrote it", path.display()),
        "give the command of the run again, which cuts the line off and makes its text again; or delete the line",
    ))
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

/// A line of `instructions.jsonl`: what names it.
#[derive(Deserialize)]
struct TextLine {
    path: TextPath,
    style: String,
    #[serde(default)]
    number: usize,
}

#[derive(Deserialize)]
struct TextPath {
    id: String,
    frames: Vec<IgnoredAny>,
}

/// A text with what points into it.
#[derive(Deserialize)]
struct TextPlaces {
    text: String,
    mentions: Vec<MentionPlace>,
    findings: Vec<FindingPlace>,
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

/// A line of `rejected.jsonl`: the best text with what points into it.
#[derive(Deserialize)]
struct RejectedPlaces {
    #[serde(default)]
    last: Option<TextPlaces>,
}

impl TextPlaces {
    /// Refuses a line with a place outside its text, or outside a path of so many frames, as the reader of records does.
    fn refuse_misfit(&self, line: &RecordLine<'_>, frames: usize) -> Result<(), CommandError> {
        let fits = |[from, to]: [usize; 2]| self.text.get(from..to).is_some();
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

    fn walk(id: &str) -> Value {
        let pose = json!({"position": [0.0, 0.0, 1.5], "heading": 0.0, "elevation_rad": 0.0});
        json!({"platform": "house", "path": {"id": id, "scene": "s", "frames": [{"pose": pose}]}, "observations": [],
            "originals": [], "map": {"nodes": [], "edges": []}, "has_pictures": false})
    }

    fn text(id: &str, words: &str) -> Value {
        json!({"path": {"id": id, "frames": [0, 1]}, "style": "r2r", "text": words,
            "mentions": [{"span": [8, 12], "frame": 1}], "findings": [{"span": [0, 4]}, {}]})
    }

    fn rejection(item: &str, number: usize) -> Value {
        json!({"item": item, "style": "r2r", "number": number, "reason": "why"})
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
        let rejected = [rejection("a", 0), rejection("a", 1), rejection("b", 0)];
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
        let twice = refusal(&[], &[], &[rejection("a", 2), rejection("a", 2)]).unwrap();
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

    /// The error about a folder with these words in one file.
    fn refusal_of(name: &str, words: &str) -> Option<String> {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(name), words).unwrap();
        let error = refuse_edited_lines(folder.path()).err()?.to_string();
        Some(error.replace(&format!("{}/", folder.path().display()), ""))
    }

    #[test]
    fn every_file_of_lines_is_read_as_strictly() {
        let whole = [
            (file::WALKS, walk("a").to_string()),
            (file::INSTRUCTIONS, text("a", "Walk to door.").to_string()),
            (file::REJECTED, rejection("a", 0).to_string()),
            (file::ERRORS, json!({"item": "a", "failure": "lost", "reason": "why"}).to_string()),
        ];
        for (name, line) in &whole {
            assert_eq!(refusal_of(name, &format!("{line}\n")), None, "{name}");
            // What a killed process leaves: a part of the last line.
            let torn = &line[..line.len() / 2];
            assert_eq!(refusal_of(name, torn), None, "{name}");
            for broken in [format!("{torn}\n{line}\n"), "\n".to_owned(), "{}\n".to_owned(), "[]\n".to_owned()] {
                let told = refusal_of(name, &broken).unwrap_or_else(|| panic!("{name}: {broken}"));
                assert!(told.starts_with(&format!("{name}: line 1: ")), "{told}");
            }
            let twice = refusal_of(name, &format!("{line}\n{line}\n")).unwrap();
            assert!(twice.starts_with(&format!("{name}: line 2: it has the same ")), "{twice}");
        }
        let kind = refusal_of(file::ERRORS, "{\"item\":\"a\",\"failure\":\"bad\",\"reason\":\"why\"}\n").unwrap();
        assert!(kind.starts_with("errors.jsonl: line 1: "), "{kind}");
        let cost = refusal_of(file::REJECTED, "{\"item\":\"a\",\"style\":\"r2r\",\"reason\":\"why\",\"drafts\":7}\n");
        assert!(cost.unwrap().starts_with("rejected.jsonl: line 1: "));
    }

    #[test]
    fn a_torn_instruction_is_named_to_readers_that_do_not_pass_over_it() {
        let folder = tempfile::tempdir().unwrap();
        assert!(refuse_torn_line(folder.path()).is_ok(), "a run without instructions");
        for (words, is_whole) in [("", true), ("{}\n", true), ("{}\n{\"", false), ("{", false)] {
            fs::write(folder.path().join(file::INSTRUCTIONS), words).unwrap();
            assert_eq!(refuse_torn_line(folder.path()).is_ok(), is_whole, "{words}");
        }
    }
}
