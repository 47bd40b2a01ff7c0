//! Writes a comparison as Markdown: tables, and notes on how to read them.

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

/// The comparison as Markdown: tables, and notes on how to read them.
#[must_use]
pub fn markdown(comparison: &Comparison) -> String {
    let mut page = format!("# {}\n\n", escaped(&notes::subject(&comparison.about)));
    for warning in notes::warnings(comparison) {
        add(&mut page, format_args!("> **{}**\n>\n", escaped(&warning)));
    }
    add(&mut page, format_args!("\n{}\n\n", notes::success(comparison.about.rule)));
    table(&mut page, "Instructions", &rows(comparison), &SHOWN, &[]);
    let first = comparison.sets.first().map_or_else(String::new, |set| escaped(&name(&set.name)));
    let less = differences(comparison);
    if !less.is_empty() {
        add(&mut page, format_args!("\n## Minus {first}\n\n"));
        table(&mut page, "Instructions", &less, &SHOWN, &BESIDE_DIFFERENCES);
    }
    let lost = swaps(comparison);
    if !lost.is_empty() {
        add(&mut page, format_args!("\n## Loss by swap of set {first}\n\n"));
        table(&mut page, "Swap", &lost, &SHOWN, &BESIDE_SWAPS);
    }
    let efforts = efforts(comparison);
    if !efforts.is_empty() {
        page.push_str("\n## What a walk by a language model took\n\n");
        table(&mut page, "Instructions", &efforts, &[], &BESIDE_EFFORTS);
        page.push_str("\n## What went wrong in it\n\n");
        table(&mut page, "Instructions", &trouble(comparison), &[], &BESIDE_TROUBLE);
    }
    list(&mut page, "Sets", comparison.sets.iter().map(notes::set));
    list(&mut page, "How to read it", notes::listeners(comparison).into_iter().chain(notes::notes(comparison)));
    let has = |metric: &Metric| comparison.rows.iter().any(|row| row.figures.contains_key(metric));
    let others: Vec<Metric> = Metric::ALL.into_iter().filter(|metric| !SHOWN.contains(metric) && has(metric)).collect();
    if !others.is_empty() {
        page.push_str("\n## Other figures\n\n");
        table(&mut page, "Instructions", &rows(comparison), &others, &[]);
    }
    page
}

fn table(page: &mut String, label: &str, lines: &[Line<'_>], metrics: &[Metric], beside: &[&str]) {
    let columns = metrics.len() + beside.len();
    let headings = metrics.iter().map(|metric| heading(*metric)).chain(beside.iter().map(|name| (*name).to_owned()));
    let headings: Vec<String> = headings.collect();
    add(page, format_args!("| Agent | {label} | {} |\n|---|---|{}\n", headings.join(" | "), "---:|".repeat(columns)));
    for line in lines {
        let figure = |metric: &Metric| line.figure(*metric).map_or_else(|| "–".to_owned(), |figure| figure.to_string());
        let cells: Vec<String> =
            metrics.iter().map(figure).chain(line.beside.iter().map(|text| escaped(text))).collect();
        let agent = if line.opens { escaped(&line.who()) } else { String::new() };
        add(page, format_args!("| {agent} | {} | {} |\n", escaped(&line.label), cells.join(" | ")));
    }
}

fn list(page: &mut String, title: &str, lines: impl Iterator<Item = String>) {
    add(page, format_args!("\n## {title}\n\n"));
    for line in lines {
        add(page, format_args!("- {}\n", escaped(&line)));
    }
}

fn add(page: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a text cannot fail.
    let _ = page.write_fmt(text);
}

/// Escapes a text for Markdown.
fn escaped(text: &str) -> String {
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
