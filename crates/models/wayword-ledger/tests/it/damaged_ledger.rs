//! A ledger that is damaged, or cannot be written for a while, reports that as an error and loses no answers.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use proptest::prelude::*;
use rusqlite::Connection;
use serde_json::json;
use std::{fs, path::Path};
use wayword_ledger::{
    CallAnswer, CostGrouping, Ledger, LedgerError, LedgerFilter, LedgerRun, ModelCall, OnceError, RequestRefusedError,
    RunLimits,
};

fn ask(run: &LedgerRun, number: usize) -> Result<CallAnswer, OnceError<RequestRefusedError>> {
    let request = json!({ "text": format!("{number} {}", "word ".repeat(50)) });
    let call = ModelCall { model: "t/m".into(), base_url: String::new(), request, replicate: 0 };
    run.answer_once(&call, |attempts| {
        attempts.begin_request(None)?;
        Ok(CallAnswer {
            text: "yes".into(),
            finish: "stop".into(),
            tokens_in: 1,
            tokens_out: 1,
            usd: None,
            latency_ms: 1,
            attempts: 1,
        })
    })
}

fn ledger_of(path: &Path, calls: usize) {
    let run = Ledger::open(path).unwrap().start_run("a", RunLimits::default()).unwrap();
    (0..calls).for_each(|number| drop(ask(&run, number).unwrap()));
}

/// Does everything that a program does with a ledger. It may fail, but must not panic, and must return the right
/// answers only.
fn use_all(path: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let ledger = Ledger::open(path)?;
    ledger.list_calls(&LedgerFilter::default())?;
    ledger.sum_costs(CostGrouping::Model)?;
    ledger.count_lost_requests()?;
    let run = ledger.start_run("a", RunLimits::default())?;
    for number in 0..25 {
        assert_eq!(ask(&run, number)?.text, "yes", "a changed answer is used");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn damage_is_an_error_and_no_panic(
        holes in prop::collection::vec((0.0..1.0f64, prop::collection::vec(any::<u8>(), 1..200)), 1..6),
        kept in 0.1..1.2f64,
    ) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("l.db");
        ledger_of(&path, 20);
        let mut bytes = fs::read(&path).unwrap();
        for (at, hole) in holes {
            let at = (at * bytes.len() as f64) as usize;
            let end = (at + hole.len()).min(bytes.len());
            bytes[at..end].copy_from_slice(&hole[..end - at]);
        }
        bytes.truncate((kept * bytes.len() as f64) as usize);
        fs::write(&path, bytes).unwrap();
        if let Err(error) = use_all(&path) {
            prop_assert!(error.to_string().contains("hint: "), "{error}");
        }
    }
}

#[test]
fn the_error_of_a_truncated_ledger_has_a_hint() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("l.db");
    ledger_of(&path, 100);
    let bytes = fs::read(&path).unwrap();
    fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let error = use_all(&path).unwrap_err().to_string();
    assert!(error.contains("l.db") && error.contains("damaged"), "{error}");
}

/// No thread waits until the use of an answer is written. If the write fails now, it is done later.
#[test]
fn failed_writes_are_made_later() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("l.db");
    ledger_of(&path, 3);
    let other = Connection::open(&path).unwrap();
    other.execute_batch("CREATE TRIGGER full BEFORE INSERT ON uses BEGIN SELECT RAISE(ABORT, 'full'); END").unwrap();
    let ledger = Ledger::open(&path).unwrap();
    let run = ledger.start_run("b", RunLimits::default()).unwrap();
    (0..3).for_each(|number| drop(ask(&run, number).unwrap()));
    let record = || run.record_calls(Path::new("recording.jsonl"), std::io::sink());
    assert!(matches!(record(), Err(LedgerError::Store { .. })));
    other.execute_batch("DROP TRIGGER full").unwrap();
    assert_eq!(record().unwrap(), 3);
}

#[test]
fn odd_names_are_files_like_any_other() {
    let folder = tempfile::tempdir().unwrap();
    // SQLite gives the first two names a special meaning. No other test here uses a relative path.
    std::env::set_current_dir(folder.path()).unwrap();
    for name in [":memory:", "file:l.db?mode=memory", "a b%20c.db"] {
        ledger_of(Path::new(name), 2);
        assert_eq!(Ledger::open(Path::new(name)).unwrap().list_calls(&LedgerFilter::default()).unwrap().len(), 2);
        assert!(fs::metadata(folder.path().join(name)).unwrap().len() > 0, "{name}");
    }
}
