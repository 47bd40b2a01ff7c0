//! Writes a comparison as plain text for a terminal.

use super::{
    figures::{
        ComparisonLine, DIFFERENCE_COLUMNS, EFFORT_COLUMNS, SHORT_TABLE_METRICS, SWAP_COLUMNS, TROUBLE_COLUMNS,
        comparison_lines, difference_lines, effort_lines, metric_heading, printable_name, swap_lines, trouble_lines,
    },
    notes,
};
use std::fmt::Write;
use wayword_metrics::TrajectoryMetric;
use wayword_navigation::comparison::AgentComparison;

/// The comparison as plain text.
#[must_use]
pub fn screen_text(comparison: &AgentComparison) -> String {
    let mut text = format!(
        "{}\n{}\n\n",
        notes::describe_subject(&comparison.about),
        notes::describe_success(comparison.about.rule)
    );
    append_table(&mut text, "instructions", &comparison_lines(comparison), &SHORT_TABLE_METRICS, &[]);
    let first = comparison.sets.first().map_or_else(String::new, |set| printable_name(&set.name));
    let differences = difference_lines(comparison);
    if !differences.is_empty() {
        append_table(&mut text, &format!("minus {first}"), &differences, &SHORT_TABLE_METRICS, &DIFFERENCE_COLUMNS);
    }
    let swap_losses = swap_lines(comparison);
    if !swap_losses.is_empty() {
        append_table(
            &mut text,
            &format!("loss by swap of set {first}"),
            &swap_losses,
            &SHORT_TABLE_METRICS,
            &SWAP_COLUMNS,
        );
    }
    let efforts = effort_lines(comparison);
    if !efforts.is_empty() {
        append_table(&mut text, "what a walk took", &efforts, &[], &EFFORT_COLUMNS);
        append_table(&mut text, "what went wrong", &trouble_lines(comparison), &[], &TROUBLE_COLUMNS);
    }
    let sets = comparison.sets.iter().map(notes::describe_set);
    let after = notes::all_notes(comparison)
        .into_iter()
        .chain(notes::listener_notes(comparison))
        .chain(notes::list_warnings(comparison));
    for line in sets.chain(after) {
        text.push_str(&line);
        text.push('\n');
    }
    text
}

/// Columns as wide as their cells; words are aligned to the left, figures to the right.
fn append_table(
    text: &mut String,
    label: &str,
    lines: &[ComparisonLine<'_>],
    metrics: &[TrajectoryMetric],
    beside: &[&str],
) {
    let mut grid: Vec<Vec<String>> = Vec::with_capacity(lines.len() + 1);
    let words = ["agent".to_owned(), label.to_owned()].into_iter();
    let headings =
        metrics.iter().map(|metric| metric_heading(*metric)).chain(beside.iter().map(|name| (*name).to_owned()));
    grid.push(words.chain(headings).collect());
    for line in lines {
        let figure = |metric: &TrajectoryMetric| {
            line.rounded_figure(*metric).map_or_else(|| "-".to_owned(), |figure| figure.to_string())
        };
        let words = [if line.opens { line.agent_with_kind() } else { String::new() }, line.label.clone()].into_iter();
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
