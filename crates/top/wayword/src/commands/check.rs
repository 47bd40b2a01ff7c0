//! `wayword check`.

use crate::{
    cli::Check as Args,
    error::{Error, Exit},
    output::Output,
    pipeline::panoramas,
    settings::{Asked, Settings},
    styles,
    world::{self, Remembering},
};
use rayon::prelude::*;
use serde::Serialize;
use std::{collections::BTreeMap, fmt, path::Path as FilePath};
use wayword_checks::{Evidence, Subject, check};
use wayword_core::{Check, Constraints, Finding, Path, Platform, Style, Verdict};
use wayword_formats::{
    Format,
    jsonl::{self, Record},
};
use wayword_world::path_of;

pub(super) fn run(args: &Args, output: &Output) -> Result<Exit, Error> {
    let report = check_file(&args.file, &Asked::from(args.world.clone()).resolve()?, args.style.as_deref(), output)?;
    output.data(&report, Shown { report: &report, most: args.show });
    Ok(if report.failed == 0 { Exit::Done } else { Exit::WithLoss })
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
    /// What the texts were held against.
    pub checked_against: Vec<String>,
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
/// When the file, the world or the style cannot be read. A path that does not fit the world is an error too: nothing about
/// it could be checked.
pub fn check_file(
    file: &FilePath,
    settings: &Settings,
    style: Option<&str>,
    output: &Output,
) -> Result<CheckReport, Error> {
    let platform = world::open(settings)?;
    let style = match style {
        Some(name) => styles::find(&[name.to_owned()], settings.seed)?.remove(0).style,
        None => Style { name: "any".into(), references: Vec::new(), constraints: Constraints::default() },
    };
    let subjects = subjects(file, platform.as_ref())?;
    let bar = output.progress(subjects.len(), "paths");
    let checked: Vec<_> = subjects
        .par_iter()
        .map(|(path, texts)| {
            let checked = check_path(platform.as_ref(), path, texts, &style);
            bar.inc(1);
            checked
        })
        .collect::<Result<_, _>>()?;
    bar.finish_and_clear();
    let mut report = CheckReport::default();
    for (source, texts) in checked {
        if !report.checked_against.iter().any(|other| other == source) {
            report.checked_against.push(source.to_owned());
        }
        for (text, findings) in texts {
            report.add(text, &findings);
        }
    }
    Ok(report)
}

/// Paths with what is said about each.
fn subjects(file: &FilePath, platform: &dyn Platform) -> Result<Vec<(Path, Vec<String>)>, Error> {
    if wayword_formats::detect(file)? == Format::Wayword {
        let records = jsonl::read(file)?.into_iter();
        let subject = |record: Record| Ok((on_graph(platform, record.path)?, vec![record.instruction.text]));
        return records.map(subject).collect();
    }
    let episodes = wayword_formats::read(file)?;
    let paths = episodes.into_iter().map(|episode| {
        // A scene that is not here is told once, with its name.
        let path = path_of(
            platform,
            &episode.id,
            &episode.scene,
            &episode.viewpoints,
            episode.start_heading,
            episode.target_object.as_ref(),
        )?;
        Ok((path, episode.instructions))
    });
    paths.collect()
}

/// A record's path with the platform's own poses and floors where its frames are viewpoints: a file is not believed.
fn on_graph(platform: &dyn Platform, path: Path) -> Result<Path, Error> {
    let viewpoints: Option<Vec<_>> = path.frames.iter().map(|frame| frame.viewpoint.clone()).collect();
    let Some(viewpoints) = viewpoints else { return Ok(path) };
    // Names of pictures are no viewpoints. The world says whether it has any: a file is not believed in this either.
    if !path.motion.is_known() && platform.graph(&path.scene)?.is_empty() {
        return Ok(path);
    }
    let heading = path.frames.first().map(|frame| frame.pose.heading);
    let object = path.target.as_ref().map(|target| &target.object);
    Ok(path_of(platform, &path.id, &path.scene, &viewpoints, heading, object)?)
}

/// Each text with everything that was found, and what it was held against.
type CheckedPath = (&'static str, Vec<(CheckedText, Vec<Finding>)>);

fn check_path(platform: &dyn Platform, path: &Path, texts: &[String], style: &Style) -> Result<CheckedPath, Error> {
    let world = Remembering::new(platform);
    let views = panoramas(&world, path)?;
    let evidence = Evidence::from_labels(path, &views).unwrap_or_else(|| Evidence::of_path_alone(path));
    let checked = texts.iter().map(|text| {
        // People call a target what they like, so any object of the final viewpoint will do.
        let checked = check(text, Subject { evidence: &evidence, style, target: None });
        let findings = checked.findings.iter().filter(|finding| finding.verdict != Verdict::Pass).cloned().collect();
        (
            CheckedText { path: path.id.clone(), text: text.clone(), verdict: checked.verdict(), findings },
            checked.findings,
        )
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
        write!(f, "checked against: {}", report.checked_against.join(", "))
    }
}
