//! `wayword check`.

mod held;
mod walks;
mod worlds;

use crate::{
    cli::{AskedWorld, Check as Args},
    commands::calibrate,
    count::count,
    error::{Error, Exit},
    follow::{Followed, KnownScenes, Shares, Told, rejection},
    output::Output,
    pipeline::panoramas,
    platforms::{self, Remembering},
    settings::{Asked, Settings},
};
use held::Held;
use rayon::prelude::*;
use serde::Serialize;
use std::{collections::BTreeMap, fmt, path::Path as FilePath};
use walks::{Text, Walk, walks};
use wayword_checks::{
    Checked, Evidence, Reach, Subject, Surroundings, Testimony, Turns, World, check, lift, open::Calibration,
};
use wayword_core::{Ambiguity, Check, Finding, Platform, Verdict};
use worlds::world_of;

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
    let how = How {
        style: args.style.as_deref(),
        world: args.world,
        without_witnesses: args.no_witnesses,
        without_route: args.no_route,
        reject_ambiguous: args.reject_ambiguous,
        calibration: args.calibration.as_deref(),
    };
    check_file(&args.file, &Asked::from(args.platform.clone()).resolve()?, how, output)
}

/// How the texts of a file are checked.
#[derive(Debug, Clone, Copy, Default)]
pub struct How<'a> {
    /// The style that every text has to keep to.
    pub style: Option<&'a str>,
    /// The world that texts are held against.
    pub world: AskedWorld,
    /// Whether other writers' texts of a path say nothing for a text that fails.
    pub without_witnesses: bool,
    /// Whether no text is followed.
    pub without_route: bool,
    /// Whether a text that may mean several places or objects fails.
    pub reject_ambiguous: bool,
    /// A file of what the user's own data says of single names.
    pub calibration: Option<&'a FilePath>,
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
    /// The worlds that texts were held against, with the number of texts.
    pub worlds: BTreeMap<&'static str, usize>,
    /// The file of `--calibration`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calibration: Option<String>,
    /// The styles that texts were checked against, with the number of texts; empty for a dataset without `--style`.
    pub styles: BTreeMap<String, usize>,
    /// Styles that texts name, but that differ from the built-in style of that name; those texts were checked against
    /// none.
    pub unknown_styles: BTreeMap<String, usize>,
    /// Per check, the texts that passed, were unverified, or failed it.
    pub by_check: BTreeMap<&'static str, Counts>,
    /// Texts that may mean several places, or several objects at the end of the path. None of them fails for that.
    pub ambiguous: usize,
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
    /// The world that it was held against: open or closed.
    pub world: &'static str,
    /// What was found, without what passed.
    pub findings: Vec<Finding>,
    /// How likely it is that the text means its path.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub route: Option<Shares>,
    /// What turning its most doubtful turn around would gain, natural logs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turn_gain: Option<f64>,
    /// What the text may mean. It makes no text fail.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ambiguity: Option<Ambiguity>,
}

/// Checks every instruction of a file.
///
/// # Errors
/// When the file, the platform's data, the style or the calibration cannot be read. A path that does not fit the data is an error too,
/// because nothing about it could be checked.
pub fn check_file(file: &FilePath, settings: &Settings, how: How<'_>, output: &Output) -> Result<CheckReport, Error> {
    let platform = platforms::open(settings)?;
    let calibration = how.calibration.map(|file| calibrate::read(file, platform.name())).transpose()?;
    let held = Held::to(how.style, settings.seed)?;
    let walks = walks(file, platform.as_ref())?;
    let checking = Checking {
        platform: platform.as_ref(),
        held: &held,
        how,
        calibration: calibration.as_ref(),
        scenes: KnownScenes::new(),
    };
    let bar = output.progress(walks.len(), "paths");
    let checked: Vec<_> = walks
        .par_iter()
        .map(|walk| {
            let checked = checking.check(walk);
            bar.inc(1);
            checked
        })
        .collect::<Result<_, _>>()?;
    bar.finish_and_clear();
    let calibration = how.calibration.map(|file| file.display().to_string());
    let mut report = CheckReport { calibration, ..CheckReport::default() };
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

/// What the texts of a path were checked against, and each text with its place in the file and everything that was found.
type CheckedWalk = (&'static str, Vec<(usize, CheckedText, Vec<Finding>)>);

/// What the texts of all paths are checked with.
struct Checking<'a> {
    platform: &'a dyn Platform,
    held: &'a Held,
    how: How<'a>,
    calibration: Option<&'a Calibration>,
    scenes: KnownScenes,
}

impl Checking<'_> {
    fn check(&self, walk: &Walk) -> Result<CheckedWalk, Error> {
        let Self { platform, how, .. } = *self;
        let world = Remembering::new(platform);
        let views = panoramas(&world, &walk.path)?;
        let evidence = Evidence::from_labels(&walk.path, &views).unwrap_or_else(|| Evidence::of_path_alone(&walk.path));
        let world_of = |text: &Text| world_of(text, how.world, platform.name(), evidence.source);
        let some_are_open = walk.texts.iter().any(|text| world_of(text) == World::Open);
        let is_surveyed = some_are_open || !how.without_route;
        let scene = is_surveyed.then(|| self.scenes.get(platform, &walk.path.scene)).transpose()?;
        let around = scene.as_ref().and_then(|scene| Surroundings::of(&scene.listed, &walk.path));
        let reach = Reach { surroundings: around.as_ref(), calibration: self.calibration };
        let followed = (!how.without_route).then(|| Followed::new(scene.as_deref(), &walk.path, &evidence));
        let hears = some_are_open && !how.without_witnesses && walk.texts.len() > 1;
        // Records of this format have one writer, whose mistakes are in all its texts.
        let testimony = |text: &Text| (hears && text.made.is_none()).then(|| Testimony::of(&text.words, &evidence));
        let testimonies: Vec<Option<Testimony>> = walk.texts.iter().map(testimony).collect();
        let checked = walk.texts.iter().zip(&testimonies).map(|(text, own)| {
            let style = self.held.style_of(text);
            let told = followed.as_ref().map(|followed| match followed {
                Ok(followed) => followed.follow(&text.words, text.tag.as_deref()),
                Err(why) => Told::unknown(why),
            });
            // People name a target as they like, so any object of the final viewpoint is accepted.
            let subject = match world_of(text) {
                World::Closed => Subject::closed(&evidence, style, None),
                World::Open => Subject::open(&evidence, style, reach),
            };
            let turns = told.as_ref().map_or(Turns::NotJudged("the text is not followed"), |told| told.turns);
            let mut checked = check(&text.words, Subject { tag: text.tag.as_deref(), turns, ..subject });
            if let Some(told) = &told {
                told.add_to(&mut checked);
            }
            if let Some(own) = own.as_ref().filter(|_| checked.world == World::Open) {
                let others: Vec<&Testimony> = testimonies.iter().flatten().collect();
                lift(&mut checked, own, &others);
            }
            let ambiguity = told.as_ref().map(|told| told.ambiguity(&text.words, &evidence));
            checked.add(ambiguity.as_ref().filter(|_| how.reject_ambiguous).and_then(rejection));
            let mut shown = CheckedText::of(text, &checked);
            shown.ambiguity = ambiguity;
            if let Some(told) = told {
                (shown.route, shown.turn_gain) = (told.route, told.turn_gain);
            }
            (text.at, shown, checked.findings)
        });
        Ok((evidence.source.name(), checked.collect()))
    }
}

impl CheckedText {
    fn of(text: &Text, checked: &Checked) -> Self {
        let findings = checked.findings.iter().filter(|finding| finding.verdict != Verdict::Pass).cloned().collect();
        let (path, words) = (text.path.clone(), text.words.clone());
        let (verdict, world) = (checked.verdict(), checked.world.name());
        Self { path, text: words, verdict, world, findings, route: None, turn_gain: None, ambiguity: None }
    }
}

impl CheckReport {
    fn add(&mut self, text: CheckedText, findings: &[Finding]) {
        for check in Check::ALL {
            let of_check: Vec<Finding> = findings.iter().filter(|finding| finding.check == check).cloned().collect();
            if !of_check.is_empty() {
                self.by_check.entry(check.name()).or_default().count(Verdict::of(&of_check));
            }
        }
        *self.worlds.entry(text.world).or_default() += 1;
        self.ambiguous += usize::from(text.ambiguity.as_ref().is_some_and(Ambiguity::is_ambiguous));
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
        let worlds = report.worlds.iter().map(|(name, texts)| format!("{name} ({texts})"));
        let worlds = worlds.collect::<Vec<_>>().join(", ");
        write!(f, "checked against: {}\nworld: {worlds}", report.checked_against.join(", "))?;
        if report.ambiguous > 0 {
            write!(f, "\nambiguous: {} may mean several places or objects", count(report.ambiguous, "text"))?;
        }
        if let Some(file) = &report.calibration {
            write!(f, "\ncalibration: {file}")?;
        }
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
