//! Writes files completely or not at all.

use crate::FormatError;
use flate2::{Compression, write::GzEncoder};
use serde::Serialize;
use std::{
    ffi::OsString,
    fs::{self, File},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

/// Writes a temporary file next to the final one and then renames it, so that a reader never sees half of it. The file
/// is gzip where its name ends in `.gz`.
pub(crate) fn write_file(file: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), FormatError> {
    let temporary = temporary_name(file)?;
    let written = write_to(&temporary, file.extension().is_some_and(|ending| ending == "gz"), fill)
        .and_then(|()| fs::rename(&temporary, file));
    written.map_err(|source| {
        // The first failure is the one to report. If the file cannot be removed either, it is left.
        let _ = fs::remove_file(&temporary);
        FormatError::from_io(file, "write", source)
    })
}

/// A hidden name in the same folder, with the number of this process: `.NAME.1234.part`.
fn temporary_name(file: &Path) -> Result<PathBuf, FormatError> {
    let Some(name) = file.file_name() else {
        return Err(FormatError::for_document(file, "it is not the name of a file", "give a file to write"));
    };
    let mut hidden = OsString::from(".");
    hidden.push(name);
    hidden.push(format!(".{}.part", std::process::id()));
    Ok(file.with_file_name(hidden))
}

fn write_to(file: &Path, gzip: bool, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut plain = BufWriter::new(File::create(file)?);
    if gzip {
        let mut zipped = GzEncoder::new(&mut plain, Compression::default());
        fill(&mut zipped)?;
        zipped.finish()?;
    } else {
        fill(&mut plain)?;
    }
    plain.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()
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
/// line. Returns the file's name.
///
/// # Errors
/// When the file cannot be written.
pub fn write_sidecar<T: Serialize>(dataset: &Path, records: &[T]) -> Result<PathBuf, FormatError> {
    let mut name = dataset.as_os_str().to_owned();
    name.push(".provenance.jsonl");
    let sidecar = PathBuf::from(name);
    write_file(&sidecar, |out| write_lines(out, records))?;
    Ok(sidecar)
}
