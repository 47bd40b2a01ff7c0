//! Runs `wayword check` in this process over texts that a measurement has in memory, and sorts its findings by text.

use clap::Args;
use serde_json::{Map, Value};
use std::path::Path;
use wayword_core::{CheckFinding, TextDoubt};
use wayword_formats::{Episode, FormatError, r2r, reverie};
use wayword_run::{
    check::{CheckReport, args::CheckArgs, check_texts},
    error::CommandError,
    output::CommandOutput,
};

/// The flags of a measurement that runs `wayword check`: all that `check` has, so that a new one needs no change here.
#[derive(Debug, Args)]
pub struct JudgingArgs {
    #[command(flatten)]
    pub(crate) check: CheckArgs,
    /// Seed of the intervals.
    #[arg(long, default_value_t = 0)]
    pub(crate) seed: u64,
    /// Print the figures as JSON.
    #[arg(long)]
    pub json: bool,
}

/// The report of `check`, sorted by text.
pub(crate) struct CheckedTexts {
    /// For each text, in the order given, the findings that did not pass.
    pub(crate) findings: Vec<Vec<CheckFinding>>,
    /// For each text, the words that a reader should doubt; empty unless doubts were asked for.
    pub(crate) doubts: Vec<Vec<TextDoubt>>,
    /// The rest of the report of `check`.
    pub(crate) report: Map<String, Value>,
}

/// Checks texts by writing them to a temporary file. Each comes with its episode; the episode's own instructions are not used.
///
/// # Errors
/// As `wayword check`.
pub(crate) fn check_in_memory(
    texts: &[(&Episode, &str)],
    mut check: CheckArgs,
    output: &CommandOutput,
) -> Result<CheckedTexts, CommandError> {
    let io = |source| CommandError::Io { path: std::env::temp_dir(), doing: "write a file of texts in", source };
    let folder = tempfile::tempdir().map_err(io)?;
    check.file = folder.path().join("texts.json");
    let items: Vec<Episode> =
        texts.iter().enumerate().map(|(at, (episode, text))| text_item(at, episode, text)).collect();
    write_items(&check.file, &items)?;
    sort_findings(&check_texts(&check, output)?, texts.len())
}

/// Writes items in the format of REVERIE where they have objects, and else of R2R.
pub(crate) fn write_items(file: &Path, items: &[Episode]) -> Result<(), FormatError> {
    let has_objects = items.iter().any(|item| item.target_object.is_some());
    if has_objects { reverie::write_reverie_file(file, items) } else { r2r::write_r2r_file(file, items) }
}

/// An item for one text about the path of `episode`. `check` keeps items apart by their names, so the name is the text's
/// number.
pub(crate) fn text_item(number: usize, episode: &Episode, text: &str) -> Episode {
    let mut item = Episode::new(number.to_string(), number.to_string(), episode.scene.clone());
    item.viewpoints.clone_from(&episode.viewpoints);
    item.start_heading = episode.start_heading;
    item.target_object.clone_from(&episode.target_object);
    item.instructions = vec![text.to_owned()];
    item
}

/// Sorts the report of `check` by the numbers of the texts.
fn sort_findings(report: &CheckReport, texts: usize) -> Result<CheckedTexts, CommandError> {
    let (mut findings, mut doubts) = (vec![Vec::new(); texts], vec![Vec::new(); texts]);
    for text in &report.not_passed {
        findings[text_number(&text.path, texts)?].extend(text.findings.iter().cloned());
    }
    for text in &report.doubted {
        doubts[text_number(&text.path, texts)?].extend(text.doubts.iter().cloned());
    }
    let mut rest = match serde_json::to_value(report) {
        Ok(Value::Object(rest)) => rest,
        _ => Map::new(),
    };
    // These lists name the texts by the numbers of the temporary file.
    for list in ["not_passed", "ambiguous_texts", "doubted"] {
        rest.shift_remove(list);
    }
    Ok(CheckedTexts { findings, doubts, report: rest })
}

/// The number of a text, by the name that its item has here. REVERIE's names end in the object.
fn text_number(path: &str, texts: usize) -> Result<usize, CommandError> {
    let number = path.split('_').next().and_then(|number| number.parse::<usize>().ok());
    let unknown =
        || CommandError::usage(format!("check named an item {path} that there is not"), "report this as a bug");
    number.filter(|number| *number < texts).ok_or_else(unknown)
}

/// A line for each field of the report of `check` that is words or counts, such as the evidence.
pub(crate) fn report_words(report: &Map<String, Value>) -> Vec<String> {
    let words = |value: &Value| match value {
        Value::String(word) => Some(word.clone()),
        Value::Array(list) => list.iter().map(Value::as_str).collect::<Option<Vec<_>>>().map(|list| list.join(", ")),
        // Names with counts of texts, such as the worlds in which they were checked.
        Value::Object(counts) => {
            let counts = counts.iter().map(|(name, texts)| Some(format!("{name} ({})", texts.as_u64()?)));
            counts.collect::<Option<Vec<_>>>().map(|counts| counts.join(", "))
        }
        _ => None,
    };
    let shown = report.iter().filter_map(|(key, value)| Some((key, words(value).filter(|words| !words.is_empty())?)));
    shown.map(|(key, words)| format!("{}: {words}", key.replace('_', " "))).collect()
}

/// Whether a finding is about words of this byte range.
pub(crate) fn is_about(finding: &CheckFinding, [from, to]: [usize; 2]) -> bool {
    finding.span.is_some_and(|[start, end]| start < to && from < end)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn said_of_lists_the_evidence_and_the_worlds_without_empty_fields() {
        let report = json!({
            "passed": 2, "checked_against": ["labels"], "worlds": { "open": 40 }, "styles": {},
            "by_check": { "route": { "passed": 2, "unverified": 0, "failed": 0 } },
        });
        let Value::Object(report) = report else { unreachable!() };
        assert_eq!(report_words(&report), ["checked against: labels", "worlds: open (40)"]);
    }
}
