//! Downloads the files that are not on this machine. A download continues where an earlier one ended.

use super::{
    cache::{CommitHash, RepoFolder, make_parent, path_with_suffix},
    client::{HubClient, HubFileAnswer, HubFileFacts},
    files::ModelFiles,
    name::HubModelName,
    request_failure::{RequestFailure, RetryPatience, TRY_LATER},
};
use crate::LocalError;
use std::{
    fs::{self, File, OpenOptions},
    io::{Read, Seek, SeekFrom, Write},
    path::{Path, PathBuf},
};

/// The most bytes of a file for which the hub gives no size; a longer download is refused. The hub gives the size of
/// every large file.
const MAX_UNANNOUNCED_BYTES: u64 = 64 << 20;

/// The number of bytes of one connection after which earlier failures are forgotten. The limit makes the program give
/// up on a server that sends only a few bytes each time.
const PROGRESS_BYTES: u64 = 1 << 20;

/// Receives the progress of downloads.
pub trait DownloadProgress {
    /// `done` bytes of a file have arrived, of `total` if the hub has given the size.
    fn bytes_arrived(&self, file: &str, done: u64, total: Option<u64>);

    /// Called when another process fetches this file, and this one waits for it.
    fn waiting_for(&self, file: &str) {
        let _ = file;
    }

    /// Receives a note that the user should read, such as one on a licence.
    fn show_note(&self, note: &str) {
        let _ = note;
    }
}

/// Shows no progress.
impl DownloadProgress for () {
    fn bytes_arrived(&self, _: &str, _: u64, _: Option<u64>) {}
}

/// Downloads files of one commit. If the commit is not known, it is the first one that the hub names.
pub(super) struct CommitDownload<'a> {
    pub(super) client: &'a HubClient,
    pub(super) model: &'a HubModelName,
    pub(super) repo: RepoFolder,
    pub(super) commit: Option<CommitHash>,
    pub(super) symlinks: bool,
    pub(super) progress: &'a dyn DownloadProgress,
}

impl CommitDownload<'_> {
    /// Returns the commit, and records it as the revision's commit. It is called when all files are there, so that the
    /// older snapshot stays in use after an interrupted download.
    pub(super) fn finish(self) -> Result<String, LocalError> {
        let Some(commit) = &self.commit else {
            return Err(LocalError::download_failed(self.file_address(""), "no file was requested", TRY_LATER));
        };
        if CommitHash::parse(&self.model.revision).is_none() {
            self.repo.keep_ref(&self.model.revision, commit)?;
        }
        Ok(commit.as_str().to_owned())
    }

    fn requested_revision(&self) -> &str {
        self.commit.as_ref().map_or(&self.model.revision, CommitHash::as_str)
    }

    fn file_address(&self, file: &str) -> String {
        self.client.file_address(self.model, self.requested_revision(), file)
    }

    /// Checks that a file is of the same commit as the files before it.
    fn check_commit(&mut self, file: &str, commit: &CommitHash) -> Result<(), LocalError> {
        if *self.commit.get_or_insert_with(|| commit.clone()) == *commit {
            return Ok(());
        }
        let problem = "the hub answers with another commit than requested";
        Err(LocalError::download_failed(self.file_address(file), problem, TRY_LATER))
    }

    /// Downloads a blob into the cache, if it is not there.
    fn fetch_blob(&self, file: &str, facts: &HubFileFacts) -> Result<(), LocalError> {
        let blob = self.repo.blob_path(&facts.hash);
        if blob.is_file() {
            return Ok(());
        }
        let _lock = self.repo.lock_blob(&facts.hash, || self.progress.waiting_for(file))?;
        if blob.is_file() {
            return Ok(());
        }
        make_parent(&blob)?;
        let part = path_with_suffix(&blob, ".incomplete");
        let mut patience = self.client.new_patience();
        let mut resumed = self.download_whole(file, facts.size, &part, &mut patience)?;
        // The whole file is read again, because its beginning may come from another process, and the disk may have
        // failed.
        while !facts.hash.matches_file(&part).map_err(|error| LocalError::from_io(&part, "read", error))? {
            fs::remove_file(&part).map_err(|error| LocalError::from_io(&part, "remove", error))?;
            if !resumed {
                let problem = format!("the received file does not have the hash {}", facts.hash.as_str());
                let hint = "try again; if it happens again, something on the network changes the file";
                return Err(LocalError::download_failed(self.file_address(file), problem, hint));
            }
            // The part from an earlier download was wrong, so the file is fetched once more from the beginning.
            self.download_whole(file, facts.size, &part, &mut patience)?;
            resumed = false;
        }
        fs::rename(&part, &blob).map_err(|error| LocalError::from_io(&blob, "write", error))
    }

    /// Downloads into the file `part` until all bytes are there. Returns whether some of them were there before.
    fn download_whole(
        &self,
        file: &str,
        size: Option<u64>,
        part: &Path,
        patience: &mut RetryPatience,
    ) -> Result<bool, LocalError> {
        let io = |error| LocalError::from_io(part, "write", error);
        let mut out = OpenOptions::new().create(true).append(true).open(part).map_err(io)?;
        let length = |out: &File| out.metadata().map(|metadata| metadata.len()).map_err(io);
        if size.is_some_and(|size| length(&out).is_ok_and(|length| length > size)) {
            out.set_len(0).map_err(io)?;
        }
        let resumed = length(&out)? > 0;
        loop {
            let before = length(&out)?;
            if before > 0 && size == Some(before) {
                break;
            }
            let Err(trouble) = self.download_piece(file, size, &mut out, part) else { break };
            if length(&out)? >= before.saturating_add(PROGRESS_BYTES) {
                patience.forget_failures();
            }
            patience.wait_or_give_up(trouble, &self.file_address(file))?;
        }
        out.sync_all().map_err(io)?;
        Ok(resumed)
    }

    /// Downloads the bytes that one connection delivers.
    fn download_piece(&self, file: &str, size: Option<u64>, out: &mut File, part: &Path) -> Result<(), RequestFailure> {
        let io = |error| RequestFailure::Lasting(LocalError::from_io(part, "write", error));
        let (address, received) = (self.file_address(file), out.seek(SeekFrom::End(0)).map_err(io)?);
        let (mut done, mut body) = self.client.open_download(self.model, &address, received)?;
        out.set_len(done).map_err(io)?;
        let max_bytes = size.unwrap_or(MAX_UNANNOUNCED_BYTES);
        let mut buffer = vec![0; 1 << 18];
        self.progress.bytes_arrived(file, done, size);
        loop {
            let read = body
                .read(&mut buffer)
                .map_err(|error| RequestFailure::from_problem(format!("the connection broke: {error}")))?;
            let piece = buffer.get(..read).unwrap_or(&buffer);
            if piece.is_empty() {
                break;
            }
            done += piece.len() as u64;
            if done > max_bytes {
                // None of these bytes can be trusted.
                out.set_len(0).map_err(io)?;
                let problem = format!("the server sends more than the expected {max_bytes} bytes");
                return Err(RequestFailure::Lasting(LocalError::download_failed(address, problem, TRY_LATER)));
            }
            out.write_all(piece).map_err(io)?;
            self.progress.bytes_arrived(file, done, size);
        }
        if size.is_some_and(|size| done < size) {
            return Err(RequestFailure::from_problem(format!("the connection broke after {done} bytes")));
        }
        Ok(())
    }
}

impl ModelFiles for CommitDownload<'_> {
    fn folder_path(&self) -> PathBuf {
        self.repo.snapshot_folder(self.requested_revision())
    }

    fn local_path(&self, file: &str) -> Option<PathBuf> {
        let path = self.repo.snapshot_folder(self.commit.as_ref()?.as_str()).join(file);
        path.is_file().then_some(path)
    }

    fn get_file(&mut self, file: &str) -> Result<Option<PathBuf>, LocalError> {
        if let Some(path) = self.local_path(file) {
            return Ok(Some(path));
        }
        if self.commit.as_ref().is_some_and(|commit| self.repo.is_absent(commit, file)) {
            return Ok(None);
        }
        match self.client.ask_about_file(self.model, self.requested_revision(), file)? {
            HubFileAnswer::Absent(None) => Ok(None),
            HubFileAnswer::Absent(Some(commit)) => {
                self.check_commit(file, &commit)?;
                self.repo.keep_absent(&commit, file)?;
                Ok(None)
            }
            HubFileAnswer::There(facts) => {
                self.check_commit(file, &facts.commit)?;
                self.fetch_blob(file, &facts)?;
                self.repo.link_blob(&facts.hash, &facts.commit, file, self.symlinks).map(Some)
            }
        }
    }

    fn missing_error(&self, file: &str, what: &'static str) -> LocalError {
        let problem = format!("the model has no {file}, {what}");
        let hint = "check the name, and the list of files on the model's page of the hub";
        LocalError::download_failed(self.file_address(file), problem, hint)
    }
}
