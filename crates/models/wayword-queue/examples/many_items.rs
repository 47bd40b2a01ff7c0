//! Measures how fast workers make items that take no time: the cost of plan, claims, marks and syncing alone.
//!
//! ```text
//! cargo run --release -p wayword-queue --features postgres --example many_items -- [queue|shards [ITEMS [WORKERS [CHUNK]]]]
//! ```
//!
//! Each worker is a process. For each chunk it writes a line for each item, syncs the file, and completes the chunk. For a queue,
//! a PostgreSQL server is started with its usual settings, so that a transaction it confirms is on disk.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout, reason = "it is a measurement")]

use std::{
    convert::Infallible,
    env, fs,
    io::{BufRead, BufReader, Write},
    path::Path,
    process::{Command, Stdio},
    thread,
    time::{Instant, SystemTime, UNIX_EPOCH},
};
use wayword_database::PostgresDatabase;
use wayword_queue::{
    ChunkBoard, ChunkOutcome, ChunkPlan, ChunkQueue, ChunkRecord, HEARTBEAT_LEASE, HeartbeatThread, ShardBoard,
    ShardPart, WorkerHeartbeat, chunk_folder, read_done_mark, sync_tree, work_chunks, worker_name,
};
use wayword_testkit::PostgresServer;

/// Where the workers' database is.
const URL: &str = "WAYWORD_MANY_ITEMS_URL";
/// Which part a worker has, and where the run is.
const WORKER: &str = "WAYWORD_MANY_ITEMS_WORKER";

fn main() {
    let by_queue = env::args().nth(1).is_none_or(|way| way == "queue");
    let argument = |at: usize, usual: usize| env::args().nth(at).map_or(usual, |text| text.parse().unwrap());
    let (items, workers, chunk) = (argument(2, 1_000_000), argument(3, 8), argument(4, 256));
    match env::var(WORKER) {
        Ok(worker) => {
            let (part, folder) = worker.split_once(' ').unwrap();
            be_worker(Path::new(folder), part.parse().unwrap());
        }
        Err(_) => measure(by_queue, items, workers, chunk),
    }
}

fn be_worker(folder: &Path, part: ShardPart) {
    let plan = ChunkPlan::for_folder(folder).unwrap();
    let worker = worker_name();
    match env::var(URL) {
        Ok(url) => {
            let database = PostgresDatabase::from_name(&url, None).unwrap();
            make_chunks(
                folder,
                &plan,
                &ChunkQueue::open(database, folder, &plan).unwrap().join_as(&worker, HEARTBEAT_LEASE).unwrap(),
            );
        }
        Err(_) => {
            let beat = WorkerHeartbeat::of_this_process(&worker, part.to_string());
            let heart =
                HeartbeatThread::start(folder, &part.heartbeat_name(), beat, HEARTBEAT_LEASE, |_| false).unwrap();
            make_chunks(folder, &plan, &ShardBoard::new(folder, &plan, part, &heart));
        }
    }
}

/// Makes chunks until none is left, and prints when each is made.
fn make_chunks(folder: &Path, plan: &ChunkPlan, board: &dyn ChunkBoard) {
    let finished = work_chunks::<Infallible, wayword_queue::QueueError>(
        board,
        |claimed| {
            let results = chunk_folder(folder, claimed.chunk, claimed.epoch);
            fs::create_dir_all(&results).unwrap();
            let range = plan.chunk_range(claimed.chunk);
            let made = range.len();
            let lines: String = plan.items[range].iter().map(|item| format!("{{\"item\":\"{item}\"}}\n")).collect();
            fs::write(results.join("instructions.jsonl"), lines).unwrap();
            sync_tree(&results)?;
            let at = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_micros();
            std::io::stdout().write_all(format!("{at} {made}\n").as_bytes()).unwrap();
            Ok(ChunkOutcome::Done(ChunkRecord {
                chunk: claimed.chunk,
                epoch: claimed.epoch,
                made,
                written: made,
                ..ChunkRecord::default()
            }))
        },
        || None,
    );
    assert_eq!(finished.unwrap().dropped, 0);
}

fn measure(by_queue: bool, items: usize, workers: usize, chunk: usize) {
    // In the program's folder, because the system's folder for temporary files may be in memory.
    let beside = env::current_exe().unwrap().parent().unwrap().to_owned();
    let folder = tempfile::Builder::new().prefix("many-items").tempdir_in(beside).unwrap();
    let server = by_queue.then(|| PostgresServer::start().expect("PostgreSQL is not installed"));
    let begun = Instant::now();
    fs::create_dir_all(folder.path().join("chunks")).unwrap();
    let names = (0..items).map(|number| format!("path-{number:08}")).collect();
    let plan = ChunkPlan::new("many".into(), chunk, String::new(), names);
    plan.write_plan(folder.path()).unwrap();
    println!("the plan of {items} items took {:.1} s", begun.elapsed().as_secs_f64());
    let url = server.as_ref().map(PostgresServer::new_database);
    let begun = Instant::now();
    let start = |k: usize| {
        let mut command = Command::new(env::current_exe().unwrap());
        command.env(WORKER, format!("{k}/{workers} {}", folder.path().display())).stdout(Stdio::piped());
        if let Some(url) = &url {
            command.env(URL, url);
        }
        command.spawn().unwrap()
    };
    let started: Vec<_> = (0..workers).map(start).collect();
    let mut made: Vec<(u64, usize)> = thread::scope(|scope| {
        let readers = started.into_iter().map(|mut worker| {
            scope.spawn(move || {
                let lines = BufReader::new(worker.stdout.take().unwrap()).lines();
                let made: Vec<_> = lines.map(|line| of_line(&line.unwrap())).collect();
                assert!(worker.wait().unwrap().success());
                made
            })
        });
        readers.collect::<Vec<_>>().into_iter().flat_map(|reader| reader.join().unwrap()).collect()
    });
    made.sort_unstable();
    let all: usize = made.iter().map(|(_, items)| items).sum();
    let took_s = begun.elapsed().as_secs_f64();
    println!("{all} items in {} chunks by {workers} workers: {took_s:.1} s, {:.0}/s", made.len(), all as f64 / took_s);
    tell_tenths(&made);
    let marked =
        (0..plan.chunk_count()).filter(|chunk| read_done_mark(folder.path(), *chunk).unwrap().is_some()).count();
    assert_eq!(
        (all, made.len(), marked),
        (items, plan.chunk_count(), plan.chunk_count()),
        "something is lost or made twice"
    );
    if let Some(url) = url {
        let queue = ChunkQueue::open(PostgresDatabase::from_name(&url, None).unwrap(), folder.path(), &plan).unwrap();
        assert_eq!(queue.read_status().unwrap().done, plan.chunk_count());
    }
    println!("every chunk has its mark, and was made once");
}

fn of_line(line: &str) -> (u64, usize) {
    let (at, items) = line.split_once(' ').unwrap();
    (at.parse().unwrap(), items.parse().unwrap())
}

/// Items a second, for each tenth of the chunks.
fn tell_tenths(made: &[(u64, usize)]) {
    let tenth = |number: usize| {
        let (from, to) = (number * (made.len() - 1) / 10, (number + 1) * (made.len() - 1) / 10);
        let items: usize = made[from + 1..=to].iter().map(|(_, items)| items).sum();
        items as f64 * 1e6 / (made[to].0 - made[from].0).max(1) as f64
    };
    let tenths: Vec<f64> = (0..10).map(tenth).collect();
    let told: Vec<String> = tenths.iter().map(|rate| format!("{rate:.0}")).collect();
    println!("items a second, by tenths: {}", told.join(" "));
    println!("the last tenth is at {:.0} % of the first nine", 900.0 * tenths[9] / tenths[..9].iter().sum::<f64>());
}
