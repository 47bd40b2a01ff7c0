//! Shards as WebDataset reads them: tar archives in which the files of a sample follow one another and share the part
//! of their name before the first point.

use super::{ActionTrajectory, PictureKind, pictures::sample_file, trajectory_line};
use crate::OutputFile;
use std::{
    fmt, io,
    path::{Path, PathBuf},
};

/// A shard that is being written, under another name until it is whole.
pub struct ShardWriter {
    file: PathBuf,
    tar: tar::Builder<OutputFile>,
}

impl fmt::Debug for ShardWriter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Shard({})", self.file.display())
    }
}

impl ShardWriter {
    /// Begins a shard.
    ///
    /// # Errors
    /// When the file cannot be made.
    pub fn begin(file: &Path) -> io::Result<Self> {
        Ok(Self { file: file.to_owned(), tar: tar::Builder::new(OutputFile::begin(file)?) })
    }

    /// Adds a walk with what a camera sees, kind by kind.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn add_walk(
        &mut self,
        key: &str,
        trajectory: &ActionTrajectory,
        pictures: &[(PictureKind, &[Vec<u8>])],
    ) -> io::Result<()> {
        self.append_file(&format!("{key}.json"), &serde_json::to_vec(&trajectory_line(trajectory))?)?;
        for (kind, pictures) in pictures {
            for (number, picture) in pictures.iter().enumerate() {
                self.append_file(&sample_file(key, *kind, number), picture)?;
            }
        }
        Ok(())
    }

    /// Appends a file without time and owner, so that the same walks give the same bytes.
    fn append_file(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        let mut header = tar::Header::new_ustar();
        header.set_size(bytes.len() as u64);
        header.set_mode(0o644);
        header.set_cksum();
        self.tar.append_data(&mut header, name, bytes)
    }

    /// Ends the shard: writes it to the disk, and gives it its name.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn finish(self) -> io::Result<()> {
        self.tar.into_inner()?.finish()
    }
}
