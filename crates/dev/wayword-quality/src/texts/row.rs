//! A figure of texts, and how it is printed.

use serde::Serialize;

/// A named figure.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Row {
    pub(super) name: String,
    #[serde(flatten)]
    pub(super) value: Value,
}

/// A share of cases, or a number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Value {
    Share { count: usize, of: usize },
    Number(f64),
}

/// The share of cases that are true.
pub(super) fn share(name: &str, cases: impl Iterator<Item = bool>) -> Row {
    let (mut count, mut of) = (0, 0);
    for case in cases {
        of += 1;
        count += usize::from(case);
    }
    Row { name: name.to_owned(), value: Value::Share { count, of } }
}

/// A number, rounded to a tenth.
pub(super) fn number(name: &str, value: f64) -> Row {
    Row { name: name.to_owned(), value: Value::Number((value * 10.0).round() / 10.0) }
}

impl Value {
    /// As a cell of a table.
    pub(super) fn cell(self) -> String {
        match self {
            Self::Share { of: 0, .. } => "-".to_owned(),
            Self::Share { count, of } => format!("{:.1} % ({count}/{of})", 100.0 * count as f64 / of as f64),
            Self::Number(number) => format!("{number}"),
        }
    }
}
