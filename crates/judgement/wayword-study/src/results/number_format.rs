//! Formats numbers, intervals and methods for the tables.

use super::measure::{MeasureUnit, StudyMeasure};
use wayword_metrics::{ConfidenceInterval, IntervalMethod};

/// Shown in place of a missing figure.
pub(super) const NO_FIGURE: &str = "–";

/// A number with `digits` digits after the point, with a typographic minus, and without a minus before zero.
pub(super) fn format_number(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return NO_FIGURE.to_owned();
    }
    let text = format!("{value:.digits$}");
    let is_zero = !text.chars().any(|c| ('1'..='9').contains(&c));
    if is_zero { text.replace('-', "") } else { text.replace('-', "−") }
}

/// A share in per cent, with as many digits as it has: 0.2 is `20`, and 0.002 is `0.2`.
pub(super) fn format_percent(share: f64) -> String {
    // Rounding takes away what the conversion from per cent and back added.
    format!("{}", (share * 1e8).round() / 1e6)
}

/// A value of a measure, in the unit in which it is shown.
pub(super) fn format_value(measure: &StudyMeasure, value: f64) -> String {
    match measure.unit {
        MeasureUnit::PerCent => format_number(100.0 * value, 1),
        MeasureUnit::Level => format_number(value, 2),
        MeasureUnit::Metres | MeasureUnit::Count | MeasureUnit::Seconds => format_number(value, 1),
    }
}

/// An interval of a measure, as `[low, high]`.
pub(super) fn format_interval(measure: &StudyMeasure, interval: Option<&ConfidenceInterval>) -> String {
    let ends = |interval: &ConfidenceInterval| {
        format!("[{}, {}]", format_value(measure, interval.low), format_value(measure, interval.high))
    };
    interval.map_or_else(|| NO_FIGURE.to_owned(), ends)
}

/// An interval of numbers, as `[low, high]`.
pub(super) fn format_ends(interval: Option<&ConfidenceInterval>, digits: usize) -> String {
    let ends = |interval: &ConfidenceInterval| {
        format!("[{}, {}]", format_number(interval.low, digits), format_number(interval.high, digits))
    };
    interval.map_or_else(|| NO_FIGURE.to_owned(), ends)
}

/// The name of the method by which an interval was computed.
pub(super) fn method_name(method: IntervalMethod) -> &'static str {
    match method {
        IntervalMethod::Wilson => "Wilson",
        IntervalMethod::Student => "Student",
        IntervalMethod::Clustered => "clustered",
        IntervalMethod::Extreme => "extreme",
        IntervalMethod::Newcombe => "Newcombe",
        IntervalMethod::None => "none",
    }
}

/// The method as one letter, for superscripts.
pub(super) fn method_letter(method: IntervalMethod) -> &'static str {
    match method {
        IntervalMethod::Wilson => "w",
        IntervalMethod::Student => "s",
        IntervalMethod::Clustered => "c",
        IntervalMethod::Extreme => "e",
        IntervalMethod::Newcombe => "n",
        IntervalMethod::None => "",
    }
}

/// Explains a method in a phrase.
pub(super) fn method_meaning(method: IntervalMethod) -> &'static str {
    match method {
        IntervalMethod::Wilson => "Wilson's interval; every person and every route occurs once",
        IntervalMethod::Student => "Student's t; every person and every route occurs once",
        IntervalMethod::Clustered => {
            "from the variance clustered by persons and by routes, V(persons) + V(routes) − V(cells), never below the larger of the \
             first two, with Student's t of the fewer of persons and routes, less one; of a share on the logit scale; of a difference from \
             both intervals and the correlation through shared persons and routes"
        }
        IntervalMethod::Extreme => {
            "a share of 0 or 100 % of answers that depend on each other: Wilson's interval of as many answers as there are persons or \
             routes, whichever are fewer"
        }
        IntervalMethod::Newcombe => {
            "Newcombe's interval of a difference between two shares; every person and every route occurs once"
        }
        IntervalMethod::None => {
            "no interval: the answers do not show how far the figure can be trusted (one person, one route, or no spread)"
        }
    }
}

/// All methods, in the order in which they are explained.
pub(super) const ALL_METHODS: [IntervalMethod; 6] = [
    IntervalMethod::Wilson,
    IntervalMethod::Student,
    IntervalMethod::Clustered,
    IntervalMethod::Extreme,
    IntervalMethod::Newcombe,
    IntervalMethod::None,
];

/// A count with its noun.
pub(super) fn count_with_noun(number: usize, one: &str, many: &str) -> String {
    format!("{number} {}", if number == 1 { one } else { many })
}
