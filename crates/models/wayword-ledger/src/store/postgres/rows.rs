//! Reads rows of the table `calls`, and checks their checksums.

use crate::{CallAnswer, CallKey, LedgerEntry, LedgerError, LedgerLocation, ModelCall, checksum};
use wayword_database::postgres;

/// The columns of a row of `calls`, in the order in which [`read_checked_entry`] takes them.
macro_rules! columns {
    () => {
        "calls.key, model, base_url, request, replicate, answer, finish, tokens_in, tokens_out, usd, latency_ms, \
         attempts, at, calls.run, checksum"
    };
}
pub(super) use columns;

/// Reads a row with `columns`, and checks it.
///
/// # Errors
/// When the row was changed after it was written.
pub(super) fn read_checked_entry(row: &postgres::Row, place: &LedgerLocation) -> Result<LedgerEntry, LedgerError> {
    let text = |at: usize| row.try_get::<_, String>(at);
    let changed = || LedgerError::Changed {
        place: place.clone(),
        key: text(0).unwrap_or_else(|_| "of an unknown name".to_owned()),
        model: text(1).unwrap_or_else(|_| "an unknown model".to_owned()),
    };
    let (entry, checksum) = read_entry(row).ok_or_else(changed)?;
    if checksum == checksum::answer_checksum(&entry.key, &entry.answer) { Ok(entry) } else { Err(changed()) }
}

/// A row and its checksum; `None` if a column has a value that this program never writes.
fn read_entry(row: &postgres::Row) -> Option<(LedgerEntry, String)> {
    let text = |at: usize| row.try_get::<_, String>(at).ok();
    let whole = |at: usize| row.try_get::<_, i64>(at).ok();
    let count = |at: usize| whole(at).and_then(|count| u64::try_from(count).ok());
    let small = |at: usize| whole(at).and_then(|count| u32::try_from(count).ok());
    let request = text(3)?;
    let entry = LedgerEntry {
        key: CallKey::from_stored(text(0)?),
        call: ModelCall {
            model: text(1)?,
            base_url: text(2)?,
            request: serde_json::from_str(&request).unwrap_or(serde_json::Value::String(request)),
            replicate: small(4)?,
        },
        answer: CallAnswer {
            text: serde_json::from_str(&text(5)?).ok()?,
            finish: text(6)?,
            tokens_in: count(7)?,
            tokens_out: count(8)?,
            usd: row.try_get(9).ok()?,
            latency_ms: count(10)?,
            attempts: small(11)?,
        },
        at_unix_s: whole(12)?,
        run: text(13)?,
    };
    Some((entry, text(14)?))
}

/// A count as the database takes it, which has no unsigned numbers.
pub(super) fn count_to_i64(count: u64) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX)
}

/// A text as the database takes it: the character 0, which PostgreSQL refuses, becomes U+FFFD.
pub(super) fn without_nul(text: &str) -> String {
    text.replace('\0', "\u{fffd}")
}
