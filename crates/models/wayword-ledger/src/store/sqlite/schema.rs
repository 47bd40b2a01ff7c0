//! The tables of a ledger's file: creates or upgrades them, and reads rows of `calls` with their checksums.

use crate::{CallAnswer, CallKey, LedgerEntry, LedgerError, LedgerLocation, ModelCall, checksum};
use rusqlite::{Connection, ErrorCode, Transaction, TransactionBehavior};
use std::{
    path::Path,
    thread,
    time::{Duration, Instant},
};

/// SQLite's application id of a ledger ("Wway"), which distinguishes it from any other database.
const APPLICATION_ID: i64 = 0x5777_6179;
/// Version of the tables that this program makes and writes.
const CURRENT_FORMAT: i64 = 2;
/// Version of the first ledgers, in which answers have no checksums.
const FIRST_FORMAT: i64 = 1;
/// Version of a file without tables.
const NEW_FILE_FORMAT: i64 = 0;

/// `calls`: every answer, with its checksum. `uses`: which run has used which call, including calls that other runs
/// made. `sent`: every request that was sent, and its outcome; the outcome stays empty if the process died. `claims`:
/// which program is making which call at the moment, and how many requests it has sent for it.
const CREATE_TABLES_SQL: &str = "
CREATE TABLE calls (
    key TEXT PRIMARY KEY, model TEXT NOT NULL, base_url TEXT NOT NULL, request TEXT NOT NULL, replicate INTEGER NOT NULL,
    answer TEXT NOT NULL, finish TEXT NOT NULL, tokens_in INTEGER NOT NULL, tokens_out INTEGER NOT NULL, usd REAL,
    latency_ms INTEGER NOT NULL, attempts INTEGER NOT NULL, at INTEGER NOT NULL, run TEXT NOT NULL, checksum TEXT
) WITHOUT ROWID;
CREATE INDEX calls_of_run ON calls (run);
CREATE TABLE uses (run TEXT NOT NULL, key TEXT NOT NULL, PRIMARY KEY (run, key)) WITHOUT ROWID;
CREATE TABLE sent (
    id INTEGER PRIMARY KEY, run TEXT NOT NULL, key TEXT NOT NULL, most_usd REAL, usd REAL, at INTEGER NOT NULL,
    outcome TEXT, reason TEXT
);
CREATE INDEX sent_of_run ON sent (run);
CREATE TABLE claims (key TEXT PRIMARY KEY, holder TEXT NOT NULL, sent INTEGER NOT NULL) WITHOUT ROWID;
";

/// Brings a ledger of the first format to the current one. Its answers stay as they are, without checksums.
const UPGRADE_FIRST_FORMAT_SQL: &str = "
ALTER TABLE calls ADD COLUMN checksum TEXT;
CREATE TABLE claims (key TEXT PRIMARY KEY, holder TEXT NOT NULL, sent INTEGER NOT NULL) WITHOUT ROWID;
";

/// The columns of a row of `calls`, in the order in which [`read_entry`] takes them.
pub(super) const CALL_COLUMNS: &str = "calls.key, model, base_url, request, replicate, answer, finish, tokens_in, tokens_out, usd, \
                                  latency_ms, attempts, at, calls.run, checksum";

/// How long this program waits for others that open the same ledger at the same time.
const OPEN_TIMEOUT: Duration = Duration::from_secs(10);
/// Pause between two tries.
const RETRY_PAUSE: Duration = Duration::from_millis(5);

/// Makes the tables, or checks that they are a ledger's.
pub(super) fn prepare_tables(connection: &mut Connection, path: &Path) -> Result<(), LedgerError> {
    let failed = LedgerError::store_error(path, "open");
    // A file that is not a ledger is not changed. One check is one transaction, so that it sees all or none of the
    // tables that another program is making.
    read_format(&connection.transaction().map_err(&failed)?, path)?;
    turn_on_write_ahead_log(connection).map_err(&failed)?;
    connection.pragma_update(None, "synchronous", "FULL").map_err(&failed)?;
    // Two programs may open a new ledger at the same moment. The second then finds the tables made.
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate).map_err(&failed)?;
    let before = read_format(&transaction, path)?;
    if before != CURRENT_FORMAT {
        transaction
            .execute_batch(if before == NEW_FILE_FORMAT { CREATE_TABLES_SQL } else { UPGRADE_FIRST_FORMAT_SQL })
            .map_err(&failed)?;
        transaction.pragma_update(None, "application_id", APPLICATION_ID).map_err(&failed)?;
        transaction.pragma_update(None, "user_version", CURRENT_FORMAT).map_err(&failed)?;
    }
    transaction.commit().map_err(&failed)
}

/// The version of a file's tables, or [`NEW_FILE_FORMAT`] if it has none yet.
fn read_format(transaction: &Transaction<'_>, path: &Path) -> Result<i64, LedgerError> {
    let failed = |error: rusqlite::Error| match error.sqlite_error_code() {
        Some(ErrorCode::NotADatabase) => LedgerError::NoLedger(path.to_owned()),
        _ => LedgerError::store_error(path, "open")(error),
    };
    let number = |sql: &str| transaction.query_row(sql, [], |row| row.get::<_, i64>(0)).map_err(failed);
    let tables = number("SELECT COUNT(*) FROM sqlite_master")?;
    match (number("PRAGMA application_id")?, number("PRAGMA user_version")?) {
        (0, NEW_FILE_FORMAT) if tables == 0 => Ok(NEW_FILE_FORMAT),
        (APPLICATION_ID, format @ FIRST_FORMAT..=CURRENT_FORMAT) => Ok(format),
        (APPLICATION_ID, format) => Err(LedgerError::Newer { path: path.to_owned(), format }),
        _ => Err(LedgerError::NoLedger(path.to_owned())),
    }
}

/// Turns on the write-ahead log, so that others can read while one program writes. Retries while another program does
/// the same, because SQLite does not wait here by itself.
fn turn_on_write_ahead_log(connection: &Connection) -> rusqlite::Result<()> {
    let until = Instant::now() + OPEN_TIMEOUT;
    loop {
        match connection.pragma_update(None, "journal_mode", "WAL") {
            Err(error) if error.sqlite_error_code() == Some(ErrorCode::DatabaseBusy) && Instant::now() < until => {
                thread::sleep(RETRY_PAUSE);
            }
            done => return done,
        }
    }
}

/// Reads a row of `calls` with [`CALL_COLUMNS`], and checks it. Rows of the first ledgers have no checksum.
///
/// # Errors
/// When the row was changed after it was written.
pub(super) fn read_checked_entry(row: &rusqlite::Row<'_>, path: &Path) -> Result<LedgerEntry, LedgerError> {
    let changed = || LedgerError::Changed {
        place: LedgerLocation::from_path(path),
        key: row.get(0).unwrap_or_else(|_| "of an unknown name".to_owned()),
        model: row.get(1).unwrap_or_else(|_| "an unknown model".to_owned()),
    };
    let (entry, checksum) = read_entry(row).map_err(|error| match error {
        // A column has a value that this program never writes.
        rusqlite::Error::InvalidColumnType(..)
        | rusqlite::Error::IntegralValueOutOfRange(..)
        | rusqlite::Error::FromSqlConversionFailure(..)
        | rusqlite::Error::Utf8Error(..) => changed(),
        error => LedgerError::store_error(path, "read")(error),
    })?;
    match checksum {
        Some(checksum) if checksum != checksum::answer_checksum(&entry.key, &entry.answer) => Err(changed()),
        _ => Ok(entry),
    }
}

/// A row with [`CALL_COLUMNS`], and its checksum if it has one.
fn read_entry(row: &rusqlite::Row<'_>) -> rusqlite::Result<(LedgerEntry, Option<String>)> {
    let count = |at: usize| row.get::<_, i64>(at).map(|count| u64::try_from(count).unwrap_or(0));
    let request: String = row.get(3)?;
    let entry = LedgerEntry {
        key: CallKey::from_stored(row.get(0)?),
        call: ModelCall {
            model: row.get(1)?,
            base_url: row.get(2)?,
            request: serde_json::from_str(&request).unwrap_or(serde_json::Value::String(request)),
            replicate: row.get(4)?,
        },
        answer: CallAnswer {
            text: row.get(5)?,
            finish: row.get(6)?,
            tokens_in: count(7)?,
            tokens_out: count(8)?,
            usd: row.get(9)?,
            latency_ms: count(10)?,
            attempts: row.get(11)?,
        },
        at_unix_s: row.get(12)?,
        run: row.get(13)?,
    };
    Ok((entry, row.get(14)?))
}
