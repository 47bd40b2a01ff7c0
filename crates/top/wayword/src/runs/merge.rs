//! `wayword runs merge`: puts chunks together, to the files that one machine would have made. Chunks that do not fit their marks
//! are named, and then nothing is put together.

use super::damage::{DamagedRun, RetryPlace};
use crate::runs::args::RunsMerge;
use serde::Serialize;
use std::{
    collections::BTreeMap,
    fmt,
    fs::{self, File},
    io::{self, ErrorKind},
    path::{Path, PathBuf},
};
use wayword_formats::OutputFile;
use wayword_queue::{ChunkPlan, ChunkRecord, CompareDepth, chunk_folder};
use wayword_run::{
    count::count_phrase,
    error::{CommandError, Exit},
    generate::{CheckedChunks, ChunkChecker},
    output::CommandOutput,
    run_folder::{file, is_begun},
    stores::{self, RunPlace},
    written_files::write_file,
};

/// The files of JSON lines, which are concatenated.
const LINE_FILES: [&str; 4] = [file::WALKS, file::INSTRUCTIONS, file::REJECTED, file::ERRORS];

/// How much was put together.
#[derive(Serialize)]
struct MergeSummary {
    run: String,
    chunks: usize,
    /// Chunks that are not finished.
    missing: usize,
    written: usize,
    rejected: usize,
    failed: usize,
    /// Chunks with marks without hashes, because an older version finished them.
    #[serde(skip_serializing_if = "is_zero")]
    without_hashes: usize,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands a reference")]
fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Runs `wayword runs merge`. It only reads the chunks and replaces whole files, so it can be repeated when more chunks
/// are finished.
pub(super) fn run_merge(args: &RunsMerge, output: &CommandOutput) -> Result<Exit, CommandError> {
    let folder = args.to.as_ref().unwrap_or(&args.run);
    match &args.to {
        Some(to) => RunPlace::fetch_run(&args.run, to, output)?,
        None => stores::refuse_address(
            &args.run,
            "a run is not merged in an object store",
            "name a folder of this machine, as in --out runs/big",
        )?,
    }
    let plan = ChunkPlan::for_folder(folder)?;
    let checked = check_all(args, folder, &plan, output)?;
    let done = checked.done;
    let missing = plan.chunk_count() - done.len();
    if missing > 0 && !args.partial {
        return Err(CommandError::usage(
            format!("{}: {missing} of {} not finished", folder.display(), count_phrase(plan.chunk_count(), "chunk")),
            format!(
                "see `wayword runs status {}`; or give --partial to put together what is there",
                args.run.display()
            ),
        ));
    }
    let _held = wayword_run::run_folder::lock_folder(folder)?;
    let chunks: Vec<PathBuf> = done.iter().map(|done| chunk_folder(folder, done.chunk, done.epoch)).collect();
    let bar = output.progress_bar(chunks.len(), "chunks put together");
    merge_pictures(folder, &chunks, || bar.inc(1))?;
    for name in LINE_FILES {
        merge_lines(folder, &chunks, name)?;
    }
    merge_data(folder, &chunks)?;
    bar.finish_and_clear();
    // Written last, because a folder with this file counts as a run.
    if !is_begun(folder) {
        write_file(&folder.join(file::CONFIG), &plan.config)?;
    }
    let sum = |count: fn(&ChunkRecord) -> usize| done.iter().map(count).sum();
    let merged = MergeSummary {
        run: folder.display().to_string(),
        chunks: done.len(),
        missing,
        written: sum(|done| done.written),
        rejected: sum(|done| done.rejected),
        failed: sum(ChunkRecord::failed_items),
        without_hashes: checked.without_hashes.len(),
    };
    output.print_result(&merged, &merged);
    Ok(if missing > 0 || merged.failed > 0 { Exit::WithLoss } else { Exit::Done })
}

/// Compares all finished chunks with their marks. Damaged chunks are printed, and are an error.
fn check_all(
    args: &RunsMerge,
    folder: &Path,
    plan: &ChunkPlan,
    output: &CommandOutput,
) -> Result<CheckedChunks, CommandError> {
    let bar = output.progress_bar(plan.chunk_count(), "chunks compared");
    let checked = ChunkChecker::new(folder, plan, CompareDepth::Everything).check_chunks(|| bar.inc(1));
    bar.finish_and_clear();
    let checked = checked?;
    if checked.damaged.is_empty() {
        return Ok(checked);
    }
    let place = match &args.to {
        Some(to) => RetryPlace::Store { address: &args.run, folder: to },
        None => RetryPlace::Folder(&args.run),
    };
    let damaged = DamagedRun::new(folder, plan.chunk_count(), &checked);
    output.print_result(&damaged, &damaged);
    Err(damaged.into_error(place))
}

/// Concatenates the files of one name of all chunks.
fn merge_lines(folder: &Path, chunks: &[PathBuf], name: &str) -> Result<(), CommandError> {
    let path = folder.join(name);
    let failed = || CommandError::io(&path, "write");
    let mut all = OutputFile::begin(&path).map_err(failed())?;
    for chunk in chunks {
        let part = chunk.join(name);
        match File::open(&part) {
            Ok(mut part) => io::copy(&mut part, &mut all).map(drop).map_err(failed())?,
            Err(source) => return Err(CommandError::Io { path: part, doing: "read", source }),
        }
    }
    all.finish().map_err(failed())
}

/// Merges the hashes of scenes of all chunks (`data.json`), and refuses different hashes of one scene. A platform
/// without files has none.
fn merge_data(folder: &Path, chunks: &[PathBuf]) -> Result<(), CommandError> {
    let mut all: BTreeMap<String, String> = BTreeMap::new();
    for chunk in chunks {
        let path = chunk.join(file::DATA);
        if !path.exists() {
            continue;
        }
        let text = wayword_run::text_file::read_text_file(&path, "read the hashes of the scenes")?;
        let chunk_hashes: BTreeMap<String, String> = serde_json::from_str(&text).map_err(|error| {
            CommandError::usage(format!("{}: {error}", path.display()), "it was changed by hand: retry its chunk")
        })?;
        for (scene, hash) in chunk_hashes {
            if all.insert(scene.clone(), hash.clone()).is_some_and(|other| other != hash) {
                return Err(CommandError::ChangedScene { scene, record: path });
            }
        }
    }
    if all.is_empty() {
        return Ok(());
    }
    write_file(&folder.join(file::DATA), serde_json::to_string_pretty(&all).unwrap_or_default())
}

/// Puts the pictures of all chunks into one folder: as hard links where the disk allows that, else as copies. Calls
/// `chunk_is_done` after each chunk.
fn merge_pictures(folder: &Path, chunks: &[PathBuf], chunk_is_done: impl Fn()) -> Result<(), CommandError> {
    let frames = folder.join(file::FRAMES);
    for chunk in chunks {
        let from = chunk.join(file::FRAMES);
        let entries = match fs::read_dir(&from) {
            Ok(entries) => entries,
            Err(error) if error.kind() == ErrorKind::NotFound => continue,
            Err(source) => return Err(CommandError::Io { path: from, doing: "list", source }),
        };
        fs::create_dir_all(&frames).map_err(CommandError::io(&frames, "make the folder"))?;
        for entry in entries {
            let entry = entry.map_err(CommandError::io(&from, "list"))?;
            let to = frames.join(entry.file_name());
            match fs::hard_link(entry.path(), &to) {
                Ok(()) => {}
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(_) => fs::copy(entry.path(), &to).map(drop).map_err(CommandError::io(&to, "copy a picture to"))?,
            }
        }
        chunk_is_done();
    }
    Ok(())
}

impl fmt::Display for MergeSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { run, chunks, missing, written, rejected, failed, without_hashes } = self;
        write!(
            f,
            "{run}: {} put together: {written} written, {rejected} rejected, {failed} failed",
            count_phrase(*chunks, "chunk")
        )?;
        if *missing > 0 {
            write!(f, "; {} missing", count_phrase(*missing, "chunk"))?;
        }
        if *without_hashes > 0 {
            write!(
                f,
                "\n{} of an older version: their marks hold no hashes, so only counts and names were compared",
                count_phrase(*without_hashes, "chunk")
            )?;
        }
        match (missing, failed) {
            (0, 0) => Ok(()),
            (0, _) => write!(f, "\nexit code 3: merged, but with loss: failed items are in {run}/{}", file::ERRORS),
            _ => write!(
                f,
                "\nexit code 3: merged, but with loss: see `wayword runs status {run}` for the missing chunks"
            ),
        }
    }
}
