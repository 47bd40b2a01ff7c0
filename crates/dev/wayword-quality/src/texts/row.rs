//! A figure of texts, and how it is printed.

use serde::Serialize;

/// A named figure.
#[derive(Debug, Clone, Serialize)]
pub(super) struct TextFigureRow {
    pub(super) name: String,
    #[serde(flatten)]
    pub(super) value: TextFigureValue,
}

/// A share of cases, or a number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum TextFigureValue {
    /// `count` of `of` cases.
    Share { count: usize, of: usize },
    /// A number in the unit that the name gives.
    Number(f64),
}

/// The share of cases that are true.
pub(super) fn share_row(name: &str, cases: impl Iterator<Item = bool>) -> TextFigureRow {
    let (mut count, mut of) = (0, 0);
    for case in cases {
        of += 1;
        count += usize::from(case);
    }
    TextFigureRow { name: name.to_owned(), value: TextFigureValue::Share { count, of } }
}

/// A number, rounded to a tenth.
pub(super) fn number_row(name: &str, value: f64) -> TextFigureRow {
    TextFigureRow { name: name.to_owned(), value: TextFigureValue::Number((value * 10.0).round() / 10.0) }
}

impl TextFigureValue {
    /// The value as a cell of a table.
    pub(super) fn table_cell(self) -> String {
        match self {
            Self::Share { of: 0, .. } => "-".to_owned(),
            Self::Share { count, of } => format!("{:.1} % ({count}/{of})", 100.0 * count as f64 / of as f64),
            Self::Number(number) => format!("{number}"),
        }
    }
}
