//! A process that is killed loses no answer that anybody has heard, and what was on the wire is counted.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by panicking, and its child talks to it")]

use serde_json::json;
use std::{
    env,
    io::{BufRead, BufReader, Write},
    path::Path,
    process::{Command, Stdio},
    thread,
    time::Duration,
};
use wayword_ledger::{Answer, Call, Filter, Ledger, Limits, Refused};

const LEDGER: &str = "WAYWORD_TEST_LEDGER";

/// Not a test of its own: the process that is killed. It says the key of every answer that it has heard.
#[test]
fn child() {
    let Some(path) = env::var_os(LEDGER) else { return };
    let run = Ledger::open(Path::new(&path)).unwrap().run("run", Limits::default()).unwrap();
    thread::scope(|scope| {
        for thread in 0..8 {
            let run = &run;
            scope.spawn(move || {
                for number in 0.. {
                    let request = json!({ "text": format!("{thread} {number}") });
                    let call = Call { model: "t/m".into(), base_url: String::new(), request, replicate: 0 };
                    let answered = run.once(&call, |attempts| -> Result<Answer, Refused> {
                        attempts.begin(Some(0.1))?;
                        thread::sleep(Duration::from_millis(1));
                        Ok(Answer {
                            text: call.key().to_string(),
                            finish: "stop".into(),
                            tokens_in: 1,
                            tokens_out: 1,
                            usd: Some(0.1),
                            latency_ms: 1,
                            attempts: 1,
                        })
                    });
                    // One write, so that a kill leaves no half line of another's.
                    std::io::stdout().write_all(format!("heard {}\n", answered.unwrap().text).as_bytes()).unwrap();
                }
            });
        }
    });
}

#[test]
fn nothing_that_was_heard_is_lost() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("l.db");
    let mut kept = Vec::new();
    for round in 1..=10 {
        let mut child = Command::new(env::current_exe().unwrap())
            .args(["--exact", "child", "--nocapture", "--test-threads=1"])
            .env(LEDGER, &path)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
        let mut heard = lines.filter_map(|line| Some(line.split_once("heard ")?.1.to_owned()));
        // What earlier rounds have heard comes first, from the ledger.
        let mut said: Vec<String> = heard.by_ref().take(kept.len() + 20 * round).collect();
        child.kill().unwrap();
        child.wait().unwrap();
        said.extend(heard.filter(|key| key.len() == 64));
        let ledger = Ledger::open(&path).unwrap();
        kept = ledger.list(&Filter::default()).unwrap().iter().map(|row| row.key.to_string()).collect();
        for key in said {
            assert!(kept.contains(&key), "{key} was heard and is gone");
        }
        // Eight threads have at most one request each on the wire when they are killed.
        assert!(ledger.lost().unwrap() <= 8 * round as u64);
    }
    assert!(kept.len() > 200);
}
