//! A file of JSON lines that only grows, so that a killed process damages at most its last line. Each line has a key, and each
//! key occurs once.

use super::lines;
use crate::error::CommandError;
use indexmap::IndexSet;
use serde::{Serialize, de::DeserializeOwned};
use serde_json::Value;
use std::{
    fs::{self, File},
    io::{self, BufRead, BufReader, BufWriter, Read, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
};

/// A file of JSON lines with the keys of the lines that it holds.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    /// The keys, in the order of the lines.
    keys: IndexSet<String>,
    /// Finds the key in a line; `None` if the line has none.
    key_of: fn(&Value) -> Option<String>,
}

impl Journal {
    /// Opens or makes the file, and cuts off an incomplete last line that a killed process was writing.
    ///
    /// # Errors
    /// When it cannot be read, or a complete line is not a record of its kind.
    pub fn open(path: &Path, key_of: fn(&Value) -> Option<String>) -> Result<Self, CommandError> {
        let file = open_appending(path)?;
        let whole = whole_line_bytes(path).map_err(CommandError::io(path, "read"))?;
        file.set_len(whole).map_err(CommandError::io(path, "cut off the incomplete last line of"))?;
        let mut keys = IndexSet::new();
        lines::each_line(path, |line| {
            let key = key_of(&line.parse()?).ok_or_else(|| line.broken_line("it lacks the fields that identify it"))?;
            keys.insert(key);
            Ok(())
        })?;
        Ok(Self { path: path.to_owned(), file, keys, key_of })
    }

    /// Makes the file again, empty.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn begin_empty(path: &Path, key_of: fn(&Value) -> Option<String>) -> Result<Self, CommandError> {
        File::create(path).map_err(CommandError::io(path, "empty"))?;
        Self::open(path, key_of)
    }

    /// Whether it has a line with that key.
    #[must_use]
    pub fn has_key(&self, key: &str) -> bool {
        self.keys.contains(key)
    }

    /// The keys of its lines, in their order.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.keys.iter().map(String::as_str)
    }

    /// How many lines it has.
    #[must_use]
    pub fn len(&self) -> usize {
        self.keys.len()
    }

    /// Whether it has no lines.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    /// Appends a line in one write, unless there is one with its key.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn append(&mut self, record: &impl Serialize) -> Result<(), CommandError> {
        let fail = |error: serde_json::Error| CommandError::Io {
            path: self.path.clone(),
            doing: "write",
            source: error.into(),
        };
        let value = serde_json::to_value(record).map_err(fail)?;
        let key = (self.key_of)(&value).ok_or_else(|| CommandError::Io {
            path: self.path.clone(),
            doing: "write a record without a name to",
            source: io::ErrorKind::InvalidData.into(),
        })?;
        if !self.keys.insert(key) {
            return Ok(());
        }
        let mut line = serde_json::to_vec(&value).map_err(fail)?;
        line.push(b'\n');
        self.file.write_all(&line).map_err(CommandError::io(&self.path, "write"))
    }

    /// Sorts the lines by `place`, which gives the place of a key's line, or `None` to drop the line. Whenever the
    /// process is killed, the file is whole, in the old order or in the new one.
    ///
    /// # Errors
    /// When it cannot be read or written.
    pub fn arrange_by(&mut self, place: impl Fn(&str) -> Option<usize>) -> Result<(), CommandError> {
        let places: Vec<Option<usize>> = self.keys.iter().map(|key| place(key)).collect();
        if places.iter().all(Option::is_some) && places.is_sorted() {
            return Ok(());
        }
        let key_of = self.key_of;
        let (mut spans, mut start) = (Vec::new(), 0);
        lines::each_line(&self.path, |line| {
            let key = key_of(&line.parse()?);
            let length = line.byte_count() as u64;
            spans.extend(key.and_then(|key| place(&key)).map(|place| (place, start, length)));
            start += length;
            Ok(())
        })?;
        spans.sort_unstable();
        let temporary = self.path.with_extension("new");
        copy_spans(&self.path, &temporary, &spans).map_err(CommandError::io(&temporary, "write"))?;
        fs::rename(&temporary, &self.path).map_err(CommandError::io(&self.path, "write"))?;
        *self = Self::open(&self.path, self.key_of)?;
        Ok(())
    }

    /// Makes sure that the file survives a crash of the machine.
    ///
    /// # Errors
    /// When it cannot be flushed.
    pub fn sync(&mut self) -> Result<(), CommandError> {
        self.file.sync_data().map_err(CommandError::io(&self.path, "flush"))
    }
}

fn open_appending(path: &Path) -> Result<File, CommandError> {
    File::options().create(true).append(true).read(true).open(path).map_err(CommandError::io(path, "open"))
}

/// Writes parts of a file to another file, which then survives a crash of the machine. Each span has a place, which is
/// not used here, and start and length in bytes.
fn copy_spans(from: &Path, to: &Path, spans: &[(usize, u64, u64)]) -> io::Result<()> {
    let mut from = File::open(from)?;
    let mut to = BufWriter::new(File::create(to)?);
    for &(_, start, length) in spans {
        from.seek(SeekFrom::Start(start))?;
        io::copy(&mut Read::by_ref(&mut from).take(length), &mut to)?;
    }
    to.into_inner()?.sync_data()
}

/// The length of a file up to the end of its last whole line.
fn whole_line_bytes(path: &Path) -> io::Result<u64> {
    let mut reader = BufReader::new(File::open(path)?);
    let (mut read, mut whole) = (0, 0);
    loop {
        let buffer = reader.fill_buf()?;
        if buffer.is_empty() {
            return Ok(whole);
        }
        if let Some(last) = buffer.iter().rposition(|byte| *byte == b'\n') {
            whole = read + last as u64 + 1;
        }
        let length = buffer.len();
        read += length as u64;
        reader.consume(length);
    }
}

/// Reads every whole line of a file of records; a missing file has none.
///
/// # Errors
/// When it cannot be read, or a line is not of the kind.
pub fn read_lines<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>, CommandError> {
    let mut records = Vec::new();
    lines::each_line(path, |line| {
        records.push(line.parse()?);
        Ok(())
    })?;
    Ok(records)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::fs;

    fn key(value: &Value) -> Option<String> {
        Some(value.get("id")?.as_str()?.to_owned())
    }

    #[test]
    fn a_torn_line_is_cut_off_and_written_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.jsonl");
        let mut journal = Journal::open(&path, key).unwrap();
        journal.append(&json!({"id": "a"})).unwrap();
        journal.append(&json!({"id": "b"})).unwrap();
        drop(journal);
        let whole = fs::read(&path).unwrap();
        for cut in 0..whole.len() {
            fs::write(&path, &whole[..cut]).unwrap();
            let mut journal = Journal::open(&path, key).unwrap();
            journal.append(&json!({"id": "a"})).unwrap();
            journal.append(&json!({"id": "b"})).unwrap();
            assert_eq!(fs::read(&path).unwrap(), whole, "cut at {cut}");
        }
    }

    #[test]
    fn lines_are_put_in_order_and_more_can_be_written_behind_them() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.jsonl");
        let mut journal = Journal::open(&path, key).unwrap();
        for id in ["c", "gone", "a"] {
            journal.append(&json!({ "id": id })).unwrap();
        }
        journal.arrange_by(|key| "abcd".find(key)).unwrap();
        journal.append(&json!({"id": "d"})).unwrap();
        journal.append(&json!({"id": "a"})).unwrap();
        let lines = ["a", "c", "d"].map(|id| format!("{{\"id\":\"{id}\"}}\n")).concat();
        assert_eq!(fs::read_to_string(&path).unwrap(), lines);
        assert!(!journal.has_key("gone") && journal.has_key("d"));
    }

    #[test]
    fn a_line_that_is_no_record_is_refused_with_its_number() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.jsonl");
        fs::write(&path, "{\"id\": \"a\"}\nnonsense\n").unwrap();
        assert!(Journal::open(&path, key).unwrap_err().to_string().contains("line 2"));
    }
}
