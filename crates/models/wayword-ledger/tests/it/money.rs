//! A run's limit on money is kept at every moment, with any number of threads and any price.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::{Store, stores};
use proptest::{prelude::*, test_runner::TestRunner};
use serde_json::json;
use std::{cell::Cell, sync::Mutex, thread};
use wayword_ledger::{CallAnswer, LedgerRun, ModelCall, OnceError, RequestRefusedError, RunLimits};

/// How a request ends.
#[derive(Debug, Clone, Copy)]
enum End {
    Answered(Option<f64>),
    Failed { maybe_paid: bool },
}

fn ask(
    run: &LedgerRun,
    number: usize,
    most_usd: Option<f64>,
    end: End,
) -> Result<CallAnswer, OnceError<RequestRefusedError>> {
    ask_watched(run, number, most_usd, end, |_| ())
}

/// `watch` gets what the request may cost when it is sent, and the difference when it ends.
fn ask_watched(
    run: &LedgerRun,
    number: usize,
    most_usd: Option<f64>,
    end: End,
    watch: impl Fn(f64),
) -> Result<CallAnswer, OnceError<RequestRefusedError>> {
    let call =
        ModelCall { model: "t/m".into(), base_url: String::new(), request: json!({ "text": number }), replicate: 0 };
    run.answer_once(&call, |attempts| {
        attempts.begin_request(most_usd)?;
        watch(most_usd.unwrap_or(0.0));
        thread::yield_now();
        match end {
            End::Answered(usd) => {
                watch(usd.unwrap_or(0.0) - most_usd.unwrap_or(0.0));
                Ok(crate::common::answer("yes", usd))
            }
            End::Failed { maybe_paid } => {
                if !maybe_paid {
                    watch(-most_usd.unwrap_or(0.0));
                }
                attempts.mark_failed("503", maybe_paid);
                Err(RequestRefusedError::Stopped)
            }
        }
    })
}

fn end(most_usd: f64) -> impl Strategy<Value = End> {
    prop_oneof![
        (0.0..1.0f64).prop_map(move |share| End::Answered(Some(most_usd * share))),
        any::<bool>().prop_map(|maybe_paid| End::Failed { maybe_paid }),
    ]
}

/// While eight threads ask, the sum of the amounts that are paid, maybe paid and in flight stays below the limit. So does the number of
/// requests. A later process of the run knows both.
#[test]
fn limits_hold_at_every_moment_with_many_threads() {
    let asked = prop::collection::vec((0.0..0.2f64).prop_flat_map(|most| (Just(most), end(most))), 64);
    let inputs = (0.0..2.0f64, 0u64..60, asked);
    for store in stores("nothing_leaves_that_could_break_a_limit") {
        let config =
            ProptestConfig { cases: if store.kind() == "sqlite" { 24 } else { 6 }, ..ProptestConfig::default() };
        let mut runner = TestRunner::new(ProptestConfig { failure_persistence: None, ..config });
        let case = Cell::new(0);
        // Each case is a run of its own.
        let tried = runner.run(&inputs, |(max_usd, max_calls, asked)| {
            case.set(case.get() + 1);
            holds(&store, case.get(), max_usd, max_calls, &asked)
        });
        tried.unwrap_or_else(|error| panic!("{}: {error}", store.kind()));
    }
}

/// The test above for one run.
fn holds(store: &Store, case: usize, max_usd: f64, max_calls: u64, asked: &[(f64, End)]) -> Result<(), TestCaseError> {
    let ledger = store.open();
    let limits = RunLimits { max_usd: Some(max_usd), max_calls: Some(max_calls) };
    let name = format!("run {case}");
    let run = ledger.start_run(&name, limits).unwrap();
    let (exposed, most_exposed) = (Mutex::new(0.0), Mutex::new(0.0f64));
    let watch = |usd: f64| {
        let mut exposed = exposed.lock().unwrap();
        *exposed += usd;
        let mut most = most_exposed.lock().unwrap();
        *most = most.max(*exposed);
    };
    let first = case * 10_000;
    thread::scope(|scope| {
        for (thread, asked) in asked.chunks(8).enumerate() {
            let (run, watch) = (&run, &watch);
            scope.spawn(move || {
                for (step, (most_usd, end)) in asked.iter().enumerate() {
                    drop(ask_watched(run, first + thread * 8 + step, Some(*most_usd), *end, watch));
                }
            });
        }
    });
    prop_assert!(*most_exposed.lock().unwrap() <= max_usd + 1e-6);
    let totals = run.totals();
    prop_assert!(totals.calls <= max_calls);
    let spending = ledger.run_spending(&name).unwrap();
    prop_assert_eq!(
        (spending.requests, spending.answered, spending.lost),
        (totals.calls, totals.answered, totals.lost)
    );
    prop_assert!((spending.usd + spending.maybe_usd - totals.usd - totals.maybe_usd).abs() < 1e-6);
    let left = max_usd - totals.usd - totals.maybe_usd;
    let again = ledger.start_run(&name, limits).unwrap();
    let too_much = ask(&again, first + 1000, Some(left + 0.001), End::Answered(Some(0.0)));
    let refused = matches!(
        too_much,
        Err(OnceError::Call(RequestRefusedError::MaxUsd { .. } | RequestRefusedError::MaxCalls { .. }))
    );
    prop_assert!(refused, "{too_much:?}");
    if totals.calls < max_calls {
        let fits = ask(&again, first + 1001, Some((left - 0.001).max(0.0)), End::Answered(Some(0.0)));
        prop_assert!(fits.is_ok(), "{fits:?}");
    }
    Ok(())
}

#[test]
fn an_invalid_price_counts_as_no_price() {
    for store in stores("a_price_that_is_no_amount_is_no_price") {
        let run = store.open().start_run("a", RunLimits { max_usd: Some(1.0), max_calls: None }).unwrap();
        for most_usd in [f64::NAN, f64::INFINITY, -1.0] {
            let refused = ask(&run, 0, Some(most_usd), End::Answered(Some(0.0)));
            assert!(matches!(refused, Err(OnceError::Call(RequestRefusedError::NoPrice))), "{most_usd}: {refused:?}");
        }
        // The same goes for an answer's price: its upper bound counts instead.
        for (number, usd) in [None, Some(f64::NAN), Some(-5.0)].into_iter().enumerate() {
            ask(&run, number, Some(0.3), End::Answered(usd)).unwrap();
        }
        let refused = ask(&run, 9, Some(0.2), End::Answered(Some(0.0)));
        assert!(matches!(refused, Err(OnceError::Call(RequestRefusedError::MaxUsd { .. }))), "{refused:?}");
        assert!(run.totals().usd.abs() < 1e-9);
    }
}

#[test]
fn an_invalid_limit_refuses_every_request() {
    for store in stores("a_limit_that_is_no_amount_lets_nothing_out") {
        let run = store.open().start_run("a", RunLimits { max_usd: Some(f64::NAN), max_calls: None }).unwrap();
        assert!(matches!(
            ask(&run, 0, Some(0.1), End::Answered(None)),
            Err(OnceError::Call(RequestRefusedError::MaxUsd { .. }))
        ));
    }
}

#[test]
fn an_answer_without_a_price_counts_at_its_upper_bound_later_too() {
    for store in stores("an_answer_without_a_price_counts_at_its_upper_bound_later_too") {
        let limits = RunLimits { max_usd: Some(1.0), max_calls: None };
        ask(&store.open().start_run("a", limits).unwrap(), 0, Some(0.8), End::Answered(None)).unwrap();
        let again = store.open().start_run("a", limits).unwrap();
        assert!(ask(&again, 1, Some(0.3), End::Answered(Some(0.1))).is_err());
        assert!(ask(&again, 1, Some(0.1), End::Answered(Some(0.1))).is_ok());
    }
}
