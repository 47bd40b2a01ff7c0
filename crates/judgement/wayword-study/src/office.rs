//! The commands of the researcher: progress, links, closing, forgetting, exports. They work on the study's folder, also while the
//! site is being served.

use crate::{
    store::{Book, Forgotten, Invited, Progress, Reconciliation, Store, now_ms},
    study::{Data, Recruiter, Study, StudyError},
};
use std::path::{Path, PathBuf};

/// Largest number of personal links that one command makes.
const MOST_LINKS: u32 = 100_000;

impl Study {
    /// Reads the study with all answers of its participants.
    ///
    /// # Errors
    /// When the database cannot be read.
    pub fn data(self) -> Result<Data, StudyError> {
        Store::open(&self.database())?.data(self, now_ms())
    }

    /// Counts how many answers the study has and how many it still needs.
    ///
    /// # Errors
    /// When the database cannot be read.
    pub fn progress(&self) -> Result<Progress, StudyError> {
        Store::open(&self.database())?.read(self, now_ms(), |book| book.progress())
    }

    /// Makes personal links. Each is for one participant.
    ///
    /// # Errors
    /// When participants come from a recruiter, or the database cannot be written.
    pub fn invite(&self, count: u32) -> Result<Invited, StudyError> {
        if self.settings.recruiter != Recruiter::Links {
            let problem = "study.toml: participants come from a recruiter, whose links name them";
            return Err(StudyError::refused(problem, "for personal links set [recruiter] kind = \"links\""));
        }
        if count > MOST_LINKS {
            return Err(StudyError::refused(format!("{count} links at once"), format!("give at most {MOST_LINKS}")));
        }
        self.transact(|book| book.invite(count))
    }

    /// Closes the study: it accepts no more answers, and the participants' ids at the recruiter are deleted.
    ///
    /// # Errors
    /// When people are still answering and `even_if_live` is not set, or the database cannot be written.
    pub fn close(&self, even_if_live: bool) -> Result<(), StudyError> {
        let live = self.transact(|book| book.close(even_if_live))?;
        if live > 0 && !even_if_live {
            let problem = format!("{live} participants are in the middle of it, and could not go on");
            return Err(StudyError::refused(problem, "wait until they are done, or give --even-if-live"));
        }
        Store::open(&self.database())?.sweep();
        Ok(())
    }

    /// Deletes all data of a participant; with `is_dry` it only counts them. `participant` is our id or the recruiter's.
    ///
    /// # Errors
    /// When the participant does not exist, or the database cannot be written.
    pub fn forget(&self, participant: &str, is_dry: bool) -> Result<Forgotten, StudyError> {
        let forgotten = self.transact(|book| book.forget(participant, is_dry))?;
        Store::open(&self.database())?.sweep();
        Ok(forgotten)
    }

    /// Compares a recruiter's list of participants (CSV) with ours.
    ///
    /// # Errors
    /// When the file cannot be read, or no participant has a recruiter's id.
    pub fn reconcile(&self, file: &Path) -> Result<Reconciliation, StudyError> {
        self.transact(|book| book.reconcile(file))
    }

    /// Remembers a folder to which results are written. It contains answers, which have to go too when somebody wants to be forgotten.
    ///
    /// # Errors
    /// When the database cannot be written.
    pub fn note_export(&self, folder: &Path) -> Result<(), StudyError> {
        let folder = std::path::absolute(folder).map_err(StudyError::io(folder, "find"))?;
        self.transact(|book| book.note_export(&folder))
    }

    /// The folders to which results were written and which are still there.
    ///
    /// # Errors
    /// When the database cannot be read.
    pub fn exports(&self) -> Result<Vec<PathBuf>, StudyError> {
        let mut folders = self.transact(|book| book.exports())?;
        folders.retain(|folder| folder.exists());
        Ok(folders)
    }

    fn transact<T>(&self, work: impl FnOnce(&Book<'_>) -> Result<T, StudyError>) -> Result<T, StudyError> {
        Store::open(&self.database())?.write(self, now_ms(), work)
    }
}
