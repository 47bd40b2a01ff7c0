//! Where models come from: the hub's cache on disk, the hub itself, or a folder of the user's.
//!
//! The cache has the layout of the hub's own client for Python, locks included, so that both use the same files:
//!
//! ```text
//! models--ORG--NAME/refs/REVISION               the commit that a branch or tag stood for
//! models--ORG--NAME/blobs/HASH                  a file's bytes, by the hash that the hub gives them
//! models--ORG--NAME/snapshots/COMMIT/FILE       a link to them
//! models--ORG--NAME/.no_exist/COMMIT/FILE       the commit has no such file
//! .locks/models--ORG--NAME/HASH.lock            held while the bytes are fetched
//! ```
//!
//! Architecture invariant: nothing is linked into a snapshot before its bytes have the hash that the hub gave them, and a token
//! goes nowhere but to the hub's own address.

mod cache;
mod client;
mod config;
mod fetching;
mod files;
mod name;
mod trouble;

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

/// The way to models.
#[derive(Debug)]
pub struct Hub {
    config: HubConfig,
    client: Client,
}

/// A model's files.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModelFolder {
    /// The folder that they lie in.
    pub path: PathBuf,
    /// The one file that was named, for GGUF.
    pub file: Option<PathBuf>,
    /// What tells this model from another of the same name: the commit's hash, 40 hex digits. Where there is no commit (local
    /// folders, files that were put into the cache by hand) `sha256:` and 64 digits over the small files, and over length,
    /// beginning, end and samples of the weights, which cost a few hundred small reads. Weights that differ between the samples
    /// alone look the same; no training does that.
    pub identity: String,
}

impl Hub {
    /// The way to models by a configuration.
    ///
    /// # Errors
    /// When the endpoint is no web address.
    pub fn new(config: HubConfig) -> Result<Self, LocalError> {
        let client = Client::new(&config)?;
        Ok(Self { config, client })
    }

    /// A model's folder with the files that are needed. What is in the cache is used as it is, whatever the branch stands for
    /// by now, so that a model stays the same until [`Hub::fetch`] asks anew; what is missing is fetched.
    ///
    /// # Errors
    /// When a file that is needed cannot be had: says which, and where it belongs.
    pub fn folder(&self, name: &ModelName, needs: &Needs, progress: &dyn Progress) -> Result<ModelFolder, LocalError> {
        self.have(name, needs, progress, false)
    }

    /// As [`Hub::folder`], but asks the hub what the revision stands for now. Offline it is the same.
    ///
    /// # Errors
    /// As there.
    pub fn fetch(&self, name: &ModelName, needs: &Needs, progress: &dyn Progress) -> Result<ModelFolder, LocalError> {
        self.have(name, needs, progress, true)
    }

    /// What the cache holds, by name and commit.
    ///
    /// # Errors
    /// When a folder cannot be read.
    pub fn list(&self) -> Result<Vec<CachedModel>, LocalError> {
        cache::list(&self.config.cache)
    }

    /// Where the cache is.
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
            return self.cached(model, &repo, known.as_ref(), needs);
        }
        if known.is_none() && !anew && repo.snapshot(&model.revision).is_dir() {
            // Somebody put files there by hand; where they are not enough, the hub is asked.
            if let Ok(found) = self.cached(model, &repo, None, needs) {
                return Ok(found);
            }
        }
        let commit = if anew { Commit::parse(&model.revision) } else { known };
        let symlinks = self.config.symlinks;
        let mut files = Fetching { client: &self.client, model, repo, commit, symlinks, progress };
        let gathered = needs.gather(&mut files, model.file.as_deref())?;
        Ok(folder(gathered, model.file.is_some(), files.finish()?))
    }

    /// Without the network. Where no commit is known, a snapshot that is named like the revision will do.
    fn cached(
        &self,
        model: &OnHub,
        repo: &RepoFolder,
        known: Option<&Commit>,
        needs: &Needs,
    ) -> Result<ModelFolder, LocalError> {
        let identity = known.map(|commit| commit.as_str().to_owned());
        let folder = repo.snapshot(known.map_or(model.revision.as_str(), Commit::as_str));
        let hint = |file: &str| {
            format!(
                "put there what {} gives, or run `wayword models fetch NAME` where there is a network, and without WAYWORD_OFFLINE and HF_HUB_OFFLINE",
                self.client.address(model, &model.revision, file)
            )
        };
        on_disk(&mut OnDisk::new(folder, &hint), needs, model.file.as_deref(), identity)
    }
}

/// What is on this machine; without an identity from elsewhere it is computed from the files.
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
