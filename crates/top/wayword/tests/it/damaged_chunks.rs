//! Chunks of a run that were damaged after they were finished: each is named, nothing is merged, and they can be made again.
//! Also the warnings of workers beforehand, and the last lines of a run.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::{Building, EPISODES, Ran, files};
use rand::Rng;
use serde_json::{Value, json};
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::Command,
};
use wayword_core::seeded_rng;

const RUN: [&str; 6] = ["--episodes", EPISODES, "--style", "r2r", "--chunk", "2"];
const LINE_FILES: [&str; 4] = ["walks.jsonl", "instructions.jsonl", "rejected.jsonl", "errors.jsonl"];

fn worker(building: &Building, out: &str, part: &str) -> Ran {
    building.generate(out, &[&RUN[..], &["--shard", part]].concat())
}

/// A building with a finished run `big` of several chunks, and the same run `one` of one machine.
fn stage() -> Building {
    let building = Building::new();
    assert_eq!(building.generate("one", &RUN[..4]).code, Some(0));
    assert_eq!(worker(&building, "big", "0/1").code, Some(0));
    building
}

/// The merged files of a run.
fn merged(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = files(folder);
    let apart = ["run.lock", "run.id", "plan.json", "workers.json"];
    files.retain(|path, _| {
        !apart.iter().any(|name| path == Path::new(name)) && !path.starts_with("chunks") && !path.starts_with("workers")
    });
    files
}

fn damaged_chunks(ran: &Ran) -> Vec<u64> {
    let mut chunks: Vec<u64> =
        ran.json()["damaged"].as_array().unwrap().iter().map(|damage| damage["chunk"].as_u64().unwrap()).collect();
    chunks.dedup();
    chunks
}

fn copy_tree(from: &Path, to: &Path) {
    for (path, bytes) in files(from) {
        let to = to.join(path);
        fs::create_dir_all(to.parent().unwrap()).unwrap();
        fs::write(to, bytes).unwrap();
    }
}

#[test]
fn no_damaged_chunk_is_merged_and_each_is_named() {
    let building = stage();
    let chunks = building.path("big/chunks");
    let kept = building.path("kept");
    copy_tree(&chunks, &kept);
    let mut rng = seeded_rng(3, &["damaged chunks"]);
    for number in 0..28 {
        let (chunk, name) = (rng.random_range(0..2_usize), LINE_FILES[number / 7 % 2]);
        let file = chunks.join(format!("{chunk:06}")).join(name);
        let bytes = fs::read(&file).unwrap();
        let mut named = vec![chunk as u64];
        match number % 7 {
            0 => fs::write(&file, &bytes[..rng.random_range(1..bytes.len())]).unwrap(),
            1 => fs::write(&file, "").unwrap(),
            2 => fs::remove_file(&file).unwrap(),
            3 => fs::write(&file, [&bytes[..], &bytes[..]].concat()).unwrap(),
            4 => {
                let mut bytes = bytes.clone();
                let at = rng.random_range(0..bytes.len());
                bytes[at] ^= 1;
                fs::write(&file, bytes).unwrap();
            }
            5 => {
                let other = chunks.join(format!("{:06}", 1 - chunk)).join(name);
                fs::write(&file, fs::read(&other).unwrap()).unwrap();
                fs::write(&other, &bytes).unwrap();
                named = vec![0, 1];
            }
            _ => fs::write(&file, fs::read(building.path("one").join(name)).unwrap()).unwrap(),
        }
        let ran = building.wayword(&["runs", "merge", "big", "--json"]);
        assert_eq!((ran.code, damaged_chunks(&ran)), (Some(1), named.clone()), "{number}: {ran:?}");
        assert_eq!(ran.json()["merged"], 0);
        assert!(ran.err.contains("nothing was merged") && ran.err.contains("runs retry big --damaged"), "{ran:?}");
        assert!(!building.path("big/config.toml").exists() && !building.path("big/walks.jsonl").exists());
        let status = building.wayword(&["runs", "status", "big", "--json"]);
        assert_eq!((status.code, damaged_chunks(&status)), (Some(0), named), "{number}: {status:?}");
        fs::remove_dir_all(&chunks).unwrap();
        copy_tree(&kept, &chunks);
    }
    let shown = building.wayword(&["runs", "status", "big"]);
    assert!(!shown.out.contains("damaged"), "{shown:?}");
    assert_eq!(building.wayword(&["runs", "merge", "big"]).code, Some(0));
    assert!(merged(&building.path("big")) == merged(&building.path("one")));
}

#[test]
fn damaged_chunks_are_made_again_and_their_old_files_stay() {
    let building = stage();
    let text = building.path("big/chunks/000001/instructions.jsonl");
    let edited = fs::read_to_string(&text).unwrap().replace("Walk", "Crawl").replace("Go", "Crawl");
    fs::write(&text, &edited).unwrap();
    fs::write(building.path("big/chunks/000000.done"), "{\"chunk\":").unwrap();
    let merge = building.wayword(&["runs", "merge", "big"]);
    assert_eq!(merge.code, Some(1), "{merge:?}");
    assert!(merge.out.contains("chunk 0: chunks/000000.done: ") && merge.out.contains("chunk 1: "), "{merge:?}");
    let retried = building.wayword(&["runs", "retry", "big", "--damaged", "--json"]).json();
    assert_eq!(retried["chunks"], json!([0, 1]));
    assert_eq!(fs::read_to_string(building.path("big/chunks/000001.damaged-1/instructions.jsonl")).unwrap(), edited);
    let unfinished = building.wayword(&["runs", "merge", "big"]);
    assert!(unfinished.refused().contains("not finished"), "{unfinished:?}");
    assert_eq!(worker(&building, "big", "0/1").code, Some(0));
    assert_eq!(building.wayword(&["runs", "merge", "big"]).code, Some(0));
    assert!(merged(&building.path("big")) == merged(&building.path("one")));
    let none = building.wayword(&["runs", "retry", "big", "--damaged"]);
    assert!(none.out.contains("no finished chunk is damaged"), "{none:?}");
    let beyond = building.wayword(&["runs", "retry", "big", "--chunk", "99"]);
    assert!(beyond.refused().contains("--chunk 99"), "{beyond:?}");
    // Also a chunk that is whole can be made anew.
    let anew = building.wayword(&["runs", "retry", "big", "--chunk", "0", "--json"]).json();
    assert_eq!(anew["chunks"], json!([0]));
    assert_eq!(building.wayword(&["runs", "retry", "big"]).code, Some(2));
}

#[test]
fn marks_of_older_versions_are_read_and_compared_by_counts() {
    let building = stage();
    for chunk in ["000000", "000001"] {
        let mark = building.path(&format!("big/chunks/{chunk}.done"));
        let mut record: Value = serde_json::from_slice(&fs::read(&mark).unwrap()).unwrap();
        for new in ["run", "files"] {
            assert!(record.as_object_mut().unwrap().remove(new).is_some());
        }
        fs::write(mark, record.to_string()).unwrap();
    }
    let status = building.wayword(&["runs", "status", "big"]);
    assert!(status.out.contains("their marks hold no hashes"), "{status:?}");
    let walks = building.path("big/chunks/000000/walks.jsonl");
    let whole = fs::read(&walks).unwrap();
    fs::write(&walks, &whole[..whole.len() - 1]).unwrap();
    assert_eq!(damaged_chunks(&building.wayword(&["runs", "merge", "big", "--json"])), [0]);
    fs::write(&walks, whole).unwrap();
    let merge = building.wayword(&["runs", "merge", "big"]);
    assert!(merge.code == Some(0) && merge.out.contains("only counts and names were compared"), "{merge:?}");
    assert!(merged(&building.path("big")) == merged(&building.path("one")));
}

#[test]
fn workers_without_work_are_told_beforehand() {
    let building = Building::new();
    let few = ["--episodes", EPISODES, "--style", "r2r", "--shard", "1/2"];
    assert!(!building.generate("even", &few).err.contains("workers share"));
    let told = building.generate("few", &[&few[..], &["--chunk", "64"]].concat());
    assert_eq!(told.code, Some(0), "{told:?}");
    assert!(told.err.contains("2 workers share 1 chunk") && told.err.contains("--chunk "), "{told:?}");
    // The plan is there: it is told before anything else.
    let again = building.generate("few", &few);
    assert!(again.err.starts_with("warning: 2 workers") && again.err.contains("another --out"), "{again:?}");
    let enough = building.generate("more", &[&RUN[..], &["--shard", "1/2"]].concat());
    assert!(!enough.err.contains("workers share"), "{enough:?}");
    let launch = |command: &[&str]| {
        let head = ["launch", "slurm", "--workers", "3", "--time", "1:00:00", "--", "generate", "--out", "big"];
        building.wayword(&[&head[..], command].concat())
    };
    assert!(!launch(&["--paths", "100"]).err.contains("workers share"));
    let script = launch(&["--paths", "100", "--queue", "wayword_db"]);
    assert!(script.code == Some(0) && script.out.starts_with("#!"), "{script:?}");
    assert!(script.err.contains("3 workers share 2 chunks") && script.err.contains("--chunk 34 "), "{script:?}");
    assert!(!launch(&["--paths", "1000"]).err.contains("workers share"));
    assert!(launch(&["--paths", "1000", "--limit", "2"]).err.contains("at most 2 workers"));
}

#[cfg(target_os = "linux")]
#[test]
fn the_part_of_a_worker_that_has_ended_is_free_at_once_on_its_machine() {
    let building = Building::new();
    assert_eq!(building.generate("big", &[&RUN[..], &["--plan"]].concat()).code, Some(0));
    let mut other = Command::new("sleep").arg("600").spawn().unwrap();
    let read = |path: &str| fs::read_to_string(path).unwrap().trim().to_owned();
    let stat = read(&format!("/proc/{}/stat", other.id()));
    let began = stat.rsplit_once(')').unwrap().1.split_whitespace().nth(19).unwrap().to_owned();
    let namespace = fs::read_link("/proc/self/ns/pid").unwrap();
    let place = format!("{} {}", read("/proc/sys/kernel/random/boot_id"), namespace.display());
    let process = json!({"host": "here", "place": place, "pid": other.id(), "began": began});
    let beat = json!({"worker": "here-1", "token": "t", "part": "shard 0/2", "process": process});
    fs::create_dir_all(building.path("big/workers")).unwrap();
    building.write("big/workers/shard-0-of-2", beat.to_string());
    assert_eq!(worker(&building, "big", "0/2").code, Some(4), "it lives");
    other.kill().unwrap();
    other.wait().unwrap();
    let status = building.wayword(&["runs", "status", "big", "--json"]).json();
    assert_eq!(status["workers"][0]["is_fresh"], false, "{status}");
    assert_eq!(worker(&building, "big", "0/2").code, Some(0), "its last sign of life is a moment ago");
}

#[test]
fn paths_lie_in_as_many_houses_as_asked_for() {
    let building = Building::new();
    let run = |out: &str, more: &[&str]| {
        let head = ["generate", "--style", "r2r", "--no-pictures", "--candidates", "1", "--out", out];
        building.wayword(&[&head[..], more].concat())
    };
    let ran = run("houses", &["--paths", "3", "--houses", "3", "--seed", "5"]);
    assert!(matches!(ran.code, Some(0 | 3)), "{ran:?}");
    assert!(ran.err.contains("3 paths through 3 houses, 1 each"), "{ran:?}");
    let scenes: Vec<Value> =
        building.lines("houses/walks.jsonl").iter().map(|walk| walk["path"]["scene"].clone()).collect();
    assert_eq!(scenes, ["house2-5", "house2-6", "house2-7"]);
    let again = run("houses", &["--paths", "3", "--houses", "3", "--seed", "5"]);
    assert!(again.err.contains("3 of 3 items done and kept"), "{again:?}");
    let other = run("houses", &["--paths", "3", "--houses", "2", "--seed", "5"]);
    assert!(other.refused().contains("houses (3 before, 2 now)"), "{other:?}");
    let fewer = run("houses", &["--paths", "2", "--houses", "2", "--seed", "5"]);
    let told = fewer.refused();
    assert!(told.contains("3 paths, but 2 are asked for") && told.contains("(3 items)"), "{told}");
    assert!(told.contains("wayword export --run houses"), "{told}");
    let dry = building.wayword(&["generate", "--paths", "500", "--dry-run"]);
    assert!(dry.err.contains("500 paths through 20 houses, 25 each; --houses 500"), "{dry:?}");
    let elsewhere = building.generate("elsewhere", &["--paths", "3", "--houses", "3"]);
    assert!(elsewhere.refused().contains("the platform is matterport"), "{elsewhere:?}");
}

#[test]
fn a_run_that_ends_with_loss_says_so_in_its_last_line() {
    let building = Building::new();
    let style = "name = \"long\"\nreferences = [\"Walk to the bed. Stop.\"]\n[constraints]\nmin_sentences = 40\n";
    building.write("long.toml", style);
    let args = ["--episodes", EPISODES, "--style", "long.toml", "--candidates", "1", "--repairs", "0"];
    let ran = building.generate("run", &args);
    assert_eq!(ran.code, Some(3), "{ran:?}");
    let last = ran.out.trim_end().lines().last().unwrap();
    assert!(last.starts_with("exit code 3: ") && last.contains("run/rejected.jsonl"), "{last}");
    // A torn line is what a kill leaves; an exporter explains how to mend it.
    let good = ["--episodes", EPISODES, "--style", "r2r"];
    assert_eq!(building.generate("good", &good).code, Some(0));
    let texts = building.path("good/instructions.jsonl");
    let whole = fs::read(&texts).unwrap();
    fs::write(&texts, &whole[..whole.len() - 9]).unwrap();
    let export = building.wayword(&["export", "--run", "good", "--format", "r2r", "--style", "r2r", "--out", "x.json"]);
    assert!(export.refused().contains("its last line is not whole"), "{export:?}");
    assert_eq!(building.generate("good", &good).code, Some(0));
    assert!(fs::read(&texts).unwrap() == whole);
}
