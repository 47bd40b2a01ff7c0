//! Marks the words of texts that a reader should doubt, in a JSON file for programs and on an HTML page for people.

#[cfg(test)]
mod tests;

use super::{load_templates, replace_page, template_error};
use minijinja::{Value, context};
use serde::Serialize;
use std::{collections::BTreeMap, path::Path};
use wayword_core::{
    DoubtCause, DoubtGrade, TextDoubt,
    doubt::{spans_overlap, split_at_doubts},
};
use wayword_language::text::split_blanks;
use wayword_run::{
    check::{CheckReport, DoubtedText},
    error::CommandError,
};

/// The version of the format of the JSON file.
const FORMAT_VERSION: u32 = 1;
/// Most texts that the page shows. The JSON file has all.
const MAX_SHOWN_TEXTS: usize = 1000;

/// Texts with their doubts, as the file has them.
#[derive(Debug, Serialize)]
pub struct DoubtHighlights {
    format: &'static str,
    version: u32,
    /// The evidence that the texts were checked against.
    checked_against: Vec<String>,
    /// Number of texts by world, open or closed.
    worlds: BTreeMap<&'static str, usize>,
    /// How much is doubted.
    pub summary: DoubtSummary,
    /// The texts, in the order of their file.
    pub texts: Vec<DoubtedText>,
}

/// How much is doubted.
#[derive(Debug, Default, Serialize)]
pub struct DoubtSummary {
    /// Texts.
    pub texts: usize,
    /// Texts with a doubt.
    pub doubted: usize,
    /// Texts that could not be followed.
    pub unfollowed: usize,
    /// Words of all texts.
    pub words: usize,
    /// By grade.
    pub grades: BTreeMap<&'static str, DoubtTally>,
    /// By cause.
    pub causes: BTreeMap<&'static str, DoubtTally>,
}

/// Doubts of one kind.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct DoubtTally {
    /// Texts that have one.
    pub texts: usize,
    /// Doubts.
    pub doubts: usize,
    /// Words in the spans of these doubts.
    pub words: usize,
}

impl DoubtSummary {
    fn from_texts(texts: &[DoubtedText]) -> Self {
        let tally = |is_counted: &dyn Fn(&TextDoubt) -> bool| {
            let mut tally = DoubtTally::default();
            for text in texts {
                let doubts: Vec<&TextDoubt> = text.doubts.iter().filter(|doubt| is_counted(doubt)).collect();
                tally.texts += usize::from(!doubts.is_empty());
                tally.doubts += doubts.len();
                let spans = doubts.iter().map(|doubt| words_in(&text.text, doubt.span));
                tally.words += spans.sum::<usize>();
            }
            tally
        };
        let grades = DoubtGrade::ALL.map(|grade| (grade.name(), tally(&|doubt| doubt.grade == grade)));
        let causes = DoubtCause::ALL.map(|cause| (cause.name(), tally(&|doubt| doubt.cause == cause)));
        Self {
            texts: texts.len(),
            doubted: texts.iter().filter(|text| !text.doubts.is_empty()).count(),
            unfollowed: texts.iter().filter(|text| text.unfollowed.is_some()).count(),
            words: texts.iter().map(|text| split_blanks(&text.text).count()).sum(),
            grades: grades.into(),
            causes: causes.into(),
        }
    }

    /// Number of words with a doubt of this grade.
    #[must_use]
    pub fn words_of_grade(&self, grade: DoubtGrade) -> usize {
        self.grades.get(grade.name()).map_or(0, |tally| tally.words)
    }
}

/// How many words of a text lie in a byte range, whole or in part.
fn words_in(text: &str, span: [usize; 2]) -> usize {
    split_blanks(text).filter(|place| spans_overlap(*place, span)).count()
}

impl DoubtHighlights {
    /// Collects the doubts of a check's report; only those of texts of one style, if it is named.
    #[must_use]
    pub fn from_report(report: CheckReport, style: Option<&str>) -> Self {
        let CheckReport { checked_against, mut doubted, .. } = report;
        doubted.retain(|text| style.is_none_or(|style| text.style.as_deref() == Some(style)));
        let mut worlds = BTreeMap::new();
        for text in &doubted {
            *worlds.entry(text.world).or_default() += 1;
        }
        let summary = DoubtSummary::from_texts(&doubted);
        Self { format: "wayword-doubts", version: FORMAT_VERSION, checked_against, worlds, summary, texts: doubted }
    }
}

/// Writes the JSON file.
///
/// # Errors
/// When it cannot be written.
pub fn write_json(out: &Path, highlights: &DoubtHighlights) -> Result<(), CommandError> {
    let text = serde_json::to_string_pretty(highlights);
    let text =
        text.map_err(|error| CommandError::usage(format!("the file cannot be made: {error}"), "report this as a bug"))?;
    replace_page(out, |take| {
        take(&text)?;
        take("\n")
    })
}

/// Writes the page.
///
/// # Errors
/// When it cannot be written.
pub fn write_page(out: &Path, highlights: &DoubtHighlights) -> Result<(), CommandError> {
    let page = highlights_html(highlights)?;
    replace_page(out, |take| take(&page))
}

/// The page as HTML.
///
/// # Errors
/// When it cannot be drawn, which is a bug.
fn highlights_html(highlights: &DoubtHighlights) -> Result<String, CommandError> {
    let DoubtHighlights { checked_against, summary, texts, .. } = highlights;
    let grade_label = |grade: DoubtGrade| (grade.name(), grade.reader_label());
    let tallies = |names: &[(&str, &str)], by_name: &BTreeMap<&str, DoubtTally>| -> Vec<Value> {
        let row = |(name, told): &(&str, &str)| {
            let tally = by_name.get(name).copied().unwrap_or_default();
            context! { name, told, share => share_text(tally.words, summary.words), ..Value::from_serialize(tally) }
        };
        names.iter().map(row).collect()
    };
    let causes = DoubtCause::ALL.map(|cause| (cause.name(), describe_cause(cause)));
    let view = context! {
        checked_against,
        summary => Value::from_serialize(summary),
        grades => tallies(&DoubtGrade::ALL.map(grade_label), &summary.grades),
        causes => tallies(&causes, &summary.causes),
        texts => texts.iter().take(MAX_SHOWN_TEXTS).map(text_view).collect::<Vec<_>>(),
        left_out => texts.len().saturating_sub(MAX_SHOWN_TEXTS),
    };
    let templates = load_templates().map_err(template_error)?;
    templates.get_template("doubts.html").and_then(|page| page.render(view)).map_err(template_error)
}

/// A cause of doubts, explained to readers.
fn describe_cause(cause: DoubtCause) -> &'static str {
    match cause {
        DoubtCause::Wrong => "a check found them wrong",
        DoubtCause::Change => "other words would fit the path better",
        DoubtCause::Ambiguous => "they may mean several places or objects",
        DoubtCause::Unverified => "no evidence decides about them",
    }
}

fn share_text(part: usize, all: usize) -> String {
    format!("{:.1} %", 100.0 * part as f64 / all.max(1) as f64)
}

fn text_view(text: &DoubtedText) -> Value {
    let runs = split_at_doubts(&text.text, &text.doubts, |doubt| doubt.span);
    let mut number = 0;
    let parts: Vec<Value> = runs
        .into_iter()
        .map(|(words, doubt)| {
            number += usize::from(doubt.is_some());
            let view = doubt.map(|doubt| {
                let alternatives: Vec<Option<&str>> =
                    doubt.alternatives.iter().map(|one| one.words.as_deref()).collect();
                let (grade, told) = (doubt.grade.name(), doubt.grade.reader_label());
                context! { number, grade, told, reason => doubt.reason, alternatives }
            });
            context! { words, doubt => view }
        })
        .collect();
    let DoubtedText { path, style, world, unfollowed, .. } = text;
    context! { path, style, world, unfollowed, parts, doubts => number }
}
