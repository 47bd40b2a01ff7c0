//! Many workers with one database: their calls, money and rates are kept as if they were one program.

#![cfg(all(unix, feature = "postgres"))]
#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stderr, reason = "a test fails by panicking")]

use crate::common::{Store, database, open, postgres};
use serde_json::json;
use std::{
    collections::BTreeSet,
    env,
    io::{BufRead, BufReader, Write},
    process::{Child, ChildStdout, Command, Stdio},
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread,
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};
use wayword_ledger::{
    CallAnswer, LEDGER_TABLES, Ledger, LedgerError, LedgerFilter, LedgerRun, ModelCall, OnceError, ProviderRates,
    RequestRefusedError, RunLimits, RunSpending,
};
use wayword_testkit::PostgresServer;

const SPEC: &str = "WAYWORD_TEST_WORKERS";
const WORKERS: usize = 8;

fn call(number: usize) -> ModelCall {
    ModelCall {
        model: "t/m".into(),
        base_url: String::new(),
        request: json!({ "text": number.to_string() }),
        replicate: 0,
    }
}

fn answer(number: usize, usd: f64) -> CallAnswer {
    crate::common::answer(&format!("{number}!"), Some(usd))
}

/// Makes a call that may cost 0.001 and costs a part of it.
fn ask(run: &LedgerRun, number: usize, share: f64) -> Result<CallAnswer, OnceError<RequestRefusedError>> {
    run.answer_once(&call(number), |attempts| {
        attempts.begin_request(Some(0.001))?;
        Ok(answer(number, 0.001 * share))
    })
}

/// Prints a line in one write, so that a kill leaves no half line of another thread.
fn say(line: &str) {
    std::io::stdout().write_all(format!("{line}\n").as_bytes()).unwrap();
}

/// Starts one of the programs below.
fn start(program: &str, store: &Store) -> Child {
    let mut command = Command::new(env::current_exe().unwrap());
    command
        .args(["--exact", &format!("workers::{program}"), "--nocapture", "--test-threads=1"])
        .env(SPEC, store.spec());
    command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap()
}

/// The numbers that a program prints behind a word.
fn heard(out: ChildStdout, word: &str) -> impl Iterator<Item = u64> {
    let marked = format!("{word} ");
    let lines = BufReader::new(out).lines().map_while(Result::ok);
    // The first line begins with the name of the test.
    lines.filter_map(move |line| line.split_once(&marked)?.1.parse().ok())
}

fn signal(child: &Child, name: &str) {
    assert!(Command::new("kill").args([name, &child.id().to_string()]).status().unwrap().success());
}

/// Not a test of its own: makes calls that no other program makes until the money is used up.
#[test]
fn program_that_spends() {
    let Ok(spec) = env::var(SPEC) else { return };
    let run = open(&spec).start_run("run", RunLimits { max_usd: Some(1.0), max_calls: None }).unwrap();
    let first = std::process::id() as usize * 1_000_000;
    let next = AtomicUsize::new(first);
    thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                loop {
                    match ask(&run, next.fetch_add(1, Ordering::SeqCst), 1.0) {
                        Ok(_) => say("made 1"),
                        Err(OnceError::Call(RequestRefusedError::MaxUsd { .. })) => break,
                        Err(error) => panic!("{error}"),
                    }
                }
            });
        }
    });
}

/// The most that a run may have cost up to this moment, billionths of a dollar.
fn exposed(client: &mut wayword_database::postgres::Client) -> i64 {
    let sql = "SELECT coalesce((SELECT sum(reserved) FROM wayword_ledger.runs), 0)::bigint
               - coalesce((SELECT sum(released - spent) FROM wayword_ledger.settled), 0)::bigint";
    client.query_one(sql, &[]).unwrap().get(0)
}

#[test]
fn one_budget_is_used_up_to_the_last_cent_and_never_exceeded() {
    let Some(store) = postgres("one_budget_is_used_up_to_the_last_cent_and_never_exceeded") else { return };
    drop(store.open());
    let is_done = AtomicBool::new(false);
    let made = thread::scope(|scope| {
        let watches = scope.spawn(|| {
            let mut client = database::past(&store);
            let mut most = 0;
            while !is_done.load(Ordering::SeqCst) {
                most = most.max(exposed(&mut client));
            }
            most
        });
        let workers: Vec<_> = (0..WORKERS).map(|_| start("program_that_spends", &store)).collect();
        let made: usize =
            workers.into_iter().map(|mut worker| heard(worker.stdout.take().unwrap(), "made").count()).sum();
        is_done.store(true, Ordering::SeqCst);
        let most = watches.join().unwrap();
        assert!(most <= 1_000_000_000, "{most}");
        made
    });
    assert_eq!(made, 1000);
    let ledger = store.open();
    let spending = ledger.run_spending("run").unwrap();
    assert_eq!((spending.requests, spending.answered, spending.lost), (1000, 1000, 0));
    assert!((spending.usd - 1.0).abs() < 1e-9);
    // The limit comes from the command, so a larger one goes on.
    let larger = ledger.start_run("run", RunLimits { max_usd: Some(1.001), max_calls: None }).unwrap();
    ask(&larger, 1, 0.5).unwrap();
    let refused = ask(&larger, 2, 0.5).unwrap_err().to_string();
    assert!(refused.contains("$1.0005 are spent"), "{refused}");
    let counted = ledger.start_run("run", RunLimits { max_usd: None, max_calls: Some(1001) }).unwrap();
    assert!(matches!(ask(&counted, 3, 0.5), Err(OnceError::Call(RequestRefusedError::MaxCalls { max_calls: 1001 }))));
    let other = ledger.start_run("other", RunLimits { max_usd: Some(0.001), max_calls: None }).unwrap();
    ask(&other, 4, 1.0).unwrap();
}

/// Not a test of its own: makes the same calls as the others, in another order.
#[test]
fn program_that_shares() {
    const CALLS: usize = 400;
    let Ok(spec) = env::var(SPEC) else { return };
    let run = open(&spec).start_run("run", RunLimits { max_usd: Some(1.0), max_calls: None }).unwrap();
    let next = AtomicUsize::new(0);
    let from = std::process::id() as usize * 7;
    thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                loop {
                    let step = next.fetch_add(1, Ordering::SeqCst);
                    if step >= CALLS {
                        break;
                    }
                    let number = (from + step) % CALLS;
                    assert_eq!(ask(&run, number, 1.0).unwrap().text, format!("{number}!"));
                    say(&format!("heard {number}"));
                }
            });
        }
    });
    say("finished 1");
}

/// Eight workers, of which one after the other is killed and replaced.
#[test]
fn workers_that_are_killed_lose_nothing_and_pay_for_nothing_twice() {
    let Some(store) = postgres("workers_that_are_killed_lose_nothing_and_pay_for_nothing_twice") else { return };
    drop(store.open());
    let (mut kept, mut kills) = (BTreeSet::new(), 0);
    let workers: Vec<_> = (0..WORKERS)
        .map(|place| {
            let store = &store;
            move || {
                let (mut all, mut kills) = (BTreeSet::new(), 0);
                loop {
                    let mut worker = start("program_that_shares", store);
                    let lines = BufReader::new(worker.stdout.take().unwrap()).lines().map_while(Result::ok);
                    let mut is_finished = false;
                    for (at, line) in lines.enumerate() {
                        is_finished |= line.contains("finished 1");
                        all.extend(line.split_once("heard ").and_then(|(_, number)| number.parse::<usize>().ok()));
                        if at == 20 + 3 * place && kills < 3 {
                            worker.kill().unwrap();
                            kills += 1;
                        }
                    }
                    worker.wait().unwrap();
                    if is_finished {
                        return (all, kills);
                    }
                }
            }
        })
        .collect();
    thread::scope(|scope| {
        let threads: Vec<_> = workers.into_iter().map(|work| scope.spawn(work)).collect();
        for thread in threads {
            let (all, killed) = thread.join().unwrap();
            kept.extend(all);
            kills += killed;
        }
    });
    store.settle();
    let ledger = store.open();
    let rows = ledger.list_calls(&LedgerFilter::default()).unwrap();
    let (known, lost) = (rows.len(), ledger.count_lost_requests().unwrap());
    assert_eq!(known, 400);
    assert!(kept.len() <= known, "something was heard and is gone");
    assert_eq!(store.count("sent") as u64, known as u64 + lost, "every request is answered or counted as lost");
    assert!(kills > 10 && lost <= 4 * kills, "{kills} kills, {lost} lost");
    // Lost requests stay reserved at their upper bounds.
    assert_eq!(exposed(&mut database::past(&store)), 1_000_000 * (known as i64 + lost as i64));
    assert_eq!(
        store.count("claims WHERE NOT EXISTS (SELECT FROM wayword_ledger.calls WHERE calls.key = claims.key)"),
        0
    );
}

const RATE: f64 = 200.0;

/// Not a test of its own: sends as often as it may for five seconds.
#[test]
fn program_that_hurries() {
    let Ok(spec) = env::var(SPEC) else { return };
    let run = open(&spec).start_run("run", RunLimits::default()).unwrap();
    let rates = ProviderRates { requests_per_s: Some(RATE), tokens_per_s: None };
    let until = Instant::now() + Duration::from_secs(6);
    thread::scope(|scope| {
        for _ in 0..8 {
            scope.spawn(|| {
                while Instant::now() < until {
                    assert!(run.wait_turn("p", rates, 1, || false).unwrap());
                    let at = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_micros();
                    say(&format!("at {at}"));
                }
            });
        }
    });
}

#[test]
fn workers_together_keep_one_rate_and_use_it() {
    let Some(store) = postgres("workers_together_keep_one_rate_and_use_it") else { return };
    drop(store.open());
    let workers: Vec<_> = (0..WORKERS).map(|_| start("program_that_hurries", &store)).collect();
    let mut at: Vec<u64> = thread::scope(|scope| {
        let read =
            |mut worker: Child| scope.spawn(move || heard(worker.stdout.take().unwrap(), "at").collect::<Vec<_>>());
        let threads: Vec<_> = workers.into_iter().map(read).collect();
        threads.into_iter().flat_map(|thread| thread.join().unwrap()).collect()
    });
    at.sort_unstable();
    let in_second = |from: usize| at[from..].iter().take_while(|time| **time < at[from] + 1_000_000).count();
    let most = (0..at.len()).map(in_second).max().unwrap();
    assert!(most <= 220, "{most} in a second");
    // While all of them run.
    let (from, until) = (at[0] + 1_000_000, at[0] + 5_000_000);
    let in_time = at.iter().filter(|time| (from..until).contains(time)).count();
    eprintln!("at most {most} in a second, {} a second", in_time as f64 / 4.0);
    assert!(in_time as f64 >= 0.9 * 4.0 * RATE, "{in_time} in four seconds");
}

#[test]
fn tokens_have_a_rate_too_and_a_wait_can_be_stopped() {
    let Some(store) = postgres("tokens_have_a_rate_too_and_a_wait_can_be_stopped") else { return };
    let run = store.open().start_run("run", RunLimits::default()).unwrap();
    assert!(run.shares_rates());
    let rates = ProviderRates { requests_per_s: None, tokens_per_s: Some(1000.0) };
    let begun = Instant::now();
    (0..4).for_each(|_| assert!(run.wait_turn("p", rates, 200, || false).unwrap()));
    // The first leaves at once, the others when those before them are paid for, but for the half of a burst.
    assert!((0.5..1.5).contains(&begun.elapsed().as_secs_f64()), "{:?}", begun.elapsed());
    assert!(run.wait_turn("other", rates, 200, || false).unwrap(), "another provider has its own rate");
    let begun = Instant::now();
    assert!(run.wait_turn("p", rates, 100_000, || false).unwrap());
    assert!(!run.wait_turn("p", rates, 1, || begun.elapsed() > Duration::from_millis(300)).unwrap());
    assert!(begun.elapsed() < Duration::from_secs(2));
    for none in [ProviderRates::default(), ProviderRates { requests_per_s: Some(f64::NAN), tokens_per_s: Some(0.0) }] {
        assert!(run.wait_turn("p", none, 1, || false).unwrap());
    }
    let alone = Ledger::in_memory().unwrap().start_run("run", RunLimits::default()).unwrap();
    assert!(!alone.shares_rates() && alone.wait_turn("p", rates, u64::MAX, || false).unwrap());
}

#[test]
fn work_goes_on_when_the_database_was_restarted() {
    if postgres("work_goes_on_when_the_database_was_restarted").is_none() {
        return;
    }
    let server = Arc::new(PostgresServer::start().unwrap());
    let store = database::on(Arc::clone(&server));
    let ledger = store.open();
    let run = ledger.start_run("run", RunLimits { max_usd: Some(0.3), max_calls: None }).unwrap();
    let next = AtomicUsize::new(0);
    let rates = ProviderRates { requests_per_s: Some(1000.0), tokens_per_s: None };
    thread::scope(|scope| {
        for _ in 0..8 {
            scope.spawn(|| {
                loop {
                    let number = next.fetch_add(1, Ordering::SeqCst);
                    if number >= 300 {
                        break;
                    }
                    assert!(run.wait_turn("p", rates, 1, || false).unwrap());
                    ask(&run, number, 1.0).unwrap();
                    thread::sleep(Duration::from_millis(10));
                }
            });
        }
        for _ in 0..3 {
            thread::sleep(Duration::from_millis(150));
            server.restart();
        }
    });
    let spending = ledger.run_spending("run").unwrap();
    assert_eq!((spending.requests, spending.answered, spending.lost), (300, 300, 0));
    assert_eq!((store.count("calls"), store.count("claims")), (300, 0));
    assert_eq!(exposed(&mut database::past(&store)), 300_000_000);
}

/// Not a test of its own: is stopped in the middle of a call.
#[test]
fn program_that_sleeps() {
    let Ok(spec) = env::var(SPEC) else { return };
    let run = open(&spec).start_run("sleeps", RunLimits::default()).unwrap();
    let made = run.answer_once(&call(1), |attempts| -> Result<CallAnswer, RequestRefusedError> {
        attempts.begin_request(Some(0.001))?;
        say("sent 1");
        let mut line = String::new();
        std::io::stdin().read_line(&mut line).unwrap();
        Ok(answer(2, 0.001))
    });
    say(&format!("heard {}", made.unwrap().text.trim_end_matches('!')));
}

#[test]
fn a_worker_that_was_suspended_too_long_finds_its_call_made() {
    let Some(store) = postgres("a_worker_that_was_suspended_too_long_finds_its_call_made") else { return };
    let mut command = Command::new(env::current_exe().unwrap());
    command.args(["--exact", "workers::program_that_sleeps", "--nocapture"]).env(SPEC, store.spec());
    let mut sleeps = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut said = BufReader::new(sleeps.stdout.take().unwrap()).lines().map_while(Result::ok);
    assert!(said.any(|line| line.contains("sent 1")));
    signal(&sleeps, "-STOP");
    let run = store.open().start_run("run", RunLimits::default()).unwrap();
    let begun = Instant::now();
    assert_eq!(ask(&run, 1, 1.0).unwrap().text, "1!");
    assert!(begun.elapsed() > Duration::from_millis(1000), "it was waited for as long as it may be alive");
    signal(&sleeps, "-CONT");
    sleeps.stdin.take().unwrap().write_all(b"\n").unwrap();
    assert!(said.any(|line| line.contains("heard 1")), "the first answer stands");
    sleeps.wait().unwrap();
    let both = RunSpending { requests: 1, answered: 1, lost: 0, usd: 0.001, maybe_usd: 0.0 };
    let ledger = store.open();
    assert_eq!([ledger.run_spending("run").unwrap(), ledger.run_spending("sleeps").unwrap()], [both; 2]);
}

#[test]
fn a_worker_needs_no_right_to_make_tables() {
    let Some(store) = postgres("a_worker_needs_no_right_to_make_tables") else { return };
    let url = store.spec().split_once(':').unwrap().1.replacen("postgres@", "worker@", 1);
    database::past(&store).batch_execute("CREATE ROLE worker LOGIN").unwrap();
    let error = Ledger::open_postgres(&database::named(&url)).unwrap_err();
    assert!(matches!(&error, LedgerError::Database { is_lost: false, .. }), "{error}");
    assert!(error.to_string().contains("may not make them") && error.to_string().contains("hint: "), "{error}");

    drop(store.open());
    database::past(&store).batch_execute(&LEDGER_TABLES.grants.replace("ROLE", "worker")).unwrap();
    let ledger = Ledger::open_postgres(&database::named(&url)).unwrap();
    let run = ledger.start_run("run", RunLimits { max_usd: Some(1.0), max_calls: None }).unwrap();
    let rates = ProviderRates { requests_per_s: Some(100.0), tokens_per_s: Some(1000.0) };
    assert!(run.wait_turn("p", rates, 1, || false).unwrap());
    ask(&run, 1, 1.0).unwrap();
    let failed = run.answer_once(&call(2), |attempts| -> Result<CallAnswer, RequestRefusedError> {
        attempts.begin_request(Some(0.5))?;
        attempts.mark_failed("a reason with \0", true);
        Err(RequestRefusedError::Stopped)
    });
    assert!(failed.is_err());
    assert!(ledger.has_answers_from("t/m", "").unwrap() && ledger.count_lost_requests().unwrap() == 1);
    assert_eq!((ledger.prune_changed().unwrap(), ledger.prune_calls(&LedgerFilter::default()).unwrap()), (0, 1));
    drop((run, ledger));
    assert_eq!(store.count("presence"), 0);
    database::past(&store).batch_execute("DROP OWNED BY worker; DROP ROLE worker").unwrap();
}
