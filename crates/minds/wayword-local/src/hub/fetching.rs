//! Files that are fetched where they are not here.

use super::{
    Progress,
    blob::{self, Wanted},
    client::{Answer, Client},
    commit::Commit,
    layout::RepoFolder,
    name::OnHub,
    needs::Files,
};
use crate::LocalError;
use std::path::PathBuf;

/// The files of one commit, which is the first that the hub names where none is known.
pub(super) struct Fetching<'a> {
    client: &'a Client,
    place: &'a OnHub,
    repo: RepoFolder,
    commit: Option<Commit>,
    symlinks: bool,
    progress: &'a dyn Progress,
}

impl<'a> Fetching<'a> {
    pub(super) fn new(
        client: &'a Client,
        place: &'a OnHub,
        repo: RepoFolder,
        commit: Option<Commit>,
        symlinks: bool,
        progress: &'a dyn Progress,
    ) -> Self {
        Self { client, place, repo, commit, symlinks, progress }
    }

    /// The commit. Only now, with everything there, does the revision stand for it: a fetch that is
    /// cut off leaves an older snapshot in use.
    pub(super) fn finish(self) -> Result<String, LocalError> {
        let Some(commit) = &self.commit else {
            return Err(self.strange("", "nothing was asked for"));
        };
        if Commit::parse(&self.place.revision).is_none() {
            self.repo.keep_ref(&self.place.revision, commit)?;
        }
        Ok(commit.as_str().to_owned())
    }

    fn revision(&self) -> &str {
        self.commit.as_ref().map_or(&self.place.revision, Commit::as_str)
    }

    /// All files are of one commit.
    fn agree(&mut self, file: &str, commit: Commit) -> Result<Commit, LocalError> {
        match &self.commit {
            Some(known) if *known != commit => {
                Err(self.strange(file, "the hub answers with another commit than asked"))
            }
            _ => {
                self.commit = Some(commit.clone());
                Ok(commit)
            }
        }
    }

    fn strange(&self, file: &str, problem: &str) -> LocalError {
        LocalError::Download {
            address: self.client.address(self.place, self.revision(), file),
            problem: problem.to_owned(),
            hint: "try again later; see HF_ENDPOINT where you have set it".to_owned(),
        }
    }
}

impl Files for Fetching<'_> {
    fn folder(&self) -> PathBuf {
        self.repo.snapshot(self.revision())
    }

    fn here(&self, file: &str) -> Option<PathBuf> {
        let path = self.repo.snapshot(self.commit.as_ref()?.as_str()).join(file);
        path.is_file().then_some(path)
    }

    fn get(&mut self, file: &str) -> Result<Option<PathBuf>, LocalError> {
        if let Some(path) = self.here(file) {
            return Ok(Some(path));
        }
        if self.commit.as_ref().is_some_and(|commit| self.repo.is_absent(commit, file)) {
            return Ok(None);
        }
        match self.client.ask(self.place, self.revision(), file)? {
            Answer::Absent(None) => Ok(None),
            Answer::Absent(Some(commit)) => {
                let commit = self.agree(file, commit)?;
                self.repo.keep_absent(&commit, file)?;
                Ok(None)
            }
            Answer::There(facts) => {
                let commit = self.agree(file, facts.commit)?;
                let wanted = Wanted { place: self.place, commit: &commit, file, hash: &facts.hash, size: facts.size };
                blob::fetch(self.client, &self.repo, &wanted, self.progress)?;
                self.repo.link(&facts.hash, &commit, file, self.symlinks).map(Some)
            }
        }
    }

    fn missing(&self, file: &str, what: &'static str) -> LocalError {
        LocalError::Download {
            address: self.client.address(self.place, self.revision(), file),
            problem: format!("the model has no {file}, {what}"),
            hint: "see that the name is right, and what files the hub's page of the model lists".to_owned(),
        }
    }
}
