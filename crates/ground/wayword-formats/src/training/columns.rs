//! Parquet files with the columns that loaders in Python expect: numbers, texts, lists, matrices and LeRobot's language rows.

use crate::{
    FormatError, OutputFile,
    leaf_column::{field_of_entries, matrix_column, required_column, write_leaf},
};
use parquet::{
    basic::{Compression, LogicalType, Repetition, Type as PhysicalType},
    data_type::{ByteArray, ByteArrayType, DoubleType, FloatType, Int32Type, Int64Type},
    errors::ParquetError,
    file::{
        metadata::KeyValue,
        properties::WriterProperties,
        writer::{SerializedFileWriter, SerializedRowGroupWriter},
    },
    schema::types::{Type, TypePtr},
};
use std::{
    fmt,
    io::Write,
    path::{Path, PathBuf},
    sync::Arc,
};

/// The values of a column, one for each row.
#[derive(Debug, Clone, PartialEq)]
pub enum ColumnValues {
    /// Whole numbers of 64 bits.
    Int64(Vec<i64>),
    /// Whole numbers of 32 bits.
    Int32(Vec<i32>),
    /// Numbers of 32 bits.
    Float32(Vec<f32>),
    /// Numbers of 64 bits.
    Float64(Vec<f64>),
    /// Texts.
    Text(Vec<String>),
    /// A list of whole numbers in each row.
    Int32List(Vec<Vec<i32>>),
    /// A list of numbers in each row.
    Float32List(Vec<Vec<f32>>),
    /// A list of texts in each row.
    TextList(Vec<Vec<String>>),
    /// A matrix in each row: a list of rows.
    Float32Matrix(Vec<Vec<Vec<f32>>>),
    /// LeRobot's language rows with a time.
    LanguagePersistent(Vec<Vec<LanguageRow>>),
    /// LeRobot's language rows of a frame, without a time.
    LanguageEvents(Vec<Vec<LanguageRow>>),
}

/// A row of language: who says what, in which style.
#[derive(Debug, Clone, PartialEq)]
pub struct LanguageRow {
    /// Who says it: `user` or `assistant`.
    pub role: &'static str,
    /// The words.
    pub content: String,
    /// What it is: `subtask`, `plan`, `task_aug`, `vqa`.
    pub style: &'static str,
    /// From when on it holds, seconds. Events have none.
    pub time_s: f32,
    /// The camera that it is about, where it is about a picture.
    pub camera: Option<String>,
}

/// A named column.
pub type NamedColumn = (String, ColumnValues);

/// A Parquet file that is written group by group, with Snappy, under its name only when it is whole. Equal values give equal bytes.
pub struct ColumnFile {
    file: PathBuf,
    writer: SerializedFileWriter<OutputFile>,
}

impl fmt::Debug for ColumnFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ColumnFile({})", self.file.display())
    }
}

impl ColumnFile {
    /// Begins a file with columns of the names and kinds of `like`. `notes` are texts in the file's foot, by name.
    ///
    /// # Errors
    /// When the file cannot be made.
    pub fn begin(file: &Path, like: &[NamedColumn], notes: &[(&str, &str)]) -> Result<Self, FormatError> {
        let output = OutputFile::begin(file).map_err(|source| FormatError::from_io(file, "write", source))?;
        let notes = notes.iter().map(|(name, text)| KeyValue::new((*name).to_owned(), (*text).to_owned())).collect();
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_created_by(concat!("wayword version ", env!("CARGO_PKG_VERSION")).to_owned())
            .set_key_value_metadata(Some(notes))
            .build();
        let begin = || {
            let fields = like.iter().map(|(name, values)| values.field_type(name)).collect::<Result<Vec<_>, _>>()?;
            let schema = Arc::new(Type::group_type_builder("schema").with_fields(fields).build()?);
            SerializedFileWriter::new(output, schema, Arc::new(properties))
        };
        Ok(Self { file: file.to_owned(), writer: begin().map_err(|error| not_parquet(file, &error))? })
    }

    /// Writes some rows, which stay together.
    ///
    /// # Errors
    /// When they cannot be written.
    pub fn write_group(&mut self, columns: &[NamedColumn]) -> Result<(), FormatError> {
        let mut write = || {
            let mut group = self.writer.next_row_group()?;
            columns.iter().try_for_each(|(_, values)| values.write_rows(&mut group))?;
            group.close().map(drop)
        };
        write().map_err(|error| not_parquet(&self.file, &error))
    }

    /// Ends the file.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn finish(self) -> Result<(), FormatError> {
        let output = self.writer.into_inner().map_err(|error| not_parquet(&self.file, &error))?;
        output.finish().map_err(|source| FormatError::from_io(&self.file, "write", source))
    }
}

fn not_parquet(file: &Path, error: &ParquetError) -> FormatError {
    FormatError::for_document(file, format!("it cannot be written as Parquet: {error}"), "see whether the disk is full")
}

/// Writes a Parquet file of one group of rows.
///
/// # Errors
/// When it cannot be written.
pub fn write_column_file(file: &Path, columns: &[NamedColumn], notes: &[(&str, &str)]) -> Result<(), FormatError> {
    let mut written = ColumnFile::begin(file, columns, notes)?;
    written.write_group(columns)?;
    written.finish()
}

fn primitive(name: &str, kind: PhysicalType, repetition: Repetition, is_text: bool) -> Result<TypePtr, ParquetError> {
    let logical = is_text.then_some(LogicalType::String);
    let builder = Type::primitive_type_builder(name, kind).with_repetition(repetition).with_logical_type(logical);
    Ok(Arc::new(builder.build()?))
}

/// A list as Parquet asks for it: a group with a repeated group `list` of `element`.
fn list_of(name: &str, element: TypePtr, repetition: Repetition) -> Result<TypePtr, ParquetError> {
    let list = Type::group_type_builder("list").with_repetition(Repetition::REPEATED).with_fields(vec![element]);
    let outer = Type::group_type_builder(name)
        .with_repetition(repetition)
        .with_logical_type(Some(LogicalType::List))
        .with_fields(vec![Arc::new(list.build()?)]);
    Ok(Arc::new(outer.build()?))
}

impl ColumnValues {
    pub(super) fn field_type(&self, name: &str) -> Result<TypePtr, ParquetError> {
        let required = Repetition::REQUIRED;
        let element = |kind, is_text| primitive("element", kind, required, is_text);
        match self {
            Self::Int64(_) => primitive(name, PhysicalType::INT64, required, false),
            Self::Int32(_) => primitive(name, PhysicalType::INT32, required, false),
            Self::Float32(_) => primitive(name, PhysicalType::FLOAT, required, false),
            Self::Float64(_) => primitive(name, PhysicalType::DOUBLE, required, false),
            Self::Text(_) => primitive(name, PhysicalType::BYTE_ARRAY, required, true),
            Self::Int32List(_) => list_of(name, element(PhysicalType::INT32, false)?, required),
            Self::Float32List(_) => list_of(name, element(PhysicalType::FLOAT, false)?, required),
            Self::TextList(_) => list_of(name, element(PhysicalType::BYTE_ARRAY, true)?, required),
            Self::Float32Matrix(_) => {
                let row = list_of("element", element(PhysicalType::FLOAT, false)?, required)?;
                list_of(name, row, required)
            }
            Self::LanguagePersistent(_) => language_type(name, true),
            Self::LanguageEvents(_) => language_type(name, false),
        }
    }

    pub(super) fn write_rows<W: Write + Send>(
        &self,
        group: &mut SerializedRowGroupWriter<'_, W>,
    ) -> Result<(), ParquetError> {
        let bytes = |text: &String| ByteArray::from(text.as_bytes().to_vec());
        match self {
            Self::Int64(values) => write_leaf::<Int64Type>(group, &required_column(values, |value| *value)),
            Self::Int32(values) => write_leaf::<Int32Type>(group, &required_column(values, |value| *value)),
            Self::Float32(values) => write_leaf::<FloatType>(group, &required_column(values, |value| *value)),
            Self::Float64(values) => write_leaf::<DoubleType>(group, &required_column(values, |value| *value)),
            Self::Text(values) => write_leaf::<ByteArrayType>(group, &required_column(values, bytes)),
            Self::Int32List(lists) => write_leaf::<Int32Type>(group, &field_of_entries(lists, 1, |value| Some(*value))),
            Self::Float32List(lists) => {
                write_leaf::<FloatType>(group, &field_of_entries(lists, 1, |value| Some(*value)))
            }
            Self::TextList(lists) => {
                write_leaf::<ByteArrayType>(group, &field_of_entries(lists, 1, |value| Some(bytes(value))))
            }
            Self::Float32Matrix(matrices) => write_leaf::<FloatType>(group, &matrix_column(matrices)),
            Self::LanguagePersistent(lists) => put_language(group, lists, true),
            Self::LanguageEvents(lists) => put_language(group, lists, false),
        }
    }
}

/// LeRobot's type of language (`lerobot/datasets/language.py`).
fn language_type(name: &str, has_time: bool) -> Result<TypePtr, ParquetError> {
    let (required, optional) = (Repetition::REQUIRED, Repetition::OPTIONAL);
    let text = |name: &str, repetition| primitive(name, PhysicalType::BYTE_ARRAY, repetition, true);
    let mut fields = vec![text("role", required)?, text("content", optional)?, text("style", optional)?];
    if has_time {
        fields.push(primitive("timestamp", PhysicalType::FLOAT, required, false)?);
    }
    fields.push(text("camera", optional)?);
    fields.push(list_of("tool_calls", text("element", optional)?, optional)?);
    let row = Type::group_type_builder("element").with_repetition(required).with_fields(fields);
    list_of(name, Arc::new(row.build()?), required)
}

fn put_language(
    group: &mut SerializedRowGroupWriter<'_, impl Write + Send>,
    rows: &[Vec<LanguageRow>],
    has_time: bool,
) -> Result<(), ParquetError> {
    let text = |text: &str| ByteArray::from(text.as_bytes().to_vec());
    write_leaf::<ByteArrayType>(group, &field_of_entries(rows, 1, |row| Some(text(row.role))))?;
    write_leaf::<ByteArrayType>(group, &field_of_entries(rows, 2, |row| Some(text(&row.content))))?;
    write_leaf::<ByteArrayType>(group, &field_of_entries(rows, 2, |row| Some(text(row.style))))?;
    if has_time {
        write_leaf::<FloatType>(group, &field_of_entries(rows, 1, |row| Some(row.time_s)))?;
    }
    write_leaf::<ByteArrayType>(group, &field_of_entries(rows, 2, |row| row.camera.as_deref().map(text)))?;
    // No row calls a tool: the list is null.
    write_leaf::<ByteArrayType>(group, &field_of_entries(rows, 2, |_| None))
}

#[cfg(test)]
mod tests {
    use super::*;
    use parquet::{
        file::reader::{FileReader as _, SerializedFileReader},
        record::Row,
    };

    #[test]
    fn nested_values_come_back() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.parquet");
        let said = |content: &str, camera: Option<&str>| LanguageRow {
            role: "user",
            content: content.to_owned(),
            style: "vqa",
            time_s: 0.5,
            camera: camera.map(str::to_owned),
        };
        let columns = [
            ("pose.125cm_30deg".to_owned(), ColumnValues::Float32Matrix(vec![vec![vec![1.0, 2.0], vec![3.0, 4.0]]; 2])),
            ("goal".to_owned(), ColumnValues::Int32List(vec![vec![], vec![5, 6]])),
            (
                "said".to_owned(),
                ColumnValues::LanguagePersistent(vec![vec![said("a", None), said("b", Some("front"))], vec![]]),
            ),
            ("tasks/x".to_owned(), ColumnValues::TextList(vec![vec!["t".to_owned()], vec![]])),
        ];
        write_column_file(&file, &columns, &[("pandas", "{}")]).unwrap();
        let reader = SerializedFileReader::new(std::fs::File::open(&file).unwrap()).unwrap();
        let rows: Vec<String> =
            reader.get_row_iter(None).unwrap().map(|row: Result<Row, _>| row.unwrap().to_string()).collect();
        assert_eq!(rows.len(), 2);
        for told in [
            "pose.125cm_30deg: [[1.0, 2.0], [3.0, 4.0]]",
            "goal: []",
            "camera: \"front\"",
            "content: \"a\"",
            "tool_calls: null",
            "tasks/x: [\"t\"]",
        ] {
            assert!(rows[0].contains(told), "{told}: {}", rows[0]);
        }
        assert!(rows[1].contains("goal: [5, 6]") && rows[1].contains("said: []"), "{}", rows[1]);
        let notes = reader.metadata().file_metadata().key_value_metadata().unwrap();
        assert_eq!(notes[0].key, "pandas");
    }
}
