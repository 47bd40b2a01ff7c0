//! Turns rows into Parquet's leaf columns. A leaf of the schema is written as its values, with two numbers for each:
//! how many of the optional or repeated fields above it are present (`def`, the definition level), and at which list a
//! value continues rather than begins (`rep`, the repetition level). This is the record shredding of Dremel.
//!
//! Example: the lists `[a, b]` and `[]` are the values a and b with `def` 1, 1, 0 and `rep` 0, 1, 0.

use parquet::{data_type::DataType, errors::ParquetError, file::writer::SerializedRowGroupWriter};
use std::io::Write;

/// The values of a leaf in some rows, and their levels.
#[derive(Debug, PartialEq)]
pub(crate) struct LeafColumn<T> {
    pub(crate) values: Vec<T>,
    /// Definition levels; `None` where every row has one value.
    pub(crate) def: Option<Vec<i16>>,
    /// Repetition levels; `None` where no row has a list.
    pub(crate) rep: Option<Vec<i16>>,
}

/// Writes the next leaf of the schema.
pub(crate) fn write_leaf<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, impl Write + Send>,
    leaf: &LeafColumn<T::T>,
) -> Result<(), ParquetError> {
    let column = group.next_column()?;
    let mut column = column.ok_or_else(|| ParquetError::General("the schema has fewer columns".to_owned()))?;
    column.typed::<T>().write_batch(&leaf.values, leaf.def.as_deref(), leaf.rep.as_deref())?;
    column.close()
}

/// A value in each row.
pub(crate) fn required_column<R, T>(rows: &[R], cell: impl Fn(&R) -> T) -> LeafColumn<T> {
    LeafColumn { values: rows.iter().map(cell).collect(), def: None, rep: None }
}

/// A value, or null.
pub(crate) fn optional_column<R, T>(rows: &[R], cell: impl Fn(&R) -> Option<T>) -> LeafColumn<T> {
    let cells: Vec<Option<T>> = rows.iter().map(cell).collect();
    let def = cells.iter().map(|cell| i16::from(cell.is_some())).collect();
    LeafColumn { values: cells.into_iter().flatten().collect(), def: Some(def), rep: None }
}

/// A list in each row, which may be empty.
pub(crate) fn list_column<R, T>(rows: &[R], cell: impl Fn(&R) -> Vec<T>) -> LeafColumn<T> {
    let mut leaf = LeafColumn::empty_nested();
    for row in rows {
        leaf.add_list(cell(row), 0);
    }
    leaf
}

/// A list, or null.
pub(crate) fn optional_list<R, T>(rows: &[R], cell: impl Fn(&R) -> Option<Vec<T>>) -> LeafColumn<T> {
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
pub(crate) fn optional_points<R>(rows: &[R], cell: impl Fn(&R) -> Option<Vec<[f64; 3]>>) -> LeafColumn<f64> {
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

/// A field of the entries of a list in each row. `present` is the definition level of a value; an entry that lacks it has the level of
/// the entry, 1.
pub(crate) fn field_of_entries<E, T>(rows: &[Vec<E>], present: i16, value: impl Fn(&E) -> Option<T>) -> LeafColumn<T> {
    let mut leaf = LeafColumn::empty_nested();
    for list in rows {
        if list.is_empty() {
            leaf.add_level(0, 0);
        }
        for (index, entry) in list.iter().enumerate() {
            let found = value(entry);
            leaf.add_level(if found.is_some() { present } else { 1 }, i16::from(index > 0));
            leaf.values.extend(found);
        }
    }
    leaf
}

/// A matrix in each row, as a list of lists; no matrix and no line of one is empty.
pub(crate) fn matrix_column(rows: &[Vec<Vec<f32>>]) -> LeafColumn<f32> {
    let mut leaf = LeafColumn::empty_nested();
    for matrix in rows {
        for (line, numbers) in matrix.iter().enumerate() {
            for (column, number) in numbers.iter().enumerate() {
                leaf.add_level(2, if column > 0 { 2 } else { i16::from(line > 0) });
                leaf.values.push(*number);
            }
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
