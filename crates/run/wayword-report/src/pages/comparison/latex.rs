//! Writes a comparison as a LaTeX table for a paper.

use super::{
    figures::{ComparisonLine, SHORT_TABLE_METRICS, comparison_lines, metric_heading},
    notes,
};
use std::fmt::Write;
use wayword_metrics::escape_latex;
use wayword_navigation::comparison::AgentComparison;

/// The comparison as a LaTeX table; it needs the package `booktabs`.
#[must_use]
pub fn latex_table(comparison: &AgentComparison) -> String {
    let mut table =
        String::from("% \\usepackage{booktabs}\n\\begin{table}\n\\centering\n\\begin{tabular}{llrrr}\n\\toprule\n");
    let headings = SHORT_TABLE_METRICS.map(|metric| escape_latex(&metric_heading(metric)));
    append_text(&mut table, format_args!("Agent & Instructions & {} \\\\\n", headings.join(" & ")));
    for line in comparison_lines(comparison) {
        if line.opens {
            table.push_str("\\midrule\n");
        }
        let agent = if line.opens { escape_latex(&line.agent_with_kind()) } else { String::new() };
        append_text(
            &mut table,
            format_args!("{agent} & {} & {} \\\\\n", escape_latex(&line.label), line_figures(&line)),
        );
    }
    table.push_str("\\bottomrule\n\\end{tabular}\n\\caption{");
    for warning in notes::list_warnings(comparison) {
        append_text(&mut table, format_args!("\\textbf{{{}}}\n", escape_latex(&warning)));
    }
    let subject = notes::describe_subject(&comparison.about);
    append_text(
        &mut table,
        format_args!(
            "{}. {}}}\n",
            escape_latex(&subject),
            escape_latex(&notes::describe_success(comparison.about.rule))
        ),
    );
    table.push_str("\\par\\smallskip{\\footnotesize\n");
    for note in notes::listener_notes(comparison).into_iter().chain(notes::notes_of_table(comparison)) {
        append_text(&mut table, format_args!("{}\n", escape_latex(&note)));
    }
    table.push_str("\\par}\n\\end{table}\n");
    table
}

fn line_figures(line: &ComparisonLine<'_>) -> String {
    let cell = |metric| {
        line.rounded_figure(metric).map_or_else(
            || "--".to_owned(),
            |figure| format!("{} {{\\scriptsize {}}}", latex_number(&figure.mean), latex_number(&figure.interval())),
        )
    };
    SHORT_TABLE_METRICS.map(cell).join(" & ")
}

/// Numbers with a minus instead of a hyphen.
fn latex_number(text: &str) -> String {
    text.replace('-', "$-$")
}

fn append_text(table: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a text cannot fail.
    let _ = table.write_fmt(text);
}
