//! Checks the texts of a run folder again, for its report: somebody may have changed them since, and the follower doubts more
//! words than the checks reject.

use super::{
    CheckOptions, CheckedText,
    path_texts::FileText,
    run_texts::{RunPathKey, RunText, check_texts_of_run, match_walks},
    styles::CheckStyles,
};
use crate::{
    error::CommandError,
    output::CommandOutput,
    run_folder::{file, lines, read_run_settings},
};
use serde::Deserialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path as FilePath,
};
use wayword_core::TextProvenance;
use wayword_formats::text_hash::hash_of_text;

/// The texts of a run as they were checked again.
#[derive(Debug, Default)]
pub struct CheckedAgain {
    /// The texts by the numbers of their lines in `instructions.jsonl`, from 1. A text whose path the run does not have is not
    /// here.
    pub texts: BTreeMap<usize, CheckedText>,
    /// What the texts were checked against.
    pub checked_against: Vec<String>,
    /// The lines with another text than the one that the run wrote. Records of older versions do not tell.
    pub changed: BTreeSet<usize>,
}

/// What is known of a text beside its record.
#[derive(Debug, Clone, Copy, Default)]
pub struct SecondCheck<'a> {
    /// The text as it was checked again; `None` if it was not.
    pub text: Option<&'a CheckedText>,
    /// Whether somebody changed it after the run.
    pub is_changed: bool,
}

impl CheckedAgain {
    /// What is known of the text in a line of `instructions.jsonl`, from 1.
    #[must_use]
    pub fn of_line(&self, line: usize) -> SecondCheck<'_> {
        SecondCheck { text: self.texts.get(&line), is_changed: self.changed.contains(&line) }
    }
}

/// A line of `instructions.jsonl`, as far as it is checked.
#[derive(Deserialize)]
struct WrittenLine {
    platform: String,
    path: WrittenPathId,
    text: String,
    style: String,
    provenance: TextProvenance,
    #[serde(default)]
    number: usize,
    #[serde(default)]
    text_hash: Option<String>,
}

#[derive(Deserialize)]
struct WrittenPathId {
    id: String,
}

/// Checks every accepted text of a run against the evidence of the run, as `wayword check --run` does, and looks for words to
/// doubt.
///
/// # Errors
/// When the run or its styles cannot be read, a line is not of its kind, or the user interrupts.
pub fn check_run_again(run: &FilePath, output: &CommandOutput) -> Result<CheckedAgain, CommandError> {
    let settings = read_run_settings(run)?;
    let styles = CheckStyles::for_run(None, &settings)?;
    let mut again = CheckedAgain::default();
    let WrittenTexts { texts, changed, unhashed } = read_written(run)?;
    let (walks, _) = match_walks(texts, run)?;
    let maybe_changed: BTreeSet<usize> = changed.union(&unhashed).copied().collect();
    again.changed = changed;
    let how = CheckOptions { doubts: true, maybe_changed: Some(&maybe_changed), ..CheckOptions::default() };
    for (source, texts) in check_texts_of_run(run, walks, (&settings, &styles), how, output)? {
        if !again.checked_against.iter().any(|other| other == source) {
            again.checked_against.push(source.to_owned());
        }
        again.texts.extend(texts.into_iter().map(|(at, text, _)| (at, text)));
    }
    Ok(again)
}

/// Finds the texts of a run that somebody changed after it, and checks none.
///
/// # Errors
/// When a line cannot be read, or is not of its kind.
pub fn find_changed_texts(run: &FilePath) -> Result<CheckedAgain, CommandError> {
    Ok(CheckedAgain { changed: read_written(run)?.changed, ..CheckedAgain::default() })
}

/// The accepted texts of a run. The place of each is the number of its line, from 1.
#[derive(Default)]
struct WrittenTexts {
    texts: Vec<RunText>,
    /// The lines with another text than the one that the run wrote.
    changed: BTreeSet<usize>,
    /// The lines that do not tell, as those of older versions.
    unhashed: BTreeSet<usize>,
}

fn read_written(run: &FilePath) -> Result<WrittenTexts, CommandError> {
    let mut written = WrittenTexts::default();
    lines::each_line(&run.join(file::INSTRUCTIONS), |line| {
        let WrittenLine { platform, path, text, style, provenance, number, text_hash } = line.parse()?;
        match text_hash {
            None => _ = written.unhashed.insert(line.number()),
            Some(hash) if hash != hash_of_text(&text) => _ = written.changed.insert(line.number()),
            Some(_) => {}
        }
        let text = FileText::from_record(&path.id, style, number, text, (platform, provenance));
        written.texts.push(RunText { text: FileText { at: line.number(), ..text }, path: RunPathKey::Id(path.id) });
        Ok(())
    })?;
    Ok(written)
}
