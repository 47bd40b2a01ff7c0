//! Fills the columns of the table, in the order of the schema.

use super::{
    Row,
    shred::{Leaf, list, optional, optional_list, optional_points, required},
};
use parquet::{
    data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type},
    errors::ParquetError,
    file::writer::SerializedRowGroupWriter,
};
use std::io::Write;
use wayword_core::{Ambiguity, Finding, Target, Verdict};

/// The language of Wayword's texts.
const LANGUAGE: &str = "en";

/// Writes the columns of some rows.
pub(super) fn write<W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    rows: &[Row<'_>],
) -> Result<(), ParquetError> {
    let mut columns = Columns { group };
    columns.text(rows)?;
    columns.path(rows)?;
    columns.ambiguity(rows)?;
    columns.provenance(rows)?;
    columns.checks(rows)
}

struct Columns<'g, 'w, W: Write> {
    group: &'g mut SerializedRowGroupWriter<'w, W>,
}

impl<W: Write + Send> Columns<'_, '_, W> {
    /// Writes the next column of the schema.
    fn put<T: DataType>(&mut self, leaf: &Leaf<T::T>) -> Result<(), ParquetError> {
        let column = self.group.next_column()?;
        let mut column = column.ok_or_else(|| ParquetError::General("the schema has fewer columns".to_owned()))?;
        column.typed::<T>().write_batch(&leaf.values, leaf.def.as_deref(), leaf.rep.as_deref())?;
        column.close()
    }

    fn words<'r>(&mut self, rows: &[Row<'r>], of: impl Fn(&Row<'r>) -> &'r str) -> Result<(), ParquetError> {
        self.put::<ByteArrayType>(&required(rows, |row| ByteArray::from(of(row))))
    }

    fn words_or_null<'r>(
        &mut self,
        rows: &[Row<'r>],
        of: impl Fn(&Row<'r>) -> Option<&'r str>,
    ) -> Result<(), ParquetError> {
        self.put::<ByteArrayType>(&optional(rows, |row| of(row).map(ByteArray::from)))
    }

    fn text(&mut self, rows: &[Row<'_>]) -> Result<(), ParquetError> {
        self.words(rows, |row| &row.record.platform)?;
        self.words(rows, |row| row.record.path.scene.as_str())?;
        self.put::<ByteArrayType>(&required(rows, |row| ByteArray::from(row.record.path_id().into_bytes())))?;
        self.words(rows, |row| &row.record.path.id)?;
        self.words(rows, |row| row.split)?;
        self.words(rows, |row| &row.record.instruction.style)?;
        self.words(rows, |row| &row.record.instruction.text)?;
        self.words(rows, |_| LANGUAGE)?;
        self.words(rows, |row| verdict(row.record.instruction.verdict))
    }

    fn path(&mut self, rows: &[Row<'_>]) -> Result<(), ParquetError> {
        self.put::<ByteArrayType>(&optional_list(rows, viewpoints))?;
        self.put::<DoubleType>(&optional_points(rows, positions))?;
        self.put::<DoubleType>(&optional_list(rows, headings))?;
        self.put::<DoubleType>(&optional(rows, |row| row.record.path.length_m()))?;
        self.words_or_null(rows, |row| target(row).map(|target| target.object.as_str()))?;
        self.words_or_null(rows, |row| target(row).map(|target| target.name.as_str()))
    }

    fn ambiguity(&mut self, rows: &[Row<'_>]) -> Result<(), ParquetError> {
        let of = |row: &Row<'_>| row.record.instruction.ambiguity.clone();
        self.put::<BoolType>(&optional(rows, |row| of(row).as_ref().map(Ambiguity::is_ambiguous)))?;
        self.put::<Int64Type>(&optional(rows, |row| of(row)?.ends.map(number)))?;
        self.put::<Int64Type>(&optional(rows, |row| of(row).map(|ambiguity| number(ambiguity.objects))))
    }

    fn provenance(&mut self, rows: &[Row<'_>]) -> Result<(), ParquetError> {
        self.words(rows, |row| &row.record.instruction.provenance.asker)?;
        self.words(rows, |row| &row.record.instruction.provenance.answerer)?;
        self.words_or_null(rows, |row| row.record.instruction.provenance.detector.as_deref())?;
        self.words(rows, |row| &row.record.instruction.provenance.summariser)?;
        self.words(rows, |row| &row.record.instruction.provenance.writer)?;
        self.words_or_null(rows, |row| row.record.instruction.provenance.finished_for.as_deref())?;
        self.words(rows, |row| &row.record.instruction.provenance.checked_against)?;
        // In the schema, the bits are those of an unsigned number.
        self.put::<Int64Type>(&required(rows, |row| row.record.instruction.provenance.seed.cast_signed()))?;
        self.put::<Int64Type>(&required(rows, |row| i64::from(row.record.instruction.provenance.repairs)))?;
        self.words(rows, |row| &row.record.instruction.provenance.style_hash)?;
        self.words_or_null(rows, |row| row.record.instruction.provenance.prompts_hash.as_deref())?;
        self.words(rows, |row| &row.record.instruction.provenance.wayword)
    }

    fn checks(&mut self, rows: &[Row<'_>]) -> Result<(), ParquetError> {
        self.of_findings(rows, |finding| finding.check.name())?;
        self.of_findings(rows, |finding| verdict(finding.verdict))?;
        self.of_findings(rows, |finding| &finding.reason)
    }

    fn of_findings(&mut self, rows: &[Row<'_>], of: impl Fn(&Finding) -> &str) -> Result<(), ParquetError> {
        let of = |finding| ByteArray::from(of(finding));
        self.put::<ByteArrayType>(&list(rows, |row| row.record.instruction.findings.iter().map(of).collect()))
    }
}

/// The nodes of the viewpoint graph; `None` if a frame is not a node, or the names are those of pictures.
fn viewpoints(row: &Row<'_>) -> Option<Vec<ByteArray>> {
    let frames = row.record.path.frames.iter().filter(|_| row.record.path.motion.is_known());
    let names = frames.map(|frame| frame.viewpoint.as_ref().map(|viewpoint| ByteArray::from(viewpoint.as_str())));
    names.collect::<Option<Vec<_>>>().filter(|names| !names.is_empty())
}

fn positions(row: &Row<'_>) -> Option<Vec<[f64; 3]>> {
    let path = &row.record.path;
    path.motion.is_known().then(|| path.frames.iter().map(|frame| frame.pose.position.to_array()).collect())
}

fn headings(row: &Row<'_>) -> Option<Vec<f64>> {
    let path = &row.record.path;
    path.motion.is_known().then(|| path.frames.iter().map(|frame| frame.pose.heading.rad()).collect())
}

fn target<'r>(row: &Row<'r>) -> Option<&'r Target> {
    row.record.path.target.as_ref()
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Pass => "pass",
        Verdict::Unverified => "unverified",
        Verdict::Fail => "fail",
    }
}

fn number(count: usize) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX)
}
