//! Tables and rows.

use crate::{Answer, Call, Key, LedgerError, call::Row};
use rusqlite::{Connection, ErrorCode, Transaction, TransactionBehavior};
use std::{
    path::Path,
    thread,
    time::{Duration, Instant},
};

/// Tells a ledger from any other database ("Wway").
const APPLICATION: i64 = 0x5777_6179;
/// Version of the tables.
const FORMAT: i64 = 1;

/// `calls`: every answer. `uses`: which run has used which call, its own and others'. `sent`: every request that has left, and what
/// became of it; an outcome that stays empty is that of a process that died.
const TABLES: &str = "
CREATE TABLE calls (
    key TEXT PRIMARY KEY, model TEXT NOT NULL, base_url TEXT NOT NULL, request TEXT NOT NULL, replicate INTEGER NOT NULL,
    answer TEXT NOT NULL, finish TEXT NOT NULL, tokens_in INTEGER NOT NULL, tokens_out INTEGER NOT NULL, usd REAL,
    latency_ms INTEGER NOT NULL, attempts INTEGER NOT NULL, at INTEGER NOT NULL, run TEXT NOT NULL
) WITHOUT ROWID;
CREATE INDEX calls_of_run ON calls (run);
CREATE TABLE uses (run TEXT NOT NULL, key TEXT NOT NULL, PRIMARY KEY (run, key)) WITHOUT ROWID;
CREATE TABLE sent (
    id INTEGER PRIMARY KEY, run TEXT NOT NULL, key TEXT NOT NULL, most_usd REAL, usd REAL, at INTEGER NOT NULL,
    outcome TEXT, reason TEXT
);
CREATE INDEX sent_of_run ON sent (run);
";

/// The columns of [`row`], in its order.
pub(crate) const COLUMNS: &str = "calls.key, model, base_url, request, replicate, answer, finish, tokens_in, tokens_out, usd, \
                                  latency_ms, attempts, at, calls.run";

/// How long one program waits for others that make the same ledger.
const PATIENCE: Duration = Duration::from_secs(10);
/// And how long between two looks.
const PAUSE: Duration = Duration::from_millis(5);

/// Makes the tables, or makes sure that they are ours.
pub(super) fn prepare(connection: &mut Connection, path: &Path) -> Result<(), LedgerError> {
    let failed = LedgerError::store(path, "open");
    // Nothing is written to a file that is not ours. One look is one transaction, so that it sees the tables of another program
    // that makes them whole or not at all.
    is_new(&connection.transaction().map_err(&failed)?, path)?;
    write_ahead(connection).map_err(&failed)?;
    connection.pragma_update(None, "synchronous", "FULL").map_err(&failed)?;
    // Two programs may open a new ledger at the same moment: the second finds the tables made.
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate).map_err(&failed)?;
    if is_new(&transaction, path)? {
        transaction.execute_batch(TABLES).map_err(&failed)?;
        transaction.pragma_update(None, "application_id", APPLICATION).map_err(&failed)?;
        transaction.pragma_update(None, "user_version", FORMAT).map_err(&failed)?;
    }
    transaction.commit().map_err(&failed)
}

/// Whether there is nothing in the file yet.
fn is_new(transaction: &Transaction<'_>, path: &Path) -> Result<bool, LedgerError> {
    let failed = |error: rusqlite::Error| match error.sqlite_error_code() {
        Some(ErrorCode::NotADatabase) => LedgerError::NoLedger(path.to_owned()),
        _ => LedgerError::store(path, "open")(error),
    };
    let number = |sql: &str| transaction.query_row(sql, [], |row| row.get::<_, i64>(0)).map_err(failed);
    let tables = number("SELECT COUNT(*) FROM sqlite_master")?;
    match (number("PRAGMA application_id")?, number("PRAGMA user_version")?) {
        (0, 0) if tables == 0 => Ok(true),
        (APPLICATION, FORMAT) => Ok(false),
        (APPLICATION, format) => Err(LedgerError::Newer { path: path.to_owned(), format }),
        _ => Err(LedgerError::NoLedger(path.to_owned())),
    }
}

/// Lets readers read while somebody writes. The database does not wait by itself for another program that does the same.
fn write_ahead(connection: &Connection) -> rusqlite::Result<()> {
    let until = Instant::now() + PATIENCE;
    loop {
        match connection.pragma_update(None, "journal_mode", "WAL") {
            Err(error) if error.sqlite_error_code() == Some(ErrorCode::DatabaseBusy) && Instant::now() < until => {
                thread::sleep(PAUSE);
            }
            done => return done,
        }
    }
}

/// A row of `calls` with [`COLUMNS`].
pub(crate) fn row(row: &rusqlite::Row<'_>) -> rusqlite::Result<Row> {
    let count = |at: usize| row.get::<_, i64>(at).map(|count| u64::try_from(count).unwrap_or(0));
    let request: String = row.get(3)?;
    Ok(Row {
        key: Key::stored(row.get(0)?),
        call: Call {
            model: row.get(1)?,
            base_url: row.get(2)?,
            request: serde_json::from_str(&request).unwrap_or(serde_json::Value::String(request)),
            replicate: row.get(4)?,
        },
        answer: Answer {
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
    })
}
