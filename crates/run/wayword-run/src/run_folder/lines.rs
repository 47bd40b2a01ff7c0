//! Reads the files of a run line by line, so that a long run needs no more memory than a short one.

use crate::error::CommandError;
use serde::de::DeserializeOwned;
use std::{
    fmt::Display,
    fs::{self, File},
    io::{BufRead, BufReader, Read},
    path::Path,
};

/// Longest line that is read, bytes. A longer one is an error.
const MAX_LINE_BYTES: usize = 16 << 20;

/// A whole line of a file.
pub struct RecordLine<'a> {
    path: &'a Path,
    /// The number of the line, from 1.
    number: usize,
    bytes: &'a [u8],
}

/// Hands every whole line of a file to `take`. A missing file counts as empty. An incomplete last line is left out, because a
/// stopped run will write it again.
///
/// # Errors
/// When the file cannot be read, a line is too long, or `take` fails.
pub fn each_line(
    path: &Path,
    mut take: impl FnMut(RecordLine<'_>) -> Result<(), CommandError>,
) -> Result<(), CommandError> {
    if !fs::exists(path).map_err(CommandError::io(path, "look for"))? {
        return Ok(());
    }
    let mut reader = BufReader::new(File::open(path).map_err(CommandError::io(path, "open"))?);
    let mut bytes = Vec::new();
    for number in 1.. {
        bytes.clear();
        let most = MAX_LINE_BYTES as u64 + 1;
        reader.by_ref().take(most).read_until(b'\n', &mut bytes).map_err(CommandError::io(path, "read"))?;
        let line = RecordLine { path, number, bytes: &bytes };
        if bytes.len() > MAX_LINE_BYTES {
            return Err(line.broken_line(format_args!("it is longer than {} MiB", MAX_LINE_BYTES >> 20)));
        }
        if bytes.last() != Some(&b'\n') {
            break;
        }
        take(line)?;
    }
    Ok(())
}

impl RecordLine<'_> {
    /// Its length, bytes.
    pub fn byte_count(&self) -> usize {
        self.bytes.len()
    }

    /// Its number in the file, from 1.
    pub fn number(&self) -> usize {
        self.number
    }

    /// The value that the line holds.
    ///
    /// # Errors
    /// When the value is not of that kind.
    pub fn parse<T: DeserializeOwned>(&self) -> Result<T, CommandError> {
        serde_json::from_slice(self.bytes).map_err(|error| {
            let text = error.to_string();
            let problem = text.rsplit_once(" at line ").map_or(text.as_str(), |(problem, _)| problem);
            self.broken_line(format_args!("column {}: {problem}", error.column()))
        })
    }

    /// The error about a line with wrong content.
    pub fn broken_line(&self, problem: impl Display) -> CommandError {
        let problem = format!("{}: line {}: {problem}", self.path.display(), self.number);
        CommandError::usage(
            problem,
            "the file was changed by hand or by another program: give another --out for a new run",
        )
    }

    /// The error about a line that can be read, and contradicts itself or another line.
    pub fn edited_line(&self, problem: impl Display) -> CommandError {
        let problem = format!("{}: line {}: {problem}", self.path.display(), self.number);
        CommandError::usage(
            problem,
            "the file was changed by hand or by another program: undo the change, or delete the line",
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(text: &str) -> Result<Vec<u32>, CommandError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.jsonl");
        fs::write(&path, text).unwrap();
        let mut numbers = Vec::new();
        each_line(&path, |line| {
            numbers.push(line.parse()?);
            Ok(())
        })?;
        Ok(numbers)
    }

    #[test]
    fn a_torn_last_line_is_left_out() {
        assert_eq!(numbers("1\n2\n3").unwrap(), [1, 2]);
    }

    #[test]
    fn parse_reports_a_broken_line_with_its_number() {
        assert!(numbers("1\nx\n3\n").unwrap_err().to_string().contains("line 2"));
    }

    #[test]
    fn a_line_without_end_is_refused() {
        assert!(numbers(&" ".repeat(MAX_LINE_BYTES + 1)).unwrap_err().to_string().contains("longer than"));
    }
}
