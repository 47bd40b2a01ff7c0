//! The commands of the researcher: making a study, progress, links, closing, forgetting, exports. They work on the study's folder, also
//! while the site is being served.

use crate::{
    store::{ErasureReport, InviteTokens, Reconciliation, StudyProgress, StudyStore, StudyTransaction, now_ms},
    study::{RecruiterSettings, Study, StudyData, StudyError},
};
use std::path::{Path, PathBuf};

/// Most personal links that one command makes. A request for more is refused.
const MAX_LINKS_PER_COMMAND: u32 = 100_000;

impl Study {
    /// Writes a new study. Its folder `pictures` already has the pictures. The plan is written last, so a folder without a plan is not
    /// a complete study.
    ///
    /// # Errors
    /// When there is one already, or a file cannot be written.
    pub fn create(&self) -> Result<(), StudyError> {
        self.write_contents()?;
        StudyStore::open(&self.database_file())?;
        self.write_plan()
    }

    /// Reads the study with all answers of its participants.
    ///
    /// # Errors
    /// When the database cannot be read.
    pub fn into_data(self) -> Result<StudyData, StudyError> {
        StudyStore::open_to_read(&self.database_file())?.into_data(self, now_ms())
    }

    /// Counts how many answers the study has and how many it still needs.
    ///
    /// # Errors
    /// When the database cannot be read.
    pub fn read_progress(&self) -> Result<StudyProgress, StudyError> {
        StudyStore::open_to_read(&self.database_file())?
            .read_transaction(self, now_ms(), |transaction| transaction.read_progress())
    }

    /// Whether the study is closed.
    ///
    /// # Errors
    /// When the database cannot be read.
    pub fn is_closed(&self) -> Result<bool, StudyError> {
        StudyStore::open_to_read(&self.database_file())?
            .read_transaction(self, now_ms(), |transaction| transaction.is_closed())
    }

    /// Refuses to make personal links that would lead nobody into the study.
    ///
    /// # Errors
    /// When participants come from a recruiter, the study is closed, or there are too many links.
    pub fn check_invitation(&self, count: u32) -> Result<(), StudyError> {
        if self.settings.recruiter != RecruiterSettings::Links {
            let problem = "study.toml: participants come from a recruiter, whose links name them";
            return Err(StudyError::refused_request(problem, "for personal links set [recruiter] kind = \"links\""));
        }
        if count > MAX_LINKS_PER_COMMAND {
            return Err(StudyError::refused_request(
                format!("{count} links at once"),
                format!("give at most {MAX_LINKS_PER_COMMAND}"),
            ));
        }
        if self.is_closed()? {
            let problem = format!(
                "{} is closed: it takes no more answers, so a link would lead nobody into it",
                self.folder.display()
            );
            return Err(StudyError::refused_request(problem, "make another study with `wayword study new`"));
        }
        Ok(())
    }

    /// Makes personal links. Each is for one participant.
    ///
    /// # Errors
    /// As [`Self::check_invitation`], or when the database cannot be written.
    pub fn invite_participants(&self, count: u32) -> Result<InviteTokens, StudyError> {
        self.check_invitation(count)?;
        self.run_transaction(|transaction| transaction.invite_participants(count))
    }

    /// Closes the study: it accepts no more answers, and the participants' ids at the recruiter are deleted.
    ///
    /// # Errors
    /// When participants are live, which means answering now, and `even_if_live` is not set, or the database cannot be written.
    pub fn close(&self, even_if_live: bool) -> Result<(), StudyError> {
        let live = self.run_transaction(|transaction| transaction.close_study(even_if_live))?;
        if live > 0 && !even_if_live {
            let who = if live == 1 { "1 participant is".to_owned() } else { format!("{live} participants are") };
            let problem = format!("{who} in the middle of it, and could not go on");
            return Err(StudyError::refused_request(problem, "wait until they are done, or give --even-if-live"));
        }
        // Deleted data must not stay in the database's log.
        StudyStore::open(&self.database_file())?.empty_log();
        Ok(())
    }

    /// Deletes all data of a participant; with `is_dry_run` it only counts them. `participant` is our id or the recruiter's.
    ///
    /// # Errors
    /// When the participant does not exist, or the database cannot be written.
    pub fn forget_participant(&self, participant: &str, is_dry_run: bool) -> Result<ErasureReport, StudyError> {
        let report = self.run_transaction(|transaction| transaction.forget_participant(participant, is_dry_run))?;
        // Deleted data must not stay in the database's log.
        StudyStore::open(&self.database_file())?.empty_log();
        Ok(report)
    }

    /// Compares a recruiter's list of participants (CSV) with ours.
    ///
    /// # Errors
    /// When the file cannot be read, or no participant has a recruiter's id.
    pub fn reconcile_recruiter_list(&self, file: &Path) -> Result<Reconciliation, StudyError> {
        self.run_transaction(|transaction| transaction.reconcile_recruiter_list(file))
    }

    /// Remembers a folder to which results are written. The results contain answers, so the researcher has to delete them too when a
    /// participant wants to be forgotten.
    ///
    /// # Errors
    /// When the database cannot be written.
    pub fn note_export(&self, folder: &Path) -> Result<(), StudyError> {
        let folder = std::path::absolute(folder).map_err(StudyError::io_error(folder, "find"))?;
        self.run_transaction(|transaction| transaction.note_export(&folder))
    }

    /// The folders to which results were written and which are still there.
    ///
    /// # Errors
    /// When the database cannot be read.
    pub fn list_exports(&self) -> Result<Vec<PathBuf>, StudyError> {
        let mut folders =
            StudyStore::open_to_read(&self.database_file())?
                .read_transaction(self, now_ms(), |transaction| transaction.list_exports())?;
        folders.retain(|folder| folder.exists());
        Ok(folders)
    }

    /// Opens the database and runs `work` as one transaction, with the present time.
    fn run_transaction<T>(
        &self,
        work: impl FnOnce(&StudyTransaction<'_>) -> Result<T, StudyError>,
    ) -> Result<T, StudyError> {
        StudyStore::open(&self.database_file())?.write_transaction(self, now_ms(), work)
    }
}
