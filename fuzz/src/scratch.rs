//! Folders for one input, in memory where the system has `/dev/shm`.

use std::{fs, path::Path};
use tempfile::TempDir;

/// An empty folder that is deleted when it is dropped.
pub fn folder() -> TempDir {
    let memory = Path::new("/dev/shm");
    if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() }
        .expect("a folder for scratch files")
}

/// Writes a file below a folder, and makes the folders on the way.
pub fn write(folder: &Path, file: &str, bytes: &[u8]) {
    let file = folder.join(file);
    if let Some(parent) = file.parent() {
        fs::create_dir_all(parent).expect("a folder for a scratch file");
    }
    fs::write(file, bytes).expect("a scratch file");
}
