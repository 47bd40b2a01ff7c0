//! The list of all texts at the top of a report: item, scene, style, text and state, with choices to filter it.

use super::{
    item_record::{ItemRecord, TextState, state_from_verdict},
    records::ReportRecords,
};
use serde::Serialize;
use std::collections::BTreeSet;
use wayword_run::run_folder::FailedItem;

/// Most characters of a text in a row. The rest is cut off; the section of the path shows the whole text.
const MAX_ROW_CHARS: usize = 700;
/// Most styles, and most scenes, that a reader can choose from. With more of them there is no choice.
const MAX_FILTER_CHOICES: usize = 200;
/// Most rows that are printed on paper; the screen shows all.
const MAX_PRINTED_ROWS: usize = 100;

/// The list of texts, with the choices to filter it.
#[derive(Debug, Serialize)]
pub(super) struct TextList {
    rows: Vec<TextRow>,
    /// The reader's choices: states with their counts, and styles and scenes if there are several.
    states: Vec<(TextRowState, usize)>,
    styles: Vec<String>,
    scenes: Vec<String>,
    printed: usize,
}

/// A row of the list: one text, or an item without one.
#[derive(Debug, Serialize)]
struct TextRow {
    state: TextRowState,
    /// The link to the path; `None` if there is no path.
    href: Option<String>,
    id: String,
    scene: Option<String>,
    style: String,
    /// The index of the scene among those that can be chosen, and that of the style; `None` if there is no choice.
    scene_at: Option<usize>,
    style_at: Option<usize>,
    text: String,
    /// Why it failed or was rejected.
    reason: Option<String>,
}

/// The state of a text, the worst first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
enum TextRowState {
    /// The item failed before it had a text.
    Failed,
    Rejected,
    Unverified,
    /// The item has no text yet.
    Unwritten,
    Passed,
}

impl From<TextState> for TextRowState {
    fn from(state: TextState) -> Self {
        match state {
            TextState::Rejected => Self::Rejected,
            TextState::Unverified => Self::Unverified,
            TextState::Passed => Self::Passed,
        }
    }
}

impl TextList {
    /// The list of a run; `href` gives the link to the item at a place (from 0).
    pub(super) fn from_records(records: &ReportRecords, href: impl Fn(usize) -> String) -> Self {
        let mut rows: Vec<TextRow> = records.failed.iter().map(failed_row).collect();
        for (at, item) in records.items.iter().enumerate() {
            rows.extend(rows_for_item(item, &href(at)));
        }
        rows.sort_by_key(|row| row.state);
        let styles = choices_among(rows.iter().map(|row| row.style.as_str()));
        let scenes = choices_among(rows.iter().filter_map(|row| row.scene.as_deref()));
        for row in &mut rows {
            row.style_at = styles.binary_search(&row.style).ok();
            row.scene_at = row.scene.as_ref().and_then(|scene| scenes.binary_search(scene).ok());
        }
        let mut states: Vec<(TextRowState, usize)> = Vec::new();
        for row in &rows {
            match states.last_mut() {
                Some((state, number)) if *state == row.state => *number += 1,
                _ => states.push((row.state, 1)),
            }
        }
        Self { rows, states, styles, scenes, printed: MAX_PRINTED_ROWS }
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
    TextRow {
        state: TextRowState::Failed,
        href: None,
        id: failed.item.clone(),
        scene: None,
        style: String::new(),
        scene_at: None,
        style_at: None,
        text: String::new(),
        reason: Some(cut_text(&format!("{}: {}", failed.failure.name(), failed.reason))),
    }
}

/// The rows of an item: one for each of its texts, or a single one if it has none.
fn rows_for_item(item: &ItemRecord, href: &str) -> Vec<TextRow> {
    let row = |state, style: &str, text: &str, reason: Option<&str>| TextRow {
        state,
        href: Some(href.to_owned()),
        id: item.walk.path.id.clone(),
        scene: Some(item.walk.path.scene.to_string()),
        style: style.to_owned(),
        scene_at: None,
        style_at: None,
        text: cut_text(text),
        reason: reason.map(cut_text),
    };
    let accepted = item.accepted.iter().map(|instruction| {
        row(state_from_verdict(instruction.verdict).into(), &instruction.style, &instruction.text, None)
    });
    let rejected = item.rejected.iter().map(|rejected| {
        let text = rejected.last.as_ref().map_or("", |last| last.text.as_str());
        row(TextRowState::Rejected, &rejected.style, text, Some(&rejected.reason))
    });
    let mut rows: Vec<TextRow> = accepted.chain(rejected).collect();
    if rows.is_empty() {
        rows.push(row(TextRowState::Unwritten, "", "", None));
    }
    rows.sort_by(|a, b| a.style.cmp(&b.style));
    rows
}

fn cut_text(text: &str) -> String {
    match text.char_indices().nth(MAX_ROW_CHARS) {
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
}
