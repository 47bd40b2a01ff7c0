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

mod cache;
mod client;
mod config;
mod fetching;
mod files;
mod name;
mod trouble;
mod trust;

pub use cache::CachedModel;
pub use config::HubConfig;
pub use fetching::Progress;
pub use files::Needs;
pub use name::ModelName;

use crate::LocalError;
use cache::{Commit, RepoFolder};
use client::Client;
use fetching::Fetching;
use files::{Gathered, OnDisk};
use name::{ModelSource, OnHub};
use std::path::{Path, PathBuf};

/// Gives access to models on disk and on the hub.
#[derive(Debug)]
pub struct Hub {
    config: HubConfig,
    client: Client,
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

impl Hub {
    /// Gives access to models with these settings. Does not use the network.
    ///
    /// # Errors
    /// When the endpoint is not a web address.
    pub fn new(config: HubConfig) -> Result<Self, LocalError> {
        let client = Client::new(&config)?;
        Ok(Self { config, client })
    }

    /// A model's folder with the needed files. Files in the cache are used as they are, even if the branch has moved,
    /// so that a model stays the same until [`Hub::fetch`] is called. Missing files are fetched.
    ///
    /// # Errors
    /// When a needed file is missing and cannot be fetched. The message names the file and its place.
    pub fn folder(&self, name: &ModelName, needs: &Needs, progress: &dyn Progress) -> Result<ModelFolder, LocalError> {
        self.have(name, needs, progress, false)
    }

    /// Like [`Hub::folder`], but asks the hub which commit the revision points to now. Offline both do the same.
    ///
    /// # Errors
    /// As for [`Hub::folder`].
    pub fn fetch(&self, name: &ModelName, needs: &Needs, progress: &dyn Progress) -> Result<ModelFolder, LocalError> {
        self.have(name, needs, progress, true)
    }

    /// The models in the cache, by name and commit.
    ///
    /// # Errors
    /// When a folder cannot be read.
    pub fn list(&self) -> Result<Vec<CachedModel>, LocalError> {
        cache::list(&self.config.cache)
    }

    /// The cache's folder.
    #[must_use]
    pub fn cache(&self) -> &Path {
        &self.config.cache
    }

    fn have(
        &self,
        name: &ModelName,
        needs: &Needs,
        progress: &dyn Progress,
        anew: bool,
    ) -> Result<ModelFolder, LocalError> {
        let found = self.found(name, needs, progress, anew)?;
        if let Some(file) = found.file.as_deref().filter(|_| name.is_trained()) {
            trust::check(&self.config, name, file, progress)?;
        }
        Ok(found)
    }

    fn found(
        &self,
        name: &ModelName,
        needs: &Needs,
        progress: &dyn Progress,
        anew: bool,
    ) -> Result<ModelFolder, LocalError> {
        let model = match &name.source {
            ModelSource::Hub(model) => model,
            ModelSource::Folder(path) => return on_disk(&mut OnDisk::local(path), needs, None, None),
            ModelSource::File(path) => {
                let folder = path.parent().unwrap_or(Path::new("."));
                let file = path.file_name().map(|file| file.to_string_lossy());
                return on_disk(&mut OnDisk::local(folder), needs, file.as_deref(), None);
            }
        };
        let repo = RepoFolder::new(&self.config.cache, model);
        let known = repo.commit_of(&model.revision);
        if self.config.offline {
            return self.cached(name, model, &repo, known.as_ref(), needs);
        }
        if known.is_none() && !anew && repo.snapshot(&model.revision).is_dir() {
            // The user put files there. If they are not enough, the hub is asked.
            if let Ok(found) = self.cached(name, model, &repo, None, needs) {
                return Ok(found);
            }
        }
        let commit = if anew { Commit::parse(&model.revision) } else { known };
        let symlinks = self.config.symlinks;
        let mut files = Fetching { client: &self.client, model, repo, commit, symlinks, progress };
        let gathered = needs.gather(&mut files, model.file.as_deref())?;
        Ok(folder(gathered, model.file.is_some(), files.finish()?))
    }

    /// Finds a model without the network. If no commit is known, uses a snapshot with the revision's name.
    fn cached(
        &self,
        name: &ModelName,
        model: &OnHub,
        repo: &RepoFolder,
        known: Option<&Commit>,
        needs: &Needs,
    ) -> Result<ModelFolder, LocalError> {
        let identity = known.map(|commit| commit.as_str().to_owned());
        let folder = repo.snapshot(known.map_or(model.revision.as_str(), Commit::as_str));
        let is_all = needs.flags().is_empty();
        let (others, them) = if is_all { (" and the others of the model", "them") } else { ("", "it") };
        let hint = |file: &str| {
            format!(
                "unset WAYWORD_OFFLINE, HF_HUB_OFFLINE and TRANSFORMERS_OFFLINE and run `wayword models fetch {}{name}`; without a network, download this file ({}){others} elsewhere, and put {them} there",
                needs.flags(),
                self.client.address(model, &model.revision, file)
            )
        };
        on_disk(&mut OnDisk::new(folder, &hint), needs, model.file.as_deref(), identity)
    }
}

/// A model on this machine. If no identity is given, it is computed from the files.
fn on_disk(
    files: &mut OnDisk<'_>,
    needs: &Needs,
    file: Option<&str>,
    identity: Option<String>,
) -> Result<ModelFolder, LocalError> {
    let gathered = needs.gather(files, file)?;
    let identity = identity.map_or_else(|| gathered.identity(), Ok)?;
    Ok(folder(gathered, file.is_some(), identity))
}

fn folder(gathered: Gathered, is_file: bool, identity: String) -> ModelFolder {
    let file = gathered.weights.into_iter().next().filter(|_| is_file);
    ModelFolder { path: gathered.folder, file, identity }
}

#[cfg(test)]
mod tests;
