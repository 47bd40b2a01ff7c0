//! Writes a file under a temporary name, and moves it to its place once it is complete. An interrupted command leaves the old file.
//! A pipe or a device is written to directly.

use std::{
    fs::{self, File},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};
use wayword_formats::is_stream;
use wayword_run::error::CommandError;

/// A file under a temporary name in the folder of its place. If dropped before it is finished, it is removed, and the old file stays.
pub struct UnfinishedFile {
    file: BufWriter<File>,
    /// Its temporary name, if it has one.
    beside: Option<PathBuf>,
    out: PathBuf,
}

impl UnfinishedFile {
    /// Begins a file.
    ///
    /// # Errors
    /// When it cannot be made.
    pub(super) fn new(out: &Path) -> Result<Self, CommandError> {
        if is_stream(out) {
            let stream = File::options().write(true).open(out).map_err(CommandError::io(out, "write"))?;
            return Ok(Self { file: BufWriter::new(stream), beside: None, out: out.to_owned() });
        }
        let mut name = std::ffi::OsString::from(".");
        name.push(out.file_name().unwrap_or_default());
        name.push(format!(".{}.part", std::process::id()));
        let beside = out.with_file_name(name);
        let file = File::create(&beside).map_err(CommandError::io(out, "write"))?;
        Ok(Self { file: BufWriter::new(file), beside: Some(beside), out: out.to_owned() })
    }

    /// Writes a complete file with these bytes.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write_whole(out: &Path, bytes: &[u8]) -> Result<(), CommandError> {
        let mut file = Self::new(out)?;
        file.write_all(bytes).map_err(CommandError::io(out, "write"))?;
        file.move_to_place()
    }

    /// Moves it to its place.
    ///
    /// # Errors
    /// When it cannot be written or moved.
    pub(super) fn move_to_place(mut self) -> Result<(), CommandError> {
        self.file
            .flush()
            .and_then(|()| self.beside.as_ref().map_or(Ok(()), |beside| fs::rename(beside, &self.out)))
            .map_err(CommandError::io(&self.out, "write"))
    }
}

impl Write for UnfinishedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for UnfinishedFile {
    fn drop(&mut self) {
        // A finished file is no longer here. A file that cannot be removed stays.
        if let Some(beside) = &self.beside {
            let _ = fs::remove_file(beside);
        }
    }
}
