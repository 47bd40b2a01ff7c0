//! Several programs, or several handles, on one ledger.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use serde_json::json;
use std::{
    env,
    path::Path,
    process::{Command, Stdio},
    sync::Barrier,
    thread,
};
use wayword_ledger::{Answer, Call, Filter, Ledger, Limits, Refused, Run};

const LEDGER: &str = "WAYWORD_TEST_SHARED_LEDGER";
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

/// Both ask before either is answered. Who comes second hears what the first was told, as everybody will from then on.
#[test]
fn the_first_answer_stands_for_whoever_asked_at_the_same_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("l.db");
    let [first, second] = ["a", "b"].map(|run| Ledger::open(&path).unwrap().run(run, Limits::default()).unwrap());
    let heard = second.once(&call(1), |attempts| -> Result<Answer, Refused> {
        attempts.begin(None)?;
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

#[test]
fn programs_that_share_a_ledger_do_not_get_in_each_others_way() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("l.db");
    let start = || {
        let mut command = Command::new(env::current_exe().unwrap());
        command.args(["--exact", "program", "--test-threads=1"]).env(LEDGER, &path).stdout(Stdio::null());
        command.spawn().unwrap()
    };
    let programs: Vec<_> = (0..4).map(|_| start()).collect();
    for mut program in programs {
        assert!(program.wait().unwrap().success());
    }
    let ledger = Ledger::open(&path).unwrap();
    assert_eq!(ledger.list(&Filter::default()).unwrap().len(), NUMBERS);
    assert_eq!(ledger.lost().unwrap(), 0);
}
