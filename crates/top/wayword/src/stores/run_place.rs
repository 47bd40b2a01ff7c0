//! Where the run of many workers lies: in a folder that all share, or in an object store.

use super::{StoredRun, address};
use crate::{error::Error, output::Output, run::is_begun};
use std::{
    fs, io,
    path::{Path, PathBuf},
};
use wayword_queue::{Board, PLAN, Plan, QueueError, WAY, worker_name};

/// The place of a run.
pub(crate) struct RunPlace {
    /// As the user named it.
    named: PathBuf,
    /// Where it is worked on. For a run in an object store this is a folder of this process alone.
    folder: PathBuf,
    stored: Option<StoredRun>,
}

impl RunPlace {
    /// The place that the user named, with what it has of the run. A run in an object store gets a folder for temporary files,
    /// which is removed at the end.
    ///
    /// # Errors
    /// When the address cannot be used, or this build cannot reach object stores.
    pub(crate) fn of(named: &Path) -> Result<Self, Error> {
        let Some(address) = address(named) else {
            return Ok(Self { named: named.to_owned(), folder: named.to_owned(), stored: None });
        };
        let folder = std::env::temp_dir().join(format!("wayword-{}", worker_name()));
        own_folder(&folder).map_err(Error::io(&folder, "make a folder for temporary files"))?;
        let stored = StoredRun::open(address, &folder)?;
        let place = Self { named: named.to_owned(), folder, stored: Some(stored) };
        place.with(|stored| {
            stored.fetch_file(PLAN)?;
            stored.fetch_file(WAY)
        })?;
        Ok(place)
    }

    /// Fetches a run from an object store into a folder that stays. How its workers get their chunks is left out: they work in the
    /// store.
    ///
    /// # Errors
    /// When the place is a folder already, the folder has another run, or the run cannot be fetched.
    pub(crate) fn fetch(named: &Path, to: &Path, output: &Output) -> Result<(), Error> {
        let Some(address) = address(named) else {
            return Err(Error::usage(
                "--to is for a run in an object store",
                "leave it out: a run in a folder is merged there",
            ));
        };
        if is_begun(to) && Plan::find(to)?.is_none() {
            let problem = format!("{} holds a run that one machine makes", to.display());
            return Err(Error::usage(problem, "give another folder"));
        }
        let stored = StoredRun::open(address, to)?;
        let bar = output.progress(0, "chunks");
        stored.fetch(&|done, all| {
            bar.set_length(all as u64);
            bar.set_position(done as u64);
        })?;
        bar.finish_and_clear();
        Ok(())
    }

    /// The folder in which this process works.
    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// The place as the user named it, for messages.
    pub(crate) fn named(&self) -> &Path {
        &self.named
    }

    /// Whether it is in an object store.
    pub(crate) fn is_stored(&self) -> bool {
        self.stored.is_some()
    }

    fn with(&self, work: impl FnOnce(&StoredRun) -> Result<(), QueueError>) -> Result<(), Error> {
        Ok(self.stored.as_ref().map_or(Ok(()), work)?)
    }

    /// Makes sure that the store lets one of several writers win.
    ///
    /// # Errors
    /// When it does not, or cannot be used.
    pub(crate) fn check(&self) -> Result<(), Error> {
        self.with(StoredRun::check)
    }

    /// Makes the plan, and the way in which chunks are handed out, the same for all workers: whose is there first counts.
    ///
    /// # Errors
    /// When the store cannot be used.
    pub(crate) fn publish(&self, file: &str) -> Result<(), Error> {
        self.with(|stored| stored.publish(file))
    }

    /// Fetches the marks of finished chunks, in place of those of this folder.
    ///
    /// # Errors
    /// When the store cannot be used.
    pub(crate) fn fetch_marks(&self, plan: &Plan) -> Result<(), Error> {
        self.with(|stored| stored.fetch_marks(plan))
    }

    /// Sends the marks that killed workers of a queue did not send.
    ///
    /// # Errors
    /// When the store cannot be used.
    pub(crate) fn send_marks(&self, plan: &Plan) -> Result<(), Error> {
        self.with(|stored| stored.send_marks(plan))
    }

    /// Removes marks of chunks that are to be made again.
    ///
    /// # Errors
    /// When the store cannot be used.
    pub(crate) fn reopen(&self, chunks: &[usize]) -> Result<(), Error> {
        self.with(|stored| chunks.iter().try_for_each(|chunk| stored.reopen(*chunk)))
    }

    /// Works with a board. In an object store each chunk is sent before the board hears that it is finished.
    pub(crate) fn sending<T>(&self, board: &dyn Board, work: impl FnOnce(&dyn Board) -> T) -> T {
        match &self.stored {
            None => work(board),
            Some(stored) => work(&stored.sending(board)),
        }
    }
}

/// Makes a folder that nobody else can read, and that nobody made before.
fn own_folder(folder: &Path) -> io::Result<()> {
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
