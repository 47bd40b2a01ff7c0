//! Shared by the tests of the binary: a made-up building in its own folder, and a way to run the binary on it.

#![allow(dead_code, reason = "each test binary uses its own part")]

#[cfg(feature = "telemetry")]
pub(crate) mod collector;
pub(crate) mod scans;

pub(crate) mod models;
pub(crate) mod submissions;

use serde_json::Value;
use std::{
    collections::BTreeMap,
    ffi::OsStr,
    fs,
    net::{Ipv4Addr, SocketAddr, TcpListener},
    path::{Path, PathBuf},
    process::{Command, Stdio},
};
use tempfile::TempDir;
use wayword_formats::jsonl::{self, InstructionRecord};

/// A folder with the made-up building in `data`. Dropping it removes the folder.
pub(crate) struct Building {
    folder: TempDir,
}

/// A port that no program uses.
pub(crate) fn free_port() -> SocketAddr {
    TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap().local_addr().unwrap()
}

/// How a command ended, and what it printed.
#[derive(Debug)]
pub(crate) struct Ran {
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Building {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        wayword_testkit::write_building(&folder.path().join("data")).unwrap();
        Self { folder }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn data(&self) -> PathBuf {
        self.path("data")
    }

    pub(crate) fn reverie(&self) -> PathBuf {
        self.path("data/reverie/REVERIE_val_seen.json")
    }

    pub(crate) fn r2r(&self) -> PathBuf {
        self.path("data/r2r/R2R_val_seen.json")
    }

    /// Writes a file of this name with the items of a dataset, each of them changed. Returns the name.
    pub(crate) fn change_items(&self, dataset: &Path, change: impl Fn(&mut Value), name: &str) -> String {
        let mut items: Vec<Value> = serde_json::from_slice(&fs::read(dataset).unwrap()).unwrap();
        items.iter_mut().for_each(change);
        self.write(name, Value::from(items).to_string());
        name.to_owned()
    }

    /// `wayword ARGS` on the building, in its folder.
    pub(crate) fn command(&self, args: &[&str]) -> Command {
        let mut command = command(args);
        command.current_dir(self.folder.path());
        command
    }

    /// Runs `wayword ARGS` in the building's folder: paths in ARGS may be relative to it.
    pub(crate) fn wayword(&self, args: &[&str]) -> Ran {
        run(&mut self.command(args))
    }

    /// `wayword generate --platform matterport --data data --out OUT ARGS`.
    pub(crate) fn generate(&self, out: &str, args: &[&str]) -> Ran {
        let mut all = vec!["generate", "--platform", "matterport", "--data", "data", "--out", out];
        all.extend(args);
        self.wayword(&all)
    }

    /// A run over the REVERIE episodes in both styles, in which every text passes.
    pub(crate) fn run_over_episodes(&self, out: &str) -> Vec<InstructionRecord> {
        let ran = self.generate(out, &["--episodes", EPISODES, "--style", "reverie", "--style", "r2r"]);
        assert_eq!(ran.code, Some(0), "{ran:?}");
        self.records(out)
    }

    pub(crate) fn records(&self, run: &str) -> Vec<InstructionRecord> {
        jsonl::read_records(&self.path(run).join("instructions.jsonl")).unwrap()
    }

    pub(crate) fn lines(&self, file: &str) -> Vec<Value> {
        let text = fs::read_to_string(self.path(file)).unwrap();
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
    }

    pub(crate) fn write(&self, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, text).unwrap();
        path
    }
}

/// The REVERIE episodes, from the building's folder.
pub(crate) const EPISODES: &str = "data/reverie/REVERIE_val_seen.json";

pub(crate) fn command(args: &[impl AsRef<OsStr>]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wayword"));
    command.args(args).stdin(Stdio::null());
    command
}

pub(crate) fn run(command: &mut Command) -> Ran {
    let output = command.output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Ran { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
}

impl Ran {
    /// Standard output, which must be one JSON value.
    pub(crate) fn json(&self) -> Value {
        assert_eq!(self.out.lines().count(), 1, "{self:?}");
        serde_json::from_str(&self.out).unwrap()
    }

    /// Asserts that the command refused its input: exit code 1, one error, an empty standard output, no panic.
    pub(crate) fn refused(&self) -> &str {
        assert_eq!(self.code, Some(1), "{self:?}");
        assert_eq!(self.err.lines().filter(|line| line.starts_with("error: ")).count(), 1, "{self:?}");
        // On a busy machine a line about the progress may come first.
        let is_progress = |line: &&str| line.contains(": at work for ");
        let first = self.err.lines().find(|line| !is_progress(line));
        assert!(first.is_some_and(|line| line.starts_with("error: ")) && self.out.is_empty(), "{self:?}");
        assert!(!self.err.contains("panicked") && !self.err.contains("RUST_BACKTRACE"), "{self:?}");
        &self.err
    }
}

/// Every file below a folder with its bytes, by its path within the folder.
pub(crate) fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut left = vec![folder.to_owned()];
    while let Some(inner) = left.pop() {
        for entry in fs::read_dir(&inner).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                left.push(path);
            } else {
                found.insert(path.strip_prefix(folder).unwrap().to_owned(), fs::read(&path).unwrap());
            }
        }
    }
    found
}
