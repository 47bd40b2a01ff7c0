//! Runs that many workers make: by shards of a folder, and by a queue in PostgreSQL. Whichever worker is killed, together they
//! make the same files as one machine, and only calls in flight are paid twice.

#![cfg(unix)]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stderr,
    reason = "a test fails by panicking, and says if it was skipped"
)]

use crate::common::models as stage;

use crate::common::{Building, EPISODES, Ran, files};
use rand::Rng;
use stage::{KEY, KEY_ENV, Stage, cast, holds_no_key};
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    thread,
    time::Duration,
};
use wayword_core::seeded_rng;
use wayword_testkit::provider::{ProviderBehaviour, ProviderDialect};

const RUN: [&str; 6] = ["--episodes", EPISODES, "--style", "r2r", "--chunk", "2"];

/// The files of a run on one machine, except its lock and its id. A killed worker can leave a file that it had not finished.
fn results(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = files(folder);
    let apart = ["run.lock", "run.id", "plan.json", "workers.json"];
    files.retain(|path, _| {
        let is_apart = apart.iter().any(|name| path == Path::new(name));
        let is_unfinished = path.to_string_lossy().contains(".new-");
        !is_apart && !is_unfinished && !path.starts_with("chunks") && !path.starts_with("workers")
    });
    files
}

fn worker(building: &Building, out: &str, part: &str) -> Ran {
    let mut args = RUN.to_vec();
    args.extend(["--shard", part]);
    building.generate(out, &args)
}

#[test]
fn shards_together_make_what_one_machine_makes() {
    let building = Building::new();
    assert_eq!(building.generate("one", &RUN[..4]).code, Some(0));
    let one = results(&building.path("one"));
    assert!(one.contains_key(Path::new("instructions.jsonl")) && one.contains_key(Path::new("data.json")));
    for n in [1, 2, 8] {
        let out = format!("by-{n}");
        for k in 0..n {
            let ran = worker(&building, &out, &format!("{k}/{n}"));
            assert_eq!(ran.code, Some(0), "{ran:?}");
        }
        let merged = building.wayword(&["runs", "merge", &out]);
        assert_eq!(merged.code, Some(0), "{merged:?}");
        let made = results(&building.path(&out));
        assert_eq!(made.keys().collect::<Vec<_>>(), one.keys().collect::<Vec<_>>());
        assert!(made == one, "the bytes differ for {n} shards");
    }
}

#[test]
fn plan_estimates_the_run_and_refuses_a_worker_with_other_settings() {
    let building = Building::new();
    let mut plan = RUN.to_vec();
    plan.extend(["--plan", "--json"]);
    let planned = building.generate("big", &plan);
    assert_eq!(planned.code, Some(0), "{planned:?}");
    assert_eq!(planned.json()["chunk"], 2);
    assert!(!building.path("big/config.toml").exists(), "nothing is made");

    let mut other = RUN.to_vec();
    other.extend(["--shard", "0/1", "--repairs", "1"]);
    assert!(building.generate("big", &other).refused().contains("these differ: repairs"));
    let chunk = ["--episodes", EPISODES, "--style", "r2r", "--chunk", "3", "--shard", "0/1"];
    assert!(building.generate("big", &chunk).refused().contains("chunk (2 in the plan)"));
    let episodes = building.path(EPISODES);
    let text = fs::read_to_string(&episodes).unwrap();
    fs::write(&episodes, format!("{text}\n")).unwrap();
    assert!(worker(&building, "big", "0/1").refused().contains("contents of episodes"));
    fs::write(&episodes, text).unwrap();
    assert!(building.generate("big", &RUN[..4]).refused().contains("workers make"));

    assert!(building.wayword(&["runs", "merge", "big"]).refused().contains("not finished"));
    let report = building.wayword(&["report", "--run", "big"]);
    assert!(report.refused().contains("wayword runs merge"), "{report:?}");
    let export = ["export", "--run", "big", "--format", "r2r", "--style", "r2r", "--out", "x.json"];
    assert!(building.wayword(&export).refused().contains("wayword runs merge"));
    assert!(building.wayword(&["runs", "status", "nowhere"]).refused().contains("no such folder"));
}

#[cfg(not(feature = "cloud"))]
#[test]
fn build_without_object_stores_refuses_their_addresses() {
    let building = Building::new();
    let refused = building.generate("s3://bucket/big", &RUN[..4]);
    assert!(refused.refused().contains("--shard"), "{refused:?}");
    for refused in
        [worker(&building, "s3://bucket/big", "0/1"), building.wayword(&["runs", "status", "s3://bucket/big"])]
    {
        assert!(refused.refused().contains("--features full,cloud"), "{refused:?}");
    }
    assert!(!building.path("s3:").exists(), "no folder is made");
}

#[test]
fn a_second_worker_on_a_shard_is_refused_while_the_first_lives() {
    let building = Building::new();
    let mut plan = RUN.to_vec();
    plan.push("--plan");
    assert_eq!(building.generate("big", &plan).code, Some(0));
    fs::create_dir_all(building.path("big/workers")).unwrap();
    let beat = building.write("big/workers/shard-0-of-2", r#"{"worker":"node7-1","token":"t","part":"shard 0/2"}"#);
    let refused = worker(&building, "big", "0/2");
    assert_eq!(refused.code, Some(4), "{refused:?}");
    assert!(refused.err.contains("node7-1") && refused.err.contains("is at work"), "{refused:?}");
    // Another cut of the run has other chunks in each part.
    assert_eq!(worker(&building, "big", "2/3").code, Some(4));
    assert_eq!(worker(&building, "big", "1/2").code, Some(0));
    let status = building.wayword(&["runs", "status", "big", "--json"]).json();
    assert_eq!((status["running"].as_u64(), status["workers"][0]["worker"].as_str()), (Some(1), Some("node7-1")));
    // A worker that is gone for long enough gives way.
    let old = std::time::SystemTime::now() - Duration::from_secs(120);
    fs::File::options().write(true).open(beat).unwrap().set_modified(old).unwrap();
    assert_eq!(worker(&building, "big", "0/2").code, Some(0));
    assert_eq!(building.wayword(&["runs", "merge", "big"]).code, Some(0));
}

#[test]
fn status_lists_failed_items_by_reason_and_retry_makes_them() {
    let building = Building::new();
    assert_eq!(building.generate("one", &RUN[..4]).code, Some(0));
    assert_eq!(worker(&building, "big", "0/1").code, Some(0));
    // As if an item of chunk 1 had failed.
    let chunk = |name: &str| building.path(&format!("big/chunks/{name}"));
    let mark = fs::read_to_string(chunk("000001.done")).unwrap();
    fs::write(chunk("000001.done"), mark.replace("\"seconds\"", "\"failed\":{\"timed out\":1},\"seconds\"")).unwrap();
    for name in ["walks.jsonl", "instructions.jsonl"] {
        let text = fs::read_to_string(chunk("000001").join(name)).unwrap();
        fs::write(chunk("000001").join(name), text.split_inclusive('\n').next().unwrap()).unwrap();
    }
    let status = building.wayword(&["runs", "status", "big", "--json"]).json();
    assert_eq!(status["failed"]["timed out"], 1);
    let prometheus = building.wayword(&["runs", "status", "big", "--prometheus"]);
    assert!(prometheus.out.contains("wayword_items_failed{run=\"big\",reason=\"timed out\"} 1"), "{prometheus:?}");
    let opened = |reason: &str| building.wayword(&["runs", "retry", "big", "--reason", reason, "--json"]).json();
    assert_eq!(opened("no such words")["chunks"], serde_json::json!([]));
    assert_eq!(opened("timed")["chunks"], serde_json::json!([1]));
    assert_eq!(worker(&building, "big", "0/1").code, Some(0));
    assert_eq!(building.wayword(&["runs", "merge", "big"]).code, Some(0));
    assert!(results(&building.path("big")) == results(&building.path("one")));
}

/// A worker of a run with models, as a process.
fn with_models(stage: &Stage, out: &str, part: &[&str]) -> Command {
    let mut args = vec!["--paths", "24", "--chunk", "4"];
    args.extend(part);
    asking_models(stage, out, &args)
}

/// `generate` with models, as a process.
fn asking_models(stage: &Stage, out: &str, part: &[&str]) -> Command {
    let base = stage.provider.base_url(ProviderDialect::OpenAi);
    let models = ["--llm", "server/words", "--see", "server/eye", "--base-url", &base, "--key-env", KEY_ENV];
    let rest = ["--style", "r2r", "--hops", "3..7", "--evidence", "captions"];
    let mut args = vec!["generate", "--platform", "matterport", "--data", "data", "--out", out, "--concurrency", "8"];
    args.extend(models.into_iter().chain(rest).chain(part.iter().copied()));
    let mut command = stage.building.command(&args);
    command.env(KEY_ENV, KEY).stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// Starts workers, kills some of them and starts these again, until all have ended by themselves.
fn kill_and_go_on(workers: &[Vec<String>], kills: usize, start: impl Fn(&[String]) -> Child) {
    let mut rng = seeded_rng(11, &["kills of workers"]);
    let mut children: Vec<Option<Child>> = workers.iter().map(|worker| Some(start(worker))).collect();
    for _ in 0..kills {
        thread::sleep(Duration::from_millis(rng.random_range(200..900)));
        let victim = rng.random_range(0..children.len());
        if let Some(child) = &mut children[victim]
            && child.try_wait().unwrap().is_none()
        {
            child.kill().unwrap();
            child.wait().unwrap();
            children[victim] = Some(start(&workers[victim]));
        }
    }
    for child in children.into_iter().flatten() {
        let code = { child }.wait().unwrap().code();
        assert_eq!(code, Some(0));
    }
}

fn flags(flags: &[&str]) -> Vec<String> {
    flags.iter().map(|flag| (*flag).to_owned()).collect()
}

fn borrowed(flags: &[String]) -> Vec<&str> {
    flags.iter().map(String::as_str).collect()
}

/// Merges the run of one worker and that of the killed workers, and asserts that the files are the same.
fn merge_to_the_same(whole: &Stage, killed: &Stage) {
    let merged = |stage: &Stage, out: &str| {
        assert_eq!(stage.building.wayword(&["runs", "merge", out]).code, Some(0));
        let mut files = results(&stage.building.path(out));
        // The addresses of the two providers differ.
        files.remove(Path::new("config.toml"));
        files
    };
    let (one, big) = (merged(whole, "one"), merged(killed, "big"));
    assert_eq!(big.keys().collect::<Vec<_>>(), one.keys().collect::<Vec<_>>());
    for (path, bytes) in &one {
        let lines = |bytes: &[u8]| String::from_utf8_lossy(bytes).lines().map(str::to_owned).collect::<Vec<_>>();
        let (expected, found) = (lines(bytes), lines(&big[path]));
        let differing = expected.iter().zip(&found).position(|(expected, found)| expected != found);
        let line = differing.unwrap_or_else(|| expected.len().min(found.len()));
        let (expected, found) = (expected.get(line), found.get(line));
        assert!(bytes == &big[path], "{}:{}: {found:?} instead of {expected:?}", path.display(), line + 1);
    }
}

/// Most requests that a kill can find in flight.
const IN_FLIGHT: u64 = 16;

#[test]
fn shards_with_models_that_are_killed_pay_for_each_call_once() {
    let kills = 4;
    let behaviour = ProviderBehaviour { latency: Duration::from_millis(10), ..cast() };
    let (whole, killed) = (Stage::new(behaviour.clone()), Stage::new(behaviour));
    let one = with_models(&whole, "one", &["--shard", "0/1"]).status().unwrap();
    assert_eq!(one.code(), Some(0));
    let parts = [flags(&["--shard", "0/2", "--lease-s", "0.5"]), flags(&["--shard", "1/2", "--lease-s", "0.5"])];
    let start = |part: &[String]| {
        // The sign of life of the killed worker counts for half a second.
        thread::sleep(Duration::from_millis(700));
        with_models(&killed, "big", &borrowed(part)).spawn().unwrap()
    };
    kill_and_go_on(&parts, kills, start);
    merge_to_the_same(&whole, &killed);
    assert!(whole.building.path("one/instructions.jsonl").metadata().unwrap().len() > 0);
    let log = killed.provider.log();
    let again = log.answered - log.distinct_answered();
    // Two chunks with the same call pay for it twice; a kill adds the calls in flight.
    let shared = whole.provider.log().answered - whole.provider.log().distinct_answered();
    eprintln!("{} calls, {again} paid again, {shared} of them by other chunks", log.answered);
    assert!(again <= shared + kills as u64 * IN_FLIGHT, "{again} paid again");
    holds_no_key(&killed.building.path("big"));
}

#[cfg(feature = "queue")]
mod by_queue;
#[cfg(feature = "cloud")]
mod in_stores;
#[cfg(feature = "queue")]
mod trials;
