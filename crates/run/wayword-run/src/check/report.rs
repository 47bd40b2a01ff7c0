//! The report of `wayword check`: counts by verdict and check, and the texts that did not pass.

use super::{CheckedWalk, args::ShownTexts, path_texts::FileText};
use crate::{count::count_phrase, doubts::TextDoubts, follow::RouteShares};
use serde::Serialize;
use std::{collections::BTreeMap, fmt};
use wayword_checks::{CoveredDecision, DecisionTold, TextFindings, put_parts_into_text};
use wayword_core::{CheckFinding, CheckKind, DoubtGrade, InstructionPart, TextAmbiguity, TextDoubt, Verdict};
use wayword_language::languages::ReadableText;

/// The result of checking a file.
#[derive(Debug, Default, Serialize)]
pub struct CheckReport {
    /// Texts that passed every check.
    pub passed: usize,
    /// Texts without a mistake of which a part could not be checked.
    pub unverified: usize,
    /// Texts that failed a check.
    pub failed: usize,
    /// The sources of evidence that texts were checked against.
    pub checked_against: Vec<String>,
    /// The number of texts that were checked in an open and in a closed world.
    pub worlds: BTreeMap<&'static str, usize>,
    /// The file of `--calibration`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub calibration: Option<String>,
    /// The styles that texts were checked against, with the number of texts; empty for a dataset without `--style`.
    pub styles: BTreeMap<String, usize>,
    /// Styles that texts name, but that differ from the built-in style of that name. These texts were not checked against a
    /// style.
    pub unknown_styles: BTreeMap<String, usize>,
    /// Per check, the texts that passed, were unverified, or failed it.
    pub by_check: BTreeMap<&'static str, VerdictCounts>,
    /// Texts that may mean several places, or several objects at the end of the path. They fail for that only where
    /// `--reject-ambiguous` asks for it.
    pub ambiguous: usize,
    /// Each of them, whether it passed or not.
    pub ambiguous_texts: Vec<AmbiguousText>,
    /// The decisions of the walks by kind, `turn` (where another way is open, as far as a graph tells so), `climb` and `room`, and how many
    /// of them their texts tell in each way: `told`, `early`, `late`, `merged` (only the place where the way leads is named) or
    /// `left_out`. It counts against no text.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub coverage_of_walk: BTreeMap<&'static str, BTreeMap<&'static str, usize>>,
    /// Every text that did not pass, with its findings.
    pub not_passed: Vec<CheckedText>,
    /// With `--doubts`: every text with the words that a reader should doubt, in the order of the file.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub doubted: Vec<DoubtedText>,
}

/// Texts by verdict.
#[derive(Debug, Default, Clone, Copy, Serialize)]
pub struct VerdictCounts {
    /// Passed.
    pub passed: usize,
    /// There was no evidence to check against.
    pub unverified: usize,
    /// Failed.
    pub failed: usize,
}

/// A text that may mean more than its path.
#[derive(Debug, Clone, Serialize)]
pub struct AmbiguousText {
    /// The id of its path.
    pub path: String,
    /// Its words.
    pub text: String,
    /// The places and objects that it may mean.
    pub ambiguity: TextAmbiguity,
}

/// A text with its findings.
#[derive(Debug, Clone, Serialize)]
pub struct CheckedText {
    /// The id of its path.
    pub path: String,
    /// Its own name: that of its item with its number, from 0, as in the instr_id of a submission; or the path with the style.
    pub name: String,
    /// Its words.
    pub text: String,
    /// The verdict of all checks together.
    pub verdict: Verdict,
    /// The world in which it was checked: open or closed.
    pub world: &'static str,
    /// The findings that are not passes.
    pub findings: Vec<CheckFinding>,
    /// How likely it is that the text means its path.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub route: Option<RouteShares>,
    /// How much the text would fit better with its most doubtful turn reversed: a difference of natural logs of likelihood.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turn_gain: Option<f64>,
    /// The places and objects that the text may mean. Ambiguity makes a text fail only where `--reject-ambiguous` asks for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ambiguity: Option<TextAmbiguity>,
    /// Its parts with their frames of the path, where it could be aligned.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub parts: Vec<InstructionPart>,
    /// The decisions of its walk, and how it tells them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub coverage_of_walk: Vec<CoveredDecision>,
    /// The words that a reader should doubt, where that was asked for. A report lists them in [`CheckReport::doubted`].
    #[serde(skip)]
    pub doubted: Option<TextDoubts>,
    /// The style that it was written in, if the file names it.
    #[serde(skip)]
    pub style: Option<String>,
}

/// A text with the words that a reader should doubt.
#[derive(Debug, Clone, Serialize)]
pub struct DoubtedText {
    /// The id of its path.
    pub path: String,
    /// Its name in the file, as in a submission.
    pub name: String,
    /// The style that it was written in, if the file names it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub style: Option<String>,
    /// Its words.
    pub text: String,
    /// The verdict of all checks together.
    pub verdict: Verdict,
    /// The world in which it was checked: open or closed.
    pub world: &'static str,
    /// Why it could not be followed, where it could not: then no other wording is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unfollowed: Option<&'static str>,
    /// The doubts, in the order of the text and apart from each other.
    pub doubts: Vec<TextDoubt>,
}

impl DoubtedText {
    fn from_checked(text: &CheckedText, TextDoubts { doubts, unfollowed }: TextDoubts) -> Self {
        let (path, name) = (text.path.clone(), text.name.clone());
        let (style, words) = (text.style.clone(), text.text.clone());
        Self { path, name, style, text: words, verdict: text.verdict, world: text.world, unfollowed, doubts }
    }

    /// Whether it has a doubt of this grade.
    #[must_use]
    pub fn has_grade(&self, grade: DoubtGrade) -> bool {
        self.doubts.iter().any(|doubt| doubt.grade == grade)
    }
}

impl CheckedText {
    pub(super) fn from_text(text: &FileText, checked: &TextFindings) -> Self {
        let findings = checked.findings.iter().filter(|finding| finding.verdict != Verdict::Pass).cloned().collect();
        let (path, name, words) = (text.path.clone(), text.name.clone(), text.words.clone());
        let (verdict, world) = (checked.verdict(), checked.world.name());
        let style = text.style.as_ref().map(|style| style.name.clone());
        let (route, turn_gain, ambiguity, doubted) = (None, None, None, None);
        let (parts, coverage_of_walk) = (checked.parts.clone(), Vec::new());
        Self {
            path,
            name,
            text: words,
            verdict,
            world,
            findings,
            route,
            turn_gain,
            ambiguity,
            parts,
            coverage_of_walk,
            doubted,
            style,
        }
    }

    /// Turns the byte ranges of its English words into those of its text.
    pub(super) fn put_into_text(&mut self, words: &ReadableText<'_>) {
        let spans = self.findings.iter_mut().filter_map(|finding| finding.span.as_mut());
        let spans = spans.chain(self.coverage_of_walk.iter_mut().filter_map(|decision| decision.span.as_mut()));
        spans.for_each(|span| *span = words.source_span(*span));
        put_parts_into_text(&mut self.parts, words);
    }
}

impl CheckedText {
    /// The verdict, as people read it.
    fn verdict_words(&self) -> String {
        let unverified = self.findings.iter().filter(|finding| finding.verdict == Verdict::Unverified).count();
        match self.verdict {
            Verdict::Unverified => format!("{} unverified", count_phrase(unverified, "claim")),
            verdict => format!("{verdict:?}"),
        }
    }
}

impl CheckReport {
    /// Adds the texts of walks, in the order of their file, and the sources of their evidence.
    pub(super) fn add_texts(&mut self, walks: Vec<CheckedWalk>) {
        let mut texts = Vec::new();
        for (source, walk_texts) in walks {
            if !self.checked_against.iter().any(|other| other == source) {
                self.checked_against.push(source.to_owned());
            }
            texts.extend(walk_texts);
        }
        // Back into the order of the file: the texts of one path were checked together.
        texts.sort_by_key(|(at, _, _)| *at);
        texts.into_iter().for_each(|(_, text, findings)| self.add_text(text, &findings));
    }

    /// Counts a checked text by verdict, check and world, and keeps it if it did not pass. `findings` are all of its
    /// findings, those that passed among them.
    fn add_text(&mut self, mut text: CheckedText, findings: &[CheckFinding]) {
        if let Some(doubted) = text.doubted.take() {
            self.doubted.push(DoubtedText::from_checked(&text, doubted));
        }
        for check in CheckKind::ALL {
            let check_findings: Vec<CheckFinding> =
                findings.iter().filter(|finding| finding.check == check).cloned().collect();
            if !check_findings.is_empty() {
                self.by_check.entry(check.name()).or_default().count_verdict(Verdict::from_findings(&check_findings));
            }
        }
        *self.worlds.entry(text.world).or_default() += 1;
        for covered in &text.coverage_of_walk {
            let kind = self.coverage_of_walk.entry(covered.decision.kind_name()).or_default();
            *kind.entry(covered.told.name()).or_default() += 1;
        }
        if let Some(ambiguity) = text.ambiguity.as_ref().filter(|ambiguity| ambiguity.is_ambiguous()) {
            let (path, words) = (text.path.clone(), text.text.clone());
            self.ambiguous += 1;
            self.ambiguous_texts.push(AmbiguousText { path, text: words, ambiguity: ambiguity.clone() });
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

impl VerdictCounts {
    fn count_verdict(&mut self, verdict: Verdict) {
        match verdict {
            Verdict::Pass => self.passed += 1,
            Verdict::Unverified => self.unverified += 1,
            Verdict::Fail => self.failed += 1,
        }
    }
}

/// The report as people read it.
pub(super) struct CheckReportText<'a> {
    pub(super) report: &'a CheckReport,
    /// Which texts to show of those that did not pass.
    pub(super) shown: ShownTexts,
}

impl fmt::Display for CheckReportText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { report, shown } = self;
        let (failed, unverified): (Vec<_>, Vec<_>) =
            report.not_passed.iter().partition(|text| text.verdict == Verdict::Fail);
        let [failed_shown, unverified_shown] = shown.how_many(failed.len(), unverified.len());
        let listed = failed.iter().take(failed_shown).chain(unverified.iter().take(unverified_shown));
        for text in listed {
            writeln!(f, "{} {}: {}", text.name, text.verdict_words(), text.text)?;
            for finding in &text.findings {
                let words = finding.span.and_then(|[from, to]| text.text.get(from..to));
                let words = words.map_or(String::new(), |words| format!(" \"{words}\""));
                writeln!(f, "    {} ({:?}){words}: {}", finding.check.name(), finding.verdict, finding.reason)?;
            }
        }
        let (more_failed, more) =
            (failed.len() - failed_shown, report.not_passed.len() - failed_shown - unverified_shown);
        if more > 0 {
            let others = if failed_shown + unverified_shown > 0 { " more" } else { "" };
            let what = match more_failed {
                0 => "could not be checked completely: --show all lists them".to_owned(),
                _ => format!(
                    "did not pass, {more_failed} of which failed: --show fail lists those that failed, --show all all of them"
                ),
            };
            writeln!(f, "{more}{others} {what}; --json has every finding\n")?;
        }
        writeln!(f, "{:<10} {:>7} {:>11} {:>7}", "check", "passed", "unverified", "failed")?;
        let all = VerdictCounts { passed: report.passed, unverified: report.unverified, failed: report.failed };
        for (name, counts) in report.by_check.iter().chain(std::iter::once((&"all", &all))) {
            writeln!(f, "{name:<10} {:>7} {:>11} {:>7}", counts.passed, counts.unverified, counts.failed)?;
        }
        let worlds = report.worlds.iter().map(|(name, texts)| format!("{name} ({texts})"));
        let worlds = worlds.collect::<Vec<_>>().join(", ");
        write!(f, "checked against: {}\nworld: {worlds}", report.checked_against.join(", "))?;
        if report.ambiguous > 0 {
            write!(f, "\nambiguous: {} may mean several places or objects", count_phrase(report.ambiguous, "text"))?;
        }
        for (kind, counts) in &report.coverage_of_walk {
            let count = |told: DecisionTold| counts.get(told.name()).copied().unwrap_or(0);
            let all: usize = counts.values().sum();
            let ways = DecisionTold::ALL.map(|told| format!("{} {}", count(told), told.name().replace('_', " ")));
            write!(f, "\n{kind}s of the walks: {all}, {}", ways.join(", "))?;
        }
        if !report.doubted.is_empty() {
            let count_grade = |grade: DoubtGrade| {
                let texts = report.doubted.iter().filter(|text| text.has_grade(grade)).count();
                format!("{} with words that are {}", count_phrase(texts, "text"), grade.reader_label())
            };
            write!(f, "\ndoubts: {}", DoubtGrade::ALL.map(count_grade).join(", "))?;
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
                count_phrase(*texts, "text")
            )?;
        }
        Ok(())
    }
}
