//! Draws the results of a robustness run as an HTML page. R is the measure of change: 1 means that a changed world makes no more
//! difference than writing again, 0 as much as another path.

mod curve;
pub mod results;
mod text_diff;

use super::{load_templates, replace_page, template_error};
use curve::CurveDrawing;
use minijinja::context;
use results::{ChangeResults, ExpectationResult, RobustnessFigure, RobustnessResults, StyleResults, TextPairExample};
use serde::Serialize;
use std::path::Path;
use text_diff::{ComparedWords, compare_words};
use wayword_metrics::MeanEstimate;
use wayword_run::{count::count_phrase, error::CommandError};

/// The kinds of statements, in the order of the table.
const STATEMENT_KINDS: [&str; 5] = ["landmarks", "turns", "rooms", "floors", "mean"];

/// Writes the page of a robustness run's results.
///
/// # Errors
/// When it cannot be written.
pub fn write_robustness(out: &Path, results: &RobustnessResults) -> Result<(), CommandError> {
    let page = robustness_html(results)?;
    replace_page(out, |take| take(&page))
}

/// The page as HTML.
///
/// # Errors
/// When it cannot be drawn, which is a bug.
pub(crate) fn robustness_html(results: &RobustnessResults) -> Result<String, CommandError> {
    let templates = load_templates().map_err(template_error)?;
    let styles: Vec<StyleResultsView> = results.styles.iter().map(StyleResultsView::from_results).collect();
    let view = context! {
        platform => results.platform,
        agent => results.agent,
        kinds => STATEMENT_KINDS,
        about => describe_run(results),
        warnings => list_warnings(results),
        refused => results.refused,
        notes => reading_notes(),
        styles,
    };
    templates.get_template("robustness.html").and_then(|page| page.render(view)).map_err(template_error)
}

/// The scope of the results: paths, scenes, roles, and level of the intervals.
fn describe_run(results: &RobustnessResults) -> String {
    let RobustnessResults { roles, paths, scenes, level, .. } = results;
    format!(
        "{} in {}. {roles}. Intervals cover {:.0} % and draw whole scenes.",
        count_phrase(*paths, "path"),
        count_phrase(*scenes, "scene"),
        level * 100.0
    )
}

fn list_warnings(results: &RobustnessResults) -> Vec<String> {
    let again = results.again;
    let differs = again.of - again.equal;
    let text = || {
        format!(
            "{} of the run's {} could not be written again as they are: another version of the program wrote them, or another eye sees. All figures compare texts of this version.",
            differs,
            count_phrase(again.of, "text")
        )
    };
    (differs > 0).then(text).into_iter().collect()
}

fn reading_notes() -> [&'static str; 5] {
    [
        "R = (S changed - S other) / (S again - S other). S is the agreement of two texts for one path: F1 of landmarks at the same frames, edit similarity of turns and of rooms, equality of what is said of floors.",
        "\"Again\" is the same world with another writing seed, or another sample of each model. \"Other\" is a text of another path of the same building with as many hops.",
        "A dash: fewer than 30 paths have such statements, or asking again is as far off as another path.",
        "The rows \"again\" and \"other path\" show the agreements themselves. R is the ratio of means over the same paths.",
        "Texts of labels and rules: labels perceive nothing, so these figures are about the writer and the geometry, not about a model's eyes.",
    ]
}

/// The results for the texts of one style, as the template shows them.
#[derive(Serialize)]
struct StyleResultsView {
    style: String,
    rows: Vec<RobustnessRow>,
    reasons: Vec<String>,
    expectations: Vec<ExpectationView>,
    curves: Vec<CurveDrawing>,
    examples: Vec<ExampleGroup>,
}

/// A row of the table of R: a change, or an anchor (the agreement of a text with one written again or with another path's).
#[derive(Serialize)]
struct RobustnessRow {
    change: String,
    is_anchor: bool,
    cells: Vec<RobustnessCell>,
    success: RobustnessCell,
    paths: String,
}

/// A figure with its interval, or a dash with the reason why there is no figure.
#[derive(Default, Serialize)]
struct RobustnessCell {
    figure: String,
    interval: String,
    reason: String,
}

/// A change with an exact expectation, and the share of texts that keep it.
#[derive(Serialize)]
struct ExpectationView {
    change: String,
    share: String,
    is_whole: bool,
    told: usize,
    expected: String,
}

/// The pairs of texts that are shown for one change.
#[derive(Serialize)]
struct ExampleGroup {
    change: String,
    examples: Vec<ExampleView>,
}

/// A text before and after a change, with the differing words marked.
#[derive(Serialize)]
struct ExampleView {
    path: String,
    note: String,
    before: Vec<ComparedWords>,
    after: Vec<ComparedWords>,
}

impl StyleResultsView {
    fn from_results(style: &StyleResults) -> Self {
        let mut rows: Vec<RobustnessRow> = anchor_rows(style);
        rows.extend(style.changes.iter().map(change_row));
        let of_changes = style.changes.iter().map(|result| (&result.change, &result.examples));
        let of_expectations = style.expectations.iter().map(|result| (&result.change, &result.examples));
        let groups = of_changes.chain(of_expectations).filter(|(_, examples)| !examples.is_empty());
        Self {
            style: style.style.clone(),
            reasons: missing_reasons(style),
            rows: if style.changes.is_empty() { Vec::new() } else { rows },
            expectations: style.expectations.iter().map(expectation_view).collect(),
            curves: style.curves.iter().map(CurveDrawing::from_curve).collect(),
            examples: groups
                .map(|(change, examples)| ExampleGroup {
                    change: change.clone(),
                    examples: examples.iter().map(example_view).collect(),
                })
                .collect(),
        }
    }
}

/// The rows with the agreements of a text with one written again, and with another path's. They are taken from the first change,
/// because they are nearly the same for all changes.
fn anchor_rows(style: &StyleResults) -> Vec<RobustnessRow> {
    let Some(first) = style.changes.first() else { return Vec::new() };
    let row = |change: &str, agreement: fn(&RobustnessFigure) -> Option<f64>| {
        let cell = |figure: &RobustnessFigure| RobustnessCell {
            figure: agreement(figure).map_or_else(dash_text, two_decimals),
            ..RobustnessCell::default()
        };
        RobustnessRow {
            change: change.to_owned(),
            is_anchor: true,
            cells: first.figures.iter().map(cell).collect(),
            success: RobustnessCell::default(),
            paths: String::new(),
        }
    };
    vec![row("S again", |figure| figure.repeat), row("S other path", |figure| figure.other)]
}

fn change_row(change: &ChangeResults) -> RobustnessRow {
    let cell = |figure: &RobustnessFigure| match &figure.r {
        Some(r) => with_interval(r, two_decimals),
        None => RobustnessCell {
            figure: dash_text(),
            reason: figure.reason.clone().unwrap_or_default(),
            ..RobustnessCell::default()
        },
    };
    RobustnessRow {
        change: change.change.clone(),
        is_anchor: false,
        cells: change.figures.iter().map(cell).collect(),
        success: change.success.as_ref().map_or_else(
            || RobustnessCell { figure: dash_text(), ..RobustnessCell::default() },
            |success| with_interval(success, |share| format!("{:+.1}", share * 100.0)),
        ),
        paths: match change.lost {
            0 => change.paths.to_string(),
            lost => format!("{} ({lost} lost)", change.paths),
        },
    }
}

fn with_interval(estimate: &MeanEstimate, shown: impl Fn(f64) -> String) -> RobustnessCell {
    let MeanEstimate { mean, low, high, .. } = *estimate;
    RobustnessCell {
        figure: shown(mean),
        interval: format!("[{}, {}]", shown(low), shown(high)),
        reason: String::new(),
    }
}

fn two_decimals(value: f64) -> String {
    format!("{value:.2}")
}

fn dash_text() -> String {
    "–".to_owned()
}

/// Why figures are missing, each reason once.
#[must_use]
pub fn missing_reasons(style: &StyleResults) -> Vec<String> {
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

fn expectation_view(result: &ExpectationResult) -> ExpectationView {
    ExpectationView {
        change: result.change.clone(),
        share: result.share_that_holds().map_or_else(dash_text, |share| format!("{:.1} %", share * 100.0)),
        is_whole: result.holds == result.told,
        told: result.told,
        expected: result.expected.clone(),
    }
}

fn example_view(example: &TextPairExample) -> ExampleView {
    let (before, after) = compare_words(&example.before, &example.after);
    ExampleView { path: example.path.clone(), note: example.note.clone(), before, after }
}
