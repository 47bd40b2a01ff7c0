//! Writes the results as LaTeX tables for a paper.

use super::{
    Less, Measure, Results, Unit, Version,
    inert::{self, latex as escaped},
    notes,
    tables::{self, Table},
    words,
};
use crate::Kind;
use std::{collections::BTreeMap, fmt::Write};
use wayword_metrics::{Interval, Method};

/// How many conditions one table has side by side: as many as fit on a page with their intervals.
const ACROSS: usize = 3;

/// The comment at the top of the file: which packages the tables need.
const HEAD: &str = "% \\usepackage{booktabs}; names beyond Latin letters need LuaLaTeX or XeLaTeX\n";

/// If a table has more text columns than this, they get a fixed width, in which their lines break.
const MOST_WHOLE: usize = 3;
/// A table with longer rows than this is set in a smaller font.
const MOST_CHARS: usize = 60;

/// The results as LaTeX tables; they need the package `booktabs`.
pub(super) fn latex(results: &Results) -> String {
    let mut page = String::from(HEAD);
    add(&mut page, format_args!("% {}\n", escaped(&notes::subject(results))));
    for version in &results.versions {
        figures(&mut page, results, version);
        differences(&mut page, results, version);
        let all = tables::of_the_paper(results, version).into_iter().chain(tables::pairs(version));
        for one in all.chain(tables::levels(results, version, false)).chain([tables::agreement(version)]) {
            table(&mut page, &one, Some(version.rule));
        }
    }
    let by_position = tables::handed("Drop-off by position", "Position", &results.people.by_position);
    for one in [tables::submissions(results), tables::attention(results), by_position] {
        table(&mut page, &one, None);
    }
    if let Some(wording) = tables::wording(results) {
        table(&mut page, &wording, None);
    }
    page
}

/// A column of a table of figures: a condition.
struct Column<'a> {
    heads: [String; 2],
    figures: BTreeMap<&'a str, (f64, Option<&'a Interval>, Method)>,
    /// Answers, persons, routes.
    counts: Option<[usize; 3]>,
}

fn figures(page: &mut String, results: &Results, version: &Version) {
    let columns = version.rows.iter().map(|row| Column {
        heads: [inert::name(&row.condition), kind(row.kind).to_owned()],
        figures: row
            .figures
            .iter()
            .map(|(name, one)| (*name, (one.value, one.interval.as_ref(), one.method)))
            .collect(),
        counts: Some([row.answers, row.persons, row.items]),
    });
    let caption = format!("{} {}", inert::name(&results.title), version.rule);
    compact(page, results, &columns.collect::<Vec<_>>(), &caption);
}

fn differences(page: &mut String, results: &Results, version: &Version) {
    let Some(first) = version.differences.first() else { return };
    let kind_of =
        |less: &Less| version.rows.iter().find(|row| row.condition == less.condition).map_or("", |row| kind(row.kind));
    let columns = version.differences.iter().map(|less| Column {
        heads: [inert::name(&less.condition), kind_of(less).to_owned()],
        figures: less
            .figures
            .iter()
            .map(|(name, one)| (*name, (one.value, one.interval.as_ref(), one.method)))
            .collect(),
        counts: None,
    });
    let caption = format!("{} Minus {}. {}", inert::name(&results.title), inert::name(&first.minus), version.rule);
    compact(page, results, &columns.collect::<Vec<_>>(), &caption);
}

/// The second line of a column's heading: which kind of control the condition is, if it is one.
fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Run => "",
        Kind::People => "control: people",
        Kind::OtherPath => "control: other path",
    }
}

/// A figure with its interval, and as a superscript the letter of the method that gave the interval.
fn cell(measure: &Measure, figure: Option<&(f64, Option<&Interval>, Method)>) -> String {
    figure.map_or_else(
        || "--".to_owned(),
        |(value, interval, method)| {
            let value = escaped(&words::value(measure, *value));
            let ends = escaped(&words::interval(measure, *interval)).replace('–', "--");
            format!("{value} {{\\scriptsize {ends}\\textsuperscript{{{}}}}}", words::letter(*method))
        },
    )
}

/// The name of a figure with its unit, in short form.
fn heading(measure: &Measure) -> String {
    let unit = match measure.unit {
        Unit::PerCent => " (%)",
        Unit::Level => " (1 to 5)",
        Unit::Metres => " (m)",
        Unit::Seconds => " (s)",
        Unit::Count => "",
    };
    escaped(&format!("{}{unit}", measure.label))
}

/// A row for each figure, a column for each condition.
fn compact(page: &mut String, results: &Results, columns: &[Column<'_>], caption: &str) {
    for columns in columns.chunks(ACROSS) {
        begin(page, &"l".repeat(columns.len() + 1), false);
        for line in 0..2 {
            let heads: Vec<String> = columns.iter().map(|column| escaped(&column.heads[line])).collect();
            add(page, format_args!(" & {} \\\\\n", heads.join(" & ")));
        }
        page.push_str("\\midrule\n");
        for measure in results.measures {
            let cells: Vec<String> =
                columns.iter().map(|column| cell(measure, column.figures.get(measure.name))).collect();
            add(page, format_args!("{} & {} \\\\\n", heading(measure), cells.join(" & ")));
        }
        if columns.iter().all(|column| column.counts.is_some()) {
            page.push_str("\\midrule\n");
        }
        for (at, name) in ["Answers", "Persons", "Routes"].into_iter().enumerate() {
            let counts: Option<Vec<String>> =
                columns.iter().map(|column| column.counts.map(|counts| counts[at].to_string())).collect();
            if let Some(counts) = counts {
                add(page, format_args!("{name} & {} \\\\\n", counts.join(" & ")));
            }
        }
        let figures = || columns.iter().flat_map(|column| column.figures.values());
        let legend: Vec<String> = words::METHODS
            .into_iter()
            .filter(|method| *method != Method::None && figures().any(|(_, _, used)| used == method))
            .map(|method| format!("{}: {}", words::letter(method), words::method(method)))
            .collect();
        let legend =
            if legend.is_empty() { String::new() } else { format!(" Intervals of 95 %; {}.", legend.join(", ")) };
        end(page, &format!("{caption}{legend}"));
    }
}

fn begin(page: &mut String, columns: &str, is_wide: bool) {
    let size = if is_wide { "\\scriptsize\\setlength{\\tabcolsep}{3pt}" } else { "\\footnotesize" };
    add(page, format_args!("\n\\begin{{table}}\n\\centering{size}\n\\begin{{tabular}}{{{columns}}}\n\\toprule\n"));
}

fn end(page: &mut String, caption: &str) {
    add(page, format_args!("\\bottomrule\n\\end{{tabular}}\n\\caption{{{}}}\n\\end{{table}}\n", escaped(caption)));
}

fn table(page: &mut String, table: &Table, rule: Option<&str>) {
    if table.rows.is_empty() {
        return;
    }
    let texts = table.heads.iter().filter(|head| !head.is_number).count();
    let is_wide = chars(table) > MOST_CHARS;
    let column = |(at, is_number): (usize, bool)| match texts {
        _ if is_number => "r".to_owned(),
        _ if is_wide && at == 0 => "p{.22\\linewidth}".to_owned(),
        0..=MOST_WHOLE => "l".to_owned(),
        _ => format!("p{{{:.2}\\linewidth}}", 0.7 / texts as f64),
    };
    let columns: String = table.heads.iter().map(|head| head.is_number).enumerate().map(column).collect();
    let heads: Vec<String> = table.heads.iter().map(|head| escaped(&head.text)).collect();
    begin(page, &columns, is_wide);
    add(page, format_args!("{} \\\\\n\\midrule\n", heads.join(" & ")));
    for row in &table.rows {
        let cells: Vec<String> = row.cells.iter().map(|cell| escaped(cell)).collect();
        add(page, format_args!("{} \\\\\n", cells.join(" & ")));
    }
    let notes = table.notes.iter().map(String::as_str).chain(rule);
    let caption: Vec<String> = std::iter::once(format!("{}.", table.title)).chain(notes.map(str::to_owned)).collect();
    end(page, &caption.join(" "));
}

/// How many characters a row of a table has at most.
fn chars(table: &Table) -> usize {
    let widest = |at: usize| {
        let cells = table.rows.iter().filter_map(|row| row.cells.get(at)).map(|cell| cell.chars().count());
        cells.chain([table.heads[at].text.chars().count()]).max().unwrap_or(0)
    };
    (0..table.heads.len()).map(widest).sum()
}

fn add(page: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a text cannot fail.
    let _ = page.write_fmt(text);
}
