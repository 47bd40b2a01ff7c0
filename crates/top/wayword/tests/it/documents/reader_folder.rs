//! A reader's folder: what somebody has who types the documents' commands one after the other. The data in it is made up
//! here, and a provider of our own answers for models.

use crate::common::{Ran, command, models, run, scans};
use std::{
    fs,
    io::{BufRead, BufReader},
    path::{Path, PathBuf},
    process::{Child, Stdio},
    rc::Rc,
};
use tempfile::TempDir;
use wayword_testkit::{
    documents::DocumentedCommand,
    provider::{ProviderDialect, ScriptedProvider},
};

/// How much of what the documents show is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RunExtent {
    /// With small numbers, and without what is slow all the same.
    Quick,
    /// With the numbers that stand there, on the data of `WAYWORD_DATA` if it is set.
    Whole,
}

/// Words of commands that take more than some seconds even with small numbers.
const SLOW: [&str; 8] = [
    "robustness",
    "perceive",
    "--format steps",
    "house --",
    "--platform habitat",
    "runs/models",
    "runs/changed",
    "view path",
];
/// The largest values of a quick run.
const AT_MOST: [(&str, u32); 8] = [
    ("--paths", 4),
    ("--views", 5),
    ("--smooth", 1),
    ("--items", 2),
    ("--limit", 4),
    ("--houses", 2),
    ("--per-item", 1),
    ("--width", 160),
];
/// Providers of the documents whose models our own provider plays, and its dialect for them.
const PLAYED_PROVIDERS: [(&str, ProviderDialect); 2] =
    [("ollama/", ProviderDialect::Ollama), ("openai/", ProviderDialect::OpenAi)];

/// The folder, and the provider that plays the documents' models.
pub(super) struct ReaderFolder {
    folder: TempDir,
    provider: Rc<ScriptedProvider>,
    extent: RunExtent,
}

impl ReaderFolder {
    /// A folder with the data that the documents name: `DATA`, `SCENES` and `GRAPHS`, and files of R2R and REVERIE.
    pub(super) fn new(extent: RunExtent) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let data = folder.path().join("DATA");
        match std::env::var_os("WAYWORD_DATA").filter(|_| extent == RunExtent::Whole) {
            Some(real) => std::os::unix::fs::symlink(fs::canonicalize(real).unwrap(), &data).unwrap(),
            None => {
                wayword_testkit::write_building(&data).unwrap();
                wayword_testkit::write_distinct_skyboxes(&data).unwrap();
            }
        }
        for (set, file) in [("r2r", "R2R_val_seen.json"), ("reverie", "REVERIE_val_seen.json")] {
            fs::copy(data.join(set).join(file), folder.path().join(file)).unwrap();
        }
        write_scenes(folder.path());
        let provider = Rc::new(ScriptedProvider::start(models::cast_as(["qwen3", "llava", "gpt-4.1-mini"])).unwrap());
        let reader = Self { folder, provider, extent };
        reader.prepare(&["view", "path", "--scan", "house2-3", "--width", "160", "--out", "walk.mp4"]);
        let words = run(command(&["study", "texts"]).current_dir(reader.path()));
        fs::write(reader.path().join("de.toml"), words.out).unwrap();
        if extent == RunExtent::Whole {
            reader.write_episodes();
        }
        reader
    }

    /// Episodes in the scenes with graphs.
    fn write_episodes(&self) {
        let platform = ["--platform", "habitat", "--data", "SCENES", "--connectivity", "GRAPHS"];
        let style = ["--paths", "2", "--hops", "2..4", "--style", "r2r", "--out", "prepared"];
        self.prepare(&[&["generate"], &platform[..], &style[..]].concat());
        self.prepare(&["export", "--run", "prepared", "--style", "r2r", "--format", "r2r", "--out", "EPISODES.json"]);
    }

    /// Runs a command that no document has.
    fn prepare(&self, args: &[&str]) {
        let ran = run(command(args).current_dir(self.path()));
        assert_eq!(ran.code, Some(0), "{ran:?}");
    }

    /// A folder of its own with what is in this one.
    pub(super) fn copy(&self) -> Self {
        let folder = tempfile::tempdir().unwrap();
        copy_files(self.path(), folder.path());
        Self { folder, provider: Rc::clone(&self.provider), extent: self.extent }
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Whether a command within a paragraph stands for others: it has a word such as FILE that is nothing in the folder.
    pub(super) fn is_a_form(&self, documented: &DocumentedCommand) -> bool {
        let is_placeholder = |word: &str| word.len() > 1 && word.chars().all(|letter| letter.is_ascii_uppercase());
        documented.is_within_text
            && documented.args.iter().any(|arg| is_placeholder(arg) && !self.path().join(arg).exists())
    }

    /// Whether a quick run leaves the command out.
    pub(super) fn is_too_slow(&self, documented: &DocumentedCommand) -> bool {
        let line = documented.args.join(" ");
        self.extent == RunExtent::Quick && SLOW.iter().any(|word| line.contains(word))
    }

    /// Runs a command. One that serves pages runs until it has its address.
    pub(super) fn run(&self, documented: &DocumentedCommand) -> Ran {
        let mut args = runnable(&documented.args);
        if self.extent == RunExtent::Quick {
            shrink_numbers(&mut args);
        }
        for (name, dialect) in PLAYED_PROVIDERS {
            if args.iter().any(|arg| arg.starts_with(name)) {
                args.extend(["--base-url".to_owned(), self.provider.base_url(dialect)]);
            }
        }
        let mut ended = self.run_args(&args, documented);
        if let Some(at) = args.iter().position(|arg| arg == "0/2") {
            // The other worker's part of the run.
            args[at] = "1/2".to_owned();
            ended = self.run_args(&args, documented);
        }
        ended
    }

    fn run_args(&self, args: &[String], documented: &DocumentedCommand) -> Ran {
        let mut process = command(args);
        process.current_dir(self.path()).envs(documented.variables.clone());
        process.env("XDG_DATA_HOME", self.path().join("data")).env("WAYWORD_OFFLINE", "1");
        process.env("OPENAI_API_KEY", models::KEY);
        if !args.iter().any(|arg| arg == "serve") {
            return run(&mut process);
        }
        let served = Served(process.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap());
        served.wait_for_address()
    }
}

/// A server that is stopped when the test is done with it.
struct Served(Child);

impl Served {
    fn wait_for_address(mut self) -> Ran {
        let out = self.0.stdout.take().map(BufReader::new).unwrap();
        let address = out.lines().map_while(Result::ok).find(|line| line.contains("http"));
        Ran { code: address.as_ref().map(|_| 0), out: address.unwrap_or_default(), err: String::new() }
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Copies all files below a folder into another.
fn copy_files(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let (old, new) = (entry.path(), to.join(entry.file_name()));
        if old.is_symlink() {
            std::os::unix::fs::symlink(fs::read_link(&old).unwrap(), &new).unwrap();
        } else if old.is_dir() {
            copy_files(&old, &new);
        } else {
            fs::copy(&old, &new).unwrap();
        }
    }
}

/// Scans of Habitat's, one of them where a reader has HM3D, with viewpoint graphs and episodes.
fn write_scenes(folder: &Path) {
    for (name, house) in ["hall", "flat"].into_iter().zip(scans::flats()) {
        scans::write_scan(&house, &folder.join("SCENES"), name, ".glb");
        scans::write_scan(&house, &folder.join("data/scene_datasets/hm3d/minival"), name, ".glb");
        let graph = scans::connectivity(&scans::graph_of(&house), |place| place);
        let file: PathBuf = folder.join("GRAPHS").join(format!("{name}_connectivity.json"));
        fs::create_dir_all(folder.join("GRAPHS")).unwrap();
        fs::write(file, graph.to_string()).unwrap();
    }
}

/// The command for one of two workers instead of many, and without `--watch`, which never ends.
fn runnable(args: &[String]) -> Vec<String> {
    let mut runnable: Vec<String> = args.iter().filter(|arg| *arg != "--watch").cloned().collect();
    for arg in &mut runnable {
        // A run for a cluster.
        if arg == "100000" {
            *arg = "8".to_owned();
        }
    }
    if let Some(at) = runnable.iter().position(|arg| arg == "--shard").filter(|at| runnable[at + 1].contains('/')) {
        runnable[at + 1] = "0/2".to_owned();
        runnable.extend(["--chunk".to_owned(), "1".to_owned()]);
    }
    runnable
}

fn shrink_numbers(args: &mut [String]) {
    for at in 1..args.len() {
        let most = AT_MOST.iter().find(|(flag, _)| *flag == args[at - 1]).map(|(_, most)| *most);
        if let Some(most) = most.filter(|most| args[at].parse::<u32>().is_ok_and(|asked| asked > *most)) {
            args[at] = most.to_string();
        }
    }
}
