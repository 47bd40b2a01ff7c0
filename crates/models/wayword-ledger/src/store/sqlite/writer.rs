//! Writes a ledger's file: several writes in each transaction.

use crate::{
    LedgerEntry, LedgerError, checksum,
    store::{
        ClaimState,
        commit_queue::{CommitQueue, GroupCommit},
    },
};
use rusqlite::{Connection, Transaction, TransactionBehavior, params};
use std::{
    path::{Path, PathBuf},
    time::Duration,
};

/// How long the last checkpoint, which moves the log into the main file, waits for other programs. They can make it too.
const LAST_CHECKPOINT_TIMEOUT: Duration = Duration::from_secs(1);

/// A change to the ledger. `by` is the name of the program that makes it, which a ledger in memory does not need.
#[derive(Debug)]
pub(super) enum LedgerWrite {
    /// A request is about to be sent.
    Sent { run: String, key: String, most_usd: Option<f64>, at: i64, by: Option<String> },
    /// The request with the number `sent` brought no answer. Its outcome is `lost` if it may have been paid.
    Ended { sent: i64, outcome: &'static str, reason: String },
    /// A call was answered. The program need not have claimed it.
    Answered { sent: Option<i64>, row: Box<LedgerEntry>, by: Option<String> },
    /// A program is about to make a call, in place of the program `from` if there is one.
    Claim { key: String, by: String, from: Option<String> },
    /// A program gives up its claim.
    Release { key: String, by: String },
    /// A program has ended, so its claims are dropped.
    Forget { by: String },
    /// A run has used an answer.
    Used { run: String, key: String },
    /// No change: waits for all writes before it.
    Flush,
}

impl LedgerWrite {
    /// Whether the write has to survive a loss of power. Claims need not, because they end with their programs.
    fn has_to_last(&self) -> bool {
        !matches!(self, Self::Claim { .. } | Self::Release { .. } | Self::Forget { .. } | Self::Flush)
    }
}

/// Passes writes to the thread that writes the file. The result of a write is a number: for a request that is about to be sent, its
/// own; for an answer, 1 if it is the first and 0 if the call had one before; for a claim, the number that [`claim_from_number`]
/// reads.
pub(super) type LedgerWriter = CommitQueue<LedgerWrite, i64>;

impl LedgerWriter {
    pub(super) fn for_connection(connection: Connection, path: &Path) -> Result<Self, LedgerError> {
        Self::start("ledger", path, LedgerCommitter { connection, path: path.to_owned() })
    }

    /// Returns once all earlier writes are on disk.
    pub(super) fn flush(&self) -> Result<(), LedgerError> {
        self.write_and_wait(LedgerWrite::Flush).map(drop)
    }
}

/// Makes each group of writes in one transaction.
struct LedgerCommitter {
    connection: Connection,
    path: PathBuf,
}

impl GroupCommit for LedgerCommitter {
    type Write = LedgerWrite;
    type Outcome = i64;

    fn commit_group(&mut self, group: &[LedgerWrite]) -> Result<Vec<i64>, LedgerError> {
        let failed = LedgerError::store_error(&self.path, "write");
        let sync = if group.iter().any(LedgerWrite::has_to_last) { "FULL" } else { "NORMAL" };
        self.connection.pragma_update(None, "synchronous", sync).map_err(&failed)?;
        let transaction = self.connection.transaction_with_behavior(TransactionBehavior::Immediate).map_err(&failed)?;
        let numbers =
            group.iter().map(|write| apply_write(&transaction, write)).collect::<Result<_, _>>().map_err(&failed)?;
        transaction.commit().map_err(&failed)?;
        Ok(numbers)
    }

    /// Puts everything into the main file, because then the ledger is easier to copy. Otherwise the next program would do this.
    fn finish(self) {
        let _ = self.connection.busy_timeout(LAST_CHECKPOINT_TIMEOUT);
        let _ = self.connection.execute_batch("PRAGMA wal_checkpoint(TRUNCATE)");
    }
}

/// Makes one write, and returns its number (see [`LedgerWriter`]).
fn apply_write(transaction: &Transaction<'_>, write: &LedgerWrite) -> rusqlite::Result<i64> {
    let execute = |sql: &str, values: &[&dyn rusqlite::ToSql]| transaction.prepare_cached(sql)?.execute(values);
    match write {
        LedgerWrite::Sent { run, key, most_usd, at, by } => {
            execute("UPDATE claims SET sent = sent + 1 WHERE key = ?1 AND holder = ?2", params![key, by])?;
            let sql = "INSERT INTO sent (run, key, most_usd, at) VALUES (?1, ?2, ?3, ?4)";
            execute(sql, params![run, key, most_usd, at])?;
            return Ok(transaction.last_insert_rowid());
        }
        LedgerWrite::Ended { sent, outcome, reason } => {
            execute("UPDATE sent SET outcome = ?2, reason = ?3 WHERE id = ?1", params![sent, outcome, reason])?;
        }
        LedgerWrite::Used { run, key } => {
            execute("INSERT OR IGNORE INTO uses (run, key) VALUES (?1, ?2)", params![run, key])?;
        }
        LedgerWrite::Flush => {}
        LedgerWrite::Claim { key, by, from } => {
            return claim_call(transaction, key, by, from.as_deref()).map(|claimed| claimed as i64);
        }
        LedgerWrite::Release { key, by } => {
            execute("DELETE FROM claims WHERE key = ?1 AND holder = ?2", params![key, by])?;
        }
        LedgerWrite::Forget { by } => {
            execute("DELETE FROM claims WHERE holder = ?1", params![by])?;
        }
        LedgerWrite::Answered { sent, row, by } => {
            let is_first = insert_answer(transaction, row)?;
            execute("DELETE FROM claims WHERE key = ?1 AND holder = ?2", params![row.key.as_str(), by])?;
            execute("INSERT OR IGNORE INTO uses (run, key) VALUES (?1, ?2)", params![row.run, row.key.as_str()])?;
            if let Some(sent) = sent {
                execute("UPDATE sent SET outcome = 'answered', usd = ?2 WHERE id = ?1", params![sent, row.answer.usd])?;
            }
            return Ok(i64::from(is_first));
        }
    }
    Ok(0)
}

/// Decodes the number that a write of a claim returns.
pub(super) fn claim_from_number(written: i64) -> ClaimState {
    match written {
        0 => ClaimState::Ours,
        1 => ClaimState::Others,
        _ => ClaimState::Answered,
    }
}

/// Gives a call to a program, unless the call is answered or another program than `from` has it.
fn claim_call(transaction: &Transaction<'_>, key: &str, by: &str, from: Option<&str>) -> rusqlite::Result<ClaimState> {
    if transaction.prepare_cached("SELECT 1 FROM calls WHERE key = ?1")?.exists(params![key])? {
        return Ok(ClaimState::Answered);
    }
    let sql = "INSERT INTO claims (key, holder, sent) VALUES (?1, ?2, 0)
               ON CONFLICT (key) DO UPDATE SET holder = ?2, sent = 0 WHERE holder = ?2 OR holder = ?3";
    let given = transaction.prepare_cached(sql)?.execute(params![key, by, from])?;
    Ok(if given == 1 { ClaimState::Ours } else { ClaimState::Others })
}

/// Stores an answer if it is the first, and returns whether it is: another program may have made the same call at the
/// same time.
fn insert_answer(transaction: &Transaction<'_>, row: &LedgerEntry) -> rusqlite::Result<bool> {
    let count = |count: u64| i64::try_from(count).unwrap_or(i64::MAX);
    let (call, answer) = (&row.call, &row.answer);
    let added = transaction
        .prepare_cached(
            "INSERT OR IGNORE INTO calls VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15)",
        )?
        .execute(params![
            row.key.as_str(),
            call.model,
            call.base_url,
            call.request.to_string(),
            call.replicate,
            answer.text,
            answer.finish,
            count(answer.tokens_in),
            count(answer.tokens_out),
            answer.usd,
            count(answer.latency_ms),
            answer.attempts,
            row.at_unix_s,
            row.run,
            checksum::answer_checksum(&row.key, answer)
        ])?;
    Ok(added == 1)
}
