//! Reads the footer of a Parquet file, and checks it against the file's length before and after the crate reads it.
//!
//! The schema is a tree that is written from the root on, each node with the number of its children
//! (apache/parquet-format, `parquet.thrift`). The crate reserves memory for as many children as a node announces, and
//! recurses as deeply as they are nested. So the tree is built here and given to the crate.

use super::{
    pages,
    thrift::{self, ThriftReader},
};
use parquet::{
    basic::{Repetition, Type as Physical},
    file::metadata::{ParquetMetaData, ParquetMetaDataOptions, ParquetMetaDataReader, ParquetStatisticsPolicy},
    schema::types::{SchemaDescriptor, Type},
};
use std::{
    fs::File,
    io::{Read, Seek, SeekFrom},
    sync::Arc,
};
use wayword_core::contain_panics::run_decoder;

const PARQUET_MAGIC: &[u8; 4] = b"PAR1";
/// Longest footer that is read, and most bytes of columns' names in it; more is an error.
const MAX_FOOTER_BYTES: u64 = 64 << 20;
/// Most nodes of a schema (columns and their groups), and their deepest nesting; more is an error.
const MAX_COLUMNS: u64 = 100_000;
const MAX_NESTING: usize = 16;
/// Most rows for each byte of a file. A dataset numbers its rows in at least one column, which takes more than a bit
/// for each row, so a file that announces more rows does not hold them.
const MAX_ROWS_PER_BYTE: u64 = 16;

/// Reads the footer of a file.
///
/// # Errors
/// When it is not a Parquet file, or contradicts itself or its length.
pub(super) fn read_footer(mut file: &File) -> Result<ParquetMetaData, String> {
    let wrong = |error: std::io::Error| error.to_string();
    let length = file.metadata().map_err(wrong)?.len();
    // The last eight bytes are the footer's length and the magic bytes.
    let end = length.checked_sub(8).ok_or("is too short for a Parquet file")?;
    file.seek(SeekFrom::Start(end)).map_err(wrong)?;
    let mut tail = [0; 8];
    file.read_exact(&mut tail).map_err(wrong)?;
    let [a, b, c, d, magic @ ..] = tail;
    if magic != *PARQUET_MAGIC {
        return Err(format!("byte {}: is not a Parquet file, or only part of one: it does not end in PAR1", end + 4));
    }
    let size = u64::from(u32::from_le_bytes([a, b, c, d]));
    let start = end.checked_sub(size).filter(|_| size <= MAX_FOOTER_BYTES);
    let start =
        start.ok_or_else(|| format!("byte {end}: claims a footer of {size} bytes in a file of {length} bytes"))?;
    file.seek(SeekFrom::Start(start)).map_err(wrong)?;
    let mut bytes = Vec::new();
    file.take(size).read_to_end(&mut bytes).map_err(wrong)?;
    decode_footer(&bytes, length).map_err(|reason| format!("footer at byte {start}: {reason}"))
}

/// Builds the schema of a footer, gives both to the crate, and checks the crate's result.
fn decode_footer(footer: &[u8], file_bytes: u64) -> Result<ParquetMetaData, String> {
    let root = read_schema(footer)?;
    let metadata = run_decoder(|| {
        let options = ParquetMetaDataOptions::new()
            .with_schema(Arc::new(SchemaDescriptor::new(Arc::new(root))))
            .with_column_stats_policy(ParquetStatisticsPolicy::SkipAll)
            .with_encoding_stats_policy(ParquetStatisticsPolicy::SkipAll)
            .with_size_stats_policy(ParquetStatisticsPolicy::SkipAll);
        let metadata = ParquetMetaDataReader::decode_metadata_with_options(footer, Some(&options));
        metadata.map_err(|error| error.to_string())
    })?;
    check_lengths(&metadata, file_bytes)?;
    Ok(metadata)
}

/// Returns an error if the footer announces more than a file of this length can hold.
fn check_lengths(metadata: &ParquetMetaData, file_bytes: u64) -> Result<(), String> {
    let (mut rows, mut bytes) = (0_u64, 0_u64);
    for group in metadata.row_groups() {
        let more = u64::try_from(group.num_rows()).map_err(|_| "a row group has no valid number of rows")?;
        rows = rows.saturating_add(more);
        for chunk in group.columns() {
            let wrong = |reason: &str| format!("column {:?} {reason}", chunk.column_path().string());
            if chunk.file_path().is_some() {
                return Err(wrong("lies in another file"));
            }
            let place = pages::column_place(chunk).filter(|place| place.end <= file_bytes);
            let place = place.ok_or_else(|| wrong("lies outside the file"))?;
            bytes = bytes.saturating_add(place.end - place.start);
        }
    }
    if rows > file_bytes.saturating_mul(MAX_ROWS_PER_BYTE) {
        return Err(format!("claims {rows} rows in {file_bytes} bytes"));
    }
    // Without this check a short file could make the program decompress the same bytes again and again.
    if bytes > file_bytes {
        return Err(format!("claims columns of {bytes} bytes in all, in a file of {file_bytes} bytes"));
    }
    Ok(())
}

/// The root of a footer's schema. All other fields are skipped, to check that the footer is well-formed up to its end.
fn read_schema(footer: &[u8]) -> Result<Type, String> {
    let mut thrift = ThriftReader::new(footer);
    let (mut number, mut root) = (0, None);
    while let Some(kind) = thrift.next_field(&mut number)? {
        // Field 2 of `FileMetaData` is the schema.
        if (number, kind) != (2, thrift::KIND_LIST) {
            thrift.skip_value(kind)?;
            continue;
        }
        let (elements, _) = thrift.read_list()?;
        if elements > MAX_COLUMNS {
            return Err(format!("has more than {MAX_COLUMNS} columns"));
        }
        let mut tree = SchemaTree { thrift: &mut thrift, elements, names_bytes: 0 };
        root = Some(tree.read_node(0, 0)?);
        if tree.elements > 0 {
            return Err("the schema has more columns than it says".to_owned());
        }
    }
    root.ok_or_else(|| "has no schema".to_owned())
}

/// A schema that is being read.
struct SchemaTree<'t, 'a> {
    thrift: &'t mut ThriftReader<'a>,
    /// Nodes that are still to be read.
    elements: u64,
    /// Bytes of all names from the root on, summed over the columns: each descriptor keeps its own copy of them.
    names_bytes: u64,
}

impl SchemaTree<'_, '_> {
    /// The next node with everything below it. `depth` nodes are above it, and their names have `above_bytes` bytes.
    fn read_node(&mut self, depth: usize, above_bytes: u64) -> Result<Type, String> {
        if depth > MAX_NESTING {
            return Err(format!("columns are nested more than {MAX_NESTING} deep"));
        }
        self.elements = self.elements.checked_sub(1).ok_or("the schema has fewer columns than it says")?;
        let (mut name, mut physical, mut repetition, mut children) = ("", None, Repetition::REQUIRED, 0);
        // The numbers of the fields are those of `SchemaElement` in parquet.thrift.
        let mut number = 0;
        while let Some(kind) = self.thrift.next_field(&mut number)? {
            match (number, kind) {
                (1, thrift::KIND_I32) => physical = Some(physical_type_from_number(self.thrift.read_number()?)?),
                (3, thrift::KIND_I32) => repetition = repetition_from_number(self.thrift.read_number()?)?,
                (4, thrift::KIND_BYTES) => {
                    name = std::str::from_utf8(self.thrift.read_bytes()?).map_err(|_| "a column's name is not text")?;
                }
                (5, thrift::KIND_I32) => children = self.thrift.read_number()?,
                _ => self.thrift.skip_value(kind)?,
            }
        }
        let names_bytes = above_bytes + name.len() as u64;
        if let (0, Some(physical), true) = (children, physical, depth > 0) {
            self.names_bytes += names_bytes;
            if self.names_bytes > MAX_FOOTER_BYTES {
                return Err(format!("the names of columns take more than {MAX_FOOTER_BYTES} bytes"));
            }
            // The length only matters for values of a fixed length, which are not read here.
            let leaf = Type::primitive_type_builder(name, physical).with_repetition(repetition).with_length(0);
            return leaf.build().map_err(|error| error.to_string());
        }
        let fields = (0..children).map(|_| self.read_node(depth + 1, names_bytes).map(Arc::new));
        let fields = fields.collect::<Result<_, _>>()?;
        let group = Type::group_type_builder(name).with_fields(fields);
        let group = if depth > 0 { group.with_repetition(repetition) } else { group };
        group.build().map_err(|error| error.to_string())
    }
}

/// The repetition type with this number in parquet.thrift.
fn repetition_from_number(number: i64) -> Result<Repetition, String> {
    match number {
        0 => Ok(Repetition::REQUIRED),
        1 => Ok(Repetition::OPTIONAL),
        2 => Ok(Repetition::REPEATED),
        other => Err(format!("a column has the unknown repetition type {other}")),
    }
}

/// The type of values with this number in parquet.thrift.
fn physical_type_from_number(number: i64) -> Result<Physical, String> {
    use Physical::{BOOLEAN, BYTE_ARRAY, DOUBLE, FIXED_LEN_BYTE_ARRAY, FLOAT, INT32, INT64, INT96};
    let kinds = [BOOLEAN, INT32, INT64, INT96, FLOAT, DOUBLE, BYTE_ARRAY, FIXED_LEN_BYTE_ARRAY];
    let kind = kinds.into_iter().find(|kind| *kind as i64 == number);
    kind.ok_or_else(|| format!("a column has values of the unknown type {number}"))
}
