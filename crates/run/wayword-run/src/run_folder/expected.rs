//! Refuses what is given as a run folder and is none, with the folder that the user may mean.

use super::{file, files_of_run, is_begun, refuse_other_format, refuse_unmerged};
use crate::{
    error::CommandError,
    settings::RunSettings,
    written_files::{expect_output_folder, expect_own_folder},
};
use std::{fs, path::Path};
use wayword_queue::{CHUNKS_FOLDER, PLAN, WORKERS_FILE, WORKERS_FOLDER};

/// Most runs below a folder that an error names.
const MAX_NAMED_ITEMS: usize = 3;

/// Refuses a path that is not a run folder, and names the one that the user may mean.
///
/// # Errors
/// When it is none, or its run is not merged.
pub fn expect_run(folder: &Path) -> Result<(), CommandError> {
    if is_begun(folder) {
        return Ok(());
    }
    refuse_unmerged(folder)?;
    let name = folder.display();
    let around = folder.parent().filter(|around| folder.is_file() && is_begun(around));
    let within = runs_within(folder);
    let what = match (fs::exists(folder), folder.is_dir()) {
        (Ok(false), _) => "there is no such folder".to_owned(),
        (_, true) => format!("it is not a run folder, because it holds no {}", file::CONFIG),
        _ => "it is a file, not a run folder".to_owned(),
    };
    let hint = match around {
        Some(around) => format!("give the folder that it is in: --run {}", around.display()),
        None if !within.is_empty() => format!("name one of the runs in it: --run {}", within.join(", --run ")),
        None => "give the --out folder of a `wayword generate` or `wayword compare`".to_owned(),
    };
    Err(CommandError::usage(format!("--run {name}: {what}"), hint))
}

/// The first runs directly below a folder, by name.
fn runs_within(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut runs: Vec<_> = entries.map(|entry| entry.path()).filter(|path| is_begun(path)).collect();
    runs.sort();
    runs.iter().take(MAX_NAMED_ITEMS).map(|run| run.display().to_string()).collect()
}

/// Refuses a name that cannot be the folder of a new run or of one that goes on: see [`expect_own_folder`].
///
/// # Errors
/// As [`expect_own_folder`].
pub fn expect_run_place(folder: &Path) -> Result<(), CommandError> {
    if is_begun(folder) || folder.join(PLAN).exists() {
        return expect_output_folder(folder);
    }
    // What a command leaves that was killed before it wrote the settings or the plan.
    let of_run = |name: &str| files_of_run(Path::new("")).any(|file| file == Path::new(name));
    let of_workers = [CHUNKS_FOLDER, WORKERS_FOLDER, WORKERS_FILE];
    expect_own_folder(folder, |name| of_run(name) || of_workers.contains(&name))
}

/// Refuses what is not the folder of a run with texts, and names the one that the user may mean. A folder with the texts alone is
/// enough.
///
/// # Errors
/// When it is none, its run is not merged, or another command made it.
pub fn expect_texts(folder: &Path) -> Result<(), CommandError> {
    if folder.join(file::INSTRUCTIONS).is_file() {
        return refuse_unmerged(folder);
    }
    expect_run(folder)?;
    refuse_other_format::<RunSettings>(folder)
}
