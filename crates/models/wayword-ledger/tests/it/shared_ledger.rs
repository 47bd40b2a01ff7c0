//! Several programs, or several handles, on one ledger.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::{Store, open, shared_stores};
use serde_json::json;
use std::{
    env, fs,
    io::{BufRead, BufReader, Write},
    path::Path,
    process::{Child, Command, Stdio},
    sync::{
        Barrier,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};
use wayword_ledger::{CallAnswer, LedgerFilter, LedgerRun, ModelCall, OnceError, RequestRefusedError, RunLimits};

const LEDGER: &str = "WAYWORD_TEST_SHARED_LEDGER";
const HANGS: &str = "WAYWORD_TEST_HANGING_LEDGER";
const NUMBERS: usize = 100;

fn call(number: usize) -> ModelCall {
    ModelCall {
        model: "t/m".into(),
        base_url: String::new(),
        request: json!({ "text": number.to_string() }),
        replicate: 0,
    }
}

fn answer(text: &str) -> CallAnswer {
    crate::common::answer(text, None)
}

fn ask(run: &LedgerRun, number: usize, text: &str) -> CallAnswer {
    let made = run.answer_once(&call(number), |attempts| -> Result<CallAnswer, RequestRefusedError> {
        attempts.begin_request(None)?;
        Ok(answer(text))
    });
    made.unwrap()
}

#[test]
fn a_new_ledger_can_be_opened_by_many_at_once() {
    for round in 0..20 {
        let stores = if round == 0 { shared_stores("a_new_ledger_can_be_opened_by_many_at_once") } else { new_files() };
        for store in stores {
            let together = Barrier::new(8);
            thread::scope(|scope| {
                for number in 0..8 {
                    let (store, together) = (&store, &together);
                    scope.spawn(move || {
                        together.wait();
                        let run = store.open().start_run("a", RunLimits::default()).unwrap();
                        ask(&run, number, "yes");
                    });
                }
            });
            assert_eq!(store.open().list_calls(&LedgerFilter::default()).unwrap().len(), 8);
        }
    }
}

/// A new file: only these are made so fast that many rounds make sense.
fn new_files() -> Vec<Store> {
    vec![crate::common::in_folder("sqlite", "ledger.db")]
}

/// One program was no longer waited for, and another made its call. The second answer is dropped: both programs get the
/// first one, as every later program will.
#[test]
fn all_programs_get_the_first_answer_to_a_call() {
    for store in shared_stores("the_first_answer_stands_for_whoever_asked_at_the_same_time") {
        let [first, second] = ["a", "b"].map(|run| store.open().start_run(run, RunLimits::default()).unwrap());
        let heard = second.answer_once(&call(1), |attempts| -> Result<CallAnswer, RequestRefusedError> {
            attempts.begin_request(None)?;
            store.change("DELETE FROM claims");
            assert_eq!(ask(&first, 1, "first").text, "first");
            Ok(answer("second"))
        });
        assert_eq!(heard.unwrap().text, "first");
        assert_eq!((second.totals().answered, second.totals().calls), (1, 1), "it was paid for all the same");
        let ledger = store.open();
        assert_eq!(ledger.count_lost_requests().unwrap(), 0);
        let rows = ledger.list_calls(&LedgerFilter { run: Some("b".into()), ..LedgerFilter::default() }).unwrap();
        assert_eq!((rows.len(), rows[0].answer.text.as_str(), rows[0].run.as_str()), (1, "first", "a"));
    }
}

/// Not a test of its own: one of the programs that share a ledger.
#[test]
fn program() {
    let Ok(spec) = env::var(LEDGER) else { return };
    let who = std::process::id().to_string();
    let run = open(&spec).start_run(&who, RunLimits::default()).unwrap();
    thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| (0..NUMBERS).for_each(|number| assert!(!ask(&run, number, &who).text.is_empty())));
        }
    });
}

/// Not a test of its own: a program that never ends its call.
#[test]
fn program_that_hangs() {
    let Ok(spec) = env::var(HANGS) else { return };
    let run = open(&spec).start_run("hangs", RunLimits::default()).unwrap();
    let _ = run.answer_once(&call(1), |attempts| -> Result<CallAnswer, RequestRefusedError> {
        attempts.begin_request(None)?;
        std::io::stdout().write_all(b"sent\n").unwrap();
        loop {
            thread::park();
        }
    });
}

fn start(test: &str, variable: &str, store: &Store, out: Stdio) -> Child {
    let mut command = Command::new(env::current_exe().unwrap());
    command
        .args(["--exact", &format!("shared_ledger::{test}"), "--nocapture", "--test-threads=1"])
        .env(variable, store.spec())
        .stdout(out);
    command.stderr(Stdio::null()).spawn().unwrap()
}

/// How many programs show that they are running, or seem to.
fn left_behind(store: &Store) -> i64 {
    if store.kind() == "postgres" {
        return store.count("presence");
    }
    let folder = Path::new(store.spec().split_once(':').unwrap().1).parent().unwrap();
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
    i64::try_from(names.filter(|name| name.to_string_lossy().contains("in-use")).count()).unwrap()
}

/// Four programs ask the same hundred things at the same time.
#[test]
fn programs_that_share_a_ledger_pay_for_each_call_once() {
    for store in shared_stores("programs_that_share_a_ledger_pay_for_each_call_once") {
        let programs: Vec<_> = (0..4).map(|_| start("program", LEDGER, &store, Stdio::null())).collect();
        for mut program in programs {
            assert!(program.wait().unwrap().success());
        }
        let ledger = store.open();
        assert_eq!(ledger.list_calls(&LedgerFilter::default()).unwrap().len(), NUMBERS);
        assert_eq!(ledger.count_lost_requests().unwrap(), 0);
        assert_eq!(store.count("sent"), NUMBERS as i64, "calls were paid for twice");
        assert_eq!(store.count("claims"), 0);
        drop(ledger);
        assert_eq!(left_behind(&store), 0);
    }
}

#[cfg(unix)]
#[test]
fn a_call_of_a_program_that_is_killed_is_free_again() {
    for store in shared_stores("a_call_of_a_program_that_is_killed_is_free_again") {
        let mut hangs = start("program_that_hangs", HANGS, &store, Stdio::piped());
        let mut said = BufReader::new(hangs.stdout.take().unwrap()).lines().map_while(Result::ok);
        assert!(said.any(|line| line.ends_with("sent")));
        let run = store.open().start_run("a", RunLimits::default()).unwrap();
        let is_killed = AtomicBool::new(false);
        thread::scope(|scope| {
            let asks = scope.spawn(|| {
                run.answer_once(&call(1), |attempts| -> Result<CallAnswer, RequestRefusedError> {
                    attempts.begin_request(None)?;
                    assert!(is_killed.load(Ordering::SeqCst), "it was asked while the other program asked");
                    Ok(answer("yes"))
                })
            });
            // There is no event here to wait for.
            thread::sleep(Duration::from_millis(100));
            is_killed.store(true, Ordering::SeqCst);
            hangs.kill().unwrap();
            hangs.wait().unwrap();
            assert_eq!(asks.join().unwrap().unwrap().text, "yes");
        });
        assert_eq!(store.open().count_lost_requests().unwrap(), 1, "the one that was on the wire");
        drop(run);
        if store.kind() == "postgres" {
            // A program is gone only some time after its last sign of life.
            thread::sleep(Duration::from_secs(2));
        }
        assert_eq!(left_behind(&store), 1);
        ask(&store.open().start_run("b", RunLimits::default()).unwrap(), 2, "yes");
        assert_eq!(left_behind(&store), 0, "the next program removes it");
    }
}

#[test]
fn a_wait_for_another_program_ends_when_the_run_is_stopped() {
    for store in shared_stores("a_wait_for_another_program_ends_when_the_run_is_stopped") {
        let [first, second] = ["a", "b"].map(|run| store.open().start_run(run, RunLimits::default()).unwrap());
        let made = first.answer_once(&call(1), |attempts| -> Result<CallAnswer, RequestRefusedError> {
            attempts.begin_request(None)?;
            thread::scope(|scope| {
                let waits = scope.spawn(|| {
                    second.answer_once(&call(1), |_| -> Result<CallAnswer, RequestRefusedError> {
                        panic!("it is asked twice")
                    })
                });
                thread::sleep(Duration::from_millis(50));
                second.stop();
                assert!(matches!(waits.join().unwrap(), Err(OnceError::Refused(RequestRefusedError::Stopped))));
            });
            Ok(answer("yes"))
        });
        assert_eq!(made.unwrap().text, "yes");
    }
}

#[test]
fn a_failed_call_is_tried_again_by_a_waiting_program() {
    for store in shared_stores("what_failed_for_one_program_is_tried_by_the_other_that_waited") {
        let [first, second] = ["a", "b"].map(|run| store.open().start_run(run, RunLimits::default()).unwrap());
        thread::scope(|scope| {
            let mut waits = None;
            let failed = first.answer_once(&call(1), |attempts| -> Result<CallAnswer, RequestRefusedError> {
                attempts.begin_request(None)?;
                waits = Some(scope.spawn(|| ask(&second, 1, "second")));
                attempts.mark_failed("503", false);
                Err(RequestRefusedError::Stopped)
            });
            assert!(failed.is_err());
            assert_eq!(waits.unwrap().join().unwrap().text, "second");
        });
    }
}
