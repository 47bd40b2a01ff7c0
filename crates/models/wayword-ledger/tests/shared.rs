//! Several programs, or several handles, on one ledger.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use rusqlite::Connection;
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
use wayword_ledger::{Answer, Call, Filter, Ledger, Limits, OnceError, Refused, Run};

const LEDGER: &str = "WAYWORD_TEST_SHARED_LEDGER";
const HANGS: &str = "WAYWORD_TEST_HANGING_LEDGER";
const NUMBERS: usize = 100;

fn call(number: usize) -> Call {
    Call { model: "t/m".into(), base_url: String::new(), request: json!({ "text": number.to_string() }), replicate: 0 }
}

fn answer(text: &str) -> Answer {
    Answer {
        text: text.into(),
        finish: "stop".into(),
        tokens_in: 1,
        tokens_out: 1,
        usd: None,
        latency_ms: 1,
        attempts: 1,
    }
}

fn ask(run: &Run, number: usize, text: &str) -> Answer {
    let made = run.once(&call(number), |attempts| -> Result<Answer, Refused> {
        attempts.begin(None)?;
        Ok(answer(text))
    });
    made.unwrap()
}

#[test]
fn a_new_ledger_can_be_opened_by_many_at_once() {
    let folder = tempfile::tempdir().unwrap();
    for round in 0..20 {
        let path = folder.path().join(format!("{round}.db"));
        let together = Barrier::new(8);
        thread::scope(|scope| {
            for number in 0..8 {
                let (path, together) = (&path, &together);
                scope.spawn(move || {
                    together.wait();
                    let run = Ledger::open(path).unwrap().run("a", Limits::default()).unwrap();
                    ask(&run, number, "yes");
                });
            }
        });
        assert_eq!(Ledger::open(&path).unwrap().list(&Filter::default()).unwrap().len(), 8);
    }
}

/// One program was no longer waited for, and another made its call. The second answer is dropped: both programs get the
/// first one, as every later program will.
#[test]
fn the_first_answer_stands_for_whoever_asked_at_the_same_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("l.db");
    let [first, second] = ["a", "b"].map(|run| Ledger::open(&path).unwrap().run(run, Limits::default()).unwrap());
    let heard = second.once(&call(1), |attempts| -> Result<Answer, Refused> {
        attempts.begin(None)?;
        Connection::open(&path).unwrap().execute("DELETE FROM claims", []).unwrap();
        assert_eq!(ask(&first, 1, "first").text, "first");
        Ok(answer("second"))
    });
    assert_eq!(heard.unwrap().text, "first");
    assert_eq!((second.totals().answered, second.totals().calls), (1, 1), "it was paid for all the same");
    let ledger = Ledger::open(&path).unwrap();
    assert_eq!(ledger.lost().unwrap(), 0);
    let rows = ledger.list(&Filter { run: Some("b".into()), ..Filter::default() }).unwrap();
    assert_eq!((rows.len(), rows[0].answer.text.as_str(), rows[0].run.as_str()), (1, "first", "a"));
}

/// Not a test of its own: one of the programs that share a ledger.
#[test]
fn program() {
    let Some(path) = env::var_os(LEDGER) else { return };
    let who = std::process::id().to_string();
    let run = Ledger::open(Path::new(&path)).unwrap().run(&who, Limits::default()).unwrap();
    thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| (0..NUMBERS).for_each(|number| assert!(!ask(&run, number, &who).text.is_empty())));
        }
    });
}

/// Not a test of its own: a program that never ends its call.
#[test]
fn program_that_hangs() {
    let Some(path) = env::var_os(HANGS) else { return };
    let run = Ledger::open(Path::new(&path)).unwrap().run("hangs", Limits::default()).unwrap();
    let _ = run.once(&call(1), |attempts| -> Result<Answer, Refused> {
        attempts.begin(None)?;
        std::io::stdout().write_all(b"sent\n").unwrap();
        loop {
            thread::park();
        }
    });
}

fn start(test: &str, variable: &str, path: &Path, out: Stdio) -> Child {
    let mut command = Command::new(env::current_exe().unwrap());
    command.args(["--exact", test, "--nocapture", "--test-threads=1"]).env(variable, path).stdout(out);
    command.stderr(Stdio::null()).spawn().unwrap()
}

/// How many files there are by which programs show that they are running.
fn left_behind(folder: &Path) -> usize {
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
    names.filter(|name| name.to_string_lossy().contains("in-use")).count()
}

/// Four programs ask the same hundred things at the same time.
#[test]
fn programs_that_share_a_ledger_pay_for_each_call_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("l.db");
    let programs: Vec<_> = (0..4).map(|_| start("program", LEDGER, &path, Stdio::null())).collect();
    for mut program in programs {
        assert!(program.wait().unwrap().success());
    }
    let ledger = Ledger::open(&path).unwrap();
    assert_eq!(ledger.list(&Filter::default()).unwrap().len(), NUMBERS);
    assert_eq!(ledger.lost().unwrap(), 0);
    let count = |sql: &str| Connection::open(&path).unwrap().query_row(sql, [], |row| row.get::<_, i64>(0)).unwrap();
    assert_eq!(count("SELECT COUNT(*) FROM sent"), NUMBERS as i64, "calls were paid for twice");
    assert_eq!(count("SELECT COUNT(*) FROM claims"), 0);
    drop(ledger);
    assert_eq!(left_behind(folder.path()), 0);
}

#[cfg(unix)]
#[test]
fn a_call_of_a_program_that_is_killed_is_free_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("l.db");
    let mut hangs = start("program_that_hangs", HANGS, &path, Stdio::piped());
    let mut said = BufReader::new(hangs.stdout.take().unwrap()).lines().map_while(Result::ok);
    assert!(said.any(|line| line.ends_with("sent")));
    let run = Ledger::open(&path).unwrap().run("a", Limits::default()).unwrap();
    let is_killed = AtomicBool::new(false);
    thread::scope(|scope| {
        let asks = scope.spawn(|| {
            run.once(&call(1), |attempts| -> Result<Answer, Refused> {
                attempts.begin(None)?;
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
    assert_eq!(Ledger::open(&path).unwrap().lost().unwrap(), 1, "the one that was on the wire");
    drop(run);
    assert_eq!(left_behind(folder.path()), 1);
    ask(&Ledger::open(&path).unwrap().run("b", Limits::default()).unwrap(), 2, "yes");
    assert_eq!(left_behind(folder.path()), 0, "the next program removes it");
}

#[test]
fn a_wait_for_another_program_ends_when_the_run_is_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("l.db");
    let [first, second] = ["a", "b"].map(|run| Ledger::open(&path).unwrap().run(run, Limits::default()).unwrap());
    let made = first.once(&call(1), |attempts| -> Result<Answer, Refused> {
        attempts.begin(None)?;
        thread::scope(|scope| {
            let waits =
                scope.spawn(|| second.once(&call(1), |_| -> Result<Answer, Refused> { panic!("it is asked twice") }));
            thread::sleep(Duration::from_millis(50));
            second.stop();
            assert!(matches!(waits.join().unwrap(), Err(OnceError::Refused(Refused::Stopped))));
        });
        Ok(answer("yes"))
    });
    assert_eq!(made.unwrap().text, "yes");
}

#[test]
fn what_failed_for_one_program_is_tried_by_the_other_that_waited() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("l.db");
    let [first, second] = ["a", "b"].map(|run| Ledger::open(&path).unwrap().run(run, Limits::default()).unwrap());
    thread::scope(|scope| {
        let mut waits = None;
        let failed = first.once(&call(1), |attempts| -> Result<Answer, Refused> {
            attempts.begin(None)?;
            waits = Some(scope.spawn(|| ask(&second, 1, "second")));
            attempts.failed("503", false);
            Err(Refused::Stopped)
        });
        assert!(failed.is_err());
        assert_eq!(waits.unwrap().join().unwrap().text, "second");
    });
}
