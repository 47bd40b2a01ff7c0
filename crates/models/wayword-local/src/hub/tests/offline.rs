//! Tests models without the network: from the cache, from files that the user put there, and from the user's own
//! folders.

use super::{
    fake::{COMMIT, FakeHub, bytes, model},
    folder, problem,
};
use crate::hub::{HubConfig, ModelHub, ModelName, NeededFiles};
use std::{fs, path::Path};

fn offline(cache: &Path) -> ModelHub {
    ModelHub::new(HubConfig { offline: true, ..HubConfig::new(cache.to_owned()) }).unwrap()
}

fn write_model(folder: &Path) {
    for (name, bytes) in model() {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
}

#[test]
fn offline_uses_the_cache_without_any_request() {
    let cache = tempfile::tempdir().unwrap();
    let fake = FakeHub::start(model());
    let online = folder(&fake.client(cache.path()), "hf/org/name").unwrap();
    let asked = fake.requests();
    let hub = ModelHub::new(HubConfig { offline: true, ..fake.config(cache.path()) }).unwrap();
    assert_eq!(folder(&hub, "hf/org/name").unwrap(), online);
    fs::remove_file(online.path.join("model.safetensors")).unwrap();
    let problem = problem(&hub, "hf/org/name");
    assert!(
        problem.starts_with(&format!("{}: the checkpoint is missing", online.path.join("model.safetensors").display()))
    );
    assert_eq!(fake.requests(), asked);
}

#[test]
fn offline_error_names_a_path_where_the_file_works() {
    let cache = tempfile::tempdir().unwrap();
    let hub = offline(cache.path());
    for (name, revision) in
        [("hf/org/name", "main"), ("hf/org/name@v1.0", "v1.0"), ("hf/org/other@refs/pr/1", "refs/pr/1")]
    {
        let told = problem(&hub, name);
        let repo = if name.contains("other") { "other" } else { "name" };
        let belongs = cache.path().join(format!("models--org--{repo}/snapshots/{revision}/config.json"));
        assert!(told.starts_with(&format!("{}: ", belongs.display())), "{told}");
        let address = format!("https://huggingface.co/org/{repo}/resolve/{}/config.json", revision.replace('/', "%2F"));
        assert!(told.contains(&address) && told.contains("WAYWORD_OFFLINE"), "{told}");
        assert!(told.contains(&format!("run `wayword models fetch {name}`;")), "{told}");
        write_model(belongs.parent().unwrap());
        let found = folder(&hub, name).unwrap();
        assert_eq!(found.path, belongs.parent().unwrap());
        assert!(found.identity.starts_with("sha256:"), "{}", found.identity);
    }
}

#[test]
fn a_tokenizer_is_fetched_without_its_model() {
    let cache = tempfile::tempdir().unwrap();
    let name = ModelName::parse("hf/org/name").unwrap();
    let told = offline(cache.path()).model_folder(&name, &NeededFiles::for_tokenizer(), &()).unwrap_err().to_string();
    assert!(told.contains("run `wayword models fetch --tokenizer hf/org/name`;"), "{told}");
    let fake = FakeHub::start(model());
    let found = fake.client(cache.path()).fetch_model(&name, &NeededFiles::for_tokenizer(), &()).unwrap();
    assert!(found.path.join("tokenizer.json").is_file() && !found.path.join("model.safetensors").exists());
    let again = ModelHub::new(HubConfig { offline: true, ..fake.config(cache.path()) }).unwrap();
    assert_eq!(again.model_folder(&name, &NeededFiles::for_tokenizer(), &()).unwrap(), found);
}

#[test]
fn files_put_there_by_hand_serve_online_too() {
    let cache = tempfile::tempdir().unwrap();
    write_model(&cache.path().join("models--org--name/snapshots/main"));
    let fake = FakeHub::start(model());
    let hub = fake.client(cache.path());
    let found = folder(&hub, "hf/org/name").unwrap();
    assert!(found.path.ends_with("snapshots/main") && fake.requests() == 0);
    fs::remove_file(found.path.join("config.json")).unwrap();
    assert!(folder(&hub, "hf/org/name").unwrap().path.ends_with(COMMIT), "half a model was used");
}

#[test]
fn a_local_folder_is_used_as_it_is() {
    let folder_ = tempfile::tempdir().unwrap();
    let name = format!("hf/{}", folder_.path().display());
    let hub = offline(Path::new("/nowhere"));
    let told = problem(&hub, &name);
    assert!(told.starts_with(&format!("{}: ", folder_.path().join("config.json").display())), "{told}");
    write_model(folder_.path());
    let found = folder(&hub, &name).unwrap();
    assert_eq!((found.path.as_path(), found.file), (folder_.path(), None));
    assert_eq!(fs::read_dir(folder_.path()).unwrap().count(), 4, "nothing was written there");
}

#[test]
fn the_identity_of_a_local_model_changes_when_the_model_does() {
    let folder_ = tempfile::tempdir().unwrap();
    let (hub, name) = (offline(Path::new("/nowhere")), format!("hf/{}", folder_.path().display()));
    write_model(folder_.path());
    let identity = || folder(&hub, &name).unwrap().identity;
    let first = identity();
    assert_eq!((first.len(), identity()), (7 + 64, first.clone()));
    let mut seen = vec![first];
    let mut trained: Vec<u8> = bytes(3 << 20).iter().map(|byte| byte ^ 1).collect();
    trained[..100_000].copy_from_slice(&bytes(100_000));
    let mut last_byte = bytes(3 << 20);
    last_byte[(3 << 20) - 1] ^= 1;
    for (file, content) in [
        ("config.json", b"{\"hidden_size\": 9}".to_vec()),
        ("tokenizer.json", b"{ }".to_vec()),
        ("model.safetensors", trained),
        ("model.safetensors", last_byte),
        ("model.safetensors", bytes((3 << 20) + 1)),
        ("model.safetensors", bytes(10)),
    ] {
        fs::write(folder_.path().join(file), content).unwrap();
        let now = identity();
        assert!(!seen.contains(&now), "{file}");
        seen.push(now);
    }
}

#[test]
fn a_local_gguf_file_is_a_model() {
    let folder_ = tempfile::tempdir().unwrap();
    let file = folder_.path().join("small.gguf");
    let (hub, name) = (offline(Path::new("/nowhere")), format!("hf/{}", file.display()));
    let told = problem(&hub, &name);
    assert!(told.starts_with(&format!("{}: the model is missing", file.display())), "{told}");
    fs::write(&file, bytes(2000)).unwrap();
    let found = folder(&hub, &name).unwrap();
    assert_eq!((found.path.as_path(), found.file), (folder_.path(), Some(file)));
}
