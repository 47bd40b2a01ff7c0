//! Writes the results as LaTeX tables for a paper.

use super::{
    ConditionDifference, MeasureUnit, ResultVersion, StudyMeasure, StudyReport,
    escape::{self, escape_latex as escaped},
    notes, number_format,
    tables::{self, ResultTable},
};
use crate::ConditionKind;
use std::{collections::BTreeMap, fmt::Write};
use wayword_metrics::{ConfidenceInterval, IntervalMethod};

/// How many conditions one table has side by side: as many as fit on a page with their intervals.
const CONDITIONS_PER_LATEX_TABLE: usize = 3;

/// The comment at the top of the file: which packages the tables need.
const LATEX_HEADER_COMMENT: &str = "% \\usepackage{booktabs}; names beyond Latin letters need LuaLaTeX or XeLaTeX\n";

/// If a table has more text columns than this, they get a fixed width, in which their lines break.
const MAX_UNWRAPPED_TEXT_COLUMNS: usize = 3;
/// A table with longer rows than this, characters, is set in a smaller font.
const MAX_NORMAL_ROW_CHARS: usize = 60;

/// The results as LaTeX tables; they need the package `booktabs`.
pub(super) fn render_latex(results: &StudyReport) -> String {
    let mut page = String::from(LATEX_HEADER_COMMENT);
    append_text(&mut page, format_args!("% {}\n", escaped(&notes::describe_study(results))));
    for version in &results.versions {
        add_figure_tables(&mut page, results, version);
        add_difference_tables(&mut page, results, version);
        let version_tables = tables::paper_table(results, version).into_iter().chain(tables::pair_tables(version));
        for table in version_tables
            .chain(tables::level_tables(results, version, false))
            .chain([tables::agreement_table(version)])
        {
            add_table(&mut page, &table, Some(version.rule));
        }
    }
    let by_position = tables::handout_table("Drop-off by position", "Position", &results.people.by_position);
    let people = [tables::submission_table(results), tables::attention_table(results)].into_iter();
    for table in people.chain(tables::exclusion_table(results)).chain([by_position]).chain(tables::end_tables(results))
    {
        add_table(&mut page, &table, None);
    }
    if let Some(wording) = tables::wording_table(results) {
        add_table(&mut page, &wording, None);
    }
    page
}

/// A column of a table of figures: a condition.
struct LatexColumn<'a> {
    /// The two lines of its heading.
    heads: [String; 2],
    /// By the name of the figure: the value, its interval, and the method of the interval.
    figures: BTreeMap<&'a str, (f64, Option<&'a ConfidenceInterval>, IntervalMethod)>,
    /// Answers, persons, routes.
    counts: Option<[usize; 3]>,
}

/// Tables with the figures of each condition.
fn add_figure_tables(page: &mut String, results: &StudyReport, version: &ResultVersion) {
    let columns = version.rows.iter().map(|row| LatexColumn {
        heads: [escape::to_table_name(&row.condition), control_label(row.kind).to_owned()],
        figures: row
            .figures
            .iter()
            .map(|(name, figure)| (*name, (figure.value, figure.interval.as_ref(), figure.method)))
            .collect(),
        counts: Some([row.answers, row.persons, row.items]),
    });
    let caption = format!("{} {}", escape::to_table_name(&results.title), version.rule);
    add_compact_tables(page, results, &columns.collect::<Vec<_>>(), &caption);
}

/// Tables with each condition minus the first one, if there are differences.
fn add_difference_tables(page: &mut String, results: &StudyReport, version: &ResultVersion) {
    let Some(first) = version.differences.first() else { return };
    let kind_of = |difference: &ConditionDifference| {
        version.rows.iter().find(|row| row.condition == difference.condition).map_or("", |row| control_label(row.kind))
    };
    let columns = version.differences.iter().map(|difference| LatexColumn {
        heads: [escape::to_table_name(&difference.condition), kind_of(difference).to_owned()],
        figures: difference
            .figures
            .iter()
            .map(|(name, figure)| (*name, (figure.value, figure.interval.as_ref(), figure.method)))
            .collect(),
        counts: None,
    });
    let caption = format!(
        "{} Minus {}. {}",
        escape::to_table_name(&results.title),
        escape::to_table_name(&first.minus),
        version.rule
    );
    add_compact_tables(page, results, &columns.collect::<Vec<_>>(), &caption);
}

/// The second line of a column's heading: which kind of control the condition is, if it is one.
fn control_label(kind: ConditionKind) -> &'static str {
    match kind {
        ConditionKind::Run => "",
        ConditionKind::People => "control: people",
        ConditionKind::OtherPath => "control: other path",
        ConditionKind::Corrupted => "control: corrupted",
    }
}

/// A figure with its interval, and as a superscript the letter of the method that gave the interval.
fn figure_cell(measure: &StudyMeasure, figure: Option<&(f64, Option<&ConfidenceInterval>, IntervalMethod)>) -> String {
    figure.map_or_else(
        || "--".to_owned(),
        |(value, interval, method)| {
            let value = escaped(&number_format::format_value(measure, *value));
            let ends = escaped(&number_format::format_interval(measure, *interval)).replace('–', "--");
            format!("{value} {{\\scriptsize {ends}\\textsuperscript{{{}}}}}", number_format::method_letter(*method))
        },
    )
}

/// The name of a figure with its unit, in short form.
fn figure_heading(measure: &StudyMeasure) -> String {
    let unit = match measure.unit {
        MeasureUnit::PerCent => " (%)",
        MeasureUnit::Level => " (1 to 5)",
        MeasureUnit::Metres => " (m)",
        MeasureUnit::Seconds => " (s)",
        MeasureUnit::Count => "",
    };
    escaped(&format!("{}{unit}", measure.label))
}

/// A row for each figure, a column for each condition.
fn add_compact_tables(page: &mut String, results: &StudyReport, columns: &[LatexColumn<'_>], caption: &str) {
    for columns in columns.chunks(CONDITIONS_PER_LATEX_TABLE) {
        begin_table(page, &"l".repeat(columns.len() + 1), false);
        for line in 0..2 {
            let heads: Vec<String> = columns.iter().map(|column| escaped(&column.heads[line])).collect();
            append_text(page, format_args!(" & {} \\\\\n", heads.join(" & ")));
        }
        page.push_str("\\midrule\n");
        for measure in results.measures {
            let cells: Vec<String> =
                columns.iter().map(|column| figure_cell(measure, column.figures.get(measure.name))).collect();
            append_text(page, format_args!("{} & {} \\\\\n", figure_heading(measure), cells.join(" & ")));
        }
        if columns.iter().all(|column| column.counts.is_some()) {
            page.push_str("\\midrule\n");
        }
        for (at, name) in ["Answers", "Persons", "Routes"].into_iter().enumerate() {
            let counts: Option<Vec<String>> =
                columns.iter().map(|column| column.counts.map(|counts| counts[at].to_string())).collect();
            if let Some(counts) = counts {
                append_text(page, format_args!("{name} & {} \\\\\n", counts.join(" & ")));
            }
        }
        let figures = || columns.iter().flat_map(|column| column.figures.values());
        let legend: Vec<String> = number_format::ALL_METHODS
            .into_iter()
            .filter(|method| *method != IntervalMethod::None && figures().any(|(_, _, used)| used == method))
            .map(|method| format!("{}: {}", number_format::method_letter(method), number_format::method_name(method)))
            .collect();
        let legend =
            if legend.is_empty() { String::new() } else { format!(" Intervals of 95 %; {}.", legend.join(", ")) };
        end_table(page, &format!("{caption}{legend}"));
    }
}

fn begin_table(page: &mut String, columns: &str, is_wide: bool) {
    let size = if is_wide { "\\scriptsize\\setlength{\\tabcolsep}{3pt}" } else { "\\footnotesize" };
    append_text(
        page,
        format_args!("\n\\begin{{table}}\n\\centering{size}\n\\begin{{tabular}}{{{columns}}}\n\\toprule\n"),
    );
}

fn end_table(page: &mut String, caption: &str) {
    append_text(
        page,
        format_args!("\\bottomrule\n\\end{{tabular}}\n\\caption{{{}}}\n\\end{{table}}\n", escaped(caption)),
    );
}

/// A table in LaTeX. `rule` is a sentence about which answers count; it goes into the caption.
fn add_table(page: &mut String, table: &ResultTable, rule: Option<&str>) {
    if table.rows.is_empty() {
        return;
    }
    let text_columns = table.heads.iter().filter(|head| !head.is_number).count();
    let is_wide = row_width_chars(table) > MAX_NORMAL_ROW_CHARS;
    let column = |(at, is_number): (usize, bool)| match text_columns {
        _ if is_number => "r".to_owned(),
        _ if is_wide && at == 0 => "p{.22\\linewidth}".to_owned(),
        0..=MAX_UNWRAPPED_TEXT_COLUMNS => "l".to_owned(),
        _ => format!("p{{{:.2}\\linewidth}}", 0.7 / text_columns as f64),
    };
    let columns: String = table.heads.iter().map(|head| head.is_number).enumerate().map(column).collect();
    let heads: Vec<String> = table.heads.iter().map(|head| escaped(&head.text)).collect();
    begin_table(page, &columns, is_wide);
    append_text(page, format_args!("{} \\\\\n\\midrule\n", heads.join(" & ")));
    for row in &table.rows {
        let cells: Vec<String> = row.cells.iter().map(|cell| escaped(cell)).collect();
        append_text(page, format_args!("{} \\\\\n", cells.join(" & ")));
    }
    let notes = table.notes.iter().map(String::as_str).chain(rule);
    let caption: Vec<String> = std::iter::once(format!("{}.", table.title)).chain(notes.map(str::to_owned)).collect();
    end_table(page, &caption.join(" "));
}

/// How many characters a row of a table has at most.
fn row_width_chars(table: &ResultTable) -> usize {
    let widest = |at: usize| {
        let cells = table.rows.iter().filter_map(|row| row.cells.get(at)).map(|cell| cell.chars().count());
        cells.chain([table.heads[at].text.chars().count()]).max().unwrap_or(0)
    };
    (0..table.heads.len()).map(widest).sum()
}

fn append_text(page: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a text cannot fail.
    let _ = page.write_fmt(text);
}
