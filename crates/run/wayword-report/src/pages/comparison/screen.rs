//! Writes a comparison as plain text for a terminal.

use super::{
    figures::{
        BESIDE_DIFFERENCES, BESIDE_EFFORTS, BESIDE_SWAPS, BESIDE_TROUBLE, Line, SHOWN, differences, efforts, heading,
        name, rows, swaps, trouble,
    },
    notes,
};
use std::fmt::Write;
use wayword_metrics::Metric;
use wayword_navigation::comparison::Comparison;

/// The comparison as plain text.
#[must_use]
pub fn screen(comparison: &Comparison) -> String {
    let mut text = format!("{}\n{}\n\n", notes::subject(&comparison.about), notes::success(comparison.about.rule));
    table(&mut text, "instructions", &rows(comparison), &SHOWN, &[]);
    let first = comparison.sets.first().map_or_else(String::new, |set| name(&set.name));
    let less = differences(comparison);
    if !less.is_empty() {
        table(&mut text, &format!("minus {first}"), &less, &SHOWN, &BESIDE_DIFFERENCES);
    }
    let lost = swaps(comparison);
    if !lost.is_empty() {
        table(&mut text, &format!("loss by swap of set {first}"), &lost, &SHOWN, &BESIDE_SWAPS);
    }
    let efforts = efforts(comparison);
    if !efforts.is_empty() {
        table(&mut text, "what a walk took", &efforts, &[], &BESIDE_EFFORTS);
        table(&mut text, "what went wrong", &trouble(comparison), &[], &BESIDE_TROUBLE);
    }
    let sets = comparison.sets.iter().map(notes::set);
    let after =
        notes::notes(comparison).into_iter().chain(notes::listeners(comparison)).chain(notes::warnings(comparison));
    for line in sets.chain(after) {
        text.push_str(&line);
        text.push('\n');
    }
    text
}

/// Columns as wide as their cells; words are aligned to the left, figures to the right.
fn table(text: &mut String, label: &str, lines: &[Line<'_>], metrics: &[Metric], beside: &[&str]) {
    let mut grid: Vec<Vec<String>> = Vec::with_capacity(lines.len() + 1);
    let words = ["agent".to_owned(), label.to_owned()].into_iter();
    let headings = metrics.iter().map(|metric| heading(*metric)).chain(beside.iter().map(|name| (*name).to_owned()));
    grid.push(words.chain(headings).collect());
    for line in lines {
        let figure = |metric: &Metric| line.figure(*metric).map_or_else(|| "-".to_owned(), |figure| figure.to_string());
        let words = [if line.opens { line.who() } else { String::new() }, line.label.clone()].into_iter();
        grid.push(words.chain(metrics.iter().map(figure)).chain(line.beside.iter().cloned()).collect());
    }
    let width = |column: usize| grid.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max();
    let widths: Vec<usize> = (0..grid[0].len()).filter_map(width).collect();
    for row in &grid {
        let mut shown = String::new();
        for (at, (cell, width)) in row.iter().zip(&widths).enumerate() {
            // Writing to a text cannot fail.
            let _ = if at < 2 { write!(shown, "{cell:<width$}  ") } else { write!(shown, "{cell:>width$}  ") };
        }
        text.push_str(shown.trim_end());
        text.push('\n');
    }
    text.push('\n');
}
