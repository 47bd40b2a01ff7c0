//! Turns rows into Parquet's leaf columns. A leaf of the schema is written as its values, with two numbers for each:
//! how many of the optional or repeated fields above it are present (`def`, the definition level), and at which list a
//! value continues rather than begins (`rep`, the repetition level). This is the record shredding of Dremel.
//!
//! Example: the lists `[a, b]` and `[]` are the values a and b with `def` 1, 1, 0 and `rep` 0, 1, 0.

use super::ParquetRow;

/// The values of a leaf in some rows, and their levels.
#[derive(Debug, PartialEq)]
pub(super) struct LeafColumn<T> {
    pub(super) values: Vec<T>,
    /// Definition levels; `None` where every row has one value.
    pub(super) def: Option<Vec<i16>>,
    /// Repetition levels; `None` where no row has a list.
    pub(super) rep: Option<Vec<i16>>,
}

/// A value in each row.
pub(super) fn required_column<'r, T>(rows: &[ParquetRow<'r>], cell: impl Fn(&ParquetRow<'r>) -> T) -> LeafColumn<T> {
    LeafColumn { values: rows.iter().map(cell).collect(), def: None, rep: None }
}

/// A value, or null.
pub(super) fn optional_column<'r, T>(
    rows: &[ParquetRow<'r>],
    cell: impl Fn(&ParquetRow<'r>) -> Option<T>,
) -> LeafColumn<T> {
    let cells: Vec<Option<T>> = rows.iter().map(cell).collect();
    let def = cells.iter().map(|cell| i16::from(cell.is_some())).collect();
    LeafColumn { values: cells.into_iter().flatten().collect(), def: Some(def), rep: None }
}

/// A list in each row, which may be empty.
pub(super) fn list_column<'r, T>(rows: &[ParquetRow<'r>], cell: impl Fn(&ParquetRow<'r>) -> Vec<T>) -> LeafColumn<T> {
    let mut leaf = LeafColumn::empty_nested();
    for row in rows {
        leaf.add_list(cell(row), 0);
    }
    leaf
}

/// A list, or null.
pub(super) fn optional_list<'r, T>(
    rows: &[ParquetRow<'r>],
    cell: impl Fn(&ParquetRow<'r>) -> Option<Vec<T>>,
) -> LeafColumn<T> {
    let mut leaf = LeafColumn::empty_nested();
    for row in rows {
        match cell(row) {
            Some(list) => leaf.add_list(list, 1),
            None => leaf.add_level(0, 0),
        }
    }
    leaf
}

/// A list of points, or null.
pub(super) fn optional_points<'r>(
    rows: &[ParquetRow<'r>],
    cell: impl Fn(&ParquetRow<'r>) -> Option<Vec<[f64; 3]>>,
) -> LeafColumn<f64> {
    let mut leaf = LeafColumn::empty_nested();
    for row in rows {
        match cell(row) {
            Some(points) if !points.is_empty() => leaf.add_points(&points),
            Some(_) => leaf.add_level(1, 0),
            None => leaf.add_level(0, 0),
        }
    }
    leaf
}

impl<T> LeafColumn<T> {
    fn empty_nested() -> Self {
        Self { values: Vec::new(), def: Some(Vec::new()), rep: Some(Vec::new()) }
    }

    /// Adds the levels of a value, or of a list or null without values.
    fn add_level(&mut self, def: i16, rep: i16) {
        self.def.get_or_insert_default().push(def);
        self.rep.get_or_insert_default().push(rep);
    }

    /// Adds a list; `empty` is the definition level at which the list is there and has no element.
    fn add_list(&mut self, list: Vec<T>, empty: i16) {
        if list.is_empty() {
            self.add_level(empty, 0);
        }
        for (index, value) in list.into_iter().enumerate() {
            self.add_level(empty + 1, i16::from(index > 0));
            self.values.push(value);
        }
    }
}

impl LeafColumn<f64> {
    /// Adds a list of points that is not empty. A point is a list of three numbers in the list of points; both lists and
    /// the null above them make the definition level 3.
    fn add_points(&mut self, points: &[[f64; 3]]) {
        for (index, point) in points.iter().enumerate() {
            for (axis, value) in point.iter().enumerate() {
                let rep = match (index, axis) {
                    (0, 0) => 0,
                    (_, 0) => 1,
                    _ => 2,
                };
                self.add_level(3, rep);
                self.values.push(*value);
            }
        }
    }
}
