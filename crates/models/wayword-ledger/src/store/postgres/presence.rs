//! Signs of life of the programs that use a ledger in a database. A program without one for the time of a lease, by the database's clock,
//! has ended or cannot reach the database. Others may then make its calls.

use super::link::DatabaseLink;
use crate::LedgerError;
use std::{
    sync::{Arc, mpsc},
    thread,
    time::Duration,
};
use wayword_database::ConnectionPool;

/// How often a program gives a sign of life, and after how long without one it counts as gone.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LeaseTiming {
    /// The time from one sign of life to the next.
    pub(crate) beat: Duration,
    /// The lease: a program without a sign of life for this long counts as gone.
    pub(crate) gone: Duration,
}

impl LeaseTiming {
    /// How long a sign of life counts by default.
    pub(crate) const DEFAULT_LEASE: Duration = Duration::from_secs(60);

    /// Six signs of life in each lease.
    pub(crate) fn from_lease(lease: Duration) -> Self {
        Self { beat: lease / 6, gone: lease }
    }
}

/// Writes a sign of life. It is not synced to disk, because it need not survive a crash of the server.
const BEAT_SQL: &str = "
INSERT INTO wayword_ledger.presence (program, beat)
SELECT $1, clock_timestamp() WHERE set_config('synchronous_commit', 'off', true) = 'off'
ON CONFLICT (program) DO UPDATE SET beat = clock_timestamp()";

/// Removes the entries and claims of programs that have ended. It waits for a lease after the start of the server, because programs
/// could not give signs of life before.
const SWEEP_SQL: &str = "
WITH old AS (
    SELECT program FROM wayword_ledger.presence WHERE beat < clock_timestamp() - make_interval(secs => $1)
    AND pg_postmaster_start_time() < clock_timestamp() - make_interval(secs => $1) FOR UPDATE SKIP LOCKED
),
gone AS (DELETE FROM wayword_ledger.presence AS p USING old WHERE p.program = old.program RETURNING p.program)
DELETE FROM wayword_ledger.claims USING gone WHERE claims.holder = gone.program";

/// Removes the entry and the claims of a program that ends.
const LEAVE_SQL: &str = "
WITH gone AS (DELETE FROM wayword_ledger.presence WHERE program = $1)
DELETE FROM wayword_ledger.claims WHERE holder = $1";

/// Shows other programs that this one is running, until it is dropped.
#[derive(Debug)]
pub(super) struct DatabasePresence {
    link: Arc<DatabaseLink>,
    /// The thread ends when this is dropped.
    stop: Option<mpsc::Sender<()>>,
}

impl DatabasePresence {
    /// Gives the first sign of life, and goes on in a thread with a connection of its own.
    pub(super) fn new(link: &Arc<DatabaseLink>, pulse: LeaseTiming) -> Result<Self, LedgerError> {
        let pool = ConnectionPool::new(link.pool.database().clone(), 1);
        write_beat(&pool, &link.program)?;
        let gone_s = pulse.gone.as_secs_f64();
        pool.with_connection("remove what ended programs left behind", |connection| {
            connection.query_rows(SWEEP_SQL, &[&gone_s])
        })?;
        let (stop, stopped) = mpsc::channel();
        let thread_link = Arc::clone(link);
        thread::Builder::new()
            .name("ledger's signs of life".to_owned())
            .spawn(move || give_signs_of_life(&pool, &thread_link, pulse.beat, &stopped))
            .map_err(LedgerError::io_error(link.ledger_location(), "start the ledger's thread"))?;
        Ok(Self { link: Arc::clone(link), stop: Some(stop) })
    }
}

/// The work of the thread: a sign of life after each pause, until the sender of `stopped` is dropped.
fn give_signs_of_life(pool: &ConnectionPool, link: &DatabaseLink, pause: Duration, stopped: &mpsc::Receiver<()>) {
    while let Err(mpsc::RecvTimeoutError::Timeout) = stopped.recv_timeout(pause) {
        // If this fails for a while, others take over this program's calls, and the first answer is kept.
        if write_beat(pool, &link.program).is_ok() {
            let _ = link.catch_up();
        }
    }
}

/// Gives one sign of life.
fn write_beat(pool: &ConnectionPool, program: &str) -> Result<(), LedgerError> {
    Ok(pool
        .with_connection("give a sign of life", |connection| connection.query_rows(BEAT_SQL, &[&program]).map(drop))?)
}

impl Drop for DatabasePresence {
    fn drop(&mut self) {
        self.stop = None;
        // One try alone, because a program that ends does not wait for a server that is away: others notice it later.
        if let Ok(mut client) = self.link.pool.database().connect() {
            let _ = client.execute(LEAVE_SQL, &[&self.link.program]);
        }
    }
}
