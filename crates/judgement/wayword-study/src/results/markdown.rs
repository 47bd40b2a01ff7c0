//! Writes the results as Markdown.

use super::{
    StudyReport,
    escape::{self, escape_markdown as escaped},
    notes,
    sheet::DataSheet,
    tables::{self, ResultTable},
};
use std::fmt::Write;

/// The whole report as Markdown. Its last section is the codebook: the meaning of every column of the CSV files.
pub(super) fn render_markdown(results: &StudyReport, sheets: &[DataSheet]) -> String {
    let mut page = format!(
        "# {}\n\n{}\n\n",
        escaped(&escape::to_table_name(&results.title)),
        escaped(&notes::describe_study(results))
    );
    for warning in notes::collect_warnings(results) {
        append_text(&mut page, format_args!("> **{}**\n\n", escaped(&warning)));
    }
    add_table(&mut page, 2, &tables::condition_table(results));
    for version in &results.versions {
        let (title, counts) = (version.title, notes::count_answers(version));
        append_text(&mut page, format_args!("## Figures: {title}\n\n{} {counts}\n\n", escaped(version.rule)));
        let paper = tables::paper_table(results, version);
        let version_tables =
            paper.into_iter().chain(tables::pair_tables(version)).chain([tables::figure_table(results, version)]);
        for table in version_tables.chain(tables::difference_table(results, version)) {
            add_table(&mut page, 3, &table);
        }
        for table in tables::level_tables(results, version, true).iter().chain([&tables::agreement_table(version)]) {
            add_table(&mut page, 3, table);
        }
    }
    page.push_str("## People\n\n");
    let people = &results.people;
    add_table(&mut page, 3, &tables::submission_table(results));
    add_table(&mut page, 3, &tables::attention_table(results));
    for table in tables::exclusion_table(results).iter().chain(&tables::end_tables(results)) {
        add_table(&mut page, 3, table);
    }
    add_table(&mut page, 3, &tables::handout_table("Drop-off by position", "Position", &people.by_position));
    add_table(&mut page, 3, &tables::handout_table("Drop-off by condition", "Condition", &people.by_condition));
    add_table(&mut page, 3, &tables::handout_table("Drop-off by item", "Item", &people.by_item));
    page.push_str("## How to read it\n\n");
    for note in notes::collect_notes(results) {
        append_text(&mut page, format_args!("- {}\n", escaped(&note)));
    }
    page.push('\n');
    add_table(&mut page, 2, &tables::meaning_table(results));
    if let Some(wording) = tables::wording_table(results) {
        add_table(&mut page, 2, &wording);
    }
    if let Some(shown) = tables::shown_wording_table(results) {
        add_table(&mut page, 2, &shown);
    }
    add_codebook(&mut page, sheets);
    page
}

/// A table in Markdown. `depth` is the level of its heading.
fn add_table(page: &mut String, depth: usize, table: &ResultTable) {
    append_text(page, format_args!("{} {}\n\n", "#".repeat(depth), escaped(&table.title)));
    if !table.rows.is_empty() {
        let heads: Vec<String> = table.heads.iter().map(|head| escaped(&head.text)).collect();
        let rules: Vec<&str> = table.heads.iter().map(|head| if head.is_number { "---:" } else { "---" }).collect();
        append_text(page, format_args!("| {} |\n| {} |\n", heads.join(" | "), rules.join(" | ")));
        for row in &table.rows {
            let cells: Vec<String> = row.cells.iter().map(|cell| escaped(cell)).collect();
            append_text(page, format_args!("| {} |\n", cells.join(" | ")));
        }
        page.push('\n');
    }
    for note in &table.notes {
        append_text(page, format_args!("{}\n\n", escaped(note)));
    }
}

fn add_codebook(page: &mut String, sheets: &[DataSheet]) {
    page.push_str("## Files\n\n");
    page.push_str(
        "CSV as in RFC 4180, UTF-8. Times are seconds after the participant's consent; no file has a clock or a date. Text that \
         begins like a formula, or with an apostrophe, has one apostrophe in front: take one away. Characters that cannot be seen are \
         replaced by U+FFFD.\n\n",
    );
    for sheet in sheets {
        append_text(page, format_args!("### {}\n\nA line is {}.\n\n", sheet.file, escaped(sheet.line)));
        page.push_str("| Column | Meaning | Unit | Values |\n| --- | --- | --- | --- |\n");
        for column in &sheet.columns {
            let cells = [column.name, &column.meaning, column.unit, &column.values].map(escaped);
            append_text(page, format_args!("| {} |\n", cells.join(" | ")));
        }
        page.push('\n');
    }
}

fn append_text(page: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a text cannot fail.
    let _ = page.write_fmt(text);
}
