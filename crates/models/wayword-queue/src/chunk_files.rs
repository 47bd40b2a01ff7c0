//! The files of a finished chunk as its mark holds them, and how the files that are there now differ from it.

use crate::QueueError;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::{
    collections::BTreeMap,
    fs::{self, File},
    io::{ErrorKind, Read},
    path::Path,
};

/// The state of a file, or of a folder of files, when its chunk was finished.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileMark {
    /// Whole lines of a file; files of a folder.
    pub count: u64,
    /// Length, bytes; of a folder the sum of its files.
    pub bytes: u64,
    /// SHA-256 of the content, hexadecimal; of a folder that of the names and hashes of its files.
    pub sha256: String,
}

/// The marks of a chunk's files, by name.
pub type FileMarks = BTreeMap<String, FileMark>;

/// How thoroughly files are compared with their marks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CompareDepth {
    /// No file is looked at: only the marks are read.
    Marks,
    /// Lengths alone, and no folders.
    Lengths,
    /// Contents of files, and no folders.
    Files,
    /// Contents of everything.
    Everything,
}

/// Marks those of the files and folders that are there.
///
/// # Errors
/// When one cannot be read.
pub fn mark_files(folder: &Path, names: &[&str]) -> Result<FileMarks, QueueError> {
    let mut marks = FileMarks::new();
    for name in names {
        if let Some(mark) = mark_path(&folder.join(name))? {
            marks.insert((*name).to_owned(), mark);
        }
    }
    Ok(marks)
}

/// The mark of a file or a folder as it is now; `None` if it is not there.
fn mark_path(path: &Path) -> Result<Option<FileMark>, QueueError> {
    let about = match fs::metadata(path) {
        Ok(about) => about,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(QueueError::Io { path: path.to_owned(), doing: "look at", source }),
    };
    if about.is_dir() { mark_folder(path).map(Some) } else { mark_file(path, about.is_file()).map(Some) }
}

fn mark_file(path: &Path, is_file: bool) -> Result<FileMark, QueueError> {
    // Reading a pipe would wait for ever.
    if !is_file {
        return Err(QueueError::Broken { path: path.to_owned(), problem: "it is no file".to_owned() });
    }
    let mut file = File::open(path).map_err(QueueError::for_file(path, "read"))?;
    let (mut hash, mut mark, mut buffer) = (Sha256::new(), FileMark::default(), vec![0; 1 << 16]);
    loop {
        let length = file.read(&mut buffer).map_err(QueueError::for_file(path, "read"))?;
        let piece = buffer.get(..length).unwrap_or_default();
        if piece.is_empty() {
            break;
        }
        hash.update(piece);
        mark.bytes += piece.len() as u64;
        mark.count += piece.iter().filter(|byte| **byte == b'\n').count() as u64;
    }
    Ok(FileMark { sha256: hex_hash(hash), ..mark })
}

/// The mark of a folder: of its plain files, not of folders in it.
fn mark_folder(path: &Path) -> Result<FileMark, QueueError> {
    let mut names = Vec::new();
    for entry in fs::read_dir(path).map_err(QueueError::for_file(path, "list"))? {
        let entry = entry.map_err(QueueError::for_file(path, "list"))?;
        if entry.file_type().is_ok_and(|kind| kind.is_file()) {
            names.push(entry.file_name());
        }
    }
    names.sort_unstable();
    let (mut hash, mut mark) = (Sha256::new(), FileMark::default());
    for name in names {
        let file = mark_file(&path.join(&name), true)?;
        mark.count += 1;
        mark.bytes += file.bytes;
        hash.update(name.as_encoded_bytes());
        hash.update([0]);
        hash.update(file.sha256.as_bytes());
    }
    Ok(FileMark { sha256: hex_hash(hash), ..mark })
}

fn hex_hash(hash: Sha256) -> String {
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// How a file, or a folder, differs from its mark.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FileDifference {
    /// It is not there; its mark has so many lines or files.
    Missing(u64),
    /// It has no mark.
    Added,
    /// It is empty; its mark has so many lines or files.
    Empty(u64),
    /// Its last line is not whole.
    CutOff {
        /// Whole lines.
        found: u64,
        /// Lines of its mark.
        marked: u64,
    },
    /// It has another number of lines or files.
    Count {
        /// Lines or files that are there.
        found: u64,
        /// Those of its mark.
        marked: u64,
        /// The hash of the content that is there.
        sha256: String,
    },
    /// It has as many lines or files, with another content. This is the hash of the content.
    Content(String),
    /// Its length differs; its content was not read.
    Length {
        /// Bytes that are there.
        found: u64,
        /// Bytes of its mark.
        marked: u64,
    },
}

/// Compares the files of a chunk with their marks. `names` are all that a chunk can have.
///
/// # Errors
/// When a file cannot be read.
pub fn compare_files(
    folder: &Path,
    marks: &FileMarks,
    names: &[&str],
    depth: CompareDepth,
) -> Result<Vec<(String, FileDifference)>, QueueError> {
    let mut differences = Vec::new();
    for name in names.iter().filter(|_| depth != CompareDepth::Marks) {
        let path = folder.join(name);
        if let Some(difference) = compare_path(&path, marks.get(*name), depth)? {
            differences.push(((*name).to_owned(), difference));
        }
    }
    Ok(differences)
}

fn compare_path(
    path: &Path,
    marked: Option<&FileMark>,
    depth: CompareDepth,
) -> Result<Option<FileDifference>, QueueError> {
    let about = fs::metadata(path);
    let (about, marked) = match (about, marked) {
        (Ok(about), Some(marked)) => (about, marked),
        (Ok(_), None) => return Ok(Some(FileDifference::Added)),
        (Err(error), marked) if error.kind() == ErrorKind::NotFound => {
            return Ok(marked.map(|marked| FileDifference::Missing(marked.count)));
        }
        (Err(source), _) => return Err(QueueError::Io { path: path.to_owned(), doing: "look at", source }),
    };
    match depth {
        CompareDepth::Marks => return Ok(None),
        CompareDepth::Lengths | CompareDepth::Files if about.is_dir() => return Ok(None),
        CompareDepth::Lengths => {
            let differs = about.len() != marked.bytes;
            return Ok(differs.then_some(FileDifference::Length { found: about.len(), marked: marked.bytes }));
        }
        CompareDepth::Files | CompareDepth::Everything => {}
    }
    let Some(found) = mark_path(path)? else { return Ok(Some(FileDifference::Missing(marked.count))) };
    if found == *marked {
        return Ok(None);
    }
    let sha256 = found.sha256;
    Ok(Some(match (found.count, marked.count) {
        _ if found.bytes == 0 => FileDifference::Empty(marked.count),
        (found, marked) if about.is_file() && !ends_whole(path)? => FileDifference::CutOff { found, marked },
        (found, marked) if found != marked => FileDifference::Count { found, marked, sha256 },
        _ => FileDifference::Content(sha256),
    }))
}

/// Whether a file ends with a whole line.
fn ends_whole(path: &Path) -> Result<bool, QueueError> {
    use std::io::{Seek, SeekFrom};
    let read_last = || {
        let mut file = File::open(path)?;
        let mut last = [0];
        file.seek(SeekFrom::End(-1))?;
        file.read_exact(&mut last)?;
        Ok(last == *b"\n")
    };
    read_last().map_err(QueueError::for_file(path, "read"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAMES: [&str; 3] = ["lines", "more", "frames"];

    /// A folder with two files and a folder of two, and their marks.
    fn chunk() -> (tempfile::TempDir, FileMarks) {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("lines"), "a\nb\nc\n").unwrap();
        fs::write(folder.path().join("more"), "").unwrap();
        fs::create_dir(folder.path().join("frames")).unwrap();
        for name in ["1.jpg", "2.jpg"] {
            fs::write(folder.path().join("frames").join(name), name).unwrap();
        }
        let marks = mark_files(folder.path(), &NAMES).unwrap();
        (folder, marks)
    }

    fn differences(folder: &Path, marks: &FileMarks, depth: CompareDepth) -> Vec<(String, FileDifference)> {
        compare_files(folder, marks, &NAMES, depth).unwrap()
    }

    #[test]
    fn files_that_stayed_fit_their_marks() {
        let (folder, marks) = chunk();
        assert_eq!((marks["lines"].count, marks["lines"].bytes, marks["frames"].count), (3, 6, 2));
        for depth in [CompareDepth::Lengths, CompareDepth::Files, CompareDepth::Everything] {
            assert_eq!(differences(folder.path(), &marks, depth), []);
        }
        let read: FileMarks = serde_json::from_str(&serde_json::to_string(&marks).unwrap()).unwrap();
        assert_eq!(read, marks);
    }

    #[test]
    fn each_change_of_a_file_is_called_by_its_name() {
        use FileDifference::{Added, Content, Count, CutOff, Empty, Length, Missing};
        let (folder, marks) = chunk();
        let path = folder.path().join("lines");
        let after = |text: &str, depth| {
            fs::write(&path, text).unwrap();
            let mut found = differences(folder.path(), &marks, depth);
            assert_eq!(found.len(), 1, "{text}");
            assert_eq!(found[0].0, "lines");
            found.remove(0).1
        };
        assert_eq!(after("a\nb", CompareDepth::Files), CutOff { found: 1, marked: 3 });
        assert_eq!(after("a\nb\nc", CompareDepth::Files), CutOff { found: 2, marked: 3 });
        assert!(matches!(after("a\nb\nc\nc\n", CompareDepth::Files), Count { found: 4, marked: 3, .. }));
        assert_eq!(after("", CompareDepth::Files), Empty(3));
        assert!(matches!(after("a\nx\nc\n", CompareDepth::Files), Content(_)));
        assert_eq!(after("a\nb\n", CompareDepth::Lengths), Length { found: 4, marked: 6 });
        fs::remove_file(&path).unwrap();
        assert_eq!(differences(folder.path(), &marks, CompareDepth::Lengths), [("lines".into(), Missing(3))]);
        fs::write(&path, "a\nb\nc\n").unwrap();
        let unmarked = FileMarks::from_iter(marks.clone().into_iter().filter(|(name, _)| name != "more"));
        assert_eq!(differences(folder.path(), &unmarked, CompareDepth::Files), [("more".into(), Added)]);
    }

    #[test]
    fn pictures_are_compared_where_that_is_asked_for() {
        let (folder, marks) = chunk();
        let picture = folder.path().join("frames/1.jpg");
        fs::write(&picture, "2.jpg").unwrap();
        assert_eq!(differences(folder.path(), &marks, CompareDepth::Files), []);
        let found = differences(folder.path(), &marks, CompareDepth::Everything);
        assert!(matches!(found[..], [(_, FileDifference::Content(_))]), "{found:?}");
        fs::remove_file(&picture).unwrap();
        let found = differences(folder.path(), &marks, CompareDepth::Everything);
        assert!(matches!(found[..], [(_, FileDifference::Count { found: 1, marked: 2, .. })]), "{found:?}");
    }
}
