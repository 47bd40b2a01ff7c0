//! Reads whole files up to a size limit. The errors name the file, the reason and a way out.

#![cfg_attr(
    not(test),
    warn(
        clippy::indexing_slicing,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap
    )
)]

use std::path::{Path, PathBuf};
use wayword_core::PlatformError;

/// A file that cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}: {reason}; {hint}", file.display())]
pub struct FileError {
    /// Which file.
    pub file: PathBuf,
    /// The fault, with the item, line or byte.
    pub reason: String,
    /// A way out.
    pub hint: &'static str,
}

impl FileError {
    pub(crate) fn new(file: &Path, reason: impl Into<String>, hint: &'static str) -> Self {
        Self { file: file.to_owned(), reason: reason.into(), hint }
    }
}

impl From<FileError> for PlatformError {
    fn from(error: FileError) -> Self {
        Self::File { file: error.file, reason: error.reason, hint: error.hint }
    }
}

/// Reads a file's bytes, at most `most` of them; `None` if the file does not exist.
pub(crate) fn bytes_if_there(file: &Path, most: u64, hint: &'static str) -> Result<Option<Vec<u8>>, FileError> {
    let wrong = |error: std::io::Error| FileError::new(file, error.to_string(), hint);
    let about = match std::fs::metadata(file) {
        Ok(about) => about,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(wrong(error)),
    };
    if let Some(reason) = wayword_world::files::describe_irregular(&about) {
        return Err(FileError::new(file, reason, hint));
    }
    let opened = std::fs::File::open(file).map_err(wrong)?;
    let mut bytes = Vec::new();
    // Reading one byte more than allowed shows that the file is too long, whatever length the file system reports.
    std::io::Read::read_to_end(&mut std::io::Read::take(opened, most + 1), &mut bytes).map_err(wrong)?;
    if bytes.len() as u64 > most {
        return Err(FileError::new(file, format!("is larger than {most} bytes"), hint));
    }
    Ok(Some(bytes))
}

/// Reads the bytes of a file that must exist.
pub(crate) fn read_bytes(file: &Path, most: u64, hint: &'static str) -> Result<Vec<u8>, FileError> {
    bytes_if_there(file, most, hint)?.ok_or_else(|| FileError::new(file, "there is no such file", hint))
}

/// Reads a UTF-8 file; `None` if it does not exist.
pub(crate) fn text_if_there(file: &Path, most: u64, hint: &'static str) -> Result<Option<String>, FileError> {
    let Some(bytes) = bytes_if_there(file, most, hint)? else { return Ok(None) };
    wayword_world::files::decode_utf8(bytes).map(Some).map_err(|reason| FileError::new(file, reason, hint))
}
