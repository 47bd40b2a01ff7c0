//! A run with models that is killed repeatedly ends like a run that was not killed. It pays twice at most for the calls
//! that were in flight. The same is true for two runs at the same time on one ledger.
//!
//! `WAYWORD_KILLS` sets how often it is killed (default 3).

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::print_stderr, reason = "a test fails by panicking, and prints what it counted")]

use crate::common::models as stage;

use rand::Rng;
use stage::{Stage, cast};
use std::{env, process::Stdio, thread, time::Duration};
use wayword_core::seeded_rng;
use wayword_testkit::provider::ProviderBehaviour;

const CONCURRENCY: u64 = 16;
/// About 2,000 calls.
const RUN: [&str; 6] = ["--paths", "100", "--concurrency", "16", "--quiet", "--json"];

#[test]
fn a_run_that_is_killed_ends_the_same_and_pays_once() {
    let kills: usize = env::var("WAYWORD_KILLS").map_or(3, |kills| kills.parse().unwrap());
    let behaviour = ProviderBehaviour { latency: Duration::from_millis(10), ..cast() };
    let (whole, killed) = (Stage::new(behaviour.clone()), Stage::new(behaviour));
    whole.generate("run", &RUN);
    let calls = whole.provider.log().answered;

    let mut rng = seeded_rng(3, &["kills"]);
    let mut moments: Vec<u64> = (0..kills).map(|_| rng.random_range(1..calls * 19 / 20)).collect();
    moments.sort_unstable();
    let mut at_work = 0;
    for moment in moments {
        let mut child = killed.generating("run", &RUN).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        while killed.provider.request_count() < moment && child.try_wait().unwrap().is_none() {
            thread::sleep(Duration::from_millis(1));
        }
        // A process without a call so far is killed while it reads its files.
        thread::sleep(Duration::from_millis(rng.random_range(0..60)));
        child.kill().unwrap();
        at_work += usize::from(child.wait().unwrap().code().is_none());
    }
    let last = killed.generate("run", &RUN);
    assert_eq!(last.json()["stopped"], serde_json::Value::Null, "{last:?}");
    assert!(at_work * 10 >= kills * 9, "only {at_work} of {kills} kills landed while it was at work");
    assert!(whole.same_results(&killed, "run"), "the results differ");

    let log = killed.provider.log();
    let cost = killed.building.wayword(&["ledger", "cost", "--ledger", "ledger.db", "--json"]).json();
    let lost = cost["lost"].as_u64().unwrap();
    let again = log.answered - log.distinct_answered();
    eprintln!("{kills} kills, {calls} calls: {again} paid again, {lost} counted as perhaps paid");
    assert_eq!(log.distinct_answered(), whole.provider.log().distinct_answered());
    assert!(again <= lost, "{again} calls were paid again, and {lost} are counted");
    assert!(lost <= kills as u64 * CONCURRENCY * 2, "{lost}");
}

/// Two runs of the same paths at the same time, one of them killed at seeded moments and started again at once.
#[test]
fn two_runs_on_one_ledger_pay_for_each_call_once() {
    const RUN: [&str; 6] = ["--paths", "40", "--concurrency", "16", "--quiet", "--json"];
    let kills: usize = env::var("WAYWORD_KILLS").map_or(3, |kills| kills.parse().unwrap());
    let behaviour = ProviderBehaviour { latency: Duration::from_millis(20), ..cast() };
    let (alone, shared) = (Stage::new(behaviour.clone()), Stage::new(behaviour));
    assert_eq!(alone.generate("one", &RUN).code, alone.generate("two", &RUN).code);
    let calls = alone.provider.log().answered;

    let begin = |out: &str| shared.generating(out, &RUN).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let mut rng = seeded_rng(5, &["kills of one of two"]);
    let mut moments: Vec<u64> = (0..kills).map(|_| rng.random_range(1..calls * 19 / 20)).collect();
    moments.sort_unstable();
    let (mut one, mut two) = (begin("one"), begin("two"));
    for moment in moments {
        while shared.provider.request_count() < moment {
            thread::sleep(Duration::from_millis(1));
        }
        let victim = if rng.random_bool(0.5) { (&mut one, "one") } else { (&mut two, "two") };
        victim.0.kill().unwrap();
        victim.0.wait().unwrap();
        *victim.0 = begin(victim.1);
    }
    let code = |mut child: std::process::Child| child.wait().unwrap().code();
    assert_eq!((code(one), code(two)), (Some(0), Some(0)));
    assert!(alone.same_results(&shared, "one") && alone.same_results(&shared, "two"), "the results differ");
    let log = shared.provider.log();
    let cost = shared.building.wayword(&["ledger", "cost", "--ledger", "ledger.db", "--json"]).json();
    let lost = cost["lost"].as_u64().unwrap();
    eprintln!("{kills} kills of two, {calls} calls: {} paid again, {lost} in flight", log.answered_again());
    assert_eq!(log.distinct_answered(), calls);
    assert!(log.answered_again() <= lost, "{} calls were paid again, and {lost} were in flight", log.answered_again());
    assert!(lost <= kills as u64 * CONCURRENCY * 2, "{lost}");
}
