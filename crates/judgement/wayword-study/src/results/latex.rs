//! The results as tables for a paper.

use super::{
    Measure, Results, Version,
    inert::{self, latex as escaped},
    notes,
    tables::{self, Table},
    words,
};
use std::fmt::Write;
use wayword_metrics::{Interval, Method};

/// How many figures stand side by side: as many as fit a page with their intervals.
const ACROSS: usize = 3;

/// With more columns of text than this, their lines break.
const MOST_WHOLE: usize = 3;

/// The results as LaTeX tables; they need the package `booktabs`.
pub(super) fn latex(results: &Results) -> String {
    let mut page = String::from("% \\usepackage{booktabs}\n");
    add(&mut page, format_args!("% {}\n", escaped(&notes::subject(results))));
    for version in &results.versions {
        for measures in results.measures.chunks(ACROSS) {
            figures(&mut page, results, version, measures);
            differences(&mut page, results, version, measures);
        }
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

fn figures(page: &mut String, results: &Results, version: &Version, measures: &[Measure]) {
    let rows = version.rows.iter().map(|row| {
        let cell = |measure: &Measure| {
            row.figures.get(measure.name).map(|figure| (figure.value, figure.interval.as_ref(), figure.method))
        };
        let counts = format!("{} & {} & {}", row.answers, row.persons, row.items);
        (format!("{} & {counts}", escaped(&tables::title(&row.condition, row.kind))), cells(measures, cell))
    });
    let caption = format!("{} {}", inert::name(&results.title), version.rule);
    compact(page, "Condition & Answers & Persons & Routes", measures, rows, &caption);
}

fn differences(page: &mut String, results: &Results, version: &Version, measures: &[Measure]) {
    let Some(first) = version.differences.first() else { return };
    let rows = version.differences.iter().map(|less| {
        let cell = |measure: &Measure| {
            less.figures.get(measure.name).map(|figure| (figure.value, figure.interval.as_ref(), figure.method))
        };
        (escaped(&inert::name(&less.condition)), cells(measures, cell))
    });
    let caption = format!("{} Minus {}. {}", inert::name(&results.title), inert::name(&first.minus), version.rule);
    compact(page, "Condition", measures, rows, &caption);
}

/// A figure of each measure, with the letter of its method.
fn cells<'a>(
    measures: &[Measure],
    figure: impl Fn(&Measure) -> Option<(f64, Option<&'a Interval>, Method)>,
) -> (Vec<String>, Vec<Method>) {
    let cell = |measure: &Measure| match figure(measure) {
        None => ("--".to_owned(), Method::None),
        Some((value, interval, method)) => {
            let value = escaped(&words::value(measure, value));
            let ends = escaped(&words::interval(measure, interval)).replace('–', "--");
            (format!("{value} {{\\scriptsize {ends}\\textsuperscript{{{}}}}}", words::letter(method)), method)
        }
    };
    measures.iter().map(cell).unzip()
}

fn compact(
    page: &mut String,
    heads: &str,
    measures: &[Measure],
    rows: impl Iterator<Item = (String, (Vec<String>, Vec<Method>))>,
    caption: &str,
) {
    let texts = heads.matches('&').count();
    let columns = format!("l{}{}", "r".repeat(texts), "l".repeat(measures.len()));
    let headings: Vec<String> = measures.iter().map(|measure| escaped(&measure.heading())).collect();
    add(page, format_args!("\n\\begin{{table}}\n\\centering\\small\n\\begin{{tabular}}{{{columns}}}\n\\toprule\n"));
    add(page, format_args!("{heads} & {} \\\\\n\\midrule\n", headings.join(" & ")));
    let mut methods = Vec::new();
    for (label, (cells, used)) in rows {
        add(page, format_args!("{label} & {} \\\\\n", cells.join(" & ")));
        methods.extend(used);
    }
    let legend: Vec<String> = words::METHODS
        .into_iter()
        .filter(|method| *method != Method::None && methods.contains(method))
        .map(|method| format!("{}: {}", words::letter(method), words::method(method)))
        .collect();
    let legend = if legend.is_empty() { String::new() } else { format!(" Intervals of 95 %; {}.", legend.join(", ")) };
    let caption = escaped(&format!("{caption}{legend}"));
    add(page, format_args!("\\bottomrule\n\\end{{tabular}}\n\\caption{{{caption}}}\n\\end{{table}}\n"));
}

fn table(page: &mut String, table: &Table, rule: Option<&str>) {
    if table.rows.is_empty() {
        return;
    }
    let texts = table.heads.iter().filter(|head| !head.is_number).count();
    let columns: String = table.heads.iter().map(|head| column(head.is_number, texts)).collect();
    let heads: Vec<String> = table.heads.iter().map(|head| escaped(&head.text)).collect();
    add(page, format_args!("\n\\begin{{table}}\n\\centering\\small\n\\begin{{tabular}}{{{columns}}}\n\\toprule\n"));
    add(page, format_args!("{} \\\\\n\\midrule\n", heads.join(" & ")));
    for row in &table.rows {
        let cells: Vec<String> = row.cells.iter().map(|cell| escaped(cell)).collect();
        add(page, format_args!("{} \\\\\n", cells.join(" & ")));
    }
    let notes = table.notes.iter().map(String::as_str).chain(rule);
    let caption: Vec<String> = std::iter::once(format!("{}.", table.title)).chain(notes.map(str::to_owned)).collect();
    let caption = escaped(&caption.join(" "));
    add(page, format_args!("\\bottomrule\n\\end{{tabular}}\n\\caption{{{caption}}}\n\\end{{table}}\n"));
}

/// A column; where many hold text, their lines break.
fn column(is_number: bool, texts: usize) -> String {
    match texts {
        _ if is_number => "r".to_owned(),
        0..=MOST_WHOLE => "l".to_owned(),
        _ => format!("p{{{:.2}\\linewidth}}", 0.8 / texts as f64),
    }
}

fn add(page: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a text cannot fail.
    let _ = page.write_fmt(text);
}
