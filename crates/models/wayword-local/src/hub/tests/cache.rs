//! Tests the layout of the cache, and when the hub is asked.

use super::{
    fake::{COMMIT, FakeHub, bytes, git, model, sha256},
    folder,
};
use crate::hub::{HubConfig, ModelHub, ModelName, NeededFiles, cache::BlobHash};
use std::{fs, path::Path};

const LATER: &str = "fedcba9876543210fedcba9876543210fedcba98";

fn read_link(path: &Path) -> String {
    fs::read_link(path).unwrap().to_str().unwrap().to_owned()
}

#[cfg(unix)]
#[test]
fn the_cache_has_the_layout_of_the_hubs_own_client() {
    let cache = tempfile::tempdir().unwrap();
    let fake = FakeHub::start(model());
    let found = folder(&fake.client(cache.path()), "hf/org/name").unwrap();
    let root = cache.path().join("models--org--name");
    assert_eq!(found.path, root.join("snapshots").join(COMMIT));
    assert_eq!((found.identity.as_str(), &found.file), (COMMIT, &None));
    assert_eq!(fs::read_to_string(root.join("refs/main")).unwrap(), COMMIT);
    let (config, weights) = (git(b"{\"hidden_size\": 8}"), sha256(&bytes(3 << 20)));
    assert_eq!(read_link(&found.path.join("config.json")), format!("../../blobs/{config}"));
    assert_eq!(read_link(&found.path.join("model.safetensors")), format!("../../blobs/{weights}"));
    let pooling = found.path.join("1_Pooling/config.json");
    assert_eq!(read_link(&pooling), format!("../../../blobs/{}", git(b"{\"mean\": true}")));
    assert_eq!(fs::read_to_string(pooling).unwrap(), "{\"mean\": true}");
    assert_eq!(fs::read(found.path.join("model.safetensors")).unwrap(), bytes(3 << 20));
    assert!(root.join(".no_exist").join(COMMIT).join("modules.json").is_file());
    assert!(cache.path().join(format!(".locks/models--org--name/{weights}.lock")).is_file());
    let mut blobs: Vec<_> = fs::read_dir(root.join("blobs")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    blobs.sort();
    assert_eq!(blobs.len(), 4, "{blobs:?}");
}

#[test]
fn cached_files_are_used_until_a_new_fetch() {
    let cache = tempfile::tempdir().unwrap();
    let fake = FakeHub::start(model());
    let hub = fake.client(cache.path());
    let first = folder(&hub, "hf/org/name").unwrap();
    let asked = fake.requests();
    fake.commit(LATER, "config.json", b"{}");
    assert_eq!(folder(&hub, "hf/org/name").unwrap(), first);
    assert_eq!(folder(&hub, &format!("hf/org/name@{COMMIT}")).unwrap(), first);
    assert_eq!(fake.requests(), asked, "the hub was asked for what is here");

    let stored = fake.store.requests().len();
    let name = ModelName::parse("hf/org/name").unwrap();
    let later = hub.fetch_model(&name, &NeededFiles::for_any_architecture(&name), &()).unwrap();
    assert_eq!(later.identity, LATER);
    assert_eq!(fs::read_to_string(later.path.join("config.json")).unwrap(), "{}");
    assert_eq!(fake.store.requests().len(), stored, "the weights are the same and came again");
    assert_eq!(folder(&hub, "hf/org/name").unwrap(), later);
    assert_eq!(fs::read_to_string(first.path.join("config.json")).unwrap(), "{\"hidden_size\": 8}");
}

#[test]
fn a_file_that_is_missing_comes_from_the_commit_of_the_others() {
    let cache = tempfile::tempdir().unwrap();
    let fake = FakeHub::start(model());
    let hub = fake.client(cache.path());
    let first = folder(&hub, "hf/org/name").unwrap();
    fs::remove_file(first.path.join("config.json")).unwrap();
    fake.commit(LATER, "tokenizer.json", b"later");
    assert_eq!(folder(&hub, "hf/org/name").unwrap(), first);
    assert_eq!(fs::read_to_string(first.path.join("config.json")).unwrap(), "{\"hidden_size\": 8}");
}

#[test]
fn a_fetch_that_fails_leaves_the_older_snapshot_in_use() {
    let cache = tempfile::tempdir().unwrap();
    let fake = FakeHub::with(
        model(),
        super::fake::fine(),
        Box::new(|count, _| (count > 0).then(|| super::server::Reply::status(403))),
    );
    let hub = fake.client(cache.path());
    let first = folder(&hub, "hf/org/name").unwrap();
    fake.commit(LATER, "model.safetensors", &bytes(5000));
    let name = ModelName::parse("hf/org/name").unwrap();
    assert!(hub.fetch_model(&name, &NeededFiles::for_any_architecture(&name), &()).is_err());
    assert_eq!(folder(&hub, "hf/org/name").unwrap(), first);
}

#[test]
fn without_links_snapshots_contain_copies() {
    let cache = tempfile::tempdir().unwrap();
    let fake = FakeHub::start(model());
    let hub = ModelHub::new(HubConfig { symlinks: false, ..fake.config(cache.path()) }).unwrap();
    let found = folder(&hub, "hf/org/name").unwrap();
    let weights = found.path.join("model.safetensors");
    assert!(fs::symlink_metadata(&weights).unwrap().is_file());
    assert_eq!(fs::read(weights).unwrap(), bytes(3 << 20));
    let names: Vec<_> = fs::read_dir(&found.path).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(names.len(), 4, "nothing is left over: {names:?}");
}

#[test]
fn weights_in_parts_are_all_fetched_and_no_other_form_of_them() {
    let cache = tempfile::tempdir().unwrap();
    let index = serde_json::json!({ "weight_map": { "a": "part-1.safetensors", "b": "part-2.safetensors" } });
    let fake = FakeHub::start(vec![
        ("config.json", b"{}".to_vec()),
        ("model.safetensors.index.json", index.to_string().into_bytes()),
        ("part-1.safetensors", bytes(100)),
        ("part-2.safetensors", bytes(200)),
        ("pytorch_model.bin", bytes(300)),
    ]);
    let found = folder(&fake.client(cache.path()), "hf/org/name").unwrap();
    assert_eq!(fs::read(found.path.join("part-2.safetensors")).unwrap(), bytes(200));
    assert!(found.path.join("part-1.safetensors").is_file() && !found.path.join("pytorch_model.bin").exists());
}

#[test]
fn a_pickled_checkpoint_is_the_last_resort_and_stays_the_one_in_use() {
    let cache = tempfile::tempdir().unwrap();
    let fake = FakeHub::start(vec![("config.json", b"{}".to_vec()), ("pytorch_model.bin", bytes(300))]);
    let hub = fake.client(cache.path());
    let found = folder(&hub, "hf/org/name").unwrap();
    assert!(found.path.join("pytorch_model.bin").is_file());
    let asked = fake.requests();
    assert_eq!(folder(&hub, "hf/org/name").unwrap(), found);
    assert_eq!(fake.requests(), asked);
}

#[test]
fn parts_that_lie_elsewhere_are_refused() {
    let cache = tempfile::tempdir().unwrap();
    let index = serde_json::json!({ "weight_map": { "a": "../../../evil.safetensors" } });
    let fake = FakeHub::start(vec![
        ("config.json", b"{}".to_vec()),
        ("model.safetensors.index.json", index.to_string().into_bytes()),
    ]);
    let problem = super::problem(&fake.client(cache.path()), "hf/org/name");
    assert!(problem.contains("not the name of a file"), "{problem}");
}

#[test]
fn a_gguf_name_fetches_that_file_alone() {
    let cache = tempfile::tempdir().unwrap();
    let fake = FakeHub::start(vec![("q4/small.gguf", bytes(5000)), ("q8/large.gguf", bytes(9000))]);
    let found = folder(&fake.client(cache.path()), "hf/org/name@main:q4/small.gguf").unwrap();
    let file = found.file.unwrap();
    assert_eq!(file, found.path.join("q4/small.gguf"));
    assert_eq!((fs::read(file).unwrap(), fake.store.requests().len()), (bytes(5000), 1));
}

#[test]
fn list_has_models_with_commits_and_lengths() {
    let cache = tempfile::tempdir().unwrap();
    let fake = FakeHub::start(model());
    let hub = fake.client(cache.path());
    assert_eq!(hub.list_models().unwrap(), []);
    let found = folder(&hub, "hf/org/name").unwrap();
    fs::create_dir_all(cache.path().join("datasets--org--data/snapshots/x")).unwrap();
    fs::create_dir_all(cache.path().join("models--gpt2/snapshots/x")).unwrap();
    fs::write(cache.path().join("version.txt"), "1").unwrap();
    let [model] = &hub.list_models().unwrap()[..] else { panic!("one model") };
    assert_eq!((model.name.as_str(), model.commit.as_str()), ("hf/org/name", COMMIT));
    assert_eq!((&model.revisions[..], model.files), (&["main".to_owned()][..], 4));
    assert_eq!(model.bytes, (3 << 20) + 18 + 2 + 14);
    assert_eq!(model.folder, found.path);
}

#[test]
fn files_are_compared_with_both_kinds_of_hash() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "hello\n").unwrap();
    // `echo hello | git hash-object --stdin` and `echo hello | sha256sum`.
    let git = "ce013625030ba8dba906f756967f9e9ca394464a";
    let sha256 = "5891b5b522d5df086d0ff0b110fbd9d21bb4fc7163af34d08286a2e846f6be03";
    for etag in [git, sha256, &format!("\"{git}\""), &format!("W/\"{sha256}\"")] {
        assert!(BlobHash::from_etag(etag).unwrap().matches_file(&file).unwrap(), "{etag}");
    }
    let other = BlobHash::from_etag(&git.replace('c', "d")).unwrap();
    assert!(!other.matches_file(&file).unwrap());
}

#[test]
fn etags_that_are_no_hash_are_refused() {
    let etags = ["", "\"\"", "abc", "../../etc/passwd", "5D41402ABC4B2A76B9719D911017C592AAAAAAAA", "bb-bWMd8e2"];
    for etag in etags {
        assert_eq!(BlobHash::from_etag(etag), None, "{etag}");
    }
}
