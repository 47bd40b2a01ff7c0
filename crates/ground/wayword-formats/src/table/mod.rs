//! Records as a table: a Parquet file with a row for each instruction, and flat, typed columns.
//!
//! `columns.rs` fills the columns and `schema.txt` gives their types, in the same order; `leaf_column`
//! computes Parquet's levels for the rows.

mod columns;

use crate::{FormatError, jsonl::InstructionRecord, output};
use parquet::{
    basic::Compression,
    errors::ParquetError,
    file::{properties::WriterProperties, writer::SerializedFileWriter},
    schema::parser::parse_message_type,
};
use std::{path::Path, sync::Arc};

const SCHEMA_TEXT: &str = include_str!("schema.txt");
/// Most rows of one row group of the file. Readers have a whole group in memory.
const GROUP_ROWS: usize = 10_000;

/// A row: an instruction, and the split that it belongs to.
#[derive(Debug, Clone, Copy)]
pub struct ParquetRow<'r> {
    /// The instruction with its path.
    pub record: &'r InstructionRecord,
    /// The name of its split.
    pub split: &'r str,
}

/// Writes a Parquet file, with Snappy. Equal rows give equal bytes.
///
/// # Errors
/// When the file cannot be written.
pub fn write_table(file: &Path, rows: &[ParquetRow<'_>]) -> Result<(), FormatError> {
    let bytes = encode_table(rows).map_err(|error| {
        FormatError::for_document(file, format!("it cannot be written as Parquet: {error}"), "write it as wayword")
    })?;
    output::write_file(file, |out| out.write_all(&bytes))
}

fn encode_table(rows: &[ParquetRow<'_>]) -> Result<Vec<u8>, ParquetError> {
    let schema = Arc::new(parse_message_type(SCHEMA_TEXT)?);
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_created_by(concat!("wayword version ", env!("CARGO_PKG_VERSION")).to_owned())
        .build();
    let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties))?;
    for rows in rows.chunks(GROUP_ROWS) {
        let mut group = writer.next_row_group()?;
        columns::write_columns(&mut group, rows)?;
        group.close()?;
    }
    writer.into_inner()
}

#[cfg(test)]
mod tests;
