//! A fetch that was killed.

#![cfg(feature = "cloud")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::{
    fs,
    io::{BufRead, BufReader},
    path::Path,
    process::{Command, Stdio},
    sync::Mutex,
};
use wayword_queue::cloud::{CloudBucket, FetchSummary};

const FILES: usize = 40;
const SIZE: usize = 4_000_000;

fn bucket(folder: &Path) -> CloudBucket {
    CloudBucket::open(&format!("file://{}/store", folder.display())).unwrap()
}

fn fetch(folder: &Path, progress: &dyn Fn(u64, u64)) -> FetchSummary {
    bucket(folder).fetch_folder("data", &folder.join("here"), 1 << 40, progress).unwrap()
}

/// The names in the folder, without the index and its lock.
fn names_in(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap());
    names.filter(|name| !name.starts_with(".wayword-fetched")).collect()
}

#[test]
fn a_fetch_that_was_killed_leaves_whole_files_and_is_continued() {
    let folder = tempfile::tempdir().unwrap();
    for number in 0..FILES {
        bucket(folder.path()).put_object(&format!("data/{number}"), vec![7; SIZE]).unwrap();
    }
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "cloud_killed::fetches", "--ignored", "--nocapture"])
        .env("WAYWORD_TEST_FOLDER", folder.path())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut arrived = lines.map(Result::unwrap).filter(|line| line.starts_with("arrived"));
    // The first line comes before the first file.
    assert!(arrived.nth(3).is_some());
    child.kill().unwrap();
    child.wait().unwrap();
    let here = folder.path().join("here");
    let whole = names_in(&here).into_iter().filter(|name| !name.ends_with("part")).collect::<Vec<_>>();
    assert!(whole.len() >= 3);
    assert!(whole.iter().all(|name| fs::read(here.join(name)).unwrap() == vec![7; SIZE]));

    let seen = Mutex::new(0);
    let fetched = fetch(folder.path(), &|done, _| *seen.lock().unwrap() = done);
    assert_eq!(fetched.files + fetched.kept, FILES);
    assert_eq!(*seen.lock().unwrap(), (FILES * SIZE) as u64);
    assert_eq!(names_in(&here).len(), FILES, "nothing unfinished is left");
    assert_eq!(fetch(folder.path(), &|_, _| {}).kept, FILES);
}

#[test]
fn of_four_fetches_into_one_folder_three_find_everything_there() {
    let folder = tempfile::tempdir().unwrap();
    for number in 0..FILES {
        bucket(folder.path()).put_object(&format!("data/{number}"), vec![7; 100_000]).unwrap();
    }
    let fetched = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                let one = fetch(folder.path(), &|_, _| {});
                fetched.lock().unwrap().push(one);
            });
        }
    });
    let files: usize = fetched.into_inner().unwrap().iter().map(|fetched| fetched.files).sum();
    assert_eq!(files, FILES, "each file is fetched once");
}

#[test]
#[ignore = "run by another test, and killed"]
fn fetches() {
    let folder = std::env::var_os("WAYWORD_TEST_FOLDER").unwrap();
    // Slow enough to be killed in between.
    fetch(Path::new(&folder), &|done, _| {
        println!("arrived {done}");
        std::thread::sleep(std::time::Duration::from_millis(20));
    });
}
