//! Prints the results of a robustness run, and the list of all changes.

use serde::Serialize;
use std::fmt::Write as _;
use wayword_metrics::Estimate;
use wayword_report::pages::robustness::results::{Expectation, Figure, OfChange, Results};
use wayword_robustness::{Change, Dose, Whole};

/// A change as `--list --json` has it.
#[derive(Debug, Serialize)]
pub(super) struct Listed {
    name: &'static str,
    unit: Option<&'static str>,
    range: Option<(f64, f64)>,
    unchanged: Option<f64>,
    is_default: bool,
    what: String,
}

/// All changes.
pub(super) fn listed() -> Vec<Listed> {
    let default = Change::default_set();
    let is_default = |name: &str| default.iter().any(|change| change.name() == name);
    let whole = Whole::ALL.into_iter().map(|whole| Listed {
        name: whole.name(),
        unit: None,
        range: None,
        unchanged: None,
        is_default: is_default(whole.name()),
        what: whole.description().to_owned(),
    });
    let dosed = Dose::ALL.into_iter().map(|dose| Listed {
        name: dose.name(),
        unit: Some(dose.unit()),
        range: Some(dose.range()),
        unchanged: dose.unchanged(),
        is_default: is_default(dose.name()),
        what: format!("as in {}={}", dose.name(), dose.example()),
    });
    let platform = Listed {
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
pub(super) fn list() -> String {
    let mut text = String::from("changes:\n");
    for Listed { name, unit, range, what, .. } in listed() {
        let doses = range.map(|(low, high)| format!("{low} to {high} {}; ", unit.unwrap_or_default()));
        let _ = writeln!(text, "  {name:<24} {}{what}", doses.unwrap_or_default());
    }
    let set: Vec<String> = Change::default_set().iter().map(ToString::to_string).collect();
    let _ = write!(text, "default set: {}", set.join(", "));
    text
}

/// The results as text: a table of R for each style, then the expectations.
pub(super) fn results(results: &Results) -> String {
    let mut text = String::new();
    for style in &results.styles {
        let _ = writeln!(text, "style {}", style.style);
        if let Some(first) = style.changes.first() {
            let _ = writeln!(text, "{:<28}{}  success", "R", heading(&first.figures));
            for change in &style.changes {
                let _ = writeln!(text, "{}", row(change));
            }
        }
        for one in &style.expectations {
            let _ = writeln!(text, "{}", expectation(one));
        }
    }
    text
}

fn heading(figures: &[Figure]) -> String {
    figures.iter().map(|figure| format!(" {:>10}", figure.kind)).collect()
}

fn row(change: &OfChange) -> String {
    let cell = |figure: &Figure| match figure.r {
        Some(Estimate { mean, .. }) => format!(" {mean:>10.2}"),
        None => format!(" {:>10}", "-"),
    };
    let figures: String = change.figures.iter().map(cell).collect();
    let success = change.success.map_or_else(
        || "-".to_owned(),
        |Estimate { mean, low, high, .. }| format!("{:+.1} [{:+.1}, {:+.1}]", mean * 100.0, low * 100.0, high * 100.0),
    );
    format!("{:<28}{figures}  {success}", change.change)
}

fn expectation(one: &Expectation) -> String {
    let Expectation { change, expected, told, holds, .. } = one;
    let share = one.share().map_or_else(|| "-".to_owned(), |share| format!("{:.1} %", share * 100.0));
    format!("{change:<28} {share:>10}  {holds} of {told}: {expected}")
}
