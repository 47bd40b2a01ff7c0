//! Prints the results of a robustness run, and the list of all changes.

use serde::Serialize;
use std::fmt::Write as _;
use wayword_metrics::MeanEstimate;
use wayword_report::pages::robustness::{
    missing_reasons,
    results::{ChangeResults, ExpectationResult, RobustnessFigure, RobustnessResults},
};
use wayword_robustness::{Change, DoseKind, WholeChange};

/// A change as `--list --json` has it.
#[derive(Debug, Serialize)]
pub(super) struct ListedChange {
    name: &'static str,
    unit: Option<&'static str>,
    range: Option<(f64, f64)>,
    unchanged: Option<f64>,
    is_default: bool,
    what: String,
}

/// All changes.
pub(super) fn list_changes() -> Vec<ListedChange> {
    let default = Change::default_set();
    let is_default = |name: &str| default.iter().any(|change| change.name() == name);
    let whole = WholeChange::ALL.into_iter().map(|whole| ListedChange {
        name: whole.name(),
        unit: None,
        range: None,
        unchanged: None,
        is_default: is_default(whole.name()),
        what: whole.describe_effect().to_owned(),
    });
    let dosed = DoseKind::ALL.into_iter().map(|dose| ListedChange {
        name: dose.name(),
        unit: Some(dose.unit()),
        range: Some(dose.value_range()),
        unchanged: dose.unchanged_value(),
        is_default: is_default(dose.name()),
        what: format!("as in {}={}", dose.name(), dose.example_values()),
    });
    let platform = ListedChange {
        name: "platform",
        unit: None,
        range: None,
        unchanged: None,
        is_default: is_default("platform"),
        what: "The same poses on another platform: habitat and recording are made from generated houses; others as in \
               process:FILE, tdw@ADDRESS."
            .to_owned(),
    };
    [platform].into_iter().chain(whole).chain(dosed).collect()
}

/// The list of all changes as text, with the default set.
pub(super) fn format_change_list() -> String {
    let mut text = String::from("changes:\n");
    for ListedChange { name, unit, range, what, .. } in list_changes() {
        let doses = range.map(|(low, high)| format!("{low} to {high} {}; ", unit.unwrap_or_default()));
        let _ = writeln!(text, "  {name:<24} {}{what}", doses.unwrap_or_default());
    }
    let set: Vec<String> = Change::default_set().iter().map(ToString::to_string).collect();
    let _ = write!(text, "default set: {}", set.join(", "));
    text
}

/// The results as text: a table of R for each style, then the expectations.
pub(super) fn format_results(results: &RobustnessResults) -> String {
    let mut text = String::new();
    for style in &results.styles {
        let _ = writeln!(text, "style {}", style.style);
        if let Some(first) = style.changes.first() {
            let _ = writeln!(text, "{:<28}{}  success", "R", figure_heading(&first.figures));
            for change in &style.changes {
                let _ = writeln!(text, "{}", change_row(change));
            }
        }
        for reason in missing_reasons(style) {
            let _ = writeln!(text, "{reason}");
        }
        for expectation in &style.expectations {
            let _ = writeln!(text, "{}", expectation_row(expectation));
        }
    }
    text
}

fn figure_heading(figures: &[RobustnessFigure]) -> String {
    figures.iter().map(|figure| format!(" {:>10}", figure.kind)).collect()
}

fn change_row(change: &ChangeResults) -> String {
    let cell = |figure: &RobustnessFigure| match figure.r {
        Some(MeanEstimate { mean, .. }) => format!(" {mean:>10.2}"),
        None => format!(" {:>10}", "-"),
    };
    let figures: String = change.figures.iter().map(cell).collect();
    let success = change.success.map_or_else(
        || "-".to_owned(),
        |MeanEstimate { mean, low, high, .. }| {
            format!("{:+.1} [{:+.1}, {:+.1}]", mean * 100.0, low * 100.0, high * 100.0)
        },
    );
    format!("{:<28}{figures}  {success}", change.change)
}

fn expectation_row(expectation: &ExpectationResult) -> String {
    let ExpectationResult { change, expected, told, holds, .. } = expectation;
    let share =
        expectation.share_that_holds().map_or_else(|| "-".to_owned(), |share| format!("{:.1} %", share * 100.0));
    format!("{change:<28} {share:>10}  {holds} of {told}: {expected}")
}
