//! Answers that were changed after they were written, and ledgers of the first format, which has no checksums.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::{Store, shared_stores};
use rusqlite::Connection;
use serde_json::json;
use std::path::Path;
use wayword_ledger::{
    CallAnswer, Ledger, LedgerError, LedgerFilter, LedgerRun, ModelCall, OnceError, RequestRefusedError, RunLimits,
};

fn call(number: usize) -> ModelCall {
    ModelCall {
        model: "t/m".into(),
        base_url: String::new(),
        request: json!({ "text": number.to_string() }),
        replicate: 0,
    }
}

fn ask(run: &LedgerRun, number: usize) -> Result<CallAnswer, OnceError<RequestRefusedError>> {
    run.answer_once(&call(number), |attempts| {
        attempts.begin_request(None)?;
        Ok(CallAnswer {
            text: "There is a lamp.".into(),
            finish: "stop".into(),
            tokens_in: 3,
            tokens_out: u64::MAX,
            usd: Some(0.1),
            latency_ms: 1,
            attempts: 1,
        })
    })
}

fn run(store: &Store) -> LedgerRun {
    store.open().start_run("a", RunLimits::default()).unwrap()
}

#[test]
fn a_changed_answer_is_reported_and_never_used() {
    for store in shared_stores("a_changed_answer_is_told_and_never_used") {
        let kind = store.kind();
        let changes: &[&str] = match kind {
            "sqlite" => &["answer = 'There is a sofa.'", "answer = x'00'", "usd = NULL"],
            _ => &["answer = '\"There is a sofa.\"'", "answer = 'no JSON'", "usd = NULL", "attempts = -1"],
        };
        let for_all =
            ["finish = 'length'", "tokens_in = -4", "usd = 0.2", "latency_ms = 2", "attempts = 2", "checksum = 'x'"];
        for change in changes.iter().copied().chain(for_all) {
            (0..3).for_each(|number| drop(ask(&run(&store), number).unwrap()));
            let key = call(1).key();
            assert_eq!(store.change(&format!("UPDATE calls SET {change} WHERE key = '{key}'")), 1);

            let error = ask(&run(&store), 1).unwrap_err();
            assert!(matches!(error, OnceError::Ledger(LedgerError::Changed { .. })), "{kind} {change}: {error}");
            let told = error.to_string();
            let place = if kind == "sqlite" { "ledger.db" } else { "postgres@" };
            assert!([place, key.as_str(), "t/m", "prune --changed"].iter().all(|part| told.contains(part)), "{told}");
            let ledger = store.open();
            assert!(
                matches!(ledger.list_calls(&LedgerFilter::default()), Err(LedgerError::Changed { .. })),
                "{change}"
            );
            let exported = ledger.export_calls(&LedgerFilter::default(), Path::new("out"), Vec::new());
            assert!(matches!(exported, Err(LedgerError::Changed { .. })), "{change}");
            assert!(ask(&run(&store), 2).is_ok(), "the others are as they were");

            assert_eq!(ledger.prune_changed().unwrap(), 1, "{change}");
            let again = run(&store);
            assert_eq!(ask(&again, 1).unwrap().text, "There is a lamp.");
            assert_eq!(again.totals().answered, 1, "it is asked anew");
            assert_eq!(ledger.prune_changed().unwrap(), 0);
        }
    }
}

#[test]
fn an_answer_of_another_call_is_a_changed_one() {
    for store in shared_stores("an_answer_of_another_call_is_a_changed_one") {
        (0..2).for_each(|number| drop(ask(&run(&store), number).unwrap()));
        let [first, second] = [0, 1].map(|number| call(number).key());
        store.change(&format!("DELETE FROM calls WHERE key = '{first}'"));
        store.change(&format!("UPDATE calls SET key = '{first}' WHERE key = '{second}'"));
        assert!(matches!(ask(&run(&store), 0), Err(OnceError::Ledger(LedgerError::Changed { .. }))));
    }
}

/// The tables of the first format, as its programs made them.
const FIRST: &str = "
CREATE TABLE calls (
    key TEXT PRIMARY KEY, model TEXT NOT NULL, base_url TEXT NOT NULL, request TEXT NOT NULL, replicate INTEGER NOT NULL,
    answer TEXT NOT NULL, finish TEXT NOT NULL, tokens_in INTEGER NOT NULL, tokens_out INTEGER NOT NULL, usd REAL,
    latency_ms INTEGER NOT NULL, attempts INTEGER NOT NULL, at INTEGER NOT NULL, run TEXT NOT NULL
) WITHOUT ROWID;
CREATE INDEX calls_of_run ON calls (run);
CREATE TABLE uses (run TEXT NOT NULL, key TEXT NOT NULL, PRIMARY KEY (run, key)) WITHOUT ROWID;
CREATE TABLE sent (
    id INTEGER PRIMARY KEY, run TEXT NOT NULL, key TEXT NOT NULL, most_usd REAL, usd REAL, at INTEGER NOT NULL,
    outcome TEXT, reason TEXT
);
CREATE INDEX sent_of_run ON sent (run);
PRAGMA application_id = 0x57776179;
PRAGMA user_version = 1;
";

#[test]
fn a_ledger_of_the_first_format_is_opened_and_its_answers_stay() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("l.db");
    let old = Connection::open(&path).unwrap();
    old.execute_batch(FIRST).unwrap();
    let row = "INSERT INTO calls VALUES (?1, 't/m', '', '{\"text\":\"1\"}', 0, 'An old answer.', 'stop', 1, 1, 0.5, 1, 1, 1, 'old')";
    old.execute(row, [call(1).key().as_str()]).unwrap();
    old.execute("INSERT INTO sent VALUES (1, 'a', ?1, 1.0, 0.5, 1, 'answered', NULL)", [call(1).key().as_str()])
        .unwrap();
    drop(old);

    let opened = Ledger::open(&path).unwrap().start_run("a", RunLimits::default()).unwrap();
    assert_eq!(ask(&opened, 1).unwrap().text, "An old answer.");
    ask(&opened, 2).unwrap();
    drop(opened);
    let ledger = Ledger::open(&path).unwrap();
    assert_eq!((ledger.list_calls(&LedgerFilter::default()).unwrap().len(), ledger.prune_changed().unwrap()), (2, 0));
    let bounded = ledger.start_run("a", RunLimits { max_usd: Some(0.55), max_calls: None }).unwrap();
    let refused = bounded.answer_once(&call(3), |attempts| -> Result<CallAnswer, RequestRefusedError> {
        attempts.begin_request(Some(0.1)).map(|()| panic!("what was spent is forgotten"))
    });
    assert!(matches!(refused, Err(OnceError::Call(RequestRefusedError::MaxUsd { .. }))));
    let checksums = "SELECT COUNT(checksum) FROM calls";
    let count = Connection::open(&path).unwrap().query_row(checksums, [], |row| row.get::<_, i64>(0)).unwrap();
    assert_eq!(count, 1, "new answers carry one, old ones have none");
}
