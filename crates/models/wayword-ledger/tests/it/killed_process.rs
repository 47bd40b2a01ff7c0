//! A process that is killed loses no answer that it had returned, and its requests in flight are counted.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by panicking, and its child talks to it")]

use crate::common::{open, stores};
use serde_json::json;
use std::{
    collections::BTreeSet,
    env,
    io::{BufRead, BufReader, Write},
    process::{Command, Stdio},
    thread,
    time::Duration,
};
use wayword_ledger::{CallAnswer, LedgerFilter, ModelCall, RequestRefusedError, RunLimits};

const LEDGER: &str = "WAYWORD_TEST_LEDGER";

fn answer(call: &ModelCall) -> CallAnswer {
    crate::common::answer(call.key().as_str(), Some(0.1))
}

/// Prints a line in one write, so that a kill leaves no half line of another thread.
fn say(line: &str) {
    std::io::stdout().write_all(format!("{line}\n").as_bytes()).unwrap();
}

/// Not a test of its own: the process that is killed. It prints the key of every request that it sends and of every
/// answer that it gets.
#[test]
fn child() {
    let Ok(spec) = env::var(LEDGER) else { return };
    let run = open(&spec).start_run("run", RunLimits::default()).unwrap();
    thread::scope(|scope| {
        for thread in 0..8 {
            let run = &run;
            scope.spawn(move || {
                for number in 0.. {
                    let request = json!({ "text": format!("{thread} {number}") });
                    let call = ModelCall { model: "t/m".into(), base_url: String::new(), request, replicate: 0 };
                    let answered = run.answer_once(&call, |attempts| -> Result<CallAnswer, RequestRefusedError> {
                        attempts.begin_request(Some(0.1))?;
                        say(&format!("sent {}", call.key()));
                        thread::sleep(Duration::from_millis(1));
                        Ok(answer(&call))
                    });
                    say(&format!("heard {}", answered.unwrap().text));
                }
            });
        }
    });
}

/// The lines that a child prints until it has got `answers` answers and is killed.
fn killed_after(spec: &str, answers: usize) -> Vec<(String, String)> {
    let mut child = Command::new(env::current_exe().unwrap())
        .args(["--exact", "killed_process::child", "--nocapture", "--test-threads=1"])
        .env(LEDGER, spec)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut said = Vec::new();
    let mut heard = 0;
    for line in BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok) {
        // The first line begins with the name of the test.
        let word = ["sent", "heard"].into_iter().find(|word| line.contains(&format!("{word} ")));
        let Some((word, key)) = word.and_then(|word| Some((word, line.rsplit_once(' ')?.1))) else { continue };
        if key.len() == 64 {
            said.push((word.to_owned(), key.to_owned()));
        }
        heard += usize::from(word == "heard");
        if heard == answers {
            child.kill().unwrap();
        }
    }
    child.wait().unwrap();
    said
}

#[test]
fn a_killed_process_keeps_returned_answers_and_counts_lost_requests() {
    for store in stores("nothing_that_was_heard_is_lost_and_what_was_lost_is_counted") {
        let (mut kept, mut lost) = (BTreeSet::new(), 0);
        let rounds = if store.kind() == "sqlite" { 10 } else { 5 };
        for round in 1..=rounds {
            // The answers of earlier rounds come first, from the ledger.
            let said = killed_after(store.spec(), kept.len() + 20 * round);
            store.settle();
            let ledger = store.open();
            let rows = ledger.list_calls(&LedgerFilter::default()).unwrap();
            let (before, lost_before) = (kept, lost);
            kept = rows.iter().map(|row| row.key.to_string()).collect();
            lost = ledger.count_lost_requests().unwrap();
            for (word, key) in &said {
                assert!(word == "sent" || kept.contains(key), "{key} was heard and is gone");
                assert!(word == "heard" || !before.contains(key), "{key} was answered and is asked again");
            }
            let unanswered = said.iter().filter(|(word, key)| word == "sent" && !kept.contains(key)).count() as u64;
            let lost_now = lost - lost_before;
            // Eight threads have at most one request each in flight when they are killed.
            assert!(unanswered <= lost_now && lost_now <= 8, "{unanswered} left without an answer, {lost_now} counted");
        }
        assert!(kept.len() >= 20 * rounds);
        // Lost requests may have been paid for.
        let spent_usd = 0.1 * (kept.len() as u64 + lost) as f64;
        for (max_usd, fits) in [(spent_usd + 0.15, true), (spent_usd + 0.15, false)] {
            let run = store.open().start_run("run", RunLimits { max_usd: Some(max_usd), max_calls: None }).unwrap();
            let call = ModelCall { model: "t/m".into(), base_url: String::new(), request: json!(fits), replicate: 0 };
            let left = run.answer_once(&call, |attempts| -> Result<CallAnswer, RequestRefusedError> {
                attempts.begin_request(Some(0.1))?;
                Ok(answer(&call))
            });
            assert_eq!(left.is_ok(), fits);
        }
    }
}
