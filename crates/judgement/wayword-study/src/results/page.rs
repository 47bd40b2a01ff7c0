//! Writes the results as one HTML page, which runs no scripts and loads nothing from elsewhere.

use super::{
    ResultVersion, StudyReport, escape, notes,
    plot::{self, DropOff, ForestPlot, LevelBars, WinMatrix},
    sheet::DataSheet,
    tables::{self, ResultTable},
};
use crate::StudyError;
use minijinja::{AutoEscape, Environment, UndefinedBehavior, context};
use serde::Serialize;

/// The figures under one rule of which participants count, as `version.html` takes them.
#[derive(Debug, Serialize)]
struct VersionView {
    name: &'static str,
    title: &'static str,
    rule: String,
    paper: Option<ResultTable>,
    forests: Vec<ForestPlot>,
    /// Plots of each condition minus the first one.
    less: Vec<ForestPlot>,
    /// The name of the first condition.
    minus: String,
    bars: Vec<LevelBars>,
    matrix: Option<WinMatrix>,
    pairs: Vec<ResultTable>,
    agreement: ResultTable,
    /// Tables that are shown only when a reader unfolds them.
    folded: Vec<ResultTable>,
}

/// A CSV file with its columns, as the template of the codebook takes it.
#[derive(Debug, Serialize)]
struct FileView {
    file: &'static str,
    line: &'static str,
    columns: Vec<[String; 4]>,
}

impl VersionView {
    fn new(results: &StudyReport, version: &ResultVersion) -> Self {
        let levels = tables::level_tables(results, version, true);
        let folded = [tables::figure_table(results, version)]
            .into_iter()
            .chain(tables::difference_table(results, version))
            .chain(levels);
        Self {
            name: version.name,
            title: version.title,
            rule: format!("{} {}", version.rule, notes::count_answers(version)),
            paper: tables::paper_table(results, version),
            forests: plot::figure_plots(results, version),
            less: plot::difference_plots(results, version),
            minus: version.differences.first().map_or_else(String::new, |first| escape::to_table_name(&first.minus)),
            bars: plot::level_bars(results, version),
            matrix: plot::win_matrix(version),
            pairs: tables::pair_tables(version),
            agreement: tables::agreement_table(version),
            folded: folded.collect(),
        }
    }
}

/// Renders the page.
pub(super) fn render_page(results: &StudyReport, sheets: &[DataSheet]) -> Result<String, StudyError> {
    let people = &results.people;
    let drop_off: Option<DropOff> = plot::drop_off(&people.by_position);
    let file = |sheet: &DataSheet| FileView {
        file: sheet.file,
        line: sheet.line,
        columns: sheet
            .columns
            .iter()
            .map(|column| {
                [column.name.to_owned(), column.meaning.clone(), column.unit.to_owned(), column.values.clone()]
            })
            .collect(),
    };
    let view = context! {
        title => escape::to_table_name(&results.title),
        subject => notes::describe_study(results),
        warnings => notes::collect_warnings(results),
        conditions => tables::condition_table(results),
        versions => results.versions.iter().map(|version| VersionView::new(results, version)).collect::<Vec<_>>(),
        people => [tables::submission_table(results), tables::attention_table(results)]
            .into_iter()
            .chain(tables::exclusion_table(results))
            .collect::<Vec<_>>(),
        end => tables::end_tables(results),
        shown_wording => tables::shown_wording_table(results),
        drop_off => drop_off,
        handed => [
            tables::handout_table("Drop-off by position", "Position", &people.by_position),
            tables::handout_table("Drop-off by condition", "Condition", &people.by_condition),
            tables::handout_table("Drop-off by item", "Item", &people.by_item),
        ],
        notes => notes::collect_notes(results),
        meanings => tables::meaning_table(results),
        wording => tables::wording_table(results),
        files => sheets.iter().map(file).collect::<Vec<_>>(),
    };
    load_templates().and_then(|templates| templates.get_template("index.html")?.render(view)).map_err(|error| {
        StudyError::refused_request(format!("the page of results cannot be drawn: {error:#}"), "report this as a bug")
    })
}

fn load_templates() -> Result<Environment<'static>, minijinja::Error> {
    let mut templates = Environment::new();
    templates.set_undefined_behavior(UndefinedBehavior::Strict);
    templates.set_auto_escape_callback(|name| if name.ends_with(".css") { AutoEscape::None } else { AutoEscape::Html });
    templates.set_trim_blocks(true);
    templates.set_lstrip_blocks(true);
    templates.add_template("index.html", include_str!("pages/index.html"))?;
    templates.add_template("version.html", include_str!("pages/version.html"))?;
    templates.add_template("macros.html", include_str!("pages/macros.html"))?;
    templates.add_template("style.css", include_str!("pages/style.css"))?;
    Ok(templates)
}
