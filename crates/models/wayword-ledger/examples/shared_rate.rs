//! How well workers keep one rate together: calls of 200 ms over 8 processes at 200 per second, with a server of
//! PostgreSQL that is started for it.
//!
//! ```text
//! cargo run --release -p wayword-ledger --features postgres --example shared_rate -- [CALLS [RATE [WORKERS]]]
//! ```
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout, reason = "it is a measurement")]

use serde_json::json;
use std::{
    env,
    io::{BufRead, BufReader, Write},
    process::{Command, Stdio},
    sync::atomic::{AtomicUsize, Ordering},
    thread,
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};
use wayword_database::PostgresDatabase;
use wayword_ledger::{CallAnswer, Ledger, ModelCall, ProviderRates, RequestRefusedError, RunLimits};
use wayword_testkit::PostgresServer;

const URL: &str = "WAYWORD_SHARED_RATE";
const CALL: Duration = Duration::from_millis(200);
/// The price of a call, US dollars.
const USD: f64 = 0.001;

fn main() {
    let argument = |at: usize, usual: usize| env::args().nth(at).map_or(usual, |text| text.parse().unwrap());
    let (calls, rate, workers) = (argument(1, 20_000), argument(2, 200), argument(3, 8));
    match env::var(URL) {
        Ok(url) => work(&url, calls, rate as f64, argument(4, 0), workers),
        Err(_) => measure(calls, rate, workers),
    }
}

/// A worker: makes its part of the calls, and prints when each leaves.
fn work(url: &str, calls: usize, rate: f64, worker: usize, workers: usize) {
    let ledger = Ledger::open_postgres(&PostgresDatabase::from_name(url, None).unwrap()).unwrap();
    let run = ledger.start_run("run", RunLimits { max_usd: Some(USD * calls as f64), max_calls: None }).unwrap();
    let rates = ProviderRates { requests_per_s: Some(rate), tokens_per_s: None };
    // Twice as many threads as the calls that are in flight at that rate.
    let threads = (2.0 * rate * CALL.as_secs_f64() / workers as f64).ceil() as usize + 1;
    let next = AtomicUsize::new(worker);
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let number = next.fetch_add(workers, Ordering::Relaxed);
                    if number >= calls {
                        break;
                    }
                    let call = ModelCall {
                        model: "t/m".into(),
                        base_url: String::new(),
                        request: json!({ "messages": [{ "text": format!("{number} {}", "word ".repeat(100)) }] }),
                        replicate: 0,
                    };
                    let made = run.answer_once(&call, |attempts| -> Result<CallAnswer, RequestRefusedError> {
                        attempts.begin_request(Some(USD))?;
                        run.wait_turn("t", rates, 500, || false)?;
                        let at = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_micros();
                        std::io::stdout().write_all(format!("{at}\n").as_bytes()).unwrap();
                        thread::sleep(CALL);
                        Ok(answer())
                    });
                    made.unwrap();
                }
            });
        }
    });
}

fn answer() -> CallAnswer {
    CallAnswer {
        text: "It is a lamp.".into(),
        finish: "stop".into(),
        tokens_in: 120,
        tokens_out: 5,
        usd: Some(USD),
        latency_ms: 200,
        attempts: 1,
    }
}

fn measure(calls: usize, rate: usize, workers: usize) {
    let server = PostgresServer::start().expect("PostgreSQL is not installed");
    let url = server.new_database();
    drop(Ledger::open_postgres(&PostgresDatabase::from_name(&url, None).unwrap()).unwrap());
    let begun = Instant::now();
    let start = |worker: usize| {
        let mut command = Command::new(env::current_exe().unwrap());
        command.args([calls, rate, workers, worker].map(|number| number.to_string())).env(URL, &url);
        command.stdout(Stdio::piped()).spawn().unwrap()
    };
    let started: Vec<_> = (0..workers).map(start).collect();
    let mut at: Vec<u64> = thread::scope(|scope| {
        let readers = started.into_iter().map(|mut worker| {
            scope.spawn(move || {
                let lines = BufReader::new(worker.stdout.take().unwrap()).lines();
                let at: Vec<u64> = lines.map(|line| line.unwrap().parse().unwrap()).collect();
                assert!(worker.wait().unwrap().success());
                at
            })
        });
        readers.collect::<Vec<_>>().into_iter().flat_map(|reader| reader.join().unwrap()).collect()
    });
    let took_s = begun.elapsed().as_secs_f64();
    at.sort_unstable();
    let in_second = |from: usize| at[from..].iter().take_while(|time| **time < at[from] + 1_000_000).count();
    let most = (0..at.len()).map(in_second).max().unwrap();
    let sending_s = (at[at.len() - 1] - at[0]) as f64 / 1e6;
    let ledger = Ledger::open_postgres(&PostgresDatabase::from_name(&url, None).unwrap()).unwrap();
    let spending = ledger.run_spending("run").unwrap();
    println!("{calls} calls of {} ms by {workers} processes at {rate}/s:", CALL.as_millis());
    println!("  {took_s:.1} s in all; sent in {sending_s:.1} s, {:.1}/s", at.len() as f64 / sending_s);
    println!("  {:.1} % of what the rate allows", 100.0 * at.len() as f64 / sending_s / rate as f64);
    println!("  at most {most} in any second, of {} that are allowed", rate + (rate / 10).max(1));
    println!(
        "  {} requests, {} answered, {} lost, ${:.3}",
        spending.requests, spending.answered, spending.lost, spending.usd
    );
}
