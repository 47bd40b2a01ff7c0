//! Checks that a checkpoint is the file that its makers published, or at least the one that was used before.
//!
//! The hub's hash protects against a damaged download, but not against a repository in which somebody replaced the
//! file. A checkpoint that training left is a pickle. No code in it is executed here, but false weights may give any
//! result. So its SHA-256 must equal the one that the user gave, or the published one. For a file without either, the
//! hash of the first use is kept, and later uses are compared with it.

use super::{
    DownloadProgress, HubConfig,
    cache::{make_parent, path_with_suffix},
    name::{ModelName, ModelSource},
};
use crate::LocalError;
use sha2::{Digest, Sha256};
use std::{
    fs::{self, File},
    io,
    path::{Path, PathBuf},
};

/// SHA-256 of published checkpoints, by the names of their files.
const PUBLISHED_SHA256: [(&str, &str); 3] = [
    ("glip_tiny_model_o365_goldg_cc_sbu.pth", "3bec0a3dea804fcb278d7106c5438de5116ee888e49dfae46270e7ad7bc4ccbf"),
    (
        "glip_tiny_model_o365_goldg_cc_sbu_lvisbest.pth",
        "246ea2b91b9b3e20c1478a6cc6e0831ae1c4f75502cf885225a99caa2e8b996a",
    ),
    ("glip_tiny_model_o365_goldg.pth", "4274770c817b966621097df306c5ae857a2bdf3dfc242afc402382d9604382d3"),
];

/// The longest file of a kept hash that is read, bytes. A longer one cannot be a hash, and is ignored.
const MAX_HASH_FILE_BYTES: u64 = 100;

/// Checks the hash of a model's file. At the first use of a file without a published hash, `progress` gets a note.
///
/// # Errors
/// When the hash is not the expected one, or a file cannot be read or written.
pub(super) fn check_file(
    config: &HubConfig,
    name: &ModelName,
    path: &Path,
    progress: &dyn DownloadProgress,
) -> Result<(), LocalError> {
    let found = file_sha256(path).map_err(|error| LocalError::from_io(path, "read", error))?;
    let wrong_hash = |expected: &str, what: &str| LocalError::File {
        file: path.to_owned(),
        problem: format!("its SHA-256 is {found}, not {expected}, {what}"),
        hint: "fetch the file again from its makers; if you know that this is the right one, say so with --trust and its SHA-256",
    };
    if let Some(given) = &config.trust {
        let is_given = given.trim().eq_ignore_ascii_case(&found);
        return if is_given { Ok(()) } else { Err(wrong_hash(given, "which was given")) };
    }
    let file = checkpoint_file_name(name).unwrap_or_default();
    if let Some((_, published)) = PUBLISHED_SHA256.iter().find(|(published, _)| *published == file) {
        return if *published == found { Ok(()) } else { Err(wrong_hash(published, "which is the published one")) };
    }
    let kept = kept_hash_path(config, name, path);
    match read_hash(&kept) {
        Some(first) if first == found => Ok(()),
        Some(first) => {
            Err(wrong_hash(&first, &format!("as it was when it was first used (kept in {})", kept.display())))
        }
        None => {
            keep_hash(&kept, &found)?;
            progress.show_note(&format!(
                "{name}: nobody is known to have published the SHA-256 of this file. It is {found}; from now on no other is taken ({})",
                kept.display()
            ));
            Ok(())
        }
    }
}

/// The file name of the checkpoint that a model's name refers to.
fn checkpoint_file_name(name: &ModelName) -> Option<&str> {
    match &name.source {
        ModelSource::Hub(model) => model.file.as_deref().and_then(|file| file.rsplit('/').next()),
        ModelSource::File(path) => path.file_name()?.to_str(),
        ModelSource::Folder(_) => None,
    }
}

/// The path of a kept hash: in the model's folder of the cache, or, for the user's own file, by the hash of its path.
fn kept_hash_path(config: &HubConfig, name: &ModelName, path: &Path) -> PathBuf {
    match &name.source {
        ModelSource::Hub(model) => {
            let folder = config.cache.join(format!("models--{}--{}", model.org, model.name)).join(".trust");
            path_with_suffix(&folder.join(&model.revision).join(model.file.as_deref().unwrap_or_default()), ".sha256")
        }
        _ => {
            let whole = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
            let path_hash = Sha256::digest(whole.as_os_str().as_encoded_bytes());
            config.cache.join(".trust").join(format!("{path_hash:x}.sha256"))
        }
    }
}

fn read_hash(kept: &Path) -> Option<String> {
    let is_short = fs::metadata(kept).ok()?.len() <= MAX_HASH_FILE_BYTES;
    is_short.then(|| fs::read_to_string(kept).ok())?.map(|text| text.trim().to_owned())
}

fn keep_hash(kept: &Path, hash: &str) -> Result<(), LocalError> {
    make_parent(kept)?;
    fs::write(kept, format!("{hash}\n")).map_err(|error| LocalError::from_io(kept, "write", error))
}

fn file_sha256(path: &Path) -> io::Result<String> {
    let mut hasher = Sha256::new();
    io::copy(&mut io::BufReader::with_capacity(1 << 20, File::open(path)?), &mut hasher)?;
    Ok(format!("{:x}", hasher.finalize()))
}
