//! Writes datasets: lists and lines of JSON, as gzip where the name asks for that, and the provenance beside them.

use crate::{FormatError, OutputFile, OutputPlace};
use flate2::{Compression, write::GzEncoder};
use serde::Serialize;
use std::{
    io::{self, Write},
    path::{Path, PathBuf},
};

/// Writes a file as [`OutputFile`] does; it is gzip where its name ends in `.gz`.
pub(crate) fn write_file(file: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), FormatError> {
    let is_gzip = file.extension().is_some_and(|ending| ending == "gz");
    let write = || {
        let mut output = OutputFile::begin(file)?;
        if is_gzip {
            let mut zipped = GzEncoder::new(&mut output, Compression::default());
            fill(&mut zipped)?;
            zipped.finish()?;
        } else {
            fill(&mut output)?;
        }
        output.finish()
    };
    write().map_err(|source| FormatError::from_io(file, "write", source))
}

/// Writes a JSON list with one item per line, so that two versions can be compared line by line.
pub(crate) fn write_list<T: Serialize>(out: &mut dyn Write, items: impl IntoIterator<Item = T>) -> io::Result<()> {
    let mut separator = "[\n";
    for item in items {
        out.write_all(separator.as_bytes())?;
        serde_json::to_writer(&mut *out, &item)?;
        separator = ",\n";
    }
    out.write_all(if separator == "[\n" { b"[]" } else { b"\n]" })
}

/// Writes one JSON object per line.
pub(crate) fn write_lines<T: Serialize>(out: &mut dyn Write, items: impl IntoIterator<Item = T>) -> io::Result<()> {
    for item in items {
        serde_json::to_writer(&mut *out, &item)?;
        out.write_all(b"\n")?;
    }
    Ok(())
}

/// Writes `<name>.provenance.jsonl` next to a dataset, for facts that its format has no field for: one JSON object per
/// line. Returns the file's name; `None` where the dataset went through a pipe or to a device, beside which there is no
/// place.
///
/// # Errors
/// When the file cannot be written.
pub fn write_sidecar<T: Serialize>(dataset: &Path, records: &[T]) -> Result<Option<PathBuf>, FormatError> {
    if !matches!(OutputPlace::for_name(dataset), Ok(OutputPlace::File(_))) {
        return Ok(None);
    }
    let mut name = dataset.as_os_str().to_owned();
    name.push(".provenance.jsonl");
    let sidecar = PathBuf::from(name);
    write_file(&sidecar, |out| write_lines(out, records))?;
    Ok(Some(sidecar))
}
