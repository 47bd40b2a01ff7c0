//! What is in the cache.

use super::{commit::Commit, name::is_part};
use crate::LocalError;
use serde::Serialize;
use std::{
    fs, io,
    path::{Path, PathBuf},
};

/// Folders in folders that are looked into; snapshots and references have few.
const DEEPEST: usize = 8;

/// A model in the cache, at one commit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct CachedModel {
    /// Its name, `hf/ORG/NAME`.
    pub name: String,
    /// Branches and tags that stand for the commit.
    pub revisions: Vec<String>,
    /// The commit, or the name of the folder that somebody put there by hand.
    pub commit: String,
    /// How many files are there.
    pub files: usize,
    /// Their length.
    pub bytes: u64,
    /// Where they are.
    pub folder: PathBuf,
}

/// Everything that has a name here: models without an organisation, data sets and spaces have none.
pub(super) fn list(cache: &Path) -> Result<Vec<CachedModel>, LocalError> {
    let mut models = Vec::new();
    for folder in entries(cache)? {
        let Some((org, name)) = folder.file_name().and_then(|name| name.to_str()).and_then(repo) else { continue };
        let refs = refs(&folder.join("refs"))?;
        for snapshot in entries(&folder.join("snapshots"))? {
            let commit = snapshot.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
            let lengths: Vec<u64> =
                files(&snapshot, DEEPEST)?.iter().filter_map(|file| Some(fs::metadata(file).ok()?.len())).collect();
            if lengths.is_empty() {
                continue;
            }
            models.push(CachedModel {
                name: format!("hf/{org}/{name}"),
                revisions: refs.iter().filter(|(_, of)| *of == commit).map(|(name, _)| name.clone()).collect(),
                commit,
                files: lengths.len(),
                bytes: lengths.iter().sum(),
                folder: snapshot,
            });
        }
    }
    models.sort_by(|a, b| (&a.name, &a.commit).cmp(&(&b.name, &b.commit)));
    Ok(models)
}

/// Organisation and name of a model's folder.
fn repo(folder: &str) -> Option<(&str, &str)> {
    let (org, name) = folder.strip_prefix("models--")?.split_once("--")?;
    (is_part(org) && is_part(name)).then_some((org, name))
}

/// Branches and tags with their commits, in the order of their names.
fn refs(folder: &Path) -> Result<Vec<(String, String)>, LocalError> {
    let name = |file: &Path| Some(file.strip_prefix(folder).ok()?.to_str()?.replace('\\', "/"));
    let entry = |file: PathBuf| {
        let commit = Commit::parse(fs::read_to_string(&file).ok()?.trim())?;
        Some((name(&file)?, commit.as_str().to_owned()))
    };
    Ok(files(folder, DEEPEST)?.into_iter().filter_map(entry).collect())
}

/// Every file below a folder, in the order of their paths.
fn files(folder: &Path, deepest: usize) -> Result<Vec<PathBuf>, LocalError> {
    let mut found = Vec::new();
    for path in entries(folder)? {
        if !path.is_dir() {
            found.push(path);
        } else if deepest > 0 {
            found.extend(files(&path, deepest - 1)?);
        }
    }
    Ok(found)
}

/// What a folder holds, in order; nothing where there is none.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, LocalError> {
    let wrong = |error| LocalError::io(folder, "read", error);
    let read = match fs::read_dir(folder) {
        Ok(read) => read,
        Err(error) if matches!(error.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => {
            return Ok(Vec::new());
        }
        Err(error) => return Err(wrong(error)),
    };
    let mut paths = read.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>().map_err(wrong)?;
    paths.sort();
    Ok(paths)
}
