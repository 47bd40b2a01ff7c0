//! Compares the findings of `wayword check` with spans of texts that people labelled right or wrong (HEAR's file).

mod doubt_figures;
mod figures;
mod kinds;

use crate::{
    checked_texts::{CheckedTexts, JudgingArgs, check_in_memory, is_about, report_words},
    share::{aligned_table, share_cell},
};
use doubt_figures::{LabelledDoubts, doubt_rows};
use figures::{CheckedSpanRow, LabelledFindings, SpanFigures, is_fail, span_figures};
use serde_json::json;
use std::path::Path;
use wayword_core::{Platform, PlatformError};
use wayword_formats::hear_annotations::{self, LabelledText};
use wayword_run::{error::CommandError, output::CommandOutput, platforms, settings::AskedSettings};
use wayword_world::path_over_viewpoints;

/// Compares the findings of `wayword check` with spans that people labelled, and prints the figures.
///
/// # Errors
/// When the labelled texts cannot be read, the platform lacks a path of theirs, and as `wayword check`.
pub fn measure_people(flags: JudgingArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let (show, seed, is_json) = (flags.check.show.how_many(usize::MAX, 0)[0], flags.seed, flags.json);
    let (texts, CheckedTexts { findings, doubts, report }) = check_labelled_texts(flags, output)?;
    let checked: Vec<LabelledFindings<'_>> =
        texts.iter().zip(&findings).map(|(text, findings)| LabelledFindings { text, findings }).collect();
    let doubted: Vec<LabelledDoubts<'_>> =
        texts.iter().zip(&doubts).map(|(text, doubts)| LabelledDoubts { text, doubts }).collect();
    let doubted = doubt_rows(&doubted, seed);
    let figures = span_figures(&checked, seed);
    for line in false_alarms(&checked).into_iter().take(if is_json { 0 } else { show }) {
        output.say(line);
    }
    let shown = format!(
        "{}\n\n{}",
        figures_table(&figures, texts.len(), &report_words(&report)),
        doubt_figures::doubt_table(&doubted)
    );
    output
        .print_result(&json!({ "texts": texts.len(), "figures": figures, "doubts": doubted, "check": report }), shown);
    Ok(())
}

/// Reads the labelled texts of a file and checks them.
fn check_labelled_texts(
    mut flags: JudgingArgs,
    output: &CommandOutput,
) -> Result<(Vec<LabelledText>, CheckedTexts), CommandError> {
    flags.check.doubts = flags.check.run.is_none();
    let texts = hear_annotations::read_hear_file(&flags.check.file)?;
    let platform = platforms::open_platform(&AskedSettings::from(flags.check.platform.clone()).resolve()?)?;
    refuse_unknown_paths(&texts, &flags.check.file, platform.as_ref())?;
    let asked: Vec<_> = texts.iter().map(|text| (&text.episode, text.text.as_str())).collect();
    let judged = check_in_memory(&asked, flags.check, output)?;
    Ok((texts, judged))
}

/// Refuses a text if the platform does not have its path. The error names the text; that of `check` would name only the path.
fn refuse_unknown_paths(texts: &[LabelledText], file: &Path, platform: &dyn Platform) -> Result<(), CommandError> {
    for LabelledText { name, episode, .. } in texts {
        let path =
            path_over_viewpoints(platform, name, &episode.scene, &episode.viewpoints, episode.start_heading, None);
        if let Err(error) = path {
            let field = if matches!(error, PlatformError::UnknownScene { .. }) { "scan" } else { "path" };
            let problem = format!("{}: text {name}: field {field:?}: {error}", file.display());
            return Err(CommandError::usage(
                problem,
                "give --platform and --data for the scenes that the texts are about",
            ));
        }
    }
    Ok(())
}

/// A line for each finding "fail" that overlaps labelled spans, all of which people called right.
fn false_alarms(checked: &[LabelledFindings<'_>]) -> Vec<String> {
    let mut lines = Vec::new();
    for LabelledFindings { text, findings } in checked {
        for finding in findings.iter().filter(|finding| is_fail(finding)) {
            let spans: Vec<_> = text.spans.iter().filter(|span| is_about(finding, span.span)).collect();
            let words = finding.span.and_then(|[from, to]| text.text.get(from..to)).unwrap_or_default();
            if !spans.is_empty() && spans.iter().all(|span| span.is_right) {
                let keys: Vec<&str> = spans.iter().map(|span| span.key.as_str()).collect();
                let (name, check) = (&text.name, finding.check.name());
                lines.push(format!("{name} {}: {check} \"{words}\": {}", keys.join(" "), finding.reason));
            }
        }
    }
    lines
}

/// The table that is printed, with the shares of texts that fail, and notes from the report of `check`.
fn figures_table(figures: &SpanFigures, texts: usize, notes: &[String]) -> String {
    let head = ["", "recall", "false alarms", "precision of fail", "wrong unverified", "right unverified", "elsewhere"];
    let row = |row: &CheckedSpanRow| {
        let shares = [&row.recall, &row.false_alarms, &row.precision, &row.unverified_wrong, &row.unverified_right];
        let shares = shares.into_iter().map(|share| share_cell(share.as_ref()));
        [row.name.clone()].into_iter().chain(shares).chain([row.elsewhere.to_string()]).collect()
    };
    let rows = figures.by_check.iter().chain(&figures.by_kind).chain([&figures.all]).map(row);
    let rows: Vec<Vec<String>> = [head.map(str::to_owned).to_vec()].into_iter().chain(rows).collect();
    let fails = [("with", &figures.wrong_texts_that_fail), ("without", &figures.right_texts_that_fail)];
    let fails =
        fails.map(|(with, share)| format!("texts {with} a wrong span that fail: {}", share_cell(share.as_ref())));
    let lines = [aligned_table(&rows), format!("texts: {texts}; intervals of 95 %, clustered by text")];
    lines.into_iter().chain(fails).chain(notes.iter().cloned()).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests;
