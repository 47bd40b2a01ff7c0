//! Writes the results as Markdown.

use super::{
    Results,
    inert::{self, markdown as escaped},
    notes,
    sheet::Sheet,
    tables::{self, Table},
};
use std::fmt::Write;

/// The whole report as Markdown. Its last section is the codebook: the meaning of every column of the CSV files.
pub(super) fn markdown(results: &Results, sheets: &[Sheet]) -> String {
    let mut page = format!("# {}\n\n{}\n\n", escaped(&inert::name(&results.title)), escaped(&notes::subject(results)));
    for warning in notes::warnings(results) {
        add(&mut page, format_args!("> **{}**\n\n", escaped(&warning)));
    }
    table(&mut page, 2, &tables::conditions(results));
    for version in &results.versions {
        let title = if version.name == "everybody" { "Figures: all answers" } else { "Figures: finished and passed" };
        let counts = format!("{} answers of {} persons.", version.answers, version.persons);
        add(&mut page, format_args!("## {title}\n\n{} {counts}\n\n", escaped(version.rule)));
        let paper = tables::of_the_paper(results, version);
        let all = paper.into_iter().chain(tables::pairs(version)).chain([tables::figures(results, version)]);
        for one in all.chain(tables::differences(results, version)) {
            table(&mut page, 3, &one);
        }
        for one in tables::levels(results, version, true).iter().chain([&tables::agreement(version)]) {
            table(&mut page, 3, one);
        }
    }
    page.push_str("## People\n\n");
    let people = &results.people;
    table(&mut page, 3, &tables::submissions(results));
    table(&mut page, 3, &tables::attention(results));
    table(&mut page, 3, &tables::handed("Drop-off by position", "Position", &people.by_position));
    table(&mut page, 3, &tables::handed("Drop-off by condition", "Condition", &people.by_condition));
    table(&mut page, 3, &tables::handed("Drop-off by item", "Item", &people.by_item));
    page.push_str("## How to read it\n\n");
    for note in notes::notes(results) {
        add(&mut page, format_args!("- {}\n", escaped(&note)));
    }
    page.push('\n');
    table(&mut page, 2, &tables::meanings(results));
    if let Some(wording) = tables::wording(results) {
        table(&mut page, 2, &wording);
    }
    codebook(&mut page, sheets);
    page
}

fn table(page: &mut String, depth: usize, table: &Table) {
    add(page, format_args!("{} {}\n\n", "#".repeat(depth), escaped(&table.title)));
    if !table.rows.is_empty() {
        let heads: Vec<String> = table.heads.iter().map(|head| escaped(&head.text)).collect();
        let rules: Vec<&str> = table.heads.iter().map(|head| if head.is_number { "---:" } else { "---" }).collect();
        add(page, format_args!("| {} |\n| {} |\n", heads.join(" | "), rules.join(" | ")));
        for row in &table.rows {
            let cells: Vec<String> = row.cells.iter().map(|cell| escaped(cell)).collect();
            add(page, format_args!("| {} |\n", cells.join(" | ")));
        }
        page.push('\n');
    }
    for note in &table.notes {
        add(page, format_args!("{}\n\n", escaped(note)));
    }
}

fn codebook(page: &mut String, sheets: &[Sheet]) {
    page.push_str("## Files\n\n");
    page.push_str(
        "CSV as in RFC 4180, UTF-8. Times are seconds after the participant's consent; no file has a clock or a date. Text that \
         begins like a formula, or with an apostrophe, has one apostrophe in front: take one away. Characters that cannot be seen are \
         replaced by U+FFFD.\n\n",
    );
    for sheet in sheets {
        add(page, format_args!("### {}\n\nA line is {}.\n\n", sheet.file, escaped(sheet.line)));
        page.push_str("| Column | Meaning | Unit | Values |\n| --- | --- | --- | --- |\n");
        for column in &sheet.columns {
            let cells = [column.name, &column.meaning, column.unit, &column.values].map(escaped);
            add(page, format_args!("| {} |\n", cells.join(" | ")));
        }
        page.push('\n');
    }
}

fn add(page: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a text cannot fail.
    let _ = page.write_fmt(text);
}
