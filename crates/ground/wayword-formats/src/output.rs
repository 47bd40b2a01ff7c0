//! Writes files completely or not at all, and through pipes and devices.

use crate::FormatError;
use flate2::{Compression, write::GzEncoder};
use serde::Serialize;
use std::{
    ffi::OsString,
    fs::{self, File},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

/// Writes a temporary file next to the final one and then renames it, so that a reader never sees half of it. A link to
/// a file stays, and the file gets the new contents. What is no file, as a pipe or a device, is written to directly,
/// because a file in its place would be of no use to its reader. The file is gzip where its name ends in `.gz`.
pub(crate) fn write_file(file: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), FormatError> {
    refuse_dash(file)?;
    let is_gzip = file.extension().is_some_and(|ending| ending == "gz");
    if is_stream(file) {
        let written = File::options().write(true).open(file).and_then(|stream| write_to(stream, is_gzip, fill));
        return written.map(drop).map_err(|source| FormatError::from_io(file, "write", source));
    }
    let place = linked_file(file);
    let temporary = temporary_name(&place)?;
    let written = File::create(&temporary)
        .and_then(|new| write_to(new, is_gzip, fill)?.sync_all())
        .and_then(|()| fs::rename(&temporary, &place));
    written.map_err(|source| {
        // The first failure is the one to report. If the file cannot be removed either, it is left.
        let _ = fs::remove_file(&temporary);
        FormatError::from_io(file, "write", source)
    })
}

/// Refuses the name "-", by which other programs mean standard output.
fn refuse_dash(file: &Path) -> Result<(), FormatError> {
    if file.as_os_str() == "-" {
        let hint = "give /dev/stdout for standard output, or ./- for a file of that name";
        return Err(FormatError::for_document(file, "it is no name of a file", hint));
    }
    Ok(())
}

/// Whether there is something of that name that is neither a file nor a folder: a pipe, a device, a socket.
#[must_use]
pub fn is_stream(file: &Path) -> bool {
    fs::metadata(file).is_ok_and(|about| !about.is_file() && !about.is_dir())
}

/// The file that a link leads to, or else the name itself: `/dev/stdout` may be a link to a file, and has to remain.
fn linked_file(file: &Path) -> PathBuf {
    let is_link = fs::symlink_metadata(file).is_ok_and(|about| about.is_symlink());
    let linked = is_link.then(|| fs::canonicalize(file).ok()).flatten();
    linked.unwrap_or_else(|| file.to_owned())
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

fn write_to(out: File, is_gzip: bool, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<File> {
    let mut plain = BufWriter::new(out);
    if is_gzip {
        let mut zipped = GzEncoder::new(&mut plain, Compression::default());
        fill(&mut zipped)?;
        zipped.finish()?;
    } else {
        fill(&mut plain)?;
    }
    plain.into_inner().map_err(io::IntoInnerError::into_error)
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
    if is_stream(dataset) {
        return Ok(None);
    }
    let mut name = dataset.as_os_str().to_owned();
    name.push(".provenance.jsonl");
    let sidecar = PathBuf::from(name);
    write_file(&sidecar, |out| write_lines(out, records))?;
    Ok(Some(sidecar))
}
