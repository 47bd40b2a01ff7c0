//! Writes the results as one HTML page, which runs no scripts and loads nothing from elsewhere.

use super::{
    Results, Version, inert, notes,
    plot::{self, Bars, DropOff, Forest, Matrix},
    sheet::Sheet,
    tables::{self, Table},
};
use crate::StudyError;
use minijinja::{AutoEscape, Environment, UndefinedBehavior, context};
use serde::Serialize;

/// A version as the template takes it.
#[derive(Debug, Serialize)]
struct VersionView {
    name: &'static str,
    title: &'static str,
    rule: String,
    paper: Option<Table>,
    forests: Vec<Forest>,
    less: Vec<Forest>,
    minus: String,
    bars: Vec<Bars>,
    matrix: Option<Matrix>,
    pairs: Vec<Table>,
    agreement: Table,
    folded: Vec<Table>,
}

/// A file as the template takes it.
#[derive(Debug, Serialize)]
struct FileView {
    file: &'static str,
    line: &'static str,
    columns: Vec<[String; 4]>,
}

impl VersionView {
    fn new(results: &Results, version: &Version) -> Self {
        let levels = tables::levels(results, version, true);
        let folded =
            [tables::figures(results, version)].into_iter().chain(tables::differences(results, version)).chain(levels);
        Self {
            name: version.name,
            title: if version.name == "everybody" { "All answers" } else { "Finished and passed" },
            rule: format!("{} {} answers of {} persons.", version.rule, version.answers, version.persons),
            paper: tables::of_the_paper(results, version),
            forests: plot::forests(results, version),
            less: plot::less(results, version),
            minus: version.differences.first().map_or_else(String::new, |less| inert::name(&less.minus)),
            bars: plot::bars(results, version),
            matrix: plot::matrix(version),
            pairs: tables::pairs(version),
            agreement: tables::agreement(version),
            folded: folded.collect(),
        }
    }
}

/// Renders the page.
pub(super) fn page(results: &Results, sheets: &[Sheet]) -> Result<String, StudyError> {
    let people = &results.people;
    let drop_off: Option<DropOff> = plot::drop_off(&people.by_position);
    let file = |sheet: &Sheet| FileView {
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
        title => inert::name(&results.title),
        subject => notes::subject(results),
        warnings => notes::warnings(results),
        conditions => tables::conditions(results),
        versions => results.versions.iter().map(|version| VersionView::new(results, version)).collect::<Vec<_>>(),
        people => [tables::submissions(results), tables::attention(results)],
        drop_off => drop_off,
        handed => [
            tables::handed("Drop-off by position", "Position", &people.by_position),
            tables::handed("Drop-off by condition", "Condition", &people.by_condition),
            tables::handed("Drop-off by item", "Item", &people.by_item),
        ],
        notes => notes::notes(results),
        meanings => tables::meanings(results),
        wording => tables::wording(results),
        files => sheets.iter().map(file).collect::<Vec<_>>(),
    };
    templates().and_then(|templates| templates.get_template("index.html")?.render(view)).map_err(|error| {
        StudyError::refused(format!("the page of results cannot be drawn: {error:#}"), "report this as a bug")
    })
}

fn templates() -> Result<Environment<'static>, minijinja::Error> {
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
