//! Writes a comparison as Markdown: tables, and notes on how to read them.

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

/// The comparison as Markdown: tables, and notes on how to read them.
#[must_use]
pub fn markdown_tables(comparison: &AgentComparison) -> String {
    let mut page = format!("# {}\n\n", escape_markdown(&notes::describe_subject(&comparison.about)));
    for warning in notes::list_warnings(comparison) {
        append_text(&mut page, format_args!("> **{}**\n>\n", escape_markdown(&warning)));
    }
    append_text(&mut page, format_args!("\n{}\n\n", notes::describe_success(comparison.about.rule)));
    append_table(&mut page, "Instructions", &comparison_lines(comparison), &SHORT_TABLE_METRICS, &[]);
    let first = comparison.sets.first().map_or_else(String::new, |set| escape_markdown(&printable_name(&set.name)));
    let differences = difference_lines(comparison);
    if !differences.is_empty() {
        append_text(&mut page, format_args!("\n## Minus {first}\n\n"));
        append_table(&mut page, "Instructions", &differences, &SHORT_TABLE_METRICS, &DIFFERENCE_COLUMNS);
    }
    let swap_losses = swap_lines(comparison);
    if !swap_losses.is_empty() {
        append_text(&mut page, format_args!("\n## Loss by swap of set {first}\n\n"));
        append_table(&mut page, "Swap", &swap_losses, &SHORT_TABLE_METRICS, &SWAP_COLUMNS);
    }
    let efforts = effort_lines(comparison);
    if !efforts.is_empty() {
        page.push_str("\n## What a walk by a language model took\n\n");
        append_table(&mut page, "Instructions", &efforts, &[], &EFFORT_COLUMNS);
        page.push_str("\n## What went wrong in it\n\n");
        append_table(&mut page, "Instructions", &trouble_lines(comparison), &[], &TROUBLE_COLUMNS);
    }
    append_list(&mut page, "Sets", comparison.sets.iter().map(notes::describe_set));
    append_list(
        &mut page,
        "How to read it",
        notes::listener_notes(comparison).into_iter().chain(notes::all_notes(comparison)),
    );
    let has = |metric: &TrajectoryMetric| comparison.rows.iter().any(|row| row.figures.contains_key(metric));
    let others: Vec<TrajectoryMetric> = TrajectoryMetric::ALL
        .into_iter()
        .filter(|metric| !SHORT_TABLE_METRICS.contains(metric) && has(metric))
        .collect();
    if !others.is_empty() {
        page.push_str("\n## Other figures\n\n");
        append_table(&mut page, "Instructions", &comparison_lines(comparison), &others, &[]);
    }
    page
}

fn append_table(
    page: &mut String,
    label: &str,
    lines: &[ComparisonLine<'_>],
    metrics: &[TrajectoryMetric],
    beside: &[&str],
) {
    let columns = metrics.len() + beside.len();
    let headings =
        metrics.iter().map(|metric| metric_heading(*metric)).chain(beside.iter().map(|name| (*name).to_owned()));
    let headings: Vec<String> = headings.collect();
    append_text(
        page,
        format_args!("| Agent | {label} | {} |\n|---|---|{}\n", headings.join(" | "), "---:|".repeat(columns)),
    );
    for line in lines {
        let figure = |metric: &TrajectoryMetric| {
            line.rounded_figure(*metric).map_or_else(|| "–".to_owned(), |figure| figure.to_string())
        };
        let cells: Vec<String> =
            metrics.iter().map(figure).chain(line.beside.iter().map(|text| escape_markdown(text))).collect();
        let agent = if line.opens { escape_markdown(&line.agent_with_kind()) } else { String::new() };
        append_text(page, format_args!("| {agent} | {} | {} |\n", escape_markdown(&line.label), cells.join(" | ")));
    }
}

fn append_list(page: &mut String, title: &str, lines: impl Iterator<Item = String>) {
    append_text(page, format_args!("\n## {title}\n\n"));
    for line in lines {
        append_text(page, format_args!("- {}\n", escape_markdown(&line)));
    }
}

fn append_text(page: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a text cannot fail.
    let _ = page.write_fmt(text);
}

/// Escapes a text for Markdown.
fn escape_markdown(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => escaped.push_str("&lt;"),
            '&' => escaped.push_str("&amp;"),
            '\\' | '`' | '*' | '_' | '|' | '~' | '$' | '[' | ']' => escaped.extend(['\\', c]),
            c => escaped.push(c),
        }
    }
    escaped
}
