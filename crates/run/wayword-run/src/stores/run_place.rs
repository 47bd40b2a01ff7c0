//! The place of a run that many workers make: a folder that all of them share, or an object store.

use super::{CloudRun, store_address};
use crate::{error::CommandError, output::CommandOutput, run_folder::is_begun};
use std::{
    fs, io,
    path::{Path, PathBuf},
};
use wayword_queue::{ChunkBoard, ChunkPlan, PLAN, QueueError, WORKERS_FILE, worker_name};

/// The place of a run.
pub struct RunPlace {
    /// The folder or address that the user gave.
    shown_path: PathBuf,
    /// The folder in which this process works. For a run in an object store this is a folder of this process alone.
    folder: PathBuf,
    /// The run in its object store; `None` for a run in a folder.
    cloud_run: Option<CloudRun>,
}

impl RunPlace {
    /// Opens the place that the user gave. A run in an object store gets a folder for temporary files, which is removed at the
    /// end.
    ///
    /// # Errors
    /// When the address cannot be used, or this build cannot reach object stores.
    pub fn open_named(named: &Path) -> Result<Self, CommandError> {
        let Some(address) = store_address(named) else {
            return Ok(Self { shown_path: named.to_owned(), folder: named.to_owned(), cloud_run: None });
        };
        let folder = std::env::temp_dir().join(format!("wayword-{}", worker_name()));
        make_private_folder(&folder).map_err(CommandError::io(&folder, "make a folder for temporary files"))?;
        let stored = CloudRun::open(address, &folder)?;
        let place = Self { shown_path: named.to_owned(), folder, cloud_run: Some(stored) };
        // A worker that joins a run has to use the plan that is there already.
        place.with_store(|stored| {
            stored.fetch_file(PLAN)?;
            stored.fetch_file(WORKERS_FILE)
        })?;
        Ok(place)
    }

    /// Fetches a run from an object store into a folder that stays. The file about how chunks are handed out is not fetched,
    /// because workers continue in the store and not in this folder.
    ///
    /// # Errors
    /// When `named` is a folder and not an object store, `to` has another run, or the run cannot be fetched.
    pub fn fetch_run(named: &Path, to: &Path, output: &CommandOutput) -> Result<(), CommandError> {
        let Some(address) = store_address(named) else {
            return Err(CommandError::usage(
                "--out is for a run in an object store",
                "leave it out: a run in a folder is merged there",
            ));
        };
        if is_begun(to) && ChunkPlan::find_plan(to)?.is_none() {
            let problem = format!("{} holds a run that one machine makes", to.display());
            return Err(CommandError::usage(problem, "give another folder"));
        }
        let stored = CloudRun::open(address, to)?;
        let bar = output.progress_bar(0, "chunks");
        stored.fetch_run(&|done, all| {
            bar.set_length(all as u64);
            bar.set_position(done as u64);
        })?;
        bar.finish_and_clear();
        Ok(())
    }

    /// The folder in which this process works.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The place as the user named it, for messages.
    pub fn shown_path(&self) -> &Path {
        &self.shown_path
    }

    /// Whether the run is in an object store.
    pub fn is_stored(&self) -> bool {
        self.cloud_run.is_some()
    }

    /// Does something with the object store; nothing for a run in a folder.
    fn with_store(&self, work: impl FnOnce(&CloudRun) -> Result<(), QueueError>) -> Result<(), CommandError> {
        Ok(self.cloud_run.as_ref().map_or(Ok(()), work)?)
    }

    /// Tests that the store lets exactly one of several concurrent writers create a file.
    ///
    /// # Errors
    /// When it does not, or cannot be used.
    pub(crate) fn check_store(&self) -> Result<(), CommandError> {
        self.with_store(CloudRun::check_store)
    }

    /// Sends a file that must be the same for all workers (the plan, or how chunks are handed out). If another worker has sent
    /// its own already, that one counts, and replaces the file of this folder.
    ///
    /// # Errors
    /// When the store cannot be used.
    pub(crate) fn publish_file(&self, file: &str) -> Result<(), CommandError> {
        self.with_store(|stored| stored.publish_file(file))
    }

    /// Fetches the marks of finished chunks, in place of those of this folder.
    ///
    /// # Errors
    /// When the store cannot be used.
    pub fn fetch_marks(&self, plan: &ChunkPlan) -> Result<(), CommandError> {
        self.with_store(|stored| stored.fetch_marks(plan))
    }

    /// Sends the marks that killed workers of a queue did not send.
    ///
    /// # Errors
    /// When the store cannot be used.
    pub(crate) fn send_marks(&self, plan: &ChunkPlan) -> Result<(), CommandError> {
        self.with_store(|stored| stored.send_marks(plan))
    }

    /// Removes marks of chunks that are to be made again.
    ///
    /// # Errors
    /// When the store cannot be used.
    pub fn reopen_chunks(&self, chunks: &[usize]) -> Result<(), CommandError> {
        self.with_store(|stored| chunks.iter().try_for_each(|chunk| stored.reopen_chunk(*chunk)))
    }

    /// Runs `work` with a board. If the run is in an object store, each chunk is sent before the board marks it as finished.
    pub(crate) fn with_sending<T>(&self, board: &dyn ChunkBoard, work: impl FnOnce(&dyn ChunkBoard) -> T) -> T {
        match &self.cloud_run {
            None => work(board),
            Some(stored) => work(&stored.sending_board(board)),
        }
    }
}

/// Makes a folder that only this user can read. Fails if it exists.
fn make_private_folder(folder: &Path) -> io::Result<()> {
    let mut builder = fs::DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(folder)
}

impl Drop for RunPlace {
    fn drop(&mut self) {
        if self.is_stored() {
            // The system empties the folder of temporary files sooner or later.
            let _ = fs::remove_dir_all(&self.folder);
        }
    }
}
