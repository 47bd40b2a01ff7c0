//! The queue in PostgreSQL against the rules that the model of the protocol is made of: the same events, in many orders, and the
//! same rows after each. It needs `WAYWORD_TEST_POSTGRES=1` and PostgreSQL's programs.

#![cfg(feature = "postgres")]
#![allow(clippy::unwrap_used, clippy::print_stderr, reason = "a test fails by panicking, and says if it was skipped")]

use rand::{Rng, SeedableRng, rngs::StdRng, seq::IndexedRandom};
use std::{path::Path, thread, time::Duration};
use wayword_database::{PostgresDatabase, postgres};
use wayword_queue::{ChunkBoard, ChunkClaim, ChunkPlan, ChunkQueue, ChunkRecord, ChunkRow, ChunkState};
use wayword_testkit::PostgresServer;

const CHUNKS: usize = 4;
const WORKERS: usize = 3;
const EVENTS: usize = 60;
const ORDERS: u64 = 12;
/// Long enough that a busy machine does not make a living worker seem gone.
const LEASE: Duration = Duration::from_secs(10);

/// A worker, and every claim that it or its killed forerunners ever had.
struct Worker {
    name: String,
    queue: ChunkQueue,
}

#[test]
fn the_queue_follows_the_rules_of_the_model() {
    if std::env::var_os("WAYWORD_TEST_POSTGRES").is_none() {
        eprintln!("skipped: the_queue_follows_the_rules_of_the_model needs WAYWORD_TEST_POSTGRES=1");
        return;
    }
    let server = PostgresServer::start().unwrap();
    // No worker counts as gone until the server has been up for a whole lease.
    thread::sleep(LEASE);
    let url = server.new_database();
    let mut died = 0;
    for seed in 0..ORDERS {
        let rows = one_order(&url, seed);
        died += rows.iter().filter(|row| row.state == ChunkState::Dead).count();
    }
    assert!(died > 0, "some chunk is given up");
}

fn one_order(url: &str, seed: u64) -> Vec<ChunkRow<String>> {
    let mut rng = StdRng::seed_from_u64(seed);
    let folder = tempfile::tempdir().unwrap();
    let run = format!("run-{seed}");
    let plan = ChunkPlan::new(run.clone(), 1, String::new(), vec![String::new(); CHUNKS]);
    std::fs::create_dir_all(folder.path().join("chunks")).unwrap();
    let mut table = postgres::Client::connect(url, postgres::NoTls).unwrap();
    let mut names = 0..;
    let mut join = || {
        let name = format!("worker-{}", names.next().unwrap_or(0));
        let queue = ChunkQueue::open(PostgresDatabase::from_name(url, None).unwrap(), folder.path(), &plan).unwrap();
        Worker { queue: queue.join_as(&name, LEASE).unwrap(), name }
    };
    let mut workers: Vec<Worker> = (0..WORKERS).map(|_| join()).collect();
    let mut rows: Vec<ChunkRow<String>> = vec![ChunkRow::default(); CHUNKS];
    // Claims of living and of killed workers: a report of each may still arrive, or arrive again.
    let mut claims: Vec<ChunkClaim> = Vec::new();
    for event in 0..EVENTS {
        let at = rng.random_range(0..WORKERS);
        let living: Vec<String> = workers.iter().map(|worker| worker.name.clone()).collect();
        match rng.random_range(0..9) {
            0..4 => claims.extend(claim(&workers[at], &mut rows, &living)),
            4 => workers[at] = join(),
            kind => {
                let Some(claimed) = claims.choose(&mut rng).copied() else { continue };
                say(kind, &workers[at].queue, &mut rows[claimed.chunk], claimed);
            }
        }
        assert_eq!(kept(&mut table, &run), rows, "event {event} of order {seed}");
    }
    assert_marks(folder.path(), &rows);
    rows
}

/// A worker asks for a chunk. A worker that has one gets the same one again, and this does not count as a claim.
fn claim(worker: &Worker, rows: &mut [ChunkRow<String>], living: &[String]) -> Option<ChunkClaim> {
    let name = &worker.name;
    let given = worker.queue.take_chunk().unwrap();
    let is_gone = |other: &String| !living.contains(other);
    if let Some(has) = rows.iter().position(|row| row.state == ChunkState::Running && row.worker.as_ref() == Some(name))
    {
        assert_eq!(given, Some(ChunkClaim { chunk: has, epoch: rows[has].epoch }));
        return None;
    }
    // A worker that asks for a chunk first gives up those that were begun too often.
    for row in rows.iter_mut() {
        let mut tried = row.clone();
        if tried.claim_chunk(name, is_gone).is_none() {
            *row = tried;
        }
    }
    match given {
        Some(claimed) => assert_eq!(rows[claimed.chunk].claim_chunk(name, is_gone), Some(claimed.epoch)),
        None => assert!(rows.iter().all(|row| row.clone().claim_chunk(name, is_gone).is_none()), "{rows:?}"),
    }
    given
}

/// Sends a report about a claim, which may be outdated, and compares the answer with the rules.
fn say(kind: i32, queue: &ChunkQueue, row: &mut ChunkRow<String>, claimed: ChunkClaim) {
    match kind {
        5 | 6 => {
            let again = row.state == ChunkState::Done && row.epoch == claimed.epoch;
            let done = ChunkRecord { chunk: claimed.chunk, epoch: claimed.epoch, ..ChunkRecord::default() };
            // A repeated completion gets the answer that the first one counts.
            assert_eq!(queue.complete_chunk(claimed, &done).unwrap(), row.complete_claim(claimed.epoch) || again);
        }
        7 => {
            queue.hand_back(claimed).unwrap();
            row.hand_back(claimed.epoch);
        }
        _ => {
            queue.give_up(claimed, "it failed").unwrap();
            row.give_up(claimed.epoch);
        }
    }
}

/// The rows of a run in the database.
fn kept(table: &mut postgres::Client, run: &str) -> Vec<ChunkRow<String>> {
    let sql = "SELECT state, epoch, tries, worker FROM wayword_queue.chunks WHERE run = $1 ORDER BY chunk";
    let row = |row: &postgres::Row| ChunkRow {
        state: match row.get(0) {
            "open" => ChunkState::Open,
            "running" => ChunkState::Running,
            "done" => ChunkState::Done,
            _ => ChunkState::Dead,
        },
        epoch: row.get(1),
        tries: row.get(2),
        worker: row.get(3),
    };
    table.query(sql, &[&run]).unwrap().iter().map(row).collect()
}

/// Checks that exactly the finished chunks have a mark, each with the number of the claim that counted.
fn assert_marks(folder: &Path, rows: &[ChunkRow<String>]) {
    for (chunk, row) in rows.iter().enumerate() {
        let mark = wayword_queue::read_done_mark(folder, chunk).unwrap();
        let expected = (row.state == ChunkState::Done).then_some(row.epoch);
        assert_eq!(mark.map(|done| done.epoch), expected, "chunk {chunk}");
    }
}
