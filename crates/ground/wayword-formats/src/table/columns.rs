//! Writes the columns of the Parquet table, in the order of its schema.

use super::ParquetRow;
use crate::leaf_column::{
    LeafColumn, list_column, optional_column, optional_list, optional_points, required_column, write_leaf,
};
use parquet::{
    data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type},
    errors::ParquetError,
    file::writer::SerializedRowGroupWriter,
};
use std::io::Write;
use wayword_core::{CheckFinding, PathTarget, TextAmbiguity, Verdict};
use wayword_language::Language;

/// Writes the columns of some rows.
pub(super) fn write_columns<W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    rows: &[ParquetRow<'_>],
) -> Result<(), ParquetError> {
    let mut columns = ColumnWriter { group };
    columns.write_text(rows)?;
    columns.write_path(rows)?;
    columns.write_ambiguity(rows)?;
    columns.write_provenance(rows)?;
    columns.write_checks(rows)
}

/// Writes columns one after the other; the order of its calls is the order of the schema.
struct ColumnWriter<'g, 'w, W: Write> {
    group: &'g mut SerializedRowGroupWriter<'w, W>,
}

impl<W: Write + Send> ColumnWriter<'_, '_, W> {
    /// Writes the next column of the schema.
    fn put_column<T: DataType>(&mut self, leaf: &LeafColumn<T::T>) -> Result<(), ParquetError> {
        write_leaf::<T>(self.group, leaf)
    }

    /// Writes a column of texts.
    fn put_texts<'r>(
        &mut self,
        rows: &[ParquetRow<'r>],
        cell: impl Fn(&ParquetRow<'r>) -> &'r str,
    ) -> Result<(), ParquetError> {
        self.put_column::<ByteArrayType>(&required_column(rows, |row| ByteArray::from(cell(row))))
    }

    /// Writes a column of texts, with null where a row has none.
    fn put_optional_texts<'r>(
        &mut self,
        rows: &[ParquetRow<'r>],
        cell: impl Fn(&ParquetRow<'r>) -> Option<&'r str>,
    ) -> Result<(), ParquetError> {
        self.put_column::<ByteArrayType>(&optional_column(rows, |row| cell(row).map(ByteArray::from)))
    }

    fn write_text(&mut self, rows: &[ParquetRow<'_>]) -> Result<(), ParquetError> {
        self.put_texts(rows, |row| &row.record.platform)?;
        self.put_texts(rows, |row| row.record.path.scene.as_str())?;
        self.put_column::<ByteArrayType>(&required_column(rows, |row| {
            ByteArray::from(row.record.path_id().into_bytes())
        }))?;
        self.put_texts(rows, |row| &row.record.path.id)?;
        self.put_texts(rows, |row| row.split)?;
        self.put_texts(rows, |row| &row.record.instruction.style)?;
        self.put_texts(rows, |row| &row.record.instruction.text)?;
        self.put_texts(rows, |row| Language::tag_of_text(&row.record.instruction.text))?;
        self.put_texts(rows, |row| verdict_name(row.record.instruction.verdict))
    }

    fn write_path(&mut self, rows: &[ParquetRow<'_>]) -> Result<(), ParquetError> {
        self.put_column::<ByteArrayType>(&optional_list(rows, viewpoint_names))?;
        self.put_column::<DoubleType>(&optional_points(rows, frame_positions))?;
        self.put_column::<DoubleType>(&optional_list(rows, frame_headings))?;
        self.put_column::<DoubleType>(&optional_column(rows, |row| row.record.path.length_m()))?;
        self.put_optional_texts(rows, |row| path_target(row).map(|target| target.object.as_str()))?;
        self.put_optional_texts(rows, |row| path_target(row).map(|target| target.name.as_str()))
    }

    fn write_ambiguity(&mut self, rows: &[ParquetRow<'_>]) -> Result<(), ParquetError> {
        let row_ambiguity = |row: &ParquetRow<'_>| row.record.instruction.ambiguity.clone();
        self.put_column::<BoolType>(&optional_column(rows, |row| {
            row_ambiguity(row).as_ref().map(TextAmbiguity::is_ambiguous)
        }))?;
        self.put_column::<Int64Type>(&optional_column(rows, |row| row_ambiguity(row)?.ends.map(count_as_i64)))?;
        self.put_column::<Int64Type>(&optional_column(rows, |row| {
            row_ambiguity(row).map(|ambiguity| count_as_i64(ambiguity.objects))
        }))
    }

    fn write_provenance(&mut self, rows: &[ParquetRow<'_>]) -> Result<(), ParquetError> {
        self.put_texts(rows, |row| &row.record.instruction.provenance.asker)?;
        self.put_texts(rows, |row| &row.record.instruction.provenance.answerer)?;
        self.put_optional_texts(rows, |row| row.record.instruction.provenance.detector.as_deref())?;
        self.put_texts(rows, |row| &row.record.instruction.provenance.summariser)?;
        self.put_texts(rows, |row| &row.record.instruction.provenance.writer)?;
        self.put_optional_texts(rows, |row| row.record.instruction.provenance.finished_for.as_deref())?;
        self.put_texts(rows, |row| &row.record.instruction.provenance.checked_against)?;
        // The schema declares this column unsigned; the same bits are passed as a signed number.
        self.put_column::<Int64Type>(&required_column(rows, |row| {
            row.record.instruction.provenance.seed.cast_signed()
        }))?;
        self.put_column::<Int64Type>(&required_column(rows, |row| {
            i64::from(row.record.instruction.provenance.repairs)
        }))?;
        self.put_texts(rows, |row| &row.record.instruction.provenance.style_hash)?;
        self.put_optional_texts(rows, |row| row.record.instruction.provenance.prompts_hash.as_deref())?;
        self.put_texts(rows, |row| &row.record.instruction.provenance.wayword)
    }

    fn write_checks(&mut self, rows: &[ParquetRow<'_>]) -> Result<(), ParquetError> {
        self.put_finding_texts(rows, |finding| finding.check.name())?;
        self.put_finding_texts(rows, |finding| verdict_name(finding.verdict))?;
        self.put_finding_texts(rows, |finding| &finding.reason)
    }

    /// Writes a column with a list of texts in each row, one for each finding.
    fn put_finding_texts(
        &mut self,
        rows: &[ParquetRow<'_>],
        text: impl Fn(&CheckFinding) -> &str,
    ) -> Result<(), ParquetError> {
        let element = |finding| ByteArray::from(text(finding));
        self.put_column::<ByteArrayType>(&list_column(rows, |row| {
            row.record.instruction.findings.iter().map(element).collect()
        }))
    }
}

/// The viewpoints of the path; `None` if a frame has none. If the motion is unknown, the frames are named after pictures, and these
/// names are left out.
fn viewpoint_names(row: &ParquetRow<'_>) -> Option<Vec<ByteArray>> {
    let frames = row.record.path.frames.iter().filter(|_| row.record.path.motion.is_known());
    let names = frames.map(|frame| frame.viewpoint.as_ref().map(|viewpoint| ByteArray::from(viewpoint.as_str())));
    names.collect::<Option<Vec<_>>>().filter(|names| !names.is_empty())
}

fn frame_positions(row: &ParquetRow<'_>) -> Option<Vec<[f64; 3]>> {
    let path = &row.record.path;
    path.motion.is_known().then(|| path.frames.iter().map(|frame| frame.pose.position.to_array()).collect())
}

fn frame_headings(row: &ParquetRow<'_>) -> Option<Vec<f64>> {
    let path = &row.record.path;
    path.motion.is_known().then(|| path.frames.iter().map(|frame| frame.pose.heading.rad()).collect())
}

fn path_target<'r>(row: &ParquetRow<'r>) -> Option<&'r PathTarget> {
    row.record.path.target.as_ref()
}

fn verdict_name(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Pass => "pass",
        Verdict::Unverified => "unverified",
        Verdict::Fail => "fail",
    }
}

fn count_as_i64(count: usize) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX)
}
