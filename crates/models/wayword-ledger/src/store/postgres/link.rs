//! A program's link to the database: its connections, its unique name, and pending writes that have to be made up for.

use super::amount;
use crate::{
    CallKey, LedgerError, LedgerLocation,
    store::{PendingRequest, RequestEnd},
};
use std::{
    hash::{BuildHasher, RandomState},
    mem,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicI64, Ordering},
    },
    time::{SystemTime, UNIX_EPOCH},
};
use wayword_database::{
    ConnectionPool,
    postgres::{self, error::SqlState},
};

/// Connections for everything but signs of life, which have one more.
const MAX_CONNECTIONS: usize = 3;

/// Number of rows of `settled` for one run, over which programs spread their changes.
const SETTLED_ROWS_PER_RUN: u64 = 16;

/// Reserves the money of a request and writes the request down, if no limit is exceeded. Executed a second time, it has no effect. The
/// released amounts that it reads may have grown since the statement began, but never shrunk, so the limits hold.
const RESERVE_SQL: &str = "
WITH back AS (
    SELECT coalesce(sum(released - spent), 0)::bigint AS usd, coalesce(sum(cancelled), 0)::bigint AS calls
    FROM wayword_ledger.settled WHERE run = $3
),
moved AS (
    UPDATE wayword_ledger.runs AS r SET reserved = r.reserved + coalesce($5::bigint, 0), calls = r.calls + 1
    WHERE r.run = $3
    AND ($7::bigint IS NULL OR r.reserved - (SELECT usd FROM back) + coalesce($5::bigint, 0) <= $7)
    AND ($8::bigint IS NULL OR r.calls - (SELECT calls FROM back) < $8)
    AND NOT EXISTS (SELECT FROM wayword_ledger.sent WHERE program = $1 AND number = $2)
    RETURNING 1
),
written AS (
    INSERT INTO wayword_ledger.sent (program, number, run, key, most, at)
    SELECT $1, $2, $3, $4, $5, $6 FROM moved RETURNING 1
)
SELECT EXISTS (SELECT FROM written) OR EXISTS (SELECT FROM wayword_ledger.sent WHERE program = $1 AND number = $2),
    EXISTS (SELECT FROM wayword_ledger.runs WHERE run = $3)";

/// Makes the row of a new run.
const INSERT_RUN_SQL: &str = "INSERT INTO wayword_ledger.runs (run) VALUES ($1) ON CONFLICT DO NOTHING";

/// Ends a request and releases its money, as far as it was not lost. Executed a second time, it has no effect.
const END_SQL: &str = "
WITH moved AS (
    UPDATE wayword_ledger.sent SET outcome = $3, reason = $4
    WHERE program = $1 AND number = $2 AND outcome IS NULL RETURNING run, coalesce(most, 0) AS most
)
INSERT INTO wayword_ledger.settled AS s (run, slot, released, spent, cancelled)
SELECT run, $5, most, CASE $3 WHEN 'lost' THEN most ELSE 0 END, CASE $3 WHEN 'cancelled' THEN 1 ELSE 0 END FROM moved
ON CONFLICT (run, slot) DO UPDATE SET released = s.released + EXCLUDED.released, spent = s.spent + EXCLUDED.spent,
    cancelled = s.cancelled + EXCLUDED.cancelled";

/// Gives back the right of program `$2` to make call `$1`.
const RELEASE_SQL: &str = "DELETE FROM wayword_ledger.claims WHERE key = $1 AND holder = $2";

/// A program's link to the database.
#[derive(Debug)]
pub(super) struct DatabaseLink {
    pub(super) pool: ConnectionPool,
    /// The unique name of this program.
    pub(super) program: String,
    /// Which of a run's rows of `settled` this program changes.
    pub(super) slot: i16,
    /// The number of the next request.
    next: AtomicI64,
    /// Writes that have failed and have to be made later.
    owed: Mutex<Vec<OwedWrite>>,
}

/// A write that could not be made, and will be made later.
#[derive(Debug)]
enum OwedWrite {
    /// The end of request `number`, which brought no answer.
    End { number: i64, end: RequestEnd, reason: String },
    /// The release of a claim.
    Release(CallKey),
}

/// The result of [`DatabaseLink::reserve_request`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ReserveOutcome {
    /// The request is reserved and written down.
    Yes,
    /// A limit would be exceeded.
    No,
    /// Nothing is decided, so the caller tries again: the run had no row until now, or the same statement is being carried out twice
    /// after a lost connection.
    Again,
}

impl DatabaseLink {
    pub(super) fn new(database: wayword_database::PostgresDatabase) -> Self {
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_micros();
        // Programs on many machines need different names, so the clock is not enough.
        let random = RandomState::new().hash_one((since, std::process::id()));
        Self {
            pool: ConnectionPool::new(database, MAX_CONNECTIONS),
            program: format!("{:x}-{since:x}-{random:x}", std::process::id()),
            slot: i16::try_from(random % SETTLED_ROWS_PER_RUN).unwrap_or(0),
            next: AtomicI64::new(0),
            owed: Mutex::default(),
        }
    }

    pub(super) fn ledger_location(&self) -> LedgerLocation {
        LedgerLocation::Database(self.pool.database().shown_name().to_owned())
    }

    /// A number for a request.
    pub(super) fn next_request_number(&self) -> i64 {
        self.next.fetch_add(1, Ordering::Relaxed)
    }

    /// Executes a statement.
    pub(super) fn query_rows(
        &self,
        doing: &'static str,
        sql: &'static str,
        values: &[&(dyn postgres::types::ToSql + Sync)],
    ) -> Result<Vec<postgres::Row>, LedgerError> {
        Ok(self.pool.with_connection(doing, |connection| connection.query_rows(sql, values))?)
    }

    /// Executes a statement that gives one row, and reads it.
    pub(super) fn query_row<T>(
        &self,
        doing: &'static str,
        sql: &'static str,
        values: &[&(dyn postgres::types::ToSql + Sync)],
        read: impl Fn(&postgres::Row) -> Result<T, postgres::Error>,
    ) -> Result<Option<T>, LedgerError> {
        Ok(self
            .pool
            .with_connection(doing, |connection| connection.query_rows(sql, values)?.first().map(&read).transpose())?)
    }

    /// Reserves the money of a request and writes it down.
    pub(super) fn reserve_request(
        &self,
        number: i64,
        request: &PendingRequest<'_>,
    ) -> Result<ReserveOutcome, LedgerError> {
        let PendingRequest { run, key, most_usd, at_unix_s, limits } = request;
        let (most, key) = (most_usd.map(amount::nanos_rounded_up), key.as_str());
        let max_usd = limits.max_usd.map(amount::limit_nanos);
        let max_calls = limits.max_calls.map(super::rows::count_to_i64);
        let done = self.pool.with_connection("write a request down", |connection| {
            let values: [&(dyn postgres::types::ToSql + Sync); 8] =
                [&self.program, &number, run, &key, &most, at_unix_s, &max_usd, &max_calls];
            match connection.query_rows(RESERVE_SQL, &values) {
                Ok(rows) => rows.first().map(|row| Ok((row.try_get(0)?, row.try_get(1)?))).transpose(),
                // The same statement was sent before the connection was lost, and is carried out at this moment.
                Err(error) if error.code() == Some(&SqlState::UNIQUE_VIOLATION) => Ok(None),
                Err(error) => Err(error),
            }
        })?;
        match done {
            Some((true, _)) => Ok(ReserveOutcome::Yes),
            Some((false, true)) => Ok(ReserveOutcome::No),
            Some((false, false)) => {
                self.query_rows("begin a run", INSERT_RUN_SQL, &[run])?;
                Ok(ReserveOutcome::Again)
            }
            None => Ok(ReserveOutcome::Again),
        }
    }

    /// Ends a request, now or later.
    pub(super) fn end_request(&self, number: i64, end: RequestEnd, reason: &str) {
        self.write_now_or_later(OwedWrite::End { number, end, reason: super::rows::without_nul(reason) });
    }

    /// Gives the right to make a call back, now or later.
    pub(super) fn release_claim(&self, key: &CallKey) {
        self.write_now_or_later(OwedWrite::Release(key.clone()));
    }

    fn write_now_or_later(&self, owed: OwedWrite) {
        if self.make_write(&owed).is_err() {
            self.owed.lock().unwrap_or_else(PoisonError::into_inner).push(owed);
        }
    }

    fn make_write(&self, owed: &OwedWrite) -> Result<(), LedgerError> {
        match owed {
            OwedWrite::End { number, end, reason } => {
                let values: [&(dyn postgres::types::ToSql + Sync); 5] =
                    [&self.program, number, &end.name(), reason, &self.slot];
                self.query_rows("write down how a request ended", END_SQL, &values).map(drop)
            }
            OwedWrite::Release(key) => {
                self.query_rows("release a call", RELEASE_SQL, &[&key.as_str(), &self.program]).map(drop)
            }
        }
    }

    /// Makes the writes that could not be made before.
    pub(super) fn catch_up(&self) -> Result<(), LedgerError> {
        let owed = mem::take(&mut *self.owed.lock().unwrap_or_else(PoisonError::into_inner));
        let mut outcome = Ok(());
        for write in owed {
            // After a failure the others would fail too, each after a long time.
            outcome = outcome.and_then(|()| self.make_write(&write));
            if outcome.is_err() {
                self.owed.lock().unwrap_or_else(PoisonError::into_inner).push(write);
            }
        }
        outcome
    }
}
