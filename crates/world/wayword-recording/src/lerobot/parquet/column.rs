//! The values of a column in a row group, some rows at a time.
//!
//! Parquet stores two small numbers with each value, its levels. The repetition level is 0 where a row begins, and larger
//! within a list. The definition level is lower than the column's maximum where the value is missing.

use super::pages::ColumnPages;
use parquet::{
    column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader},
    data_type::{ByteArray, DataType},
    file::metadata::RowGroupMetaData,
};
use std::{
    fs::File,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering::Relaxed},
    },
};
use wayword_core::contain_panics::run_decoder;

/// A column in a row group, with the position up to which it was read.
pub(super) struct ParquetColumn {
    reader: ColumnReader,
    /// Number of values that pages announced since the last request.
    announced: Arc<AtomicU64>,
    /// The definition level of values that are not missing.
    max_definition: i16,
}

/// Some rows of a column: whether each value begins a row, and the value, if there is one.
pub(super) type ColumnCells<T> = Box<dyn Iterator<Item = (bool, Option<T>)>>;

impl ParquetColumn {
    /// Begins to read a column.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub(super) fn new(file: File, group: &RowGroupMetaData, leaf: usize) -> Result<Self, String> {
        let chunk = group.column(leaf);
        let announced = Arc::<AtomicU64>::default();
        let pages = ColumnPages::new(file, chunk, announced.clone())?;
        let reader = run_decoder(|| Ok(get_column_reader(chunk.column_descr_ptr(), Box::new(pages))))?;
        Ok(Self { reader, announced, max_definition: chunk.column_descr().max_def_level() })
    }

    /// The numbers of at most the next `rows` rows; empty after the last row.
    ///
    /// # Errors
    /// When the file is broken.
    pub(super) fn next_numbers(&mut self, rows: u64) -> Result<ColumnCells<f64>, String> {
        self.announced.store(0, Relaxed);
        let max = self.max_definition;
        match &mut self.reader {
            ColumnReader::Int32ColumnReader(reader) => read_cells(reader, rows, max, f64::from),
            ColumnReader::Int64ColumnReader(reader) => read_cells(reader, rows, max, |value| value as f64),
            ColumnReader::FloatColumnReader(reader) => read_cells(reader, rows, max, f64::from),
            ColumnReader::DoubleColumnReader(reader) => read_cells(reader, rows, max, |value| value),
            _ => Err("holds no numbers".to_owned()),
        }
    }

    /// The bytes of the next row, or `Some(None)` if it has none; `None` after the last row.
    ///
    /// # Errors
    /// When the file is broken.
    pub(super) fn next_bytes(&mut self) -> Result<Option<Option<ByteArray>>, String> {
        self.announced.store(0, Relaxed);
        let ColumnReader::ByteArrayColumnReader(reader) = &mut self.reader else {
            return Err("holds no bytes".to_owned());
        };
        let mut cells = read_cells(reader, 1, self.max_definition, |value| value)?;
        Ok(cells.next().map(|(_, value)| value))
    }

    /// Skips some rows of a column that does not repeat; skipped pages are not decompressed.
    ///
    /// # Errors
    /// When the file is broken.
    pub(super) fn skip_rows(&mut self, rows: u64) -> Result<(), String> {
        self.announced.store(0, Relaxed);
        let rows = usize::try_from(rows).map_err(|error| error.to_string())?;
        let skipped = run_decoder(|| {
            let skipped = match &mut self.reader {
                ColumnReader::Int32ColumnReader(reader) => reader.skip_records(rows),
                ColumnReader::Int64ColumnReader(reader) => reader.skip_records(rows),
                ColumnReader::FloatColumnReader(reader) => reader.skip_records(rows),
                ColumnReader::DoubleColumnReader(reader) => reader.skip_records(rows),
                ColumnReader::ByteArrayColumnReader(reader) => reader.skip_records(rows),
                _ => Ok(0),
            };
            skipped.map_err(|error| error.to_string())
        })?;
        if skipped == rows { Ok(()) } else { Err("ends early".to_owned()) }
    }
}

/// Reads at most `rows` rows, and joins their values with their levels.
fn read_cells<T: DataType, V: 'static>(
    reader: &mut ColumnReaderImpl<T>,
    rows: u64,
    max_definition: i16,
    value: impl Fn(T::T) -> V + 'static,
) -> Result<ColumnCells<V>, String> {
    let rows = usize::try_from(rows).map_err(|error| error.to_string())?;
    let (mut definitions, mut repetitions, mut values) = (Vec::new(), Vec::new(), Vec::new());
    run_decoder(|| {
        let read = reader.read_records(rows, Some(&mut definitions), Some(&mut repetitions), &mut values);
        read.map_err(|error| error.to_string())
    })?;
    let count = if max_definition > 0 { definitions.len() } else { values.len() };
    let mut values = values.into_iter().map(value);
    Ok(Box::new((0..count).map(move |at| {
        let is_present = definitions.get(at).is_none_or(|definition| *definition == max_definition);
        (repetitions.get(at).is_none_or(|repetition| *repetition == 0), if is_present { values.next() } else { None })
    })))
}
