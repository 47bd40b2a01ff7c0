//! Formats numbers, intervals and methods for the tables.

use super::measure::{Measure, Unit};
use wayword_metrics::{Interval, Method};

/// Shown in place of a missing figure.
pub(super) const NOTHING: &str = "–";

/// A number with `digits` digits after the point, with a typographic minus, and without a minus before zero.
pub(super) fn number(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return NOTHING.to_owned();
    }
    let text = format!("{value:.digits$}");
    let is_zero = !text.chars().any(|c| ('1'..='9').contains(&c));
    if is_zero { text.replace('-', "") } else { text.replace('-', "−") }
}

/// A value of a measure, in the unit in which it is shown.
pub(super) fn value(measure: &Measure, value: f64) -> String {
    match measure.unit {
        Unit::PerCent => number(100.0 * value, 1),
        Unit::Level => number(value, 2),
        Unit::Metres | Unit::Count | Unit::Seconds => number(value, 1),
    }
}

/// An interval of a measure, as `[low, high]`.
pub(super) fn interval(measure: &Measure, interval: Option<&Interval>) -> String {
    let ends = |interval: &Interval| format!("[{}, {}]", value(measure, interval.low), value(measure, interval.high));
    interval.map_or_else(|| NOTHING.to_owned(), ends)
}

/// An interval of numbers, as `[low, high]`.
pub(super) fn ends(interval: Option<&Interval>, digits: usize) -> String {
    let ends = |interval: &Interval| format!("[{}, {}]", number(interval.low, digits), number(interval.high, digits));
    interval.map_or_else(|| NOTHING.to_owned(), ends)
}

/// The name of the method by which an interval was computed.
pub(super) fn method(method: Method) -> &'static str {
    match method {
        Method::Wilson => "Wilson",
        Method::Student => "Student",
        Method::Clustered => "clustered",
        Method::Extreme => "extreme",
        Method::Newcombe => "Newcombe",
        Method::None => "none",
    }
}

/// The method as one letter, for superscripts.
pub(super) fn letter(method: Method) -> &'static str {
    match method {
        Method::Wilson => "w",
        Method::Student => "s",
        Method::Clustered => "c",
        Method::Extreme => "e",
        Method::Newcombe => "n",
        Method::None => "",
    }
}

/// Explains a method in a phrase.
pub(super) fn meaning(method: Method) -> &'static str {
    match method {
        Method::Wilson => "Wilson's interval; every person and every route occurs once",
        Method::Student => "Student's t; every person and every route occurs once",
        Method::Clustered => {
            "from the variance clustered by persons and by routes, V(persons) + V(routes) − V(cells), never below the larger of the \
             first two, with Student's t of the fewer of persons and routes, less one; of a share on the logit scale; of a difference from \
             both intervals and the correlation through shared persons and routes"
        }
        Method::Extreme => {
            "a share of 0 or 100 % of answers that depend on each other: Wilson's interval of as many answers as there are persons or \
             routes, whichever are fewer"
        }
        Method::Newcombe => {
            "Newcombe's interval of a difference between two shares; every person and every route occurs once"
        }
        Method::None => {
            "no interval: the answers do not show how far the figure can be trusted (one person, one route, or no spread)"
        }
    }
}

/// All methods, in the order in which they are explained.
pub(super) const METHODS: [Method; 6] =
    [Method::Wilson, Method::Student, Method::Clustered, Method::Extreme, Method::Newcombe, Method::None];

/// A count with its noun.
pub(super) fn count(number: usize, one: &str, many: &str) -> String {
    format!("{number} {}", if number == 1 { one } else { many })
}
