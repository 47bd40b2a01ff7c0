//! Compares the findings of `wayword check` with spans of texts that people labelled right or wrong (HEAR's file).

mod doubted;
mod figures;
mod kinds;

use crate::{
    judged::{Judged, Judging, is_about, judged, said_of},
    share::{cell, table},
};
use doubted::{Doubted, rows};
use figures::{Figures, Held, Row, figures, is_fail};
use serde_json::json;
use std::path::Path;
use wayword_core::{Platform, PlatformError};
use wayword_formats::hear::{self, LabelledText};
use wayword_run::{error::Error, output::Output, platforms, settings::Asked};
use wayword_world::path_of;

pub fn measure(flags: Judging, output: &Output) -> Result<(), Error> {
    let (show, seed, is_json) = (flags.check.show, flags.seed, flags.json);
    let (texts, Judged { findings, doubts, report }) = found(flags, output)?;
    let held: Vec<Held<'_>> = texts.iter().zip(&findings).map(|(text, findings)| Held { text, findings }).collect();
    let doubted: Vec<Doubted<'_>> = texts.iter().zip(&doubts).map(|(text, doubts)| Doubted { text, doubts }).collect();
    let doubted = rows(&doubted, seed);
    let figures = figures(&held, seed);
    for line in false_alarms(&held).into_iter().take(if is_json { 0 } else { show }) {
        output.say(line);
    }
    let shown = format!("{}\n\n{}", shown(&figures, texts.len(), &said_of(&report)), doubted::shown(&doubted));
    output.data(&json!({ "texts": texts.len(), "figures": figures, "doubts": doubted, "check": report }), shown);
    Ok(())
}

/// Reads the labelled texts of a file and checks them.
fn found(mut flags: Judging, output: &Output) -> Result<(Vec<LabelledText>, Judged), Error> {
    flags.check.doubts = flags.check.run.is_none();
    let texts = hear::read(&flags.check.file)?;
    let platform = platforms::open(&Asked::from(flags.check.platform.clone()).resolve()?)?;
    fit(&texts, &flags.check.file, platform.as_ref())?;
    let asked: Vec<_> = texts.iter().map(|text| (&text.episode, text.text.as_str())).collect();
    let judged = judged(&asked, flags.check, output)?;
    Ok((texts, judged))
}

/// Refuses a text if the platform does not have its path. The error names the text; that of `check` would name only the path.
fn fit(texts: &[LabelledText], file: &Path, platform: &dyn Platform) -> Result<(), Error> {
    for LabelledText { name, episode, .. } in texts {
        let path = path_of(platform, name, &episode.scene, &episode.viewpoints, episode.start_heading, None);
        if let Err(error) = path {
            let field = if matches!(error, PlatformError::UnknownScene { .. }) { "scan" } else { "path" };
            let problem = format!("{}: text {name}: field {field:?}: {error}", file.display());
            return Err(Error::usage(problem, "give --platform and --data for the scenes that the texts are about"));
        }
    }
    Ok(())
}

/// A line for each finding "fail" that overlaps labelled spans, all of which people called right.
fn false_alarms(held: &[Held<'_>]) -> Vec<String> {
    let mut lines = Vec::new();
    for Held { text, findings } in held {
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

fn shown(figures: &Figures, texts: usize, said: &[String]) -> String {
    let head = ["", "recall", "false alarms", "precision of fail", "wrong unverified", "right unverified", "elsewhere"];
    let row = |row: &Row| {
        let shares = [&row.recall, &row.false_alarms, &row.precision, &row.unverified_wrong, &row.unverified_right];
        let shares = shares.into_iter().map(|share| cell(share.as_ref()));
        [row.name.clone()].into_iter().chain(shares).chain([row.elsewhere.to_string()]).collect()
    };
    let rows = figures.by_check.iter().chain(&figures.by_kind).chain([&figures.all]).map(row);
    let rows: Vec<Vec<String>> = [head.map(str::to_owned).to_vec()].into_iter().chain(rows).collect();
    let fails = [("with", &figures.wrong_texts_that_fail), ("without", &figures.right_texts_that_fail)];
    let fails = fails.map(|(with, share)| format!("texts {with} a wrong span that fail: {}", cell(share.as_ref())));
    let lines = [table(&rows), format!("texts: {texts}; intervals of 95 %, clustered by text")];
    lines.into_iter().chain(fails).chain(said.iter().cloned()).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests;
