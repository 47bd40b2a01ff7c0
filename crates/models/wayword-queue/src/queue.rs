//! A board in PostgreSQL: a worker that asks gets the first open chunk. The rules are those of [`crate::ChunkRow`], in SQL.
//!
//! Each claim of a chunk has a number, its epoch, which goes up. A worker that was suspended and taken over still has the
//! old epoch, so its late result changes no row.

use crate::{
    ChunkBoard, ChunkClaim, ChunkPlan, ChunkRecord, MAX_CHUNK_TRIES, QueueError, RemainingChunks, failing_chunks,
    heartbeat::named_worker_has_ended, reopen_chunks,
};
use std::{
    path::{Path, PathBuf},
    sync::{Arc, mpsc},
    thread::{self, JoinHandle},
    time::Duration,
};
use wayword_database::{ConnectionPool, PostgresDatabase, SchemaTables, prepare_tables};

/// The tables of the queue.
///
/// `chunks` changes only when a chunk changes hands, and results are not in it, so its rows stay few and short. A worker's
/// heartbeat is one row of `workers`.
pub const QUEUE_TABLES: SchemaTables =
    SchemaTables { schema: "wayword_queue", steps: &[CREATE_TABLES_SQL], grants: GRANTS_SQL };

/// `chunks.done` is the [`ChunkRecord`] of a finished chunk as JSON. `chunks.reason` is why the chunk last failed, and
/// `chunks.retries` counts such failures. `chunks.since` is when the chunk last changed hands.
const CREATE_TABLES_SQL: &str = "
CREATE TABLE wayword_queue.runs (
    run TEXT PRIMARY KEY, plan TEXT NOT NULL, chunks INTEGER NOT NULL, at TIMESTAMPTZ NOT NULL DEFAULT now()
);
CREATE TABLE wayword_queue.chunks (
    run TEXT NOT NULL REFERENCES wayword_queue.runs ON DELETE CASCADE, chunk INTEGER NOT NULL,
    state TEXT NOT NULL DEFAULT 'open' CHECK (state IN ('open', 'running', 'done', 'dead')),
    epoch BIGINT NOT NULL DEFAULT 0, tries INTEGER NOT NULL DEFAULT 0, worker TEXT, reason TEXT,
    since TIMESTAMPTZ, done TEXT, retries INTEGER NOT NULL DEFAULT 0, PRIMARY KEY (run, chunk)
) WITH (fillfactor = 70);
CREATE INDEX chunks_open ON wayword_queue.chunks (run, chunk) WHERE state = 'open';
CREATE INDEX chunks_running ON wayword_queue.chunks (run, chunk) WHERE state = 'running';
CREATE TABLE wayword_queue.workers (
    run TEXT NOT NULL REFERENCES wayword_queue.runs ON DELETE CASCADE, worker TEXT NOT NULL,
    beat TIMESTAMPTZ NOT NULL DEFAULT now(), since TIMESTAMPTZ NOT NULL DEFAULT now(), PRIMARY KEY (run, worker)
) WITH (fillfactor = 50);
";

/// The rights that a worker's role needs.
const GRANTS_SQL: &str = "
GRANT USAGE ON SCHEMA wayword_queue TO ROLE;
GRANT SELECT ON wayword_queue.version TO ROLE;
GRANT SELECT, INSERT ON wayword_queue.runs TO ROLE;
GRANT SELECT, INSERT, UPDATE ON wayword_queue.chunks TO ROLE;
GRANT SELECT, INSERT, UPDATE, DELETE ON wayword_queue.workers TO ROLE;
";

/// Gives up chunks that were begun too often by workers that are gone.
const BURY_SQL: &str = "
UPDATE wayword_queue.chunks AS c SET state = 'dead', reason = 'begun ' || tries || ' times without a result: its worker ended each time'
WHERE run = $1 AND state = 'running' AND tries >= $2 AND pg_postmaster_start_time() < now() - make_interval(secs => $3) AND NOT EXISTS (
    SELECT 1 FROM wayword_queue.workers AS w WHERE w.run = c.run AND w.worker = c.worker AND w.beat > now() - make_interval(secs => $3)
)";

/// Claims a chunk of a worker that is gone, or else the first open one. No worker counts as gone until the server has been
/// up for a whole lease, because while it was down no heartbeat could arrive. `SKIP LOCKED` gives different chunks to two
/// workers that ask at once. The two kinds are looked up separately, each in a small index, so that the finished chunks are
/// never scanned.
const CLAIM_SQL: &str = "
WITH lost AS (
    SELECT c.chunk FROM wayword_queue.chunks AS c
    WHERE c.run = $1 AND c.state = 'running' AND c.tries < $4 AND pg_postmaster_start_time() < now() - make_interval(secs => $3) AND NOT EXISTS (
        SELECT 1 FROM wayword_queue.workers AS w WHERE w.run = c.run AND w.worker = c.worker AND w.beat > now() - make_interval(secs => $3)
    )
    ORDER BY c.chunk LIMIT 1 FOR UPDATE SKIP LOCKED
), first AS (
    SELECT c.chunk FROM wayword_queue.chunks AS c
    WHERE c.run = $1 AND c.state = 'open' AND NOT EXISTS (SELECT 1 FROM lost)
    ORDER BY c.chunk LIMIT 1 FOR UPDATE SKIP LOCKED
), next AS (SELECT chunk FROM lost UNION ALL SELECT chunk FROM first)
UPDATE wayword_queue.chunks AS c SET state = 'running', epoch = c.epoch + 1, tries = c.tries + 1, worker = $2, since = now()
FROM next WHERE c.run = $1 AND c.chunk = next.chunk RETURNING c.chunk, c.epoch";

/// The chunk that a worker already has, although the answer to its claim was lost.
const OWN_CLAIM_SQL: &str =
    "SELECT chunk, epoch FROM wayword_queue.chunks WHERE run = $1 AND worker = $2 AND state = 'running'";

/// Records the result of a chunk, if epoch `$3` is still its latest claim.
const COMPLETE_SQL: &str = "
UPDATE wayword_queue.chunks SET state = 'done', done = $4, since = now()
WHERE run = $1 AND chunk = $2 AND epoch = $3 AND state = 'running'";

/// Whether a chunk was finished under epoch `$3`.
const IS_DONE_SQL: &str = "
SELECT 1 FROM wayword_queue.chunks WHERE run = $1 AND chunk = $2 AND epoch = $3 AND state = 'done'";

/// Opens a chunk again, without counting the try, if epoch `$3` is still its latest claim.
const HAND_BACK_SQL: &str = "
UPDATE wayword_queue.chunks SET state = 'open', tries = tries - 1
WHERE run = $1 AND chunk = $2 AND epoch = $3 AND state = 'running'";

/// Opens a chunk again after a failure, or gives it up after `$4` tries, if epoch `$3` is still its latest claim.
const GIVE_UP_SQL: &str = "
UPDATE wayword_queue.chunks SET state = CASE WHEN tries >= $4 THEN 'dead' ELSE 'open' END, reason = $5, retries = retries + 1
WHERE run = $1 AND chunk = $2 AND epoch = $3 AND state = 'running'";

/// Records a heartbeat of a worker.
const BEAT_SQL: &str = "
INSERT INTO wayword_queue.workers (run, worker) VALUES ($1, $2)
ON CONFLICT (run, worker) DO UPDATE SET beat = now()";

/// Removes the heartbeat of a worker, so that its chunk can be taken.
const LEAVE_SQL: &str = "DELETE FROM wayword_queue.workers WHERE run = $1 AND worker = $2";

/// A worker's view of a run's chunks.
#[derive(Debug)]
pub struct ChunkQueue {
    pool: Arc<ConnectionPool>,
    /// The run's name.
    run: String,
    /// This worker's name; empty before [`ChunkQueue::join_as`].
    worker: String,
    /// Where the marks of finished chunks go.
    folder: PathBuf,
    /// How long a heartbeat counts.
    lease: Duration,
    /// The thread of the heartbeat, and the sender that ends it when it is dropped.
    beating: Option<(mpsc::Sender<()>, JoinHandle<()>)>,
}

/// Connections of one worker: one for its work, one for its heartbeat.
const WORKER_CONNECTIONS: usize = 2;
/// Heartbeats in the time for which one counts.
const BEATS_PER_LEASE: u32 = 6;

/// A worker, its last heartbeat, and its chunk.
#[derive(Debug, Clone, PartialEq)]
pub struct QueueWorker {
    /// Its name.
    pub worker: String,
    /// Seconds since its last heartbeat.
    pub beat_s: f64,
    /// The chunk that it has.
    pub chunk: Option<usize>,
    /// For how long it has had it, seconds.
    pub chunk_s: Option<f64>,
}

/// The state of a run in the queue, for people.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct QueueStatus {
    /// Chunks that no worker has.
    pub open: usize,
    /// Chunks that workers have.
    pub running: usize,
    /// Finished chunks.
    pub done: usize,
    /// Chunks that were given up, with the reasons.
    pub dead: Vec<(usize, String)>,
    /// How often chunks were tried again, by reason.
    pub retries: Vec<(String, i64)>,
    /// The workers.
    pub workers: Vec<QueueWorker>,
}

impl ChunkQueue {
    /// A queue for the run of a folder's plan, without a worker: to look at it.
    ///
    /// # Errors
    /// When the database cannot be used, or has a run of that name with another plan.
    pub fn open(database: PostgresDatabase, folder: &Path, plan: &ChunkPlan) -> Result<Self, QueueError> {
        let pool = Arc::new(ConnectionPool::new(database, WORKER_CONNECTIONS));
        prepare_tables(&pool, &QUEUE_TABLES)?;
        let queue = Self {
            pool,
            run: plan.run.clone(),
            worker: String::new(),
            folder: folder.to_owned(),
            lease: crate::HEARTBEAT_LEASE,
            beating: None,
        };
        queue.enter_run(plan)?;
        Ok(queue)
    }

    /// Joins the workers. A worker without a heartbeat for as long as `lease` loses its chunk.
    ///
    /// # Errors
    /// When the database cannot be used.
    pub fn join_as(mut self, worker: &str, lease: Duration) -> Result<Self, QueueError> {
        self.worker = worker.to_owned();
        self.lease = lease;
        send_heartbeat(&self.pool, &self.run, worker)?;
        self.free_ended_workers()?;
        let (end, ended) = mpsc::channel();
        let (pool, run, name) = (Arc::clone(&self.pool), self.run.clone(), worker.to_owned());
        let beats = move || {
            while ended.recv_timeout(lease / BEATS_PER_LEASE) == Err(mpsc::RecvTimeoutError::Timeout) {
                // The pool tries several times. If that fails, the next heartbeat follows.
                let _ = send_heartbeat(&pool, &run, &name);
            }
        };
        let thread = thread::Builder::new().name("heartbeat".to_owned()).spawn(beats);
        let thread = thread.map_err(QueueError::for_file("heartbeat", "start the thread"))?;
        self.beating = Some((end, thread));
        Ok(self)
    }

    fn remove_worker(&self, worker: &str) -> Result<(), QueueError> {
        self.pool.with_connection("leave", |connection| connection.query_rows(LEAVE_SQL, &[&self.run, &worker]))?;
        Ok(())
    }

    /// Frees the chunks of workers that ran on this machine and have ended.
    fn free_ended_workers(&self) -> Result<(), QueueError> {
        let sql = "SELECT worker FROM wayword_queue.workers WHERE run = $1";
        let workers: Vec<String> = self.pool.with_connection("ask for the workers", |connection| {
            connection.query_rows(sql, &[&self.run])?.iter().map(|row| row.try_get(0)).collect()
        })?;
        workers.iter().filter(|worker| named_worker_has_ended(worker)).try_for_each(|worker| self.remove_worker(worker))
    }

    /// Enters the run and its chunks, unless they are there.
    fn enter_run(&self, plan: &ChunkPlan) -> Result<(), QueueError> {
        let (chunks, hash) = (i32::try_from(plan.chunk_count()).unwrap_or(i32::MAX), plan.plan_hash());
        let entered = self.pool.with_connection("enter the run", |connection| {
            let sql = "WITH new AS (INSERT INTO wayword_queue.runs (run, plan, chunks) VALUES ($1, $2, $3) ON CONFLICT DO NOTHING RETURNING run)
                       INSERT INTO wayword_queue.chunks (run, chunk) SELECT new.run, n FROM new, generate_series(0, $3 - 1) AS n";
            connection.query_rows(sql, &[&self.run, &hash, &chunks])?;
            let rows = connection.query_rows("SELECT plan FROM wayword_queue.runs WHERE run = $1", &[&self.run])?;
            rows.first().map(|row| row.try_get::<_, String>(0)).transpose()
        })?;
        match entered {
            Some(plan) if plan == hash => Ok(()),
            _ => Err(QueueError::Broken {
                path: crate::PLAN.into(),
                problem: format!("the database has a run {} with another plan", self.run),
            }),
        }
    }

    /// Changes the row of a claimed chunk by `sql`, where `$1` to `$3` are run, chunk and epoch, and `rest` the values from `$4` on.
    /// Returns whether the claim was still the latest.
    fn change_chunk(
        &self,
        doing: &'static str,
        sql: &'static str,
        claimed: ChunkClaim,
        rest: &[&(dyn wayword_database::postgres::types::ToSql + Sync)],
    ) -> Result<bool, QueueError> {
        let chunk = chunk_number(claimed.chunk);
        let mut values: Vec<&(dyn wayword_database::postgres::types::ToSql + Sync)> =
            vec![&self.run, &chunk, &claimed.epoch];
        values.extend(rest);
        let changed = self.pool.with_connection(doing, |connection| {
            let statement = connection.prepare_statement(sql)?;
            connection.client().execute(&statement, &values)
        })?;
        Ok(changed == 1)
    }

    /// The state of the run.
    ///
    /// # Errors
    /// When the database cannot be used.
    pub fn read_status(&self) -> Result<QueueStatus, QueueError> {
        Ok(self.pool.with_connection("look at the run", |connection| {
            let mut status = QueueStatus::default();
            let sql = "SELECT state, count(*) FROM wayword_queue.chunks WHERE run = $1 GROUP BY state";
            for row in connection.query_rows(sql, &[&self.run])? {
                let count = usize::try_from(row.try_get::<_, i64>(1)?).unwrap_or(0);
                match row.try_get::<_, &str>(0)? {
                    "open" => status.open = count,
                    "running" => status.running = count,
                    "done" => status.done = count,
                    _ => {}
                }
            }
            let sql = "SELECT chunk, coalesce(reason, '') FROM wayword_queue.chunks WHERE run = $1 AND state = 'dead' ORDER BY chunk";
            for row in connection.query_rows(sql, &[&self.run])? {
                status.dead.push((chunk_index(row.try_get(0)?), row.try_get(1)?));
            }
            let sql = "SELECT reason, sum(retries)::bigint FROM wayword_queue.chunks WHERE run = $1 AND retries > 0 AND reason IS NOT NULL GROUP BY 1 ORDER BY 1";
            for row in connection.query_rows(sql, &[&self.run])? {
                status.retries.push((row.try_get(0)?, row.try_get(1)?));
            }
            let sql = "SELECT w.worker, extract(epoch FROM now() - w.beat)::float8, c.chunk, extract(epoch FROM now() - c.since)::float8
                       FROM wayword_queue.workers AS w
                       LEFT JOIN wayword_queue.chunks AS c ON c.run = w.run AND c.worker = w.worker AND c.state = 'running'
                       WHERE w.run = $1 ORDER BY w.worker";
            for row in connection.query_rows(sql, &[&self.run])? {
                let chunk: Option<i32> = row.try_get(2)?;
                status.workers.push(QueueWorker {
                    worker: row.try_get(0)?,
                    beat_s: row.try_get(1)?,
                    chunk: chunk.map(chunk_index),
                    chunk_s: row.try_get(3)?,
                });
            }
            Ok(status)
        })?)
    }

    /// Writes missing marks of finished chunks: a worker can be killed after it has reported the chunk and before it writes
    /// the mark. Returns how many.
    ///
    /// # Errors
    /// When the database cannot be used or a mark cannot be written.
    pub fn write_missing_marks(&self) -> Result<usize, QueueError> {
        let records: Vec<String> = self.pool.with_connection("ask for the finished chunks", |connection| {
            let sql = "SELECT done FROM wayword_queue.chunks WHERE run = $1 AND state = 'done' AND done IS NOT NULL";
            connection.query_rows(sql, &[&self.run])?.iter().map(|row| row.try_get(0)).collect()
        })?;
        let mut marked = 0;
        for record in records {
            let done: ChunkRecord = serde_json::from_str(&record).map_err(|error| QueueError::Broken {
                path: crate::PLAN.into(),
                problem: format!("the database has a result that cannot be read: {error}"),
            })?;
            if !crate::done_path(&self.folder, done.chunk).exists() {
                marked += usize::from(done.write_mark(&self.folder)?);
            }
        }
        Ok(marked)
    }

    /// The chunks with failed items, or given up, for a reason that contains the text `reason`.
    ///
    /// # Errors
    /// When the database cannot be used or a mark cannot be read.
    pub fn failing_chunks(&self, plan: &ChunkPlan, reason: &str) -> Result<Vec<usize>, QueueError> {
        let mut failing = failing_chunks(&self.folder, plan, reason)?;
        // The reason why a chunk was given up is only in the database.
        failing.extend(
            self.read_status()?.dead.into_iter().filter(|(_, why)| why.contains(reason)).map(|(chunk, _)| chunk),
        );
        failing.sort_unstable();
        failing.dedup();
        Ok(failing)
    }

    /// Makes chunks open again.
    ///
    /// # Errors
    /// When the database cannot be used or a mark cannot be removed.
    pub fn reopen_chunks(&self, chunks: &[usize]) -> Result<(), QueueError> {
        reopen_chunks(&self.folder, chunks)?;
        let numbers: Vec<i32> = chunks.iter().map(|chunk| chunk_number(*chunk)).collect();
        self.pool.with_connection("make chunks open again", |connection| {
            let sql = "UPDATE wayword_queue.chunks SET state = 'open', tries = 0, done = NULL
                       WHERE run = $1 AND chunk = ANY($2) AND state IN ('done', 'dead')";
            connection.query_rows(sql, &[&self.run, &numbers])
        })?;
        Ok(())
    }
}

/// A chunk's number as the database stores it.
fn chunk_number(chunk: usize) -> i32 {
    i32::try_from(chunk).unwrap_or(i32::MAX)
}

/// A chunk's number, out of the database.
fn chunk_index(chunk: i32) -> usize {
    usize::try_from(chunk).unwrap_or(0)
}

fn send_heartbeat(pool: &ConnectionPool, run: &str, worker: &str) -> Result<(), QueueError> {
    pool.with_connection("give a sign of life", |connection| connection.query_rows(BEAT_SQL, &[&run, &worker]))?;
    Ok(())
}

impl ChunkBoard for ChunkQueue {
    fn take_chunk(&self) -> Result<Option<ChunkClaim>, QueueError> {
        let lease_s = self.lease.as_secs_f64();
        let taken = self.pool.with_connection("take a chunk", |connection| {
            // A worker has one chunk at a time. If it has one, the answer to its claim was lost with the connection.
            let mut rows = connection.query_rows(OWN_CLAIM_SQL, &[&self.run, &self.worker])?;
            if rows.is_empty() {
                connection.query_rows(BURY_SQL, &[&self.run, &MAX_CHUNK_TRIES, &lease_s])?;
                rows = connection.query_rows(CLAIM_SQL, &[&self.run, &self.worker, &lease_s, &MAX_CHUNK_TRIES])?;
            }
            rows.first().map(|row| Ok((row.try_get::<_, i32>(0)?, row.try_get::<_, i64>(1)?))).transpose()
        })?;
        Ok(taken.map(|(chunk, epoch)| ChunkClaim { chunk: chunk_index(chunk), epoch }))
    }

    fn complete_chunk(&self, claimed: ChunkClaim, done: &ChunkRecord) -> Result<bool, QueueError> {
        let record = serde_json::to_string(done).unwrap_or_default();
        if self.change_chunk("complete a chunk", COMPLETE_SQL, claimed, &[&record])? {
            done.write_mark(&self.folder)?;
            return Ok(true);
        }
        // No row changed. Perhaps an earlier try of this statement was carried out, and its answer got lost.
        let chunk = chunk_number(claimed.chunk);
        let done_rows = self.pool.with_connection("ask for a chunk", |connection| {
            connection.query_rows(IS_DONE_SQL, &[&self.run, &chunk, &claimed.epoch])
        })?;
        if done_rows.is_empty() {
            return Ok(false);
        }
        done.write_mark(&self.folder)?;
        Ok(true)
    }

    fn hand_back(&self, claimed: ChunkClaim) -> Result<(), QueueError> {
        self.change_chunk("hand a chunk back", HAND_BACK_SQL, claimed, &[]).map(drop)
    }

    fn give_up(&self, claimed: ChunkClaim, reason: &str) -> Result<(), QueueError> {
        self.change_chunk("give a chunk up", GIVE_UP_SQL, claimed, &[&MAX_CHUNK_TRIES, &reason]).map(drop)
    }

    fn count_remaining(&self) -> Result<RemainingChunks, QueueError> {
        let rows = self.pool.with_connection("ask what is left", |connection| {
            let sql = "SELECT count(*) FILTER (WHERE state = 'open'), count(*) FILTER (WHERE state = 'running')
                       FROM wayword_queue.chunks WHERE run = $1 AND state IN ('open', 'running')";
            let rows = connection.query_rows(sql, &[&self.run])?;
            rows.first().map(|row| Ok((row.try_get::<_, i64>(0)?, row.try_get::<_, i64>(1)?))).transpose()
        })?;
        let (open, running) = rows.unwrap_or_default();
        let count = |count: i64| usize::try_from(count).unwrap_or(0);
        Ok(RemainingChunks { open: count(open), running: count(running) })
    }
}

impl Drop for ChunkQueue {
    fn drop(&mut self) {
        let Some((end, thread)) = self.beating.take() else { return };
        drop(end);
        let _ = thread.join();
        let _ = self.remove_worker(&self.worker);
    }
}
