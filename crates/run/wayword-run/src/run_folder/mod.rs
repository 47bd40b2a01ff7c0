//! The run folder: the settings of a run, and its results so far.
//!
//! It holds `config.toml` (the settings as resolved), `walks.jsonl` (paths, captions and dialogues),
//! `instructions.jsonl` (Wayword records), `rejected.jsonl` (texts that failed a check, with reasons), `errors.jsonl`
//! (items that failed; the next command tries them again), `data.json` (hashes of the scenes' files) and `frames/`. A
//! process that is killed leaves at most one incomplete last line in each file; the next process cuts it off and goes
//! on where the first stopped. At the end the lines are sorted, so the files are the same byte for byte however often
//! the run was stopped.

mod config;
mod cost;
mod expected;
mod folder_lock;
mod journal;
mod line_check;
pub mod lines;
mod record;
mod setting_differences;
mod world_data;

use crate::{
    error::CommandError, item::RunItem, pictures, settings::RunSettings, text_file, written_files::write_file,
};
use serde::{Deserialize, de::IgnoredAny};
use sha2::{Digest, Sha256};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs::{self, File},
    path::{Path, PathBuf},
    time::SystemTime,
};
use wayword_core::hex_text;
use wayword_world::files;

use config::keep_settings;
pub use config::{config_text, is_comparison, keep_config, read_config, refuse_other_format, refuse_unmerged};
pub use config::{continued_settings, is_begun, read_run_settings};
pub use cost::{ItemCalls, TextCost};
pub use expected::{expect_run, expect_run_place, expect_texts};
pub use folder_lock::{FolderLock, lock_folder};
pub use journal::{Journal, read_lines};
pub use line_check::{refuse_edited_lines, refuse_repeated_lines, refuse_torn_line};
pub use record::{FailedItem, PathMap, RejectedText, WalkRecord};
pub use record::{extra_fields, number_of_text, text_file_name, text_label, text_name};
pub use setting_differences::setting_differences;
pub use world_data::WorldData;
pub(crate) use world_data::scene_hashes;

/// A run folder in which only this process works.
#[derive(Debug)]
pub struct RunFolder {
    folder: PathBuf,
    /// Paths and captions, one line per item.
    pub walks: Journal,
    /// Accepted instructions, one line each.
    pub instructions: Journal,
    /// Texts that failed their checks.
    pub rejected: Journal,
    /// Items that failed. Each command empties it at the start, and tries them again.
    pub errors: Journal,
    /// Items that failed in the command before this one.
    failed_before: BTreeSet<String>,
    /// Items that have a line in `walks.jsonl`, but not all the pictures that belong to it.
    without_pictures: BTreeSet<String>,
    /// Keeps other processes out for as long as this lives.
    _held: Option<FolderLock>,
}

/// Names of the files in a run folder.
pub mod file {
    /// The settings as resolved.
    pub const CONFIG: &str = "config.toml";
    /// Paths and captions.
    pub const WALKS: &str = "walks.jsonl";
    /// Accepted instructions.
    pub const INSTRUCTIONS: &str = "instructions.jsonl";
    /// Texts that failed their checks.
    pub const REJECTED: &str = "rejected.jsonl";
    /// Items that failed, to be tried again.
    pub const ERRORS: &str = "errors.jsonl";
    /// The name under which the ledger keeps the run's spending.
    pub const ID: &str = "run.id";
    /// Hashes of the files that scenes are read from.
    pub const DATA: &str = "data.json";
    /// Pictures of frames.
    pub const FRAMES: &str = "frames";
    /// The report.
    pub const REPORT: &str = "report.html";
    /// Locked by the process that works in the folder.
    pub const LOCK: &str = "run.lock";
    /// Names the process at work in the folder, on network file systems, where locks are not reliable.
    pub const OWNER: &str = "run.owner";
}

/// The files of a run, pages and pictures left out: without them it is not whole.
pub fn files_of_run(folder: &Path) -> impl Iterator<Item = PathBuf> + '_ {
    use file::{CONFIG, DATA, ERRORS, ID, INSTRUCTIONS, LOCK, OWNER, REJECTED, WALKS};
    [CONFIG, WALKS, INSTRUCTIONS, REJECTED, ERRORS, ID, DATA, LOCK, OWNER].into_iter().map(|name| folder.join(name))
}

impl RunFolder {
    /// Opens a run folder for work: makes it, or continues the run in it.
    ///
    /// # Errors
    /// When another process works in it or may do, it holds a run with other settings, or it cannot be written.
    pub fn open(folder: &Path, settings: &RunSettings) -> Result<Self, CommandError> {
        fs::create_dir_all(folder).map_err(CommandError::io(folder, "make the run folder"))?;
        let held = lock_folder(folder)?;
        Self::with_lock(folder, settings, Some(held))
    }

    /// Opens the folder of a chunk. It is not locked, because only one worker knows its name, and because locks are not reliable
    /// on network file systems.
    ///
    /// # Errors
    /// When it holds a run with other settings, or it cannot be written.
    pub(crate) fn open_for_chunk(folder: &Path, settings: &RunSettings) -> Result<Self, CommandError> {
        fs::create_dir_all(folder).map_err(CommandError::io(folder, "make the chunk's folder"))?;
        Self::with_lock(folder, settings, None)
    }

    /// Opens the files of a folder after a check of its settings.
    fn with_lock(folder: &Path, settings: &RunSettings, held: Option<FolderLock>) -> Result<Self, CommandError> {
        keep_settings(folder, settings)?;
        refuse_edited_lines(folder)?;
        let walks = folder.join(file::WALKS);
        Ok(Self {
            failed_before: failed_item_ids(&folder.join(file::ERRORS))?,
            without_pictures: without_pictures(&walks, &folder.join(file::FRAMES))?,
            walks: Journal::open(&walks, WalkRecord::key_of)?,
            instructions: Journal::open(&folder.join(file::INSTRUCTIONS), record::instruction_key)?,
            rejected: Journal::open(&folder.join(file::REJECTED), RejectedText::key_of)?,
            errors: Journal::begin_empty(&folder.join(file::ERRORS), FailedItem::key_of)?,
            folder: folder.to_owned(),
            _held: held,
        })
    }

    /// Where pictures of frames go.
    #[must_use]
    pub fn frames_folder(&self) -> PathBuf {
        self.folder.join(file::FRAMES)
    }

    /// Whether an item needs no more work: its path and pictures are there, and each of its texts has a line. `texts`
    /// are the names of the texts of an item, as [`text_name`] makes them.
    #[must_use]
    fn is_done(&self, item: &str, texts: &[String]) -> bool {
        let has = |text: &str| {
            let key = record::line_key(item, text);
            self.instructions.has_key(&key) || self.rejected.has_key(&key)
        };
        self.walks.has_key(item) && !self.without_pictures.contains(item) && texts.iter().all(|text| has(text))
    }

    /// The items that need more work, where `texts` are the names of the texts of an item. Those that failed last time
    /// come last, so that they do not hold up the others.
    #[must_use]
    pub fn items_left<'a>(&self, items: &'a [RunItem], texts: &[String]) -> Vec<&'a RunItem> {
        let left = items.iter().filter(|item| !self.is_done(&item.id(), texts));
        let (failed, mut left): (Vec<&RunItem>, Vec<&RunItem>) =
            left.partition(|item| self.failed_before.contains(&item.id()));
        left.extend(failed);
        left
    }

    /// Sorts the lines of all files by item and text. Without this, an item that failed at first and was made later
    /// would come after its successors.
    ///
    /// # Errors
    /// When a file cannot be read or written.
    pub fn arrange_lines<'a>(
        &mut self,
        items: impl Iterator<Item = &'a RunItem>,
        texts: &[String],
    ) -> Result<(), CommandError> {
        let places: BTreeMap<String, usize> = items.enumerate().map(|(place, item)| (item.id(), place)).collect();
        let place = |key: &str| {
            let (item, text) = record::key_parts(key);
            // An item that is not among these stays, at the end.
            let item = places.get(item).copied().unwrap_or(places.len());
            match text {
                None => Some(item),
                // A rejection of a whole item, as older versions wrote it. This version has tried the item again.
                Some("") => None,
                Some(text) => {
                    let text = texts.iter().position(|other| other == text).unwrap_or(texts.len());
                    Some(item * (texts.len() + 1) + text)
                }
            }
        };
        self.walks.arrange_by(place)?;
        self.instructions.arrange_by(place)?;
        self.rejected.arrange_by(place)
    }

    /// Flushes all files to the disk, so that they survive a crash of the machine.
    ///
    /// # Errors
    /// When a file cannot be flushed.
    pub fn sync(&mut self) -> Result<(), CommandError> {
        self.walks.sync()?;
        self.instructions.sync()?;
        self.rejected.sync()?;
        self.errors.sync()
    }
}

/// The name under which the ledger keeps a folder's spending: the one that the folder keeps, else a new one. This function does
/// not write it, so that models can be loaded before the folder is made; [`keep_id`] does. A new run in place of a deleted one
/// has another name, so it starts without spending.
///
/// # Errors
/// When it cannot be read.
pub fn run_id_or_fresh(folder: &Path, kind: &str) -> Result<String, CommandError> {
    Ok(kept_id(folder)?.unwrap_or_else(|| fresh_id(kind)))
}

/// Keeps in a folder the name under which the ledger keeps its spending.
///
/// # Errors
/// When it cannot be read or written, or another process has kept its own since [`run_id_or_fresh`] gave this one.
pub fn keep_id(folder: &Path, id: &str) -> Result<(), CommandError> {
    match kept_id(folder)? {
        None => write_file(&folder.join(file::ID), id),
        Some(kept) if kept == id => Ok(()),
        Some(_) => Err(CommandError::Busy(folder.to_owned())),
    }
}

fn kept_id(folder: &Path) -> Result<Option<String>, CommandError> {
    let path = folder.join(file::ID);
    let read = || text_file::read_text_file(&path, "read the run's name");
    if path.exists() { Ok(Some(read()?.trim().to_owned())) } else { Ok(None) }
}

/// The items in `errors.jsonl`.
fn failed_item_ids(errors: &Path) -> Result<BTreeSet<String>, CommandError> {
    let mut keys = BTreeSet::new();
    lines::each_line(errors, |line| {
        keys.extend(FailedItem::key_of(&line.parse()?));
        Ok(())
    })?;
    Ok(keys)
}

/// The items in `walks.jsonl` of which a picture is missing.
fn without_pictures(walks: &Path, frames: &Path) -> Result<BTreeSet<String>, CommandError> {
    let mut without = BTreeSet::new();
    lines::each_line(walks, |line| {
        let PicturedLine { path: PicturedPath { id, frames: of_path }, has_pictures } = line.parse()?;
        let is_there = |frame: usize| {
            fs::metadata(pictures::picture_file(frames, &id, frame)).is_ok_and(|metadata| metadata.len() > 0)
        };
        if has_pictures && !(0..of_path.len()).all(is_there) {
            without.insert(id);
        }
        Ok(())
    })?;
    Ok(without)
}

/// The fields of a line of `walks.jsonl` from which the expected pictures follow.
#[derive(Deserialize)]
struct PicturedLine {
    path: PicturedPath,
    has_pictures: bool,
}

#[derive(Deserialize)]
struct PicturedPath {
    id: String,
    frames: Vec<IgnoredAny>,
}

/// A name that no other process makes: kind, time and process.
#[must_use]
pub fn fresh_id(kind: &str) -> String {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    format!("{kind}-{:x}-{:x}", since.as_micros(), std::process::id())
}

/// The beginning of the hash of an input file.
pub fn hash_of_file(file: &Path) -> Result<String, CommandError> {
    // Reading a pipe would wait for ever.
    let about = fs::metadata(file).map_err(CommandError::io(file, "read"))?;
    if let Some(reason) = files::describe_irregular(&about) {
        return Err(CommandError::usage(format!("{}: it {reason}", file.display()), "name a file"));
    }
    let mut hash = Sha256::new();
    let copied = File::open(file).and_then(|mut file| std::io::copy(&mut file, &mut hash));
    copied.map_err(CommandError::io(file, "read"))?;
    Ok(short_hex(hash))
}

/// The first eight bytes of a hash, as text.
pub fn short_hex(hash: Sha256) -> String {
    hex_text(&hash.finalize()[..8])
}
