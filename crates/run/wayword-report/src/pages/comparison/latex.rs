//! Writes a comparison as a LaTeX table for a paper.

use super::{
    figures::{Line, SHOWN, heading, rows},
    notes,
};
use std::fmt::Write;
use wayword_navigation::comparison::Comparison;

/// The comparison as a LaTeX table; it needs the package `booktabs`.
#[must_use]
pub fn latex(comparison: &Comparison) -> String {
    let mut table =
        String::from("% \\usepackage{booktabs}\n\\begin{table}\n\\centering\n\\begin{tabular}{llrrr}\n\\toprule\n");
    let headings = SHOWN.map(|metric| escaped(&heading(metric)));
    add(&mut table, format_args!("Agent & Instructions & {} \\\\\n", headings.join(" & ")));
    for line in rows(comparison) {
        if line.opens {
            table.push_str("\\midrule\n");
        }
        let agent = if line.opens { escaped(&line.who()) } else { String::new() };
        add(&mut table, format_args!("{agent} & {} & {} \\\\\n", escaped(&line.label), figures(&line)));
    }
    table.push_str("\\bottomrule\n\\end{tabular}\n\\caption{");
    for warning in notes::warnings(comparison) {
        add(&mut table, format_args!("\\textbf{{{}}}\n", escaped(&warning)));
    }
    let subject = notes::subject(&comparison.about);
    add(&mut table, format_args!("{}. {}}}\n", escaped(&subject), escaped(&notes::success(comparison.about.rule))));
    table.push_str("\\par\\smallskip{\\footnotesize\n");
    for note in notes::listeners(comparison).into_iter().chain(notes::notes_of_table(comparison)) {
        add(&mut table, format_args!("{}\n", escaped(&note)));
    }
    table.push_str("\\par}\n\\end{table}\n");
    table
}

fn figures(line: &Line<'_>) -> String {
    let cell = |metric| {
        line.figure(metric).map_or_else(
            || "--".to_owned(),
            |figure| format!("{} {{\\scriptsize {}}}", number(&figure.mean), number(&figure.interval())),
        )
    };
    SHOWN.map(cell).join(" & ")
}

/// Numbers with a minus instead of a hyphen.
fn number(text: &str) -> String {
    text.replace('-', "$-$")
}

fn add(table: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a text cannot fail.
    let _ = table.write_fmt(text);
}

/// Escapes a text for LaTeX.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\\' => escaped.push_str("\\textbackslash{}"),
            '~' => escaped.push_str("\\textasciitilde{}"),
            '^' => escaped.push_str("\\textasciicircum{}"),
            '<' => escaped.push_str("\\textless{}"),
            '>' => escaped.push_str("\\textgreater{}"),
            '|' => escaped.push_str("\\textbar{}"),
            '"' => escaped.push_str("\\textquotedbl{}"),
            '†' => escaped.push_str("\\textdagger{}"),
            // After the end of a line of a table it would begin an option.
            '[' => escaped.push_str("{[}"),
            '…' => escaped.push_str("\\ldots{}"),
            '{' | '}' | '$' | '&' | '#' | '_' | '%' => escaped.extend(['\\', c]),
            c => escaped.push(c),
        }
    }
    escaped
}
