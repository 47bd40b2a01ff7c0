//! Draws the results of a robustness run as an HTML page. R is the measure of change: 1 means that a changed world makes no more
//! difference than writing again, 0 as much as another path.

mod curve;
pub mod results;
mod words;

use super::{broken, replace, templates};
use curve::Drawing;
use minijinja::context;
use results::{Example, Expectation, Figure, OfChange, OfStyle, Results};
use serde::Serialize;
use std::path::Path;
use wayword_metrics::Estimate;
use wayword_run::{count::count, error::Error};
use words::{Words, beside};

/// The kinds of statements, in the order of the table.
const KINDS: [&str; 5] = ["landmarks", "turns", "rooms", "floors", "mean"];

/// Writes the page of a robustness run's results.
///
/// # Errors
/// When it cannot be written.
pub fn write(out: &Path, results: &Results) -> Result<(), Error> {
    let page = html(results)?;
    replace(out, |take| take(&page))
}

/// The page as HTML.
///
/// # Errors
/// When it cannot be drawn, which is a bug.
pub(crate) fn html(results: &Results) -> Result<String, Error> {
    let templates = templates().map_err(broken)?;
    let styles: Vec<StyleView> = results.styles.iter().map(StyleView::of).collect();
    let view = context! {
        platform => results.platform,
        agent => results.agent,
        kinds => KINDS,
        about => about(results),
        warnings => warnings(results),
        refused => results.refused,
        notes => notes(),
        styles,
    };
    templates.get_template("robustness.html").and_then(|page| page.render(view)).map_err(broken)
}

/// The scope of the results: paths, scenes, roles, and level of the intervals.
fn about(results: &Results) -> String {
    let Results { roles, paths, scenes, level, .. } = results;
    format!(
        "{} in {}. {roles}. Intervals cover {:.0} % and draw whole scenes.",
        count(*paths, "path"),
        count(*scenes, "scene"),
        level * 100.0
    )
}

fn warnings(results: &Results) -> Vec<String> {
    let again = results.again;
    let differs = again.of - again.equal;
    let text = || {
        format!(
            "{} of the run's {} could not be written again as they are: another version of the program wrote them, or another eye sees. All figures compare texts of this version.",
            differs,
            count(again.of, "text")
        )
    };
    (differs > 0).then(text).into_iter().collect()
}

fn notes() -> [&'static str; 5] {
    [
        "R = (S changed - S other) / (S again - S other). S is the agreement of two texts for one path: F1 of landmarks at the same frames, edit similarity of turns and of rooms, equality of what is said of floors.",
        "\"Again\" is the same world with another writing seed, or another sample of each model. \"Other\" is a text of another path of the same building with as many hops.",
        "A dash: fewer than 30 paths have such statements, or asking again is as far off as another path.",
        "The rows \"again\" and \"other path\" show the agreements themselves. R is the ratio of means over the same paths.",
        "Texts of labels and rules: labels perceive nothing, so these figures are about the writer and the geometry, not about a model's eyes.",
    ]
}

#[derive(Serialize)]
struct StyleView {
    style: String,
    rows: Vec<Row>,
    reasons: Vec<String>,
    expectations: Vec<ExpectationView>,
    curves: Vec<Drawing>,
    examples: Vec<Group>,
}

#[derive(Serialize)]
struct Row {
    change: String,
    is_anchor: bool,
    cells: Vec<Cell>,
    success: Cell,
    paths: String,
}

#[derive(Default, Serialize)]
struct Cell {
    figure: String,
    interval: String,
    reason: String,
}

#[derive(Serialize)]
struct ExpectationView {
    change: String,
    share: String,
    is_whole: bool,
    told: usize,
    expected: String,
}

#[derive(Serialize)]
struct Group {
    change: String,
    examples: Vec<ExampleView>,
}

#[derive(Serialize)]
struct ExampleView {
    path: String,
    note: String,
    before: Vec<Words>,
    after: Vec<Words>,
}

impl StyleView {
    fn of(style: &OfStyle) -> Self {
        let mut rows: Vec<Row> = anchors(style);
        rows.extend(style.changes.iter().map(row));
        let of_changes = style.changes.iter().map(|one| (&one.change, &one.examples));
        let of_expectations = style.expectations.iter().map(|one| (&one.change, &one.examples));
        let groups = of_changes.chain(of_expectations).filter(|(_, examples)| !examples.is_empty());
        Self {
            style: style.style.clone(),
            reasons: reasons(style),
            rows: if style.changes.is_empty() { Vec::new() } else { rows },
            expectations: style.expectations.iter().map(expectation).collect(),
            curves: style.curves.iter().map(Drawing::of).collect(),
            examples: groups
                .map(|(change, examples)| Group {
                    change: change.clone(),
                    examples: examples.iter().map(example).collect(),
                })
                .collect(),
        }
    }
}

/// The agreements of a text with one written again, and with another path's: of the first change, because all have nearly
/// the same.
fn anchors(style: &OfStyle) -> Vec<Row> {
    let Some(first) = style.changes.first() else { return Vec::new() };
    let row = |change: &str, of: fn(&Figure) -> Option<f64>| {
        let cell = |figure: &Figure| Cell { figure: of(figure).map_or_else(dash, two), ..Cell::default() };
        Row {
            change: change.to_owned(),
            is_anchor: true,
            cells: first.figures.iter().map(cell).collect(),
            success: Cell::default(),
            paths: String::new(),
        }
    };
    vec![row("S again", |figure| figure.repeat), row("S other path", |figure| figure.other)]
}

fn row(change: &OfChange) -> Row {
    let cell = |figure: &Figure| match &figure.r {
        Some(r) => with_interval(r, two),
        None => Cell { figure: dash(), reason: figure.reason.clone().unwrap_or_default(), ..Cell::default() },
    };
    Row {
        change: change.change.clone(),
        is_anchor: false,
        cells: change.figures.iter().map(cell).collect(),
        success: change.success.as_ref().map_or_else(
            || Cell { figure: dash(), ..Cell::default() },
            |success| with_interval(success, |share| format!("{:+.1}", share * 100.0)),
        ),
        paths: match change.lost {
            0 => change.paths.to_string(),
            lost => format!("{} ({lost} lost)", change.paths),
        },
    }
}

fn with_interval(estimate: &Estimate, shown: impl Fn(f64) -> String) -> Cell {
    let Estimate { mean, low, high, .. } = *estimate;
    Cell { figure: shown(mean), interval: format!("[{}, {}]", shown(low), shown(high)), reason: String::new() }
}

fn two(value: f64) -> String {
    format!("{value:.2}")
}

fn dash() -> String {
    "–".to_owned()
}

/// Why figures are missing, each reason once.
fn reasons(style: &OfStyle) -> Vec<String> {
    let mut reasons: Vec<String> = Vec::new();
    for figure in style.changes.iter().flat_map(|change| &change.figures) {
        let Some(reason) = &figure.reason else { continue };
        let reason = format!("No R of {}: {reason}.", figure.kind);
        if !reasons.contains(&reason) {
            reasons.push(reason);
        }
    }
    reasons
}

fn expectation(one: &Expectation) -> ExpectationView {
    ExpectationView {
        change: one.change.clone(),
        share: one.share().map_or_else(dash, |share| format!("{:.1} %", share * 100.0)),
        is_whole: one.holds == one.told,
        told: one.told,
        expected: one.expected.clone(),
    }
}

fn example(example: &Example) -> ExampleView {
    let (before, after) = beside(&example.before, &example.after);
    ExampleView { path: example.path.clone(), note: example.note.clone(), before, after }
}
