//! A line of a chunk's file: a JSON object that begins with the checksum of the rest of the line, as
//! `{"sha256":"1f...","ended":{"number":3,"outcome":"lost","reason":"timeout"}}`.

use crate::{CallKey, LedgerEntry, checksum::sha256_text, store::RequestEnd};
use serde::{Deserialize, Serialize};

/// Version of the lines, which the first line of a file contains.
pub(super) const CHUNK_LINE_FORMAT: u32 = 1;

/// How every line begins.
const LINE_PREFIX: &str = "{\"sha256\":\"";
/// Hexadecimal digits of a checksum.
const CHECKSUM_DIGITS: usize = 64;
/// The characters between the checksum and the part of the line that it covers.
const CHECKSUM_SUFFIX: &str = "\",";

/// The content of a line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(crate) enum ChunkEntry {
    /// The first line of a file.
    Ledger { format: u32 },
    /// Request `number` of the file is about to be sent, for a call of a run. It may cost at most `most_usd` US dollars.
    Sent { number: i64, run: String, key: CallKey, most_usd: Option<f64>, at_unix_s: i64 },
    /// Request `number` brought no answer.
    Ended { number: i64, outcome: RequestEnd, reason: String },
    /// A call was answered, by request `number` if it needed one.
    Answered { number: Option<i64>, row: Box<LedgerEntry> },
}

impl ChunkEntry {
    /// Encodes the entry as a line, including the line end.
    pub(super) fn to_line(&self) -> serde_json::Result<Vec<u8>> {
        let json = serde_json::to_vec(self)?;
        let rest = json.get(1..).unwrap_or_default();
        let mut line = format!("{LINE_PREFIX}{}{CHECKSUM_SUFFIX}", sha256_text(rest)).into_bytes();
        line.extend_from_slice(rest);
        line.push(b'\n');
        Ok(line)
    }

    /// Whether bytes begin as a line of a chunk's file does.
    pub(crate) fn is_line(bytes: &[u8]) -> bool {
        bytes.starts_with(LINE_PREFIX.as_bytes())
    }

    /// Reads a line, with or without the end of the line.
    ///
    /// # Errors
    /// The problem of the line.
    pub(crate) fn from_line(line: &[u8]) -> Result<Self, String> {
        let line = line.strip_suffix(b"\n").unwrap_or(line);
        let changed = || "its checksum does not match, so the line was changed by hand or damaged".to_owned();
        let after_prefix = line.strip_prefix(LINE_PREFIX.as_bytes()).ok_or("it is no line of a recording in chunks")?;
        let (checksum, rest) = after_prefix.split_at_checked(CHECKSUM_DIGITS).ok_or_else(changed)?;
        let rest = rest.strip_prefix(CHECKSUM_SUFFIX.as_bytes()).ok_or_else(changed)?;
        if checksum != sha256_text(rest).as_bytes() {
            return Err(changed());
        }
        let json = [b"{", rest].concat();
        let entry: Self = serde_json::from_slice(&json).map_err(|error| error.to_string())?;
        match &entry {
            Self::Answered { row, .. } if row.call.key() != row.key => {
                Err("its key does not match its call, so the line was changed by hand".to_owned())
            }
            _ => Ok(entry),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_written_line_reads_back_and_any_change_is_refused(
            reason in ".{0,30}",
            number: i64,
            at in 0.0..1.0f64,
            bit in 0u8..8,
        ) {
            let entry = ChunkEntry::Ended { number, outcome: RequestEnd::Lost, reason };
            let mut line = entry.to_line().unwrap();
            prop_assert_eq!(line.iter().filter(|byte| **byte == b'\n').count(), 1);
            prop_assert_eq!(ChunkEntry::from_line(&line), Ok(entry));
            let at = (at * (line.len() - 1) as f64) as usize;
            line[at] ^= 1 << bit;
            prop_assert!(ChunkEntry::from_line(&line).is_err());
        }
    }
}
