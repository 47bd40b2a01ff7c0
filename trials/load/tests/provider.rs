//! The measurements that start a provider as a process of their own, on so few calls that each figure is known.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::process::Command;

fn measured(args: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_wayword-trials")).args(args).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// The number in front of some words.
fn number_before(text: &str, words: &str) -> f64 {
    let before = text[..text.find(words).unwrap()].trim_end();
    before.rsplit([' ', '\n']).next().unwrap().parse().unwrap()
}

/// Four calls at a time with 50 ms for each are 80 per second at most.
#[test]
fn calls_stay_within_the_limit_by_latency() {
    let told = measured(&["calls", "--calls", "40", "--latency-ms", "50", "--concurrency", "4"]);
    assert!(told.contains("after 40 calls: ") && told.contains(" 0 failed"), "{told}");
    let per_s = number_before(&told, "calls/s");
    assert!(per_s > 0.0 && per_s <= 80.0, "{told}");
    assert!(told.contains("of the ideal 80.0"), "{told}");
}

#[test]
fn pictures_are_measured_in_both_ways() {
    let told = measured(&["pictures", "--calls", "20"]);
    assert_eq!(told.matches(", 0 failed").count(), 2, "{told}");
}

/// Without faults all calls are answered, and each is let in once.
#[test]
fn a_storm_without_faults_answers_every_call() {
    let told = measured(&["storm", "--calls", "30", "--requests-per-second", "500", "--burst", "30", "--share", "0"]);
    assert!(told.starts_with("30 calls: 30 answered, 0 failed"), "{told}");
    assert!(told.contains("30 requests let in, 0 faults"), "{told}");
    assert!(told.contains("% of 500.0 (allowed rate"), "{told}");
}
