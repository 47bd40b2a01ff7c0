//! Marks the words of texts that a reader should doubt, in a JSON file for programs and on an HTML page for people.

#[cfg(test)]
mod tests;

use super::{broken, replace, templates};
use minijinja::{Value, context};
use serde::Serialize;
use std::{collections::BTreeMap, path::Path};
use wayword_core::{
    Cause, Doubt, Grade,
    doubt::{overlap, parts},
};
use wayword_language::text::pieces;
use wayword_run::{
    check::{CheckReport, DoubtedText},
    error::Error,
};

/// The version of the file.
const VERSION: u32 = 1;
/// Most texts on the page. The file has all.
const MOST_SHOWN: usize = 1000;

/// Texts with their doubts, as the file has them.
#[derive(Debug, Serialize)]
pub struct Highlights {
    format: &'static str,
    version: u32,
    /// The evidence that the texts were checked against.
    checked_against: Vec<String>,
    /// Number of texts by world, open or closed.
    worlds: BTreeMap<&'static str, usize>,
    /// How much is doubted.
    pub summary: Summary,
    /// The texts, in the order of their file.
    pub texts: Vec<DoubtedText>,
}

/// How much is doubted.
#[derive(Debug, Default, Serialize)]
pub struct Summary {
    /// Texts.
    pub texts: usize,
    /// Texts with a doubt.
    pub doubted: usize,
    /// Texts that could not be followed.
    pub unfollowed: usize,
    /// Words of all texts.
    pub words: usize,
    /// By grade.
    pub grades: BTreeMap<&'static str, Tally>,
    /// By cause.
    pub causes: BTreeMap<&'static str, Tally>,
}

/// Doubts of one kind.
#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Tally {
    /// Texts that have one.
    pub texts: usize,
    /// Doubts.
    pub doubts: usize,
    /// Words in the spans of these doubts.
    pub words: usize,
}

impl Summary {
    fn of_texts(texts: &[DoubtedText]) -> Self {
        let tally = |is: &dyn Fn(&Doubt) -> bool| {
            let mut tally = Tally::default();
            for text in texts {
                let doubts: Vec<&Doubt> = text.doubts.iter().filter(|doubt| is(doubt)).collect();
                tally.texts += usize::from(!doubts.is_empty());
                tally.doubts += doubts.len();
                let spans = doubts.iter().map(|doubt| words_in(&text.text, doubt.span));
                tally.words += spans.sum::<usize>();
            }
            tally
        };
        let grades = Grade::ALL.map(|grade| (grade.name(), tally(&|doubt| doubt.grade == grade)));
        let causes = Cause::ALL.map(|cause| (cause.name(), tally(&|doubt| doubt.cause == cause)));
        Self {
            texts: texts.len(),
            doubted: texts.iter().filter(|text| !text.doubts.is_empty()).count(),
            unfollowed: texts.iter().filter(|text| text.unfollowed.is_some()).count(),
            words: texts.iter().map(|text| pieces(&text.text).count()).sum(),
            grades: grades.into(),
            causes: causes.into(),
        }
    }

    /// Number of words with a doubt of this grade.
    #[must_use]
    pub fn of(&self, grade: Grade) -> usize {
        self.grades.get(grade.name()).map_or(0, |tally| tally.words)
    }
}

/// How many words of a text lie in a byte range, whole or in part.
fn words_in(text: &str, span: [usize; 2]) -> usize {
    pieces(text).filter(|place| overlap(*place, span)).count()
}

impl Highlights {
    /// Collects the doubts of a check's report; only those of texts of one style, if it is named.
    #[must_use]
    pub fn of(report: CheckReport, style: Option<&str>) -> Self {
        let CheckReport { checked_against, mut doubted, .. } = report;
        doubted.retain(|text| style.is_none_or(|style| text.style.as_deref() == Some(style)));
        let mut worlds = BTreeMap::new();
        for text in &doubted {
            *worlds.entry(text.world).or_default() += 1;
        }
        let summary = Summary::of_texts(&doubted);
        Self { format: "wayword-doubts", version: VERSION, checked_against, worlds, summary, texts: doubted }
    }
}

/// Writes the JSON file.
///
/// # Errors
/// When it cannot be written.
pub fn write_json(out: &Path, highlights: &Highlights) -> Result<(), Error> {
    let text = serde_json::to_string_pretty(highlights);
    let text =
        text.map_err(|error| Error::usage(format!("the file cannot be made: {error}"), "report this as a bug"))?;
    replace(out, |take| {
        take(&text)?;
        take("\n")
    })
}

/// Writes the page.
///
/// # Errors
/// When it cannot be written.
pub fn write_page(out: &Path, highlights: &Highlights) -> Result<(), Error> {
    let page = html(highlights)?;
    replace(out, |take| take(&page))
}

/// The page as HTML.
///
/// # Errors
/// When it cannot be drawn, which is a bug.
fn html(highlights: &Highlights) -> Result<String, Error> {
    let Highlights { checked_against, summary, texts, .. } = highlights;
    let told = |grade: Grade| (grade.name(), grade.told());
    let tallies = |names: &[(&str, &str)], of: &BTreeMap<&str, Tally>| -> Vec<Value> {
        let row = |(name, told): &(&str, &str)| {
            let tally = of.get(name).copied().unwrap_or_default();
            context! { name, told, share => share(tally.words, summary.words), ..Value::from_serialize(tally) }
        };
        names.iter().map(row).collect()
    };
    let causes = Cause::ALL.map(|cause| (cause.name(), told_of(cause)));
    let view = context! {
        checked_against,
        summary => Value::from_serialize(summary),
        grades => tallies(&Grade::ALL.map(told), &summary.grades),
        causes => tallies(&causes, &summary.causes),
        texts => texts.iter().take(MOST_SHOWN).map(text_view).collect::<Vec<_>>(),
        left_out => texts.len().saturating_sub(MOST_SHOWN),
    };
    let templates = templates().map_err(broken)?;
    templates.get_template("doubts.html").and_then(|page| page.render(view)).map_err(broken)
}

/// A cause of doubts, explained to readers.
fn told_of(cause: Cause) -> &'static str {
    match cause {
        Cause::Wrong => "a check found them wrong",
        Cause::Change => "other words would fit the path better",
        Cause::Ambiguous => "they may mean several places or objects",
        Cause::Unverified => "no evidence decides about them",
    }
}

fn share(part: usize, all: usize) -> String {
    format!("{:.1} %", 100.0 * part as f64 / all.max(1) as f64)
}

fn text_view(text: &DoubtedText) -> Value {
    let runs = parts(&text.text, &text.doubts, |doubt| doubt.span);
    let mut number = 0;
    let parts: Vec<Value> = runs
        .into_iter()
        .map(|(words, doubt)| {
            number += usize::from(doubt.is_some());
            let view = doubt.map(|doubt| {
                let alternatives: Vec<Option<&str>> =
                    doubt.alternatives.iter().map(|one| one.words.as_deref()).collect();
                let (grade, told) = (doubt.grade.name(), doubt.grade.told());
                context! { number, grade, told, reason => doubt.reason, alternatives }
            });
            context! { words, doubt => view }
        })
        .collect();
    let DoubtedText { path, style, world, unfollowed, .. } = text;
    context! { path, style, world, unfollowed, parts, doubts => number }
}
