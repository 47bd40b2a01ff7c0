//! A CSV file with typed cells and described columns, and the codebook that lists the meaning of every column.

use super::escape;
use std::fmt::Write;

/// A column of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct SheetColumn {
    pub(super) name: &'static str,
    pub(super) meaning: String,
    /// Unit of a number; empty where it has none, or where it is text.
    pub(super) unit: &'static str,
    /// Its possible values.
    pub(super) values: String,
}

/// A cell.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum SheetCell {
    /// No value.
    Empty,
    /// A whole number.
    Whole(i64),
    /// A number and how many digits after the point it is written with.
    Number(f64, usize),
    /// Text from any source; it is escaped when it is written.
    Text(String),
}

/// A CSV file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DataSheet {
    pub(super) file: &'static str,
    /// The meaning of one line of the file, as a phrase.
    pub(super) line: &'static str,
    pub(super) columns: Vec<SheetColumn>,
    pub(super) rows: Vec<Vec<SheetCell>>,
}

/// A column, described by name, meaning, unit and values.
pub(super) fn sheet_column(name: &'static str, meaning: &str, unit: &'static str, values: &str) -> SheetColumn {
    SheetColumn { name, meaning: meaning.to_owned(), unit, values: values.to_owned() }
}

impl SheetCell {
    pub(super) fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    pub(super) fn count(count: usize) -> Self {
        i64::try_from(count).map_or(Self::Empty, Self::Whole)
    }

    pub(super) fn yes_or_no(is: bool) -> Self {
        Self::Whole(i64::from(is))
    }

    pub(super) fn number(value: Option<f64>, digits: usize) -> Self {
        value.filter(|value| value.is_finite()).map_or(Self::Empty, |value| Self::Number(value, digits))
    }

    fn csv_text(&self) -> String {
        match self {
            Self::Empty => String::new(),
            Self::Whole(number) => number.to_string(),
            Self::Number(number, digits) => format!("{number:.digits$}"),
            Self::Text(text) => escape::escape_csv_cell(text),
        }
    }
}

impl DataSheet {
    pub(super) fn new(file: &'static str, line: &'static str, columns: Vec<SheetColumn>) -> Self {
        Self { file, line, columns, rows: Vec::new() }
    }

    /// The file's text: a line of names, then a line for each row, each ended by CR and LF.
    pub(super) fn to_csv(&self) -> String {
        let mut text = self.columns.iter().map(|column| column.name).collect::<Vec<_>>().join(",");
        text.push_str("\r\n");
        for row in &self.rows {
            let cells: Vec<String> = row.iter().map(SheetCell::csv_text).collect();
            // Writing to a text cannot fail.
            let _ = write!(text, "{}\r\n", cells.join(","));
        }
        text
    }
}

/// Makes the codebook: one line for every column of every file.
pub(super) fn codebook_sheet(sheets: &[DataSheet]) -> DataSheet {
    let columns = vec![
        sheet_column("file", "the file", "", "a name"),
        sheet_column("column", "the column", "", "a name"),
        sheet_column("meaning", "what it says", "", "text"),
        sheet_column("unit", "in what it is counted", "", "text; empty where there is no unit"),
        sheet_column("values", "what it can be", "", "text"),
    ];
    let mut book = DataSheet::new("codebook.csv", "a column of a file", columns);
    for sheet in sheets {
        for column in &sheet.columns {
            let cells = [sheet.file, column.name, &column.meaning, column.unit, &column.values];
            book.rows.push(cells.into_iter().map(SheetCell::text).collect());
        }
    }
    book
}
