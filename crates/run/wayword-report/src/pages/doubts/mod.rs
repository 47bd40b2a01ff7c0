//! Marks the words of texts that a reader should doubt, in a JSON file for programs and on an HTML page for people.

#[cfg(test)]
mod tests;

use super::{link_targets::item_anchor, load_templates, replace_page, report_files::ReportFiles, template_error};
use minijinja::{Value, context};
use serde::Serialize;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};
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
/// Texts on a page. With more of them, the page is a list, and the details are on numbered pages beside it.
const TEXTS_PER_PAGE: usize = 500;

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

/// Writes the page, with numbered pages beside it where there are many texts; the most doubtful texts come first.
///
/// # Errors
/// When a page cannot be written, or another report's file is where a numbered page belongs.
pub fn write_page(out: &Path, highlights: &DoubtHighlights) -> Result<(), CommandError> {
    write_paged(out, highlights, TEXTS_PER_PAGE)
}

fn write_paged(out: &Path, highlights: &DoubtHighlights, per_page: usize) -> Result<(), CommandError> {
    // They are pages of their own report, so its file stands for the run.
    let files = ReportFiles::new(out, out, highlights.texts.len(), per_page);
    files.refuse_to_replace_others()?;
    let list = DoubtList::from_highlights(highlights, &files);
    for page in 1..=files.page_count() {
        let drawn = list.draw_leaf(page, &files)?;
        replace_page(&files.page_file(page), |take| take(&drawn))?;
    }
    let drawn = list.draw_first(highlights, &files)?;
    replace_page(out, |take| take(&drawn))?;
    files.remove_older_pages()
}

/// The texts, the most doubtful first, as the templates show them.
struct DoubtList {
    texts: Vec<Value>,
    styles: Vec<String>,
}

impl DoubtList {
    fn from_highlights(highlights: &DoubtHighlights, files: &ReportFiles<'_>) -> Self {
        let mut order: Vec<(usize, &DoubtedText)> = highlights.texts.iter().enumerate().collect();
        order.sort_by(|(_, a), (_, b)| doubtfulness(b).total_cmp(&doubtfulness(a)));
        let styles: BTreeSet<&str> = highlights.texts.iter().filter_map(|text| text.style.as_deref()).collect();
        let styles: Vec<String> = styles.into_iter().map(str::to_owned).collect();
        let view = |(at, (place, text)): (usize, (usize, &DoubtedText))| {
            let style_at = text.style.as_ref().and_then(|style| styles.binary_search(style).ok());
            let href = files.walk_address(at, &item_anchor(at + 1));
            context! { number => at + 1, place, style_at, href, ..text_view(text) }
        };
        let texts = order.into_iter().enumerate().map(view).collect();
        // One style is no choice.
        Self { texts, styles: if styles.len() > 1 { styles } else { Vec::new() } }
    }

    fn draw_first(&self, highlights: &DoubtHighlights, files: &ReportFiles<'_>) -> Result<String, CommandError> {
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
        let kinds = [("likely", "likely wrong"), ("uncertain", "uncertain"), ("clean", "without a doubt")];
        let of_kind = |(kind, label)| (kind, label, texts.iter().filter(|text| text_kind(text) == kind).count());
        let unfollowed = ("unfollowed", "not followed", summary.unfollowed);
        let kinds: Vec<Value> = kinds
            .map(of_kind)
            .into_iter()
            .chain([unfollowed])
            .filter(|(_, _, texts)| *texts > 0)
            .map(|(kind, label, texts)| context! { kind, label, texts })
            .collect();
        let view = context! {
            checked_against,
            kinds,
            summary => Value::from_serialize(summary),
            grades => tallies(&DoubtGrade::ALL.map(grade_label), &summary.grades),
            causes => tallies(&causes, &summary.causes),
            texts => self.texts,
            styles => self.styles,
            first => 1,
            last => 0,
            pager => files.pager_for_page(None),
            pager_name => "Pages",
        };
        draw("doubts.html", view)
    }

    /// Draws a numbered page (from 1).
    fn draw_leaf(&self, page: usize, files: &ReportFiles<'_>) -> Result<String, CommandError> {
        let shown = files.walks_on_page(page);
        let view = context! {
            page_of => files.page_of(),
            first => shown.start + 1,
            last => shown.end,
            all => self.texts.len(),
            texts => self.texts[shown].to_vec(),
            pager => files.pager_for_page(Some(page)),
            pager_name => "Pages",
        };
        draw("doubts_leaf.html", view)
    }
}

fn draw(template: &str, view: Value) -> Result<String, CommandError> {
    let templates = load_templates().map_err(template_error)?;
    templates.get_template(template).and_then(|page| page.render(view)).map_err(template_error)
}

/// How doubtful a text is: the higher, the earlier it comes.
fn doubtfulness(text: &DoubtedText) -> f64 {
    let worth = |doubt: &TextDoubt| match doubt.grade {
        DoubtGrade::Likely => 1000.0 + 10.0 * doubt.best_gain(),
        DoubtGrade::Uncertain => 1.0 + doubt.best_gain(),
    };
    text.doubts.iter().map(worth).sum()
}

/// The kind of a text, by which a reader can filter.
fn text_kind(text: &DoubtedText) -> &'static str {
    match text.doubts.is_empty() {
        true => "clean",
        false if text.has_grade(DoubtGrade::Likely) => "likely",
        false => "uncertain",
    }
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
    let DoubtedText { name, style, world, unfollowed, .. } = text;
    let length = text.text.chars().count();
    context! { name, style, world, unfollowed, parts, length, kind => text_kind(text), doubts => number }
}
