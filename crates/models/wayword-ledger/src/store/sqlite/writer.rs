//! The one thread that writes a ledger's file. Each commit has to wait for the disk, so the thread combines all writes that arrived
//! during the last commit into the next one.

use crate::{LedgerError, Place, Row, checksum, store::Claimed};
use rusqlite::{Connection, Transaction, TransactionBehavior, params};
use std::{
    path::{Path, PathBuf},
    sync::mpsc,
    thread::{self, JoinHandle},
    time::Duration,
};

/// Most writes in the queue, and in one commit. A sender waits while the queue is full, so that memory is bounded.
const MOST_AT_ONCE: usize = 1024;

/// How long the last checkpoint waits for other programs. They can make the checkpoint too.
const LAST_PATIENCE: Duration = Duration::from_secs(1);

/// A change to the ledger.
#[derive(Debug)]
pub(super) enum Write {
    /// A request is about to be sent.
    Sent { run: String, key: String, most_usd: Option<f64>, at: i64, by: Option<String> },
    /// A request brought no answer. Its outcome is `lost` if it may have been paid.
    Ended { sent: i64, outcome: &'static str, reason: String },
    /// A call was answered. The program need not have claimed it.
    Answered { sent: Option<i64>, row: Box<Row>, by: Option<String> },
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

/// The result of a write: for a request that is about to be sent, its number; for an answer, 1 if it is the first and 0
/// if the call had one before; for a claim, the number that [`claimed`] reads.
type Written = Result<i64, LedgerError>;

impl Write {
    /// Whether the write has to survive a loss of power. Claims need not, because they end with their programs.
    fn has_to_last(&self) -> bool {
        !matches!(self, Self::Claim { .. } | Self::Release { .. } | Self::Forget { .. } | Self::Flush)
    }
}

struct Job {
    write: Write,
    /// Gets the result once the write is on disk, if a thread waits for it.
    done: Option<mpsc::SyncSender<Written>>,
}

/// Passes writes to the writing thread. When it is dropped, all pending writes are finished first.
#[derive(Debug)]
pub(super) struct Writer {
    jobs: Option<mpsc::SyncSender<Job>>,
    thread: Option<JoinHandle<()>>,
    path: PathBuf,
}

impl Writer {
    pub(super) fn start(connection: Connection, path: &Path) -> Result<Self, LedgerError> {
        let (sender, jobs) = mpsc::sync_channel(MOST_AT_ONCE);
        let of = path.to_owned();
        let thread = thread::Builder::new()
            .name("ledger".to_owned())
            .spawn(move || work(connection, &jobs, &of))
            .map_err(LedgerError::io(path, "start the ledger's thread"))?;
        Ok(Self { jobs: Some(sender), thread: Some(thread), path: path.to_owned() })
    }

    /// Writes a change, and returns once it is on disk.
    pub(super) fn keep(&self, write: Write) -> Written {
        let (done, written) = mpsc::sync_channel(1);
        self.send(Job { write, done: Some(done) });
        written.recv().unwrap_or_else(|_| Err(self.gone()))
    }

    /// Writes a change with the next commit that succeeds, and does not wait for it.
    pub(super) fn note(&self, write: Write) {
        self.send(Job { write, done: None });
    }

    /// Returns once all earlier writes are on disk.
    pub(super) fn flush(&self) -> Result<(), LedgerError> {
        self.keep(Write::Flush).map(drop)
    }

    fn send(&self, job: Job) {
        if let Some(jobs) = &self.jobs {
            // If the thread has ended, `keep` returns an error.
            let _ = jobs.send(job);
        }
    }

    fn gone(&self) -> LedgerError {
        LedgerError::Store {
            place: Place::file(&self.path),
            doing: "write",
            reason: "the thread that writes it has ended".to_owned(),
            hint: "run the same command again",
            is_lost: false,
        }
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn work(mut connection: Connection, jobs: &mpsc::Receiver<Job>, path: &Path) {
    let mut group = Vec::new();
    while let Ok(first) = jobs.recv() {
        group.push(first);
        while group.len() < MOST_AT_ONCE {
            let Ok(next) = jobs.try_recv() else { break };
            group.push(next);
        }
        let written = commit(&mut connection, &group, path);
        group = tell(group, &written);
    }
    if !group.is_empty() {
        let _ = commit(&mut connection, &group, path);
    }
    // Puts everything into the main file, because then the ledger is easier to copy. Otherwise the next program would
    // do this.
    let _ = connection.busy_timeout(LAST_PATIENCE);
    let _ = connection.execute_batch("PRAGMA wal_checkpoint(TRUNCATE)");
}

/// Passes the result to the threads that wait. Returns the failed writes that no thread waits for: they go into the
/// next commit.
fn tell(group: Vec<Job>, written: &Result<Vec<i64>, LedgerError>) -> Vec<Job> {
    let mut unwritten = Vec::new();
    for (at, job) in group.into_iter().enumerate() {
        let result = match written {
            Ok(numbers) => Ok(numbers.get(at).copied().unwrap_or(0)),
            Err(error) => Err(error.clone()),
        };
        match job.done {
            // The thread may no longer wait.
            Some(done) => drop(done.send(result)),
            None if result.is_err() => unwritten.push(job),
            None => {}
        }
    }
    unwritten
}

fn commit(connection: &mut Connection, group: &[Job], path: &Path) -> Result<Vec<i64>, LedgerError> {
    let failed = LedgerError::store(path, "write");
    let sync = if group.iter().any(|job| job.write.has_to_last()) { "FULL" } else { "NORMAL" };
    connection.pragma_update(None, "synchronous", sync).map_err(&failed)?;
    let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate).map_err(&failed)?;
    let numbers = group.iter().map(|job| apply(&transaction, &job.write)).collect::<Result<_, _>>().map_err(&failed)?;
    transaction.commit().map_err(&failed)?;
    Ok(numbers)
}

fn apply(transaction: &Transaction<'_>, write: &Write) -> rusqlite::Result<i64> {
    let run = |sql: &str, with: &[&dyn rusqlite::ToSql]| transaction.prepare_cached(sql)?.execute(with);
    match write {
        Write::Sent { run: for_run, key, most_usd, at, by } => {
            run("UPDATE claims SET sent = sent + 1 WHERE key = ?1 AND holder = ?2", params![key, by])?;
            let sql = "INSERT INTO sent (run, key, most_usd, at) VALUES (?1, ?2, ?3, ?4)";
            run(sql, params![for_run, key, most_usd, at])?;
            return Ok(transaction.last_insert_rowid());
        }
        Write::Ended { sent, outcome, reason } => {
            run("UPDATE sent SET outcome = ?2, reason = ?3 WHERE id = ?1", params![sent, outcome, reason])?;
        }
        Write::Used { run: by, key } => {
            run("INSERT OR IGNORE INTO uses (run, key) VALUES (?1, ?2)", params![by, key])?;
        }
        Write::Flush => {}
        Write::Claim { key, by, from } => {
            return claim(transaction, key, by, from.as_deref()).map(|claimed| claimed as i64);
        }
        Write::Release { key, by } => {
            run("DELETE FROM claims WHERE key = ?1 AND holder = ?2", params![key, by])?;
        }
        Write::Forget { by } => {
            run("DELETE FROM claims WHERE holder = ?1", params![by])?;
        }
        Write::Answered { sent, row, by } => {
            let is_first = answered(transaction, row)?;
            run("DELETE FROM claims WHERE key = ?1 AND holder = ?2", params![row.key.as_str(), by])?;
            run("INSERT OR IGNORE INTO uses (run, key) VALUES (?1, ?2)", params![row.run, row.key.as_str()])?;
            if let Some(sent) = sent {
                run("UPDATE sent SET outcome = 'answered', usd = ?2 WHERE id = ?1", params![sent, row.answer.usd])?;
            }
            return Ok(i64::from(is_first));
        }
    }
    Ok(0)
}

/// Decodes the number that a write of a claim returns.
pub(super) fn claimed(written: i64) -> Claimed {
    match written {
        0 => Claimed::Ours,
        1 => Claimed::Others,
        _ => Claimed::Answered,
    }
}

/// Gives a call to a program, unless the call is answered or another program than `from` has it.
fn claim(transaction: &Transaction<'_>, key: &str, by: &str, from: Option<&str>) -> rusqlite::Result<Claimed> {
    if transaction.prepare_cached("SELECT 1 FROM calls WHERE key = ?1")?.exists(params![key])? {
        return Ok(Claimed::Answered);
    }
    let sql = "INSERT INTO claims (key, holder, sent) VALUES (?1, ?2, 0)
               ON CONFLICT (key) DO UPDATE SET holder = ?2, sent = 0 WHERE holder = ?2 OR holder = ?3";
    let given = transaction.prepare_cached(sql)?.execute(params![key, by, from])?;
    Ok(if given == 1 { Claimed::Ours } else { Claimed::Others })
}

/// Stores an answer if it is the first, and returns whether it is: another program may have made the same call at the
/// same time.
fn answered(transaction: &Transaction<'_>, row: &Row) -> rusqlite::Result<bool> {
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
            checksum::of(&row.key, answer)
        ])?;
    Ok(added == 1)
}
