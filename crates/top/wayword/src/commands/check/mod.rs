//! `wayword check`.

mod held;
mod walks;

use crate::{
    cli::Check as Args,
    count::count,
    error::{Error, Exit},
    output::Output,
    pipeline::panoramas,
    platforms::{self, Remembering},
    settings::{Asked, Settings},
};
use held::Held;
use rayon::prelude::*;
use serde::Serialize;
use std::{collections::BTreeMap, fmt, path::Path as FilePath};
use walks::{Walk, walks};
use wayword_checks::{Evidence, Subject, check};
use wayword_core::{Check, Finding, Platform, Verdict};

pub(super) fn run(args: &Args, output: &Output) -> Result<Exit, Error> {
    let report = checked(args, output)?;
    output.data(&report, Shown { report: &report, most: args.show });
    Ok(if report.failed == 0 { Exit::Done } else { Exit::WithLoss })
}

/// Checks a file as the flags of `wayword check` ask, without printing the result.
///
/// # Errors
/// As [`check_file`]; also when the flags do not fit together.
pub fn checked(args: &Args, output: &Output) -> Result<CheckReport, Error> {
    check_file(&args.file, &Asked::from(args.platform.clone()).resolve()?, args.style.as_deref(), output)
}

/// What was found in a file.
#[derive(Debug, Default, Serialize)]
pub struct CheckReport {
    /// Texts that passed every check.
    pub passed: usize,
    /// Texts of which something could not be checked, and nothing was wrong.
    pub unverified: usize,
    /// Texts that failed a check.
    pub failed: usize,
    /// What the texts were checked against.
    pub checked_against: Vec<String>,
    /// The styles that texts were checked against, with the number of texts; empty for a dataset without `--style`.
    pub styles: BTreeMap<String, usize>,
    /// Styles that texts name, but that differ from the built-in style of that name; those texts were checked against
    /// none.
    pub unknown_styles: BTreeMap<String, usize>,
    /// Per check, the texts that passed, were unverified, or failed it.
    pub by_check: BTreeMap<&'static str, Counts>,
    /// Every text that did not pass, with its findings.
    pub not_passed: Vec<CheckedText>,
}

/// Texts by verdict.
#[derive(Debug, Default, Clone, Copy, Serialize)]
pub struct Counts {
    /// Passed.
    pub passed: usize,
    /// Nothing to check against.
    pub unverified: usize,
    /// Failed.
    pub failed: usize,
}

/// A text with what was found.
#[derive(Debug, Clone, Serialize)]
pub struct CheckedText {
    /// Its path.
    pub path: String,
    /// Its words.
    pub text: String,
    /// All checks together.
    pub verdict: Verdict,
    /// What was found, without what passed.
    pub findings: Vec<Finding>,
}

/// Checks every instruction of a file.
///
/// # Errors
/// When the file, the platform's data or the style cannot be read. A path that does not fit the data is an error too,
/// because nothing about it could be checked.
pub fn check_file(
    file: &FilePath,
    settings: &Settings,
    style: Option<&str>,
    output: &Output,
) -> Result<CheckReport, Error> {
    let platform = platforms::open(settings)?;
    let held = Held::to(style, settings.seed)?;
    let walks = walks(file, platform.as_ref())?;
    let bar = output.progress(walks.len(), "paths");
    let checked: Vec<_> = walks
        .par_iter()
        .map(|walk| {
            let checked = check_walk(platform.as_ref(), walk, &held);
            bar.inc(1);
            checked
        })
        .collect::<Result<_, _>>()?;
    bar.finish_and_clear();
    let mut report = CheckReport::default();
    let mut texts = Vec::new();
    for (source, of_walk) in checked {
        if !report.checked_against.iter().any(|other| other == source) {
            report.checked_against.push(source.to_owned());
        }
        texts.extend(of_walk);
    }
    for text in walks.iter().flat_map(|walk| &walk.texts) {
        held.count(text, &mut report);
    }
    // Back into the order of the file: the texts of one path were checked together.
    texts.sort_by_key(|(at, _, _)| *at);
    for (_, text, findings) in texts {
        report.add(text, &findings);
    }
    Ok(report)
}

/// What texts were checked against, and each text with its place in the file and everything that was found.
type CheckedWalk = (&'static str, Vec<(usize, CheckedText, Vec<Finding>)>);

fn check_walk(platform: &dyn Platform, walk: &Walk, held: &Held) -> Result<CheckedWalk, Error> {
    let world = Remembering::new(platform);
    let views = panoramas(&world, &walk.path)?;
    let evidence = Evidence::from_labels(&walk.path, &views).unwrap_or_else(|| Evidence::of_path_alone(&walk.path));
    let checked = walk.texts.iter().map(|text| {
        let style = held.style_of(text);
        // People name a target as they like, so any object of the final viewpoint is accepted.
        let checked = check(&text.words, Subject { evidence: &evidence, style, target: None });
        let findings = checked.findings.iter().filter(|finding| finding.verdict != Verdict::Pass).cloned().collect();
        let (path, words) = (text.path.clone(), text.words.clone());
        (text.at, CheckedText { path, text: words, verdict: checked.verdict(), findings }, checked.findings)
    });
    Ok((evidence.source.name(), checked.collect()))
}

impl CheckReport {
    fn add(&mut self, text: CheckedText, findings: &[Finding]) {
        for check in Check::ALL {
            let of_check: Vec<Finding> = findings.iter().filter(|finding| finding.check == check).cloned().collect();
            if !of_check.is_empty() {
                self.by_check.entry(check.name()).or_default().count(Verdict::of(&of_check));
            }
        }
        match text.verdict {
            Verdict::Pass => self.passed += 1,
            Verdict::Unverified => self.unverified += 1,
            Verdict::Fail => self.failed += 1,
        }
        if text.verdict != Verdict::Pass {
            self.not_passed.push(text);
        }
    }
}

impl Counts {
    fn count(&mut self, verdict: Verdict) {
        match verdict {
            Verdict::Pass => self.passed += 1,
            Verdict::Unverified => self.unverified += 1,
            Verdict::Fail => self.failed += 1,
        }
    }
}

/// The report as people read it.
struct Shown<'a> {
    report: &'a CheckReport,
    most: usize,
}

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { report, most } = self;
        for text in report.not_passed.iter().take(*most) {
            writeln!(f, "{} {:?}: {}", text.path, text.verdict, text.text)?;
            for finding in &text.findings {
                let words = finding.span.and_then(|[from, to]| text.text.get(from..to));
                let words = words.map_or(String::new(), |words| format!(" \"{words}\""));
                writeln!(f, "    {} ({:?}){words}: {}", finding.check.name(), finding.verdict, finding.reason)?;
            }
        }
        writeln!(f, "{:<10} {:>7} {:>11} {:>7}", "check", "passed", "unverified", "failed")?;
        let all = Counts { passed: report.passed, unverified: report.unverified, failed: report.failed };
        for (name, counts) in report.by_check.iter().chain(std::iter::once((&"all", &all))) {
            writeln!(f, "{name:<10} {:>7} {:>11} {:>7}", counts.passed, counts.unverified, counts.failed)?;
        }
        write!(f, "checked against: {}", report.checked_against.join(", "))?;
        if !report.styles.is_empty() {
            let styles = report.styles.iter().map(|(name, texts)| format!("{name} ({texts})"));
            write!(f, "\nstyles: {}", styles.collect::<Vec<_>>().join(", "))?;
        }
        for (name, texts) in &report.unknown_styles {
            write!(
                f,
                "\nstyle {name} in this file differs from the built-in one (it is your own, or of another version), so \
                 the form of {} was not checked: name the style with --style",
                count(*texts, "text")
            )?;
        }
        Ok(())
    }
}
