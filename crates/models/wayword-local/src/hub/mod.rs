//! Finds and fetches models: in the hub's cache on disk, from the hub itself, or in the user's own folder.
//!
//! The cache has the layout of the hub's own Python client, including locks, so that both use the same files:
//!
//! ```text
//! models--ORG--NAME/refs/REVISION               the commit that a branch or tag pointed to
//! models--ORG--NAME/blobs/HASH                  a file's bytes, by the hash that the hub gives them
//! models--ORG--NAME/snapshots/COMMIT/FILE       a link to them
//! models--ORG--NAME/.no_exist/COMMIT/FILE       an empty file: the commit lacks FILE
//! .locks/models--ORG--NAME/HASH.lock            locked while the bytes are fetched
//! ```
//!
//! Architecture invariant: a file is linked into a snapshot only if it has the hash that the hub announced, and the
//! token is sent only to the hub's own address.

#![cfg_attr(
    not(test),
    warn(
        clippy::indexing_slicing,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap
    )
)]

mod cache;
mod client;
mod commit_download;
mod config;
mod files;
mod name;
mod request_failure;
mod trust;

pub use cache::CachedModel;
pub use commit_download::DownloadProgress;
pub use config::HubConfig;
pub use files::NeededFiles;
pub use name::ModelName;

use crate::LocalError;
use cache::{CommitHash, RepoFolder};
use client::HubClient;
use commit_download::CommitDownload;
use files::{DiskModelFiles, GatheredFiles};
use name::{HubModelName, ModelSource};
use std::path::{Path, PathBuf};

/// Gives access to models on disk and on the hub.
#[derive(Debug)]
pub struct ModelHub {
    config: HubConfig,
    client: HubClient,
}

/// The files of a model on this machine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModelFolder {
    /// The folder that the files are in.
    pub path: PathBuf,
    /// The file in the model's name, if it names one.
    pub file: Option<PathBuf>,
    /// Distinguishes models of the same name: the commit's hash, 40 hex digits. If there is no commit (local folders,
    /// files that the user put into the cache), `sha256:` and 64 digits over the small files, and over length,
    /// beginning, end and samples of the weights, which costs a few hundred small reads. Weights that differ only
    /// between the samples look the same, but training changes weights everywhere.
    pub identity: String,
}

impl ModelHub {
    /// Gives access to models with these settings. Does not use the network.
    ///
    /// # Errors
    /// When the endpoint is not a web address.
    pub fn new(config: HubConfig) -> Result<Self, LocalError> {
        let client = HubClient::new(&config)?;
        Ok(Self { config, client })
    }

    /// A model's folder with the needed files. Files in the cache are used as they are, even if the branch has moved,
    /// so that a model stays the same until [`ModelHub::fetch_model`] is called. Missing files are fetched.
    ///
    /// # Errors
    /// When a needed file is missing and cannot be fetched. The message names the file and its place.
    pub fn model_folder(
        &self,
        name: &ModelName,
        needs: &NeededFiles,
        progress: &dyn DownloadProgress,
    ) -> Result<ModelFolder, LocalError> {
        self.find_trusted(name, needs, progress, false)
    }

    /// Like [`ModelHub::model_folder`], but asks the hub which commit the revision points to now. Offline both do the
    /// same.
    ///
    /// # Errors
    /// As for [`ModelHub::model_folder`].
    pub fn fetch_model(
        &self,
        name: &ModelName,
        needs: &NeededFiles,
        progress: &dyn DownloadProgress,
    ) -> Result<ModelFolder, LocalError> {
        self.find_trusted(name, needs, progress, true)
    }

    /// The models in the cache, by name and commit.
    ///
    /// # Errors
    /// When a folder cannot be read.
    pub fn list_models(&self) -> Result<Vec<CachedModel>, LocalError> {
        cache::list_models(&self.config.cache)
    }

    /// The cache's folder.
    #[must_use]
    pub fn cache_folder(&self) -> &Path {
        &self.config.cache
    }

    /// Finds or fetches a model, and checks the hash of a `.pth` file. With `anew` the hub is asked for the current
    /// commit.
    fn find_trusted(
        &self,
        name: &ModelName,
        needs: &NeededFiles,
        progress: &dyn DownloadProgress,
        anew: bool,
    ) -> Result<ModelFolder, LocalError> {
        let found = self.find_model(name, needs, progress, anew)?;
        if let Some(file) = found.file.as_deref().filter(|_| name.is_trained()) {
            trust::check_file(&self.config, name, file, progress)?;
        }
        Ok(found)
    }

    /// Finds or fetches a model, wherever its files are.
    fn find_model(
        &self,
        name: &ModelName,
        needs: &NeededFiles,
        progress: &dyn DownloadProgress,
        anew: bool,
    ) -> Result<ModelFolder, LocalError> {
        let model = match &name.source {
            ModelSource::Hub(model) => model,
            ModelSource::Folder(path) => {
                return gather_local_files(&mut DiskModelFiles::for_user_folder(path), needs, None, None);
            }
            ModelSource::File(path) => {
                let folder = path.parent().unwrap_or(Path::new("."));
                let file = path.file_name().map(|file| file.to_string_lossy());
                return gather_local_files(&mut DiskModelFiles::for_user_folder(folder), needs, file.as_deref(), None);
            }
        };
        let repo = RepoFolder::new(&self.config.cache, model);
        let known = repo.find_commit(&model.revision);
        if self.config.offline {
            return self.find_cached(name, model, &repo, known.as_ref(), needs);
        }
        if known.is_none() && !anew && repo.snapshot_folder(&model.revision).is_dir() {
            // The user put files there. If they are not enough, the hub is asked.
            if let Ok(found) = self.find_cached(name, model, &repo, None, needs) {
                return Ok(found);
            }
        }
        let commit = if anew { CommitHash::parse(&model.revision) } else { known };
        let symlinks = self.config.symlinks;
        let mut files = CommitDownload { client: &self.client, model, repo, commit, symlinks, progress };
        let gathered = needs.gather_files(&mut files, model.file.as_deref())?;
        Ok(to_model_folder(gathered, model.file.is_some(), files.finish()?))
    }

    /// Finds a model without the network. If no commit is known, uses a snapshot with the revision's name.
    fn find_cached(
        &self,
        name: &ModelName,
        model: &HubModelName,
        repo: &RepoFolder,
        known: Option<&CommitHash>,
        needs: &NeededFiles,
    ) -> Result<ModelFolder, LocalError> {
        let identity = known.map(|commit| commit.as_str().to_owned());
        let folder = repo.snapshot_folder(known.map_or(model.revision.as_str(), CommitHash::as_str));
        let is_all = needs.fetch_flags().is_empty();
        let (others, them) = if is_all { (" and the others of the model", "them") } else { ("", "it") };
        let hint = |file: &str| {
            format!(
                "unset WAYWORD_OFFLINE, HF_HUB_OFFLINE and TRANSFORMERS_OFFLINE and run `wayword models fetch {}{name}`; without a network, download this file ({}){others} elsewhere, and put {them} there",
                needs.fetch_flags(),
                self.client.file_address(model, &model.revision, file)
            )
        };
        gather_local_files(&mut DiskModelFiles::new(folder, &hint), needs, model.file.as_deref(), identity)
    }
}

/// A model on this machine. If no identity is given, it is computed from the files.
fn gather_local_files(
    files: &mut DiskModelFiles<'_>,
    needs: &NeededFiles,
    file: Option<&str>,
    identity: Option<String>,
) -> Result<ModelFolder, LocalError> {
    let gathered = needs.gather_files(files, file)?;
    let identity = identity.map_or_else(|| gathered.hash_identity(), Ok)?;
    Ok(to_model_folder(gathered, file.is_some(), identity))
}

fn to_model_folder(gathered: GatheredFiles, is_file: bool, identity: String) -> ModelFolder {
    let file = gathered.weights.into_iter().next().filter(|_| is_file);
    ModelFolder { path: gathered.folder, file, identity }
}

#[cfg(test)]
mod tests;
