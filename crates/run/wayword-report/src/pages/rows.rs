//! The list of all texts of a report, on its first page: item, scene, style and text, and what speaks against it. The worst come
//! first; the page's script filters, sorts, searches and samples the rows.

use super::{
    item_record::{ItemRecord, TextState},
    pictures::{PagePicture, PagePictures},
    records::ReportRecords,
    spans::{TextMarks, cut_segments},
    suspicion::{SuspicionSign, TextSuspicion, failed_score, unwritten_score},
};
use serde::Serialize;
use std::{cmp::Reverse, collections::BTreeSet};
use wayword_core::{CheckFinding, CheckKind, Verdict};
use wayword_language::Language;
use wayword_run::run_folder::{FailedItem, text_label};

/// Most characters of a text in a row. The rest is cut off; the section of the path shows the whole text.
const MAX_ROW_CHARS: usize = 700;
/// Most characters of a sign in a row.
const MAX_SIGN_CHARS: usize = 200;
/// Most styles, and most scenes, that a reader can choose from. With more of them there is no choice.
const MAX_FILTER_CHOICES: usize = 500;
/// Most rows that are printed on paper; the screen shows all.
const MAX_PRINTED_ROWS: usize = 100;

/// The list of texts, with the choices to filter it.
#[derive(Debug, Serialize)]
pub(super) struct TextList {
    rows: Vec<TextRow>,
    /// The reader's choices: kinds of texts with their counts, and styles and scenes if there are several.
    kinds: Vec<KindCount>,
    styles: Vec<String>,
    scenes: Vec<String>,
    /// Whether the texts differ in cost.
    has_costs: bool,
    printed: usize,
}

/// How many rows are of a kind.
#[derive(Debug, Serialize)]
struct KindCount {
    kind: &'static str,
    /// What the reader sees behind the number.
    label: &'static str,
    rows: usize,
}

/// The kinds of rows by which a reader can filter, with their labels.
const KINDS: [(&str, &str); 10] = [
    ("look", "need a look"),
    ("wrong", "fail now"),
    ("changed", "changed after the run"),
    ("failed", "failed"),
    ("rejected", "rejected"),
    ("unverified", "unverified"),
    ("doubtful", "with doubtful words"),
    ("ambiguous", "ambiguous"),
    ("unwritten", "not written yet"),
    ("passed", "passed"),
];

/// A row of the list: one text, or an item without one.
#[derive(Debug, Serialize)]
struct TextRow {
    /// The state of the text, or `failed` or `unwritten`.
    state: &'static str,
    /// All kinds that it belongs to.
    kinds: Vec<&'static str>,
    /// The higher, the more likely it is wrong.
    score: u32,
    /// The link to the path; `None` if there is no path.
    href: Option<String>,
    id: String,
    scene: Option<String>,
    style: String,
    /// The style, with the number of the text if the path has several of that style.
    label: String,
    /// The index of the scene among those that can be chosen, and that of the style; `None` if there is no choice.
    scene_at: Option<usize>,
    style_at: Option<usize>,
    /// The place of the item in the run.
    place: usize,
    /// Characters of the text.
    length: usize,
    unverified: usize,
    /// US dollars for the text, or in runs of older versions for the item.
    usd: Option<f64>,
    /// The text, cut at the words that something speaks against.
    said: Vec<(String, bool)>,
    /// The tag of its language, if that is written in other letters than English.
    lang: Option<&'static str>,
    signs: Vec<SuspicionSign>,
    /// The view at the end of the path.
    picture: Option<PagePicture>,
}

impl TextList {
    /// The list of a run; `href` gives the link to the item at a place (from 0).
    pub(super) fn from_records(
        records: &ReportRecords<'_>,
        href: impl Fn(usize) -> String,
        pictures: &mut PagePictures<'_>,
    ) -> Self {
        let mut rows: Vec<TextRow> = records.failed.iter().map(failed_row).collect();
        for (at, item) in records.items.iter().enumerate() {
            rows.extend(rows_for_item(records, item, &href(at), pictures));
        }
        rows.sort_by_key(|row| Reverse(row.score));
        let styles = choices_among(rows.iter().map(|row| row.style.as_str()));
        let scenes = choices_among(rows.iter().filter_map(|row| row.scene.as_deref()));
        for row in &mut rows {
            row.style_at = styles.binary_search(&row.style).ok();
            row.scene_at = row.scene.as_ref().and_then(|scene| scenes.binary_search(scene).ok());
        }
        let count = |(kind, label)| {
            let rows = rows.iter().filter(|row| row.kinds.contains(&kind)).count();
            KindCount { kind, label, rows }
        };
        let kinds = KINDS.into_iter().map(count).filter(|count| count.rows > 0).collect();
        let has_costs = rows.iter().any(|row| row.usd.is_some());
        Self { rows, kinds, styles, scenes, has_costs, printed: MAX_PRINTED_ROWS }
    }
}

/// Different names in their order; empty if there is only one, or too many to choose from.
fn choices_among<'n>(names: impl Iterator<Item = &'n str>) -> Vec<String> {
    let names: BTreeSet<&str> = names.filter(|name| !name.is_empty()).collect();
    if (2..=MAX_FILTER_CHOICES).contains(&names.len()) {
        names.into_iter().map(str::to_owned).collect()
    } else {
        Vec::new()
    }
}

fn failed_row(failed: &FailedItem) -> TextRow {
    let words = cut_text(&format!("{}: {}", failed.failure.name(), failed.reason), MAX_SIGN_CHARS);
    TextRow {
        state: "failed",
        kinds: vec!["failed", "look"],
        score: failed_score(failed.failure),
        href: None,
        id: failed.item.clone(),
        scene: None,
        style: String::new(),
        label: String::new(),
        scene_at: None,
        style_at: None,
        place: usize::MAX,
        length: 0,
        unverified: 0,
        usd: None,
        said: Vec::new(),
        lang: None,
        signs: vec![SuspicionSign { class: "bad", words, span: None }],
        picture: None,
    }
}

/// The rows of an item: one for each of its texts, or a single one if it has none.
fn rows_for_item(
    records: &ReportRecords<'_>,
    item: &ItemRecord,
    href: &str,
    pictures: &mut PagePictures<'_>,
) -> Vec<TextRow> {
    let path = &item.walk.path;
    let picture = item.walk.has_pictures.then(|| pictures.take_small(&path.id, path.frames.len().saturating_sub(1)));
    let picture = picture.flatten();
    let row = |style: &str, number: usize, text: &str, suspicion: Option<TextSuspicion>, usd: Option<f64>| {
        let (state, kinds) = kinds_of(suspicion.as_ref());
        let signs = suspicion.as_ref().map(|suspicion| suspicion.signs.clone()).unwrap_or_default();
        TextRow {
            state,
            kinds,
            score: suspicion.as_ref().map_or_else(unwritten_score, |suspicion| suspicion.score),
            href: Some(href.to_owned()),
            id: path.id.clone(),
            scene: Some(path.scene.to_string()),
            style: style.to_owned(),
            label: text_label(style, number),
            scene_at: None,
            style_at: None,
            place: item.place,
            length: text.chars().count(),
            unverified: suspicion.map_or(0, |suspicion| suspicion.unverified),
            usd: usd.or(item.walk.used.map(|used| used.usd)).filter(|usd| *usd > 0.0),
            said: marked_words(text, &signs),
            lang: Language::tag_of_script(text),
            signs: signs.iter().filter(|sign| !sign.words.is_empty()).map(SuspicionSign::cut_to_row).collect(),
            picture: picture.clone(),
        }
    };
    let accepted = item.accepted.iter().map(|text| {
        let stored = &text.instruction;
        let judged = (stored.text.as_str(), stored.verdict, &stored.findings[..]);
        let second = records.again.of_line(text.line);
        let suspicion = TextSuspicion::of_accepted(judged, stored.ambiguity.as_ref(), second);
        row(&stored.style, text.number, &stored.text, Some(suspicion), text.cost.and_then(|cost| cost.cost_usd))
    });
    let rejected = item.rejected.iter().map(|rejected| {
        let text = rejected.last.as_ref().map_or("", |last| last.text.as_str());
        row(
            &rejected.style,
            rejected.number,
            text,
            Some(TextSuspicion::of_rejected(rejected)),
            rejected.cost.and_then(|cost| cost.cost_usd),
        )
    });
    let mut rows: Vec<TextRow> = accepted.chain(rejected).collect();
    if rows.is_empty() {
        rows.push(row("", 0, "", None, None));
    }
    rows.sort_by(|a, b| a.label.cmp(&b.label));
    rows
}

impl SuspicionSign {
    fn cut_to_row(&self) -> Self {
        Self { words: cut_text(&self.words, MAX_SIGN_CHARS), ..self.clone() }
    }
}

/// The state of a text, and all kinds that it belongs to; `None` for an item without a text.
fn kinds_of(suspicion: Option<&TextSuspicion>) -> (&'static str, Vec<&'static str>) {
    let Some(suspicion) = suspicion else { return ("unwritten", vec!["unwritten"]) };
    let state = match suspicion.state {
        TextState::Wrong => "wrong",
        TextState::Rejected => "rejected",
        TextState::Unverified => "unverified",
        TextState::Passed => "passed",
    };
    let others = [
        (suspicion.needs_look(), "look"),
        (suspicion.is_changed, "changed"),
        (suspicion.is_doubtful, "doubtful"),
        (suspicion.is_ambiguous, "ambiguous"),
        (suspicion.unverified > 0 && state != "unverified", "unverified"),
    ];
    let others = others.into_iter().filter_map(|(is_so, kind)| is_so.then_some(kind));
    (state, std::iter::once(state).chain(others).collect())
}

/// A text, cut at the words that something speaks against.
fn marked_words(text: &str, signs: &[SuspicionSign]) -> Vec<(String, bool)> {
    let finding = |sign: &SuspicionSign| CheckFinding {
        check: CheckKind::Form,
        verdict: Verdict::Fail,
        reason: String::new(),
        span: sign.span,
    };
    let findings: Vec<CheckFinding> = signs.iter().map(finding).collect();
    let text = cut_text(text, MAX_ROW_CHARS);
    let marks = TextMarks { findings: &findings, ..TextMarks::default() };
    let mut words: Vec<(String, bool)> = Vec::new();
    for part in cut_segments(&text, marks, 0) {
        match words.last_mut() {
            Some((last, is_flawed)) if *is_flawed == part.is_flawed => last.push_str(part.text),
            _ => words.push((part.text.to_owned(), part.is_flawed)),
        }
    }
    words
}

fn cut_text(text: &str, most_chars: usize) -> String {
    match text.char_indices().nth(most_chars) {
        Some((end, _)) => format!("{} …", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_is_no_choice_among_one_name_or_among_too_many() {
        let choice = |number: usize| {
            let names: Vec<String> = (0..number).map(|name| format!("style-{name:03}")).collect();
            choices_among(names.iter().map(String::as_str)).len()
        };
        assert_eq!([1, 2, MAX_FILTER_CHOICES, MAX_FILTER_CHOICES + 1].map(choice), [0, 2, MAX_FILTER_CHOICES, 0]);
    }

    #[test]
    fn the_words_that_something_speaks_against_are_marked() {
        let sign = |span| SuspicionSign { class: "bad", words: "x".into(), span };
        let signs = [sign(Some([5, 9])), sign(None), sign(Some([0, 9])), sign(Some([90, 99]))];
        let marked = marked_words("Turn left now.", &signs);
        assert_eq!(marked, [("Turn left".into(), true), (" now.".into(), false)]);
    }
}
