//! The run folder: what a run was asked to do, and what it has done so far.
//!
//! `config.toml` as resolved, `walks.jsonl` (paths, captions and dialogues), `instructions.jsonl` (Wayword records),
//! `rejected.jsonl` (with reasons), `errors.jsonl` (what the next command tries again), `frames/`. A process that is killed leaves at most one torn last line in each file; the
//! next one cuts it off and goes on where it stopped, and the files end up the same byte for byte.

mod held;
mod journal;
pub(crate) mod lines;
mod record;

use crate::{error::Error, settings::Settings, text_file};
use serde::{Serialize, de::DeserializeOwned};
use sha2::{Digest, Sha256};
use std::{
    collections::BTreeSet,
    fs::{self, File},
    path::{Path, PathBuf},
    time::SystemTime,
};
use wayword_world::files;

use held::Held;
pub(crate) use held::hold;
pub use journal::{Journal, read_lines};
pub use record::{Map, Rejected, WalkRecord, extra};

/// A run folder that this process alone works in.
#[derive(Debug)]
pub struct RunFolder {
    folder: PathBuf,
    /// Paths and captions, one line per item.
    pub walks: Journal,
    /// Accepted instructions, one line each.
    pub instructions: Journal,
    /// Rejected ones, and items that nothing can be written for.
    pub rejected: Journal,
    /// Items that failed because a model gave nothing. It begins empty with each command, which tries them again.
    pub errors: Journal,
    /// Held for as long as the folder is worked in.
    _held: Held,
}

/// Names of the files in a run folder.
pub mod file {
    /// The settings as resolved.
    pub const CONFIG: &str = "config.toml";
    /// Paths and captions.
    pub const WALKS: &str = "walks.jsonl";
    /// Accepted instructions.
    pub const INSTRUCTIONS: &str = "instructions.jsonl";
    /// Rejected ones.
    pub const REJECTED: &str = "rejected.jsonl";
    /// Items that failed, to be tried again.
    pub const ERRORS: &str = "errors.jsonl";
    /// The name under which the ledger keeps what the run has spent.
    pub const ID: &str = "run.id";
    /// Pictures of frames.
    pub const FRAMES: &str = "frames";
    /// The report.
    pub const REPORT: &str = "report.html";
    /// Held by the process that works in the folder.
    pub const LOCK: &str = "run.lock";
    /// On a network's file system, where locks do not tell: who works in the folder.
    pub const OWNER: &str = "run.owner";
}

impl RunFolder {
    /// Opens a run folder for work: makes it, or goes on with what is there.
    ///
    /// # Errors
    /// When another process works in it or may do, it holds a run with other settings, or it cannot be written.
    pub fn open(folder: &Path, settings: &Settings) -> Result<Self, Error> {
        fs::create_dir_all(folder).map_err(Error::io(folder, "make the run folder"))?;
        let held = hold(folder)?;
        keep_config(folder, settings)?;
        Ok(Self {
            walks: Journal::open(&folder.join(file::WALKS), WalkRecord::key_of)?,
            instructions: Journal::open(&folder.join(file::INSTRUCTIONS), record::instruction_key)?,
            rejected: Journal::open(&folder.join(file::REJECTED), Rejected::key_of)?,
            errors: Journal::begin(&folder.join(file::ERRORS), Rejected::key_of)?,
            folder: folder.to_owned(),
            _held: held,
        })
    }

    /// The name under which the ledger keeps what the run has spent.
    ///
    /// # Errors
    /// When it cannot be read or written.
    pub fn id(&self) -> Result<String, Error> {
        id_of(&self.folder, "run")
    }

    /// Where pictures of frames go.
    #[must_use]
    pub fn frames(&self) -> PathBuf {
        self.folder.join(file::FRAMES)
    }

    /// Whether an item needs no more work: each style has its line, or the item itself was rejected.
    #[must_use]
    pub fn is_done(&self, item: &str, styles: &[String]) -> bool {
        let has = |style: &str| {
            let key = record::key(item, style);
            self.instructions.has(&key) || self.rejected.has(&key)
        };
        self.rejected.has(&record::key(item, "")) || styles.iter().all(|style| has(style))
    }

    /// Makes sure that what was written survives a crash of the machine.
    ///
    /// # Errors
    /// When a file cannot be flushed.
    pub fn sync(&mut self) -> Result<(), Error> {
        self.walks.sync()?;
        self.instructions.sync()?;
        self.rejected.sync()?;
        self.errors.sync()
    }
}

/// The name under which the ledger keeps what a folder's work has spent: made when it is first asked for, kept in the folder. New
/// work in the place of what was deleted has spent nothing.
///
/// # Errors
/// When it cannot be read or written.
pub(crate) fn id_of(folder: &Path, kind: &str) -> Result<String, Error> {
    let path = folder.join(file::ID);
    if path.exists() {
        return Ok(text_file::read(&path, "read the run's name")?.trim().to_owned());
    }
    let id = fresh_id(kind);
    write_whole(&path, &id)?;
    Ok(id)
}

/// A name that no other process gives: kind, time and process.
#[must_use]
pub fn fresh_id(kind: &str) -> String {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    format!("{kind}-{:x}-{:x}", since.as_micros(), std::process::id())
}

/// Writes the settings, or holds them against those that are there.
pub(crate) fn keep_config<S>(folder: &Path, settings: &S) -> Result<(), Error>
where
    S: Serialize + DeserializeOwned + PartialEq,
{
    let path = folder.join(file::CONFIG);
    if !path.exists() {
        let text = toml::to_string_pretty(settings)
            .map_err(|error| Error::usage(format!("the settings cannot be kept: {error}"), "report this as a bug"))?;
        return write_whole(&path, &text);
    }
    let before: S = config_of(folder)?;
    if before == *settings {
        return Ok(());
    }
    let differs = differing_keys(&before, settings).into_iter().collect::<Vec<_>>().join(", ");
    let problem = format!("{} holds a run with other settings ({differs})", folder.display());
    Err(Error::usage(problem, "give the same command to continue it, or another --out for a new run"))
}

/// Writes a small file that is there whole or not at all, whenever the process is killed.
pub(crate) fn write_whole(path: &Path, text: &str) -> Result<(), Error> {
    let mut temporary = path.as_os_str().to_owned();
    temporary.push(".new");
    let temporary = PathBuf::from(temporary);
    fs::write(&temporary, text).map_err(Error::io(&temporary, "write"))?;
    fs::rename(&temporary, path).map_err(Error::io(path, "write"))
}

/// The settings of a run.
///
/// # Errors
/// When the folder is no run folder.
pub fn settings_of(folder: &Path) -> Result<Settings, Error> {
    config_of(folder)
}

/// What `config.toml` of a folder holds.
pub(crate) fn config_of<S: DeserializeOwned>(folder: &Path) -> Result<S, Error> {
    let path = folder.join(file::CONFIG);
    let text = text_file::read(&path, "read the run's settings")?;
    toml::from_str(&text).map_err(|error| {
        Error::usage(
            format!("{}: {}", path.display(), error.to_string().trim()),
            "it was written by another command or another version: use another folder",
        )
    })
}

fn differing_keys<S: Serialize>(a: &S, b: &S) -> BTreeSet<String> {
    let table = |settings: &S| toml::Table::try_from(settings).unwrap_or_default();
    let (a, b) = (table(a), table(b));
    let keys: BTreeSet<&String> = a.keys().chain(b.keys()).collect();
    keys.into_iter().filter(|key| a.get(*key) != b.get(*key)).cloned().collect()
}

/// The beginning of a file's hash, for settings that only name it.
pub(crate) fn hash_of_file(file: &Path) -> Result<String, Error> {
    // A pipe would be waited for.
    let about = fs::metadata(file).map_err(Error::io(file, "read"))?;
    if let Some(reason) = files::irregular(&about) {
        return Err(Error::usage(format!("{}: it {reason}", file.display()), "name a file"));
    }
    let mut hash = Sha256::new();
    let copied = File::open(file).and_then(|mut file| std::io::copy(&mut file, &mut hash));
    copied.map_err(Error::io(file, "read"))?;
    Ok(short_hex(hash))
}

/// The first eight bytes of a hash, as text.
pub(crate) fn short_hex(hash: Sha256) -> String {
    hash.finalize().iter().take(8).map(|byte| format!("{byte:02x}")).collect()
}
