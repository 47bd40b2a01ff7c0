//! Tests that a checkpoint must have the hash that is published, given by the user, or kept since its first use.

use super::fake::{COMMIT, FakeHub, bytes, sha256};
use crate::hub::{DownloadProgress, HubConfig, ModelHub, ModelName, NeededFiles};
use std::{fs, sync::Mutex};

/// Collects the notes for the user.
#[derive(Default)]
struct Notes(Mutex<Vec<String>>);

impl DownloadProgress for Notes {
    fn bytes_arrived(&self, _: &str, _: u64, _: Option<u64>) {}

    fn show_note(&self, note: &str) {
        self.0.lock().unwrap().push(note.to_owned());
    }
}

/// Uses a model, and returns the notes for the user, or the error.
fn used(config: HubConfig, name: &str) -> Result<Vec<String>, String> {
    let (hub, name, notes) = (ModelHub::new(config).unwrap(), ModelName::parse(name).unwrap(), Notes::default());
    let found = hub
        .model_folder(&name, &NeededFiles::for_any_architecture(&name), &notes)
        .map_err(|error| error.to_string())?;
    assert!(found.file.unwrap().is_file());
    Ok(notes.0.into_inner().unwrap())
}

#[test]
fn a_file_without_a_published_hash_is_noted_once_and_compared_later() {
    let cache = tempfile::tempdir().unwrap();
    let fake = FakeHub::start(vec![("own.pth", bytes(3000))]);
    let hash = sha256(&bytes(3000));
    let notes = used(fake.config(cache.path()), "hf/org/name:own.pth").unwrap();
    assert!(notes.len() == 1 && notes[0].contains(&hash) && notes[0].contains("hf/org/name:own.pth"), "{notes:?}");
    assert!(used(fake.config(cache.path()), "hf/org/name:own.pth").unwrap().is_empty());
    // Somebody replaces the file on this machine.
    let kept = cache.path().join("models--org--name/.trust/main/own.pth.sha256");
    assert_eq!(fs::read_to_string(&kept).unwrap().trim(), hash);
    let file = cache.path().join("models--org--name/snapshots").join(COMMIT).join("own.pth");
    fs::write(&file, bytes(3001)).unwrap();
    let error = used(fake.config(cache.path()), "hf/org/name:own.pth").unwrap_err();
    for part in [&hash, &sha256(&bytes(3001)), "--trust", "own.pth"] {
        assert!(error.contains(part), "{error}");
    }
    // The user accepts the new file by its hash.
    let trust = Some(sha256(&bytes(3001)).to_uppercase());
    assert!(used(HubConfig { trust, ..fake.config(cache.path()) }, "hf/org/name:own.pth").unwrap().is_empty());
}

#[test]
fn a_hash_that_is_published_or_given_must_be_the_files() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("glip_tiny_model_o365_goldg_cc_sbu.pth");
    fs::write(&file, bytes(100)).unwrap();
    let name = format!("hf/{}", file.display());
    let config = || HubConfig { offline: true, ..HubConfig::new(folder.path().join("cache")) };
    let error = used(config(), &name).unwrap_err();
    assert!(
        error.contains("published") && error.contains("3bec0a3d") && error.contains(&sha256(&bytes(100))),
        "{error}"
    );
    let given = |hash: &str| HubConfig { trust: Some(hash.to_owned()), ..config() };
    assert!(used(given(&sha256(&bytes(100))), &name).unwrap().is_empty());
    assert!(used(given(&sha256(b"")), &name).unwrap_err().contains("which was given"));
    // No hash was kept.
    assert!(!folder.path().join("cache").exists());
}

#[test]
fn the_hash_of_the_users_own_file_is_kept_by_its_path() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mine.pth");
    let name = format!("hf/{}", file.display());
    let config = || HubConfig { offline: true, ..HubConfig::new(folder.path().join("cache")) };
    fs::write(&file, bytes(10)).unwrap();
    assert_eq!(used(config(), &name).unwrap().len(), 1);
    assert!(used(config(), &name).unwrap().is_empty());
    fs::write(&file, bytes(11)).unwrap();
    assert!(used(config(), &name).unwrap_err().contains("first used"));
}
