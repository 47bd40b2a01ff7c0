//! Recordings of chunks: files that are only appended to, and limits that hold over all chunks of a shard.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use serde_json::json;
use std::{
    env, fs,
    io::Write,
    path::{Path, PathBuf},
    process::Command,
};
use wayword_ledger::{
    CallAnswer, Ledger, LedgerError, LedgerFilter, LedgerRun, ModelCall, OnceError, RequestRefusedError, RunLimits,
    RunSpending,
};

const FULL: &str = "WAYWORD_TEST_FULL_DISK";

fn call(number: usize) -> ModelCall {
    ModelCall {
        model: "t/m".into(),
        base_url: String::new(),
        request: json!({ "text": number.to_string() }),
        replicate: 0,
    }
}

fn answer(number: usize) -> CallAnswer {
    CallAnswer {
        text: format!("{number}!"),
        finish: "stop".into(),
        tokens_in: 1,
        tokens_out: 1,
        usd: Some(0.1),
        latency_ms: 1,
        attempts: 1,
    }
}

fn ask(run: &LedgerRun, number: usize) -> Result<CallAnswer, OnceError<RequestRefusedError>> {
    run.answer_once(&call(number), |attempts| attempts.begin_request(Some(0.2)).map(|()| answer(number)))
}

/// The ledger of a program that goes on with a file.
fn at(file: &Path) -> Ledger {
    let ledger = Ledger::in_chunks(&[]).unwrap();
    ledger.turn_to(file).unwrap();
    ledger
}

fn kept(file: &Path) -> usize {
    at(file).list_calls(&LedgerFilter::default()).unwrap().len()
}

#[test]
fn limits_hold_over_all_chunks_of_a_shard() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second, third] = ["1", "2", "3"].map(|name| folder.path().join(name));
    let limits = RunLimits { max_usd: Some(0.95), max_calls: None };
    let ledger = Ledger::in_chunks(&[]).unwrap();
    let run = ledger.start_run("a", limits).unwrap();
    for (chunk, file) in [&first, &second].into_iter().enumerate() {
        ledger.turn_to(file).unwrap();
        (0..3).for_each(|number| drop(ask(&run, 10 * chunk + number).unwrap()));
    }
    drop((run, ledger));
    // The second chunk is gone on with, so it is among the earlier ones and the current one.
    let ledger = Ledger::in_chunks(&[first.clone(), second, folder.path().join("none")]).unwrap();
    let run = ledger.start_run("a", limits).unwrap();
    ledger.turn_to(&folder.path().join("./2")).unwrap();
    assert_eq!(ask(&run, 12).unwrap().text, "12!", "it is in the file");
    assert!(run.totals().calls == 0 && ask(&run, 2).is_ok() && run.totals().calls == 1, "another chunk's is not");
    ledger.turn_to(&third).unwrap();
    ledger.turn_to(&third).unwrap();
    // 0.7 are spent, and the next may cost 0.2.
    ask(&run, 20).unwrap();
    let refused = ask(&run, 21).unwrap_err();
    assert!(refused.to_string().contains("$0.8000 are spent"), "{refused}");
    ledger.turn_to(&first).unwrap();
    assert!(ask(&run, 22).unwrap_err().to_string().contains("$0.8000 are spent"));
    assert!((ledger.run_spending("a").unwrap().usd - 0.8).abs() < 1e-9);
    let in_third = RunSpending { requests: 1, answered: 1, lost: 0, usd: 0.1, maybe_usd: 0.0 };
    assert_eq!(Ledger::spent_in(&third).unwrap(), in_third);
    assert_eq!(Ledger::spent_in(&folder.path().join("none")).unwrap(), RunSpending::default());
}

#[test]
fn turn_to_counts_a_file_that_was_not_among_the_earlier_ones() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = ["1", "2"].map(|name| folder.path().join(name));
    ask(&at(&first).start_run("a", RunLimits::default()).unwrap(), 1).unwrap();
    let ledger = at(&second);
    let run = ledger.start_run("a", RunLimits { max_usd: None, max_calls: Some(2) }).unwrap();
    ask(&run, 2).unwrap();
    ledger.turn_to(&first).unwrap();
    assert!(matches!(ask(&run, 3), Err(OnceError::Call(RequestRefusedError::MaxCalls { max_calls: 2 }))));
}

/// The file is cut anywhere, as by a crash.
#[test]
fn a_torn_line_is_cut_off_and_work_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("whole");
    let run = at(&whole).start_run("a", RunLimits::default()).unwrap();
    (0..2).for_each(|number| drop(ask(&run, number).unwrap()));
    drop(run);
    let bytes = fs::read(&whole).unwrap();
    for length in (0..=bytes.len()).step_by(11) {
        let file = folder.path().join("torn");
        for zeros in [0, 30] {
            fs::write(&file, [&bytes[..length], &vec![0; zeros]].concat()).unwrap();
            let spent = Ledger::spent_in(&file).unwrap();
            let run = at(&file).start_run("a", RunLimits::default()).unwrap();
            (0..2).for_each(|number| assert_eq!(ask(&run, number).unwrap(), answer(number)));
            let made = run.totals().answered;
            assert_eq!(spent.answered + made, 2, "at {length}");
            drop(run);
            let after = Ledger::spent_in(&file).unwrap();
            assert_eq!((after.answered, after.requests), (2, spent.requests + made), "at {length}");
            assert_eq!(after.lost, spent.lost, "a request without an end stays counted");
            assert_eq!(kept(&file), 2);
        }
    }
}

#[test]
fn a_line_that_was_changed_is_refused_with_its_number() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("chunk");
    let run = at(&file).start_run("a", RunLimits::default()).unwrap();
    (0..2).for_each(|number| drop(ask(&run, number).unwrap()));
    drop(run);
    let text = fs::read_to_string(&file).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let without =
        |at: usize| lines.iter().enumerate().filter(move |(line, _)| *line != at).map(|(_, line)| format!("{line}\n"));
    for (changed, line) in [
        (text.replacen("0!", "7!", 1), 3),
        (text.replacen("\"usd\":0.1", "\"usd\":0.0", 1), 3),
        (text.replacen("\"most_usd\":0.2", "\"most_usd\":0.0", 1), 2),
        (text.replacen("\"format\":1", "\"format\":2", 1), 1),
        (text.replacen(lines[3], "", 1), 4),
        (text.replacen(lines[3], "\0\0", 1), 4),
        (format!("{text}nonsense\n"), 6),
        (without(0).collect(), 1),
        ("something else entirely\n".to_owned(), 1),
    ] {
        fs::write(&file, &changed).unwrap();
        let error = Ledger::in_chunks(&[]).unwrap().turn_to(&file).unwrap_err();
        assert!(matches!(&error, LedgerError::Chunk { line: at, .. } if *at == line), "{error}");
        assert!(error.to_string().contains("hint: "), "{error}");
        assert!(Ledger::in_chunks(std::slice::from_ref(&file)).is_err() && Ledger::spent_in(&file).is_err());
        assert_eq!(fs::read_to_string(&file).unwrap(), changed, "it is left as it is");
    }
}

#[test]
fn a_chunk_is_not_left_while_a_call_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = ["1", "2"].map(|name| folder.path().join(name));
    let ledger = at(&first);
    let run = ledger.start_run("a", RunLimits::default()).unwrap();
    let made = run.answer_once(&call(1), |attempts| -> Result<CallAnswer, RequestRefusedError> {
        attempts.begin_request(None)?;
        assert!(matches!(ledger.turn_to(&second), Err(LedgerError::Misuse { .. })));
        Ok(answer(1))
    });
    made.unwrap();
    ledger.turn_to(&second).unwrap();
    assert!(
        ask(&Ledger::in_chunks(&[]).unwrap().start_run("a", RunLimits::default()).unwrap(), 1).is_err(),
        "no chunk yet"
    );
    assert!(Ledger::in_memory().unwrap().turn_to(&second).is_err(), "it has no chunks");
}

#[test]
fn a_chunk_can_be_replayed_and_has_no_second_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("chunk");
    let ledger = at(&file);
    let run = ledger.start_run("a", RunLimits::default()).unwrap();
    (0..3).for_each(|number| drop(ask(&run, number).unwrap()));
    let names: Vec<PathBuf> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path()).collect();
    assert_eq!(names, std::slice::from_ref(&file));
    fs::OpenOptions::new().append(true).open(&file).unwrap().write_all(b"{\"sha256\":\"torn").unwrap();
    let replayed = Ledger::replay_recording(&file).unwrap().start_run("b", RunLimits::default()).unwrap();
    assert_eq!(ask(&replayed, 2).unwrap().text, "2!");
    assert!(matches!(ask(&replayed, 3), Err(OnceError::NotRecorded { .. })));
    let recording = folder.path().join("recording");
    assert_eq!(run.record_calls(&recording, std::fs::File::create(&recording).unwrap()).unwrap(), 3);
    assert!(Ledger::replay_recording(&recording).is_ok());
}

/// Not a test of its own: the program that runs out of disk space.
#[cfg(unix)]
#[test]
fn program_whose_disk_is_full() {
    let Some(file) = env::var_os(FULL) else { return };
    let run = at(Path::new(&file)).start_run("a", RunLimits::default()).unwrap();
    let heard = (0..).map(|number| ask(&run, number)).take_while(Result::is_ok).count();
    let error = ask(&run, heard + 1).unwrap_err();
    assert!(matches!(error, OnceError::Call(RequestRefusedError::Ledger(LedgerError::Io { .. }))), "{error}");
    std::io::stdout().write_all(format!("heard {heard}\n").as_bytes()).unwrap();
}

/// No request leaves before its line is written, and written lines are kept. A limit on the size of files simulates a full disk.
#[cfg(unix)]
#[test]
fn a_full_disk_keeps_requests_from_leaving() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("chunk");
    let limited = "trap '' XFSZ; ulimit -f 16; exec \"$0\" --exact chunks::program_whose_disk_is_full --nocapture";
    let mut program = Command::new("sh");
    program.args(["-c", limited]).arg(env::current_exe().unwrap()).env(FULL, &file);
    let said = String::from_utf8(program.output().unwrap().stdout).unwrap();
    let heard = said.split_once("heard ").unwrap().1.lines().next().unwrap().parse::<usize>().unwrap();
    assert!(heard > 3, "{said}");
    assert_eq!(kept(&file), heard);
    ask(&at(&file).start_run("a", RunLimits::default()).unwrap(), heard).unwrap();
    assert_eq!(kept(&file), heard + 1);
}
