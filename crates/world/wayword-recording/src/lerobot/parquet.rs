//! Reads Parquet files, as far as LeRobot datasets need them: integers, floating-point numbers, bytes, and lists of
//! floating-point numbers.
//!
//! The crate `parquet` decodes levels, dictionaries, values, and the footer's description of columns. Its panics are
//! contained. Files are not trusted, but the crate believes some of the numbers in them. The table compares version 60.1
//! of the crate with this module:
//!
//! | number in the file | the crate | here |
//! |---|---|---|
//! | the footer's length | checks it against the file's | the same, and at most 64 MiB (`footer`) |
//! | a column's number of children in the schema | reserves memory for up to 2^31, and recurses as deep as they nest | the schema is built from the footer here, at most 16 deep, and given to the crate, which then skips the footer's (`footer`) |
//! | lists in the footer | checks their lengths against the remaining bytes, except for lists that it skips | all are checked against the remaining bytes (`thrift`) |
//! | rows, and where columns lie | believes them | checked against the file's length (`footer`) |
//! | lists in a page's header | skips up to 2^31 elements beyond the end of the file | the headers are read here (`pages`) |
//! | the decompressed length of a page | reserves up to 2 GiB; decompresses gzip without a limit | pages are decompressed here, to at most 8 MiB or 256 times their length (`pages`) |
//! | entries of a dictionary | reserves memory for up to 2^31 | checked against the dictionary's length (`pages`) |
//! | values of a page | takes memory for the values of the requested rows; a row's list may go on over all pages | rows are requested in steps, and their pages may not announce more values than a file of this length holds (`pages`) |
//! | number of texts, if their lengths are encoded as differences | reserves memory for any number | these encodings are refused (`pages`) |
//!
//! So memory is at most a multiple of the file's length. Time has one exception: in a malicious footer with fields of
//! other types than the crate expects, a list of booleans costs the crate two seconds for nine bytes.

mod column;
mod footer;
mod pages;
mod thrift;

use column::{ColumnCells, ParquetColumn};
use parquet::{
    basic::Type,
    file::metadata::{ParquetMetaData, RowGroupMetaData},
    schema::types::{ColumnDescPtr, ColumnDescriptor},
};
use std::{
    fs::File,
    iter::Peekable,
    ops::Range,
    path::{Path, PathBuf},
};
use wayword_core::PlatformError;
use wayword_world::files;

const PARQUET_HINT: &str =
    "download the file again; if it is complete, write it again with pyarrow and Snappy, as LeRobot does";
/// Rows that are read at a time.
const STEP_ROWS: u64 = 1024;

/// Receives the number of a row, and its bytes; `None` if the row has none.
pub(super) type TakeBytes<'a> = dyn FnMut(u64, Option<&[u8]>) -> Result<(), PlatformError> + 'a;

/// A Parquet file: rows with named columns.
#[derive(Debug)]
pub(crate) struct ParquetTable {
    path: PathBuf,
    about: ParquetMetaData,
}

impl ParquetTable {
    /// Opens a file and reads its footer.
    ///
    /// # Errors
    /// When it is not a Parquet file.
    pub(crate) fn open(path: &Path) -> Result<Self, PlatformError> {
        let about = footer::read_footer(&files::open_plain_file(path, PARQUET_HINT)?);
        Ok(Self {
            path: path.to_owned(),
            about: about.map_err(|reason| files::file_error(path, reason, PARQUET_HINT))?,
        })
    }

    /// The path of the file.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Number of rows.
    pub(super) fn row_count(&self) -> u64 {
        self.about.row_groups().iter().map(count_rows).sum()
    }

    /// Whether there is a column of this name.
    pub(crate) fn has_column(&self, name: &str) -> bool {
        self.leaf_columns().iter().any(|leaf| is_named(leaf, name))
    }

    /// Hands out a column of numbers, row by row.
    ///
    /// # Errors
    /// When the column does not exist, a number is missing, the file is broken, or `take` refuses a number.
    pub(super) fn read_numbers(
        &self,
        name: &str,
        rows: Range<u64>,
        take: &mut dyn FnMut(u64, f64) -> Result<(), String>,
    ) -> Result<(), PlatformError> {
        let leaf = self
            .find_leaf(name, |leaf| is_number(leaf) && leaf.path().parts().len() == 1 && leaf.max_rep_level() == 0)?;
        self.each_row_group(leaf, rows, |column, group, rows| {
            column.skip_rows(rows.start - group.start).map_err(|reason| near_row(rows.start, &reason))?;
            let mut row = rows.start;
            while row < rows.end {
                let cells =
                    column.next_numbers(STEP_ROWS.min(rows.end - row)).map_err(|reason| near_row(row, &reason))?;
                let before = row;
                for (_, number) in cells {
                    take(row, number.ok_or_else(|| format!("row {row} holds no number"))?)?;
                    row += 1;
                }
                if row == before {
                    return Err(format!("ends before row {row}"));
                }
            }
            Ok(())
        })
    }

    /// Some elements of a column of lists of `width` numbers: for each row in order, those at the indices `kept`. The numbers of lists in a
    /// list (a matrix) count one after the other.
    ///
    /// # Errors
    /// When the column does not exist, a list has another length, or the file is broken.
    pub(crate) fn read_lists(
        &self,
        name: &str,
        rows: Range<u64>,
        width: usize,
        kept: &[usize],
    ) -> Result<Vec<f64>, PlatformError> {
        let leaf = self.find_leaf(name, |leaf| is_number(leaf) && leaf.max_rep_level() >= 1)?;
        let mut numbers = Vec::new();
        self.each_row_group(leaf, rows, |column, group, rows| {
            let mut row = group.start;
            while row < rows.end {
                let cells =
                    column.next_numbers(STEP_ROWS.min(rows.end - row)).map_err(|reason| near_row(row, &reason))?;
                let mut cells = cells.peekable();
                if cells.peek().is_none() {
                    return Err(format!("ends before row {row}"));
                }
                while cells.peek().is_some() {
                    let list = next_list(&mut cells, width).map_err(|reason| format!("row {row} {reason}"))?;
                    if rows.contains(&row) {
                        numbers.extend(kept.iter().filter_map(|at| list.get(*at)));
                    }
                    row += 1;
                }
            }
            Ok(())
        })?;
        Ok(numbers)
    }

    /// Hands out the bytes of some rows, which must ascend. The column holds bytes itself or in its part `bytes`, as
    /// for pictures. `None` if a row has no bytes.
    ///
    /// # Errors
    /// When the column does not exist, the file is broken, or `take` fails.
    pub(super) fn read_bytes(&self, name: &str, wanted: &[u64], take: &mut TakeBytes<'_>) -> Result<(), PlatformError> {
        let flat = |leaf: &ColumnDescriptor| leaf.max_rep_level() == 0 && leaf.physical_type() == Type::BYTE_ARRAY;
        let leaf =
            self.find_leaf(name, |leaf| flat(leaf) && leaf.path().parts().get(1).is_none_or(|part| part == "bytes"))?;
        let mut wanted = wanted.iter().copied().peekable();
        // The closure below can only return texts, so an error of `take` is kept here.
        let mut refused = None;
        let read = self.each_row_group(leaf, 0..self.row_count(), |column, _, rows| {
            let mut next_row = rows.start;
            while let Some(row) = wanted.next_if(|row| rows.contains(row)) {
                column.skip_rows(row.saturating_sub(next_row)).map_err(|reason| near_row(row, &reason))?;
                let bytes = column.next_bytes().map_err(|reason| near_row(row, &reason))?;
                let bytes = bytes.ok_or_else(|| format!("ends before row {row}"))?;
                if let Err(error) = take(row, bytes.as_ref().map(|bytes| bytes.data())) {
                    refused = Some(error);
                    return Err(String::new());
                }
                next_row = row + 1;
            }
            Ok(())
        });
        refused.map_or(read, Err)
    }

    fn leaf_columns(&self) -> &[ColumnDescPtr] {
        self.about.file_metadata().schema_descr().columns()
    }

    /// The only column with this name that fits.
    fn find_leaf(&self, name: &str, fits: impl Fn(&ColumnDescriptor) -> bool) -> Result<usize, PlatformError> {
        let leaves = self.leaf_columns().iter().enumerate();
        let mut found = leaves.filter(|(_, leaf)| is_named(leaf, name) && fits(leaf)).map(|(at, _)| at);
        match (found.next(), found.next()) {
            (Some(leaf), None) => Ok(leaf),
            _ if self.has_column(name) => {
                Err(files::file_error(&self.path, format!("column {name:?} is not of the expected type"), PARQUET_HINT))
            }
            _ => Err(files::file_error(&self.path, format!("has no column {name:?}"), PARQUET_HINT)),
        }
    }

    /// Reads a column, row group by row group. `read` gets the rows of the group in the file, and which of these are
    /// wanted.
    fn each_row_group(
        &self,
        leaf: usize,
        wanted: Range<u64>,
        mut read: impl FnMut(&mut ParquetColumn, Range<u64>, Range<u64>) -> Result<(), String>,
    ) -> Result<(), PlatformError> {
        let name = self.leaf_columns().get(leaf).map(|column| column.path().string()).unwrap_or_default();
        let wrong = |reason: String| files::file_error(&self.path, format!("column {name:?}: {reason}"), PARQUET_HINT);
        let mut first = 0;
        for group in self.about.row_groups() {
            let rows = first..first + count_rows(group);
            first = rows.end;
            let within = wanted.start.max(rows.start)..wanted.end.min(rows.end);
            if !within.is_empty() {
                let file = File::open(&self.path).map_err(|error| wrong(error.to_string()))?;
                ParquetColumn::new(file, group, leaf)
                    .and_then(|mut column| read(&mut column, rows, within))
                    .map_err(wrong)?;
            }
        }
        Ok(())
    }
}

/// Number of rows of a row group. A footer with a negative one was refused.
fn count_rows(group: &RowGroupMetaData) -> u64 {
    u64::try_from(group.num_rows()).unwrap_or(0)
}

/// Whether a column, or the group of columns in which it lies, has this name.
fn is_named(leaf: &ColumnDescriptor, name: &str) -> bool {
    leaf.path().parts().first().is_some_and(|first| first == name)
}

fn is_number(leaf: &ColumnDescriptor) -> bool {
    matches!(leaf.physical_type(), Type::INT32 | Type::INT64 | Type::FLOAT | Type::DOUBLE)
}

/// The list of the next row. Only whole rows are handed out, so the list ends within the same cells.
fn next_list(cells: &mut Peekable<ColumnCells<f64>>, width: usize) -> Result<Vec<f64>, String> {
    let mut list = Vec::with_capacity(width);
    let mut next = cells.next();
    while let Some((_, number)) = next {
        list.push(number.ok_or("holds no number")?);
        next = cells.next_if(|(begins_row, _)| !begins_row && list.len() <= width);
    }
    if list.len() == width { Ok(list) } else { Err(format!("is not a list of {width} numbers")) }
}

/// An error of the crate in the rows that are read next, of which it does not name the row.
fn near_row(row: u64, reason: &str) -> String {
    format!("at row {row} or soon after it: {reason}")
}

#[cfg(test)]
mod tests;
