//! Each call is made once, within the limits, and its answer is kept.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::stores;
use serde_json::json;
use std::{
    collections::BTreeMap,
    convert::Infallible,
    fs,
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};
use wayword_ledger::{
    CallAnswer, CallAttempts, CostGrouping, Ledger, LedgerError, LedgerFilter, LedgerRun, ModelCall, OnceError,
    RequestRefusedError, RunLimits, RunSpending,
};

fn call(number: usize) -> ModelCall {
    let request = json!({"messages": [{"role": "user", "text": format!("What is {number}?")}], "max_tokens": 10});
    ModelCall { model: "test/m".into(), base_url: "http://127.0.0.1:1".into(), request, replicate: 0 }
}

fn answer(text: &str, usd: f64) -> CallAnswer {
    crate::common::answer(text, Some(usd))
}

fn ask(run: &LedgerRun, number: usize) -> Result<CallAnswer, OnceError<RequestRefusedError>> {
    run.answer_once(&call(number), |attempts: &mut CallAttempts<'_>| {
        attempts.begin_request(Some(0.02))?;
        Ok(answer(&format!("{number}!"), 0.01))
    })
}

#[test]
fn an_answer_is_kept_for_every_later_run() {
    for store in stores("an_answer_is_kept_for_every_later_run") {
        let first = store.open().start_run("a", RunLimits::default()).unwrap();
        assert_eq!(ask(&first, 1).unwrap().text, "1!");
        assert_eq!((first.totals().answered, first.totals().hits), (1, 0));
        drop(first);
        let second = store.open().start_run("b", RunLimits::default()).unwrap();
        let kept = second
            .answer_once(&call(1), |_| -> Result<CallAnswer, Infallible> { panic!("it is asked again") })
            .unwrap();
        assert_eq!(kept, answer("1!", 0.01));
        assert_eq!((second.totals().hits, second.totals().usd), (1, 0.0));
    }
}

/// Prompts may be private.
#[cfg(unix)]
#[test]
fn files_are_their_owners_alone() {
    for store in stores("files_are_their_owners_alone").iter().filter(|store| store.kind() != "postgres") {
        ask(&store.open().start_run("a", RunLimits::default()).unwrap(), 1).unwrap();
        let permissions = fs::metadata(store.spec().split_once(':').unwrap().1).unwrap().permissions();
        assert_eq!(std::os::unix::fs::PermissionsExt::mode(&permissions) & 0o777, 0o600, "{}", store.kind());
    }
}

/// An answer may hold any character, also those that a store gives a meaning.
#[test]
fn an_answer_comes_back_as_it_was() {
    let odd = CallAnswer {
        text: "\0 \u{1}\"\\ \r\n\t \u{2028}\u{1f6cb} \u{feff}".into(),
        finish: "le\nngth".into(),
        tokens_in: 0,
        tokens_out: u64::from(u32::MAX) + 1,
        usd: Some(0.1 + 0.2),
        latency_ms: 1,
        attempts: u32::MAX,
    };
    for store in stores("an_answer_comes_back_as_it_was") {
        let made = store
            .open()
            .start_run("a", RunLimits::default())
            .unwrap()
            .answer_once(&call(1), |attempts| attempts.begin_request(None).map(|()| odd.clone()));
        assert_eq!(made.unwrap(), odd);
        let rows = store.open().list_calls(&LedgerFilter::default()).unwrap();
        assert_eq!((rows.len(), &rows[0].answer, &rows[0].call), (1, &odd, &call(1)), "{}", store.kind());
    }
}

#[test]
fn threads_that_ask_the_same_get_one_answer_that_is_asked_for_once() {
    for store in stores("threads_that_ask_the_same_get_one_answer_that_is_asked_for_once") {
        let calls = if store.kind() == "postgres" { 20 } else { 500 };
        let run = store.open().start_run("a", RunLimits::default()).unwrap();
        let made: Mutex<BTreeMap<usize, usize>> = Mutex::default();
        thread::scope(|scope| {
            for thread in 0..64 {
                let (run, made) = (&run, &made);
                scope.spawn(move || {
                    for step in 0..calls {
                        let number = (thread * 7 + step) % calls;
                        let text =
                            run.answer_once(&call(number), |attempts| -> Result<CallAnswer, RequestRefusedError> {
                                attempts.begin_request(None)?;
                                *made.lock().unwrap().entry(number).or_default() += 1;
                                thread::yield_now();
                                Ok(answer(&format!("{number}!"), 0.0))
                            });
                        assert_eq!(text.unwrap().text, format!("{number}!"));
                    }
                });
            }
        });
        let made = made.into_inner().unwrap();
        assert_eq!(made.len(), calls);
        assert!(made.values().all(|times| *times == 1), "{made:?}");
        assert_eq!(run.totals().hits, (64 * calls - calls) as u64);
    }
}

#[test]
fn a_failed_call_is_tried_again_by_a_waiting_thread() {
    for store in stores("one_that_fails_is_tried_by_those_who_waited") {
        let run = store.open().start_run("a", RunLimits::default()).unwrap();
        let tries = AtomicUsize::new(0);
        let answered = AtomicUsize::new(0);
        thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    let got = run.answer_once(&call(1), |attempts| {
                        attempts.begin_request(None).map_err(|refused| refused.to_string())?;
                        thread::sleep(std::time::Duration::from_millis(5));
                        if tries.fetch_add(1, Ordering::SeqCst) < 3 {
                            attempts.mark_failed("503", false);
                            return Err("503".to_owned());
                        }
                        Ok(answer("1!", 0.0))
                    });
                    answered.fetch_add(usize::from(got.is_ok()), Ordering::SeqCst);
                });
            }
        });
        assert_eq!((tries.load(Ordering::SeqCst), answered.load(Ordering::SeqCst)), (4, 5));
        assert_eq!((run.totals().failed, run.totals().lost), (3, 0));
    }
}

#[test]
fn limits_bind_the_run_as_a_whole() {
    for store in stores("limits_bind_the_run_as_a_whole") {
        let limits = RunLimits { max_usd: Some(0.055), max_calls: None };
        let run = store.open().start_run("a", limits).unwrap();
        for number in 0..4 {
            ask(&run, number).unwrap();
        }
        drop(run);
        // 0.04 are spent and the next may cost 0.02.
        let again = store.open().start_run("a", limits).unwrap();
        assert!(matches!(ask(&again, 4), Err(OnceError::Call(RequestRefusedError::MaxUsd { .. }))));
        assert_eq!(ask(&again, 3).unwrap().text, "3!", "what is kept costs nothing");
        drop(again);
        let other = store.open().start_run("b", RunLimits { max_usd: None, max_calls: Some(1) }).unwrap();
        ask(&other, 5).unwrap();
        assert!(matches!(ask(&other, 6), Err(OnceError::Call(RequestRefusedError::MaxCalls { max_calls: 1 }))));
    }
}

#[test]
fn money_is_bounded_however_many_ask_at_once() {
    for store in stores("money_is_bounded_however_many_ask_at_once") {
        let limits = RunLimits { max_usd: Some(1.0), max_calls: None };
        let run = store.open().start_run("a", limits).unwrap();
        thread::scope(|scope| {
            for thread in 0..16 {
                let run = &run;
                scope.spawn(move || (0..20).for_each(|step| drop(ask(run, thread * 20 + step))));
            }
        });
        let totals = run.totals();
        assert!(totals.usd <= 1.0 && totals.usd >= 0.97, "{totals:?}");
    }
}

#[test]
fn lost_requests_count_at_their_upper_bounds() {
    for store in stores("what_was_lost_counts_at_its_upper_bound") {
        let ledger = store.open();
        let run = ledger.start_run("a", RunLimits::default()).unwrap();
        for (number, maybe_paid) in [(0, true), (1, false)] {
            let failed: Result<_, OnceError<RequestRefusedError>> = run.answer_once(&call(number), |attempts| {
                attempts.begin_request(Some(0.5))?;
                attempts.mark_failed("reset", maybe_paid);
                Err(RequestRefusedError::Stopped)
            });
            assert!(failed.is_err());
        }
        assert_eq!((run.totals().failed, run.totals().lost, run.totals().maybe_usd), (2, 1, 0.5));
        drop((run, ledger));
        let ledger = store.open();
        assert_eq!(ledger.count_lost_requests().unwrap(), 1);
        let spending = RunSpending { requests: 2, answered: 0, lost: 1, usd: 0.0, maybe_usd: 0.5 };
        assert_eq!(ledger.run_spending("a").unwrap(), spending, "{}", store.kind());
        let bounded = ledger.start_run("a", RunLimits { max_usd: Some(0.51), max_calls: None }).unwrap();
        assert!(matches!(ask(&bounded, 2), Err(OnceError::Call(RequestRefusedError::MaxUsd { .. }))));
    }
}

#[test]
fn a_stopped_run_sends_no_requests_and_cancelled_ones_do_not_count() {
    for store in stores("a_stopped_run_sends_nothing_and_a_request_that_never_left_does_not_count") {
        let run = store.open().start_run("a", RunLimits { max_usd: None, max_calls: Some(1) }).unwrap();
        let never_left: Result<_, OnceError<RequestRefusedError>> = run.answer_once(&call(0), |attempts| {
            attempts.begin_request(Some(1.0))?;
            attempts.mark_cancelled();
            Err(RequestRefusedError::Stopped)
        });
        assert!(never_left.is_err());
        assert_eq!(run.totals().calls, 0);
        ask(&run, 1).unwrap();
        run.stop();
        assert!(matches!(ask(&run, 2), Err(OnceError::Call(RequestRefusedError::Stopped))));
        assert_eq!(ask(&run, 1).unwrap().text, "1!");
    }
}

#[test]
fn replay_answers_the_recorded_calls_and_no_others() {
    for store in stores("a_recording_makes_the_run_again_and_nothing_else") {
        let folder = tempfile::tempdir().unwrap();
        let ledger = store.open();
        let (run, other) = (
            ledger.start_run("a", RunLimits::default()).unwrap(),
            ledger.start_run("b", RunLimits::default()).unwrap(),
        );
        for number in 0..20 {
            ask(if number < 10 { &other } else { &run }, number).unwrap();
        }
        ask(&run, 3).unwrap();
        let file = folder.path().join("recording.jsonl");
        assert_eq!(run.record_calls(&file, std::fs::File::create(&file).unwrap()).unwrap(), 11);
        let replayed = Ledger::replay_recording(&file).unwrap().start_run("c", RunLimits::default()).unwrap();
        assert_eq!(ask(&replayed, 3).unwrap().text, "3!");
        let missing = ask(&replayed, 4).unwrap_err();
        assert!(matches!(missing, OnceError::NotRecorded { .. }));
        assert!(missing.to_string().contains("What is 4?"), "{missing}");

        let lines = fs::read_to_string(&file).unwrap();
        let mut keys: Vec<&str> = lines.lines().map(|line| &line[..75]).collect();
        assert_eq!(keys.len(), 11);
        keys.sort_unstable();
        assert_eq!(keys, lines.lines().map(|line| &line[..75]).collect::<Vec<_>>());
        for broken in [lines.replacen("What is", "Who is", 1), format!("{lines}nonsense\n"), format!("{lines}{{}}\n")] {
            fs::write(&file, broken).unwrap();
            assert!(matches!(Ledger::replay_recording(&file), Err(LedgerError::Recording { .. })));
        }
    }
}

#[test]
fn people_can_list_sum_up_and_prune() {
    for store in stores("people_can_list_sum_up_and_prune") {
        let ledger = store.open();
        let run = ledger.start_run("a", RunLimits::default()).unwrap();
        for number in 0..5 {
            ask(&run, number).unwrap();
        }
        assert_eq!(ledger.list_calls(&LedgerFilter { limit: Some(2), ..LedgerFilter::default() }).unwrap().len(), 2);
        assert_eq!(
            ledger.list_calls(&LedgerFilter { model: Some("test/other".into()), ..LedgerFilter::default() }).unwrap(),
            []
        );
        let costs = ledger.sum_costs(CostGrouping::Run).unwrap();
        assert_eq!((costs.len(), costs[0].of.as_str(), costs[0].calls, costs[0].tokens_in), (1, "a", 5, 15));
        assert!((costs[0].usd - 0.05).abs() < 1e-9);
        if store.kind() == "chunks" {
            assert!(ledger.prune_calls(&LedgerFilter::default()).is_err(), "a recording only grows");
            continue;
        }
        assert_eq!(
            ledger.prune_calls(&LedgerFilter { older_than_s: Some(3600), ..LedgerFilter::default() }).unwrap(),
            0
        );
        assert_eq!(
            ledger.prune_calls(&LedgerFilter { model: Some("test/m".into()), ..LedgerFilter::default() }).unwrap(),
            5
        );
        assert!(ledger.list_calls(&LedgerFilter::default()).unwrap().is_empty());
        let bounded = ledger.start_run("a", RunLimits { max_usd: Some(0.06), max_calls: None }).unwrap();
        assert!(ask(&bounded, 9).is_err(), "what was spent stays spent");
    }
}

#[test]
fn files_that_are_no_ledgers_are_refused_and_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("l.db");
    fs::write(
        &path,
        "something else entirely, and long enough to be looked at as a header of one hundred bytes. ".repeat(3),
    )
    .unwrap();
    let before = fs::read(&path).unwrap();
    assert!(matches!(Ledger::open(&path), Err(LedgerError::NoLedger(_))));
    assert_eq!(fs::read(&path).unwrap(), before);

    let path = folder.path().join("other.db");
    let other = rusqlite::Connection::open(&path).unwrap();
    other.execute_batch("CREATE TABLE theirs (x)").unwrap();
    assert!(matches!(Ledger::open(&path), Err(LedgerError::NoLedger(_))));

    let path = folder.path().join("newer.db");
    drop(Ledger::open(&path).unwrap());
    rusqlite::Connection::open(&path).unwrap().pragma_update(None, "user_version", 99).unwrap();
    assert!(matches!(Ledger::open(&path), Err(LedgerError::Newer { format: 99, .. })));
}

/// An answer may claim any number of tokens.
#[test]
fn counts_without_measure_are_summed_up_all_the_same() {
    for store in stores("counts_without_measure_are_summed_up_all_the_same") {
        let ledger = store.open();
        let run = ledger.start_run("a", RunLimits::default()).unwrap();
        for number in 0..2 {
            let answered = run.answer_once(&call(number), |attempts| -> Result<CallAnswer, RequestRefusedError> {
                attempts.begin_request(None)?;
                Ok(CallAnswer { tokens_in: u64::MAX, tokens_out: u64::MAX, ..answer("yes", 0.0) })
            });
            answered.unwrap();
        }
        assert_eq!((run.totals().tokens_in, run.totals().tokens_out), (u64::MAX, u64::MAX));
        let costs = ledger.sum_costs(CostGrouping::Model).unwrap();
        assert_eq!((costs[0].calls, costs[0].tokens_in), (2, i64::MAX.cast_unsigned()));
    }
}
