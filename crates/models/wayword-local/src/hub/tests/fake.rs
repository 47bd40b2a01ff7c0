//! A hub with one model, and a storage on another port, to which the hub redirects for large files.

use super::server::{Reply, Request, Server};
use crate::hub::{HubConfig, ModelHub, config::HubToken};
use sha1::Sha1;
use sha2::{Digest, Sha256};
use std::{
    collections::BTreeMap,
    path::Path,
    sync::{Arc, Mutex},
    time::Duration,
};

pub(super) const TOKEN: &str = "hf_test_0123456789";
/// The commit that `main` points to at first.
pub(super) const COMMIT: &str = "0123456789abcdef0123456789abcdef01234567";

/// The faulty answer that a server gives instead of the right one, by the number of earlier requests.
pub(super) type Fault = Box<dyn Fn(usize, &Request) -> Option<Reply> + Send + Sync>;

pub(super) struct FakeHub {
    pub(super) hub: Server,
    pub(super) store: Server,
    repo: Arc<Mutex<Repo>>,
}

#[derive(Clone)]
struct Repo {
    commit: String,
    files: BTreeMap<String, Vec<u8>>,
}

/// No fault.
pub(super) fn fine() -> Fault {
    Box::new(|_, _| None)
}

/// Bytes that are not all equal.
pub(super) fn bytes(count: usize) -> Vec<u8> {
    (0..count).map(|at| (at * 31 % 251) as u8).collect()
}

/// A small model with its weights in one file.
pub(super) fn model() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("config.json", b"{\"hidden_size\": 8}".to_vec()),
        ("tokenizer.json", b"{}".to_vec()),
        ("1_Pooling/config.json", b"{\"mean\": true}".to_vec()),
        ("model.safetensors", bytes(3 << 20)),
    ]
}

impl FakeHub {
    pub(super) fn start(files: Vec<(&'static str, Vec<u8>)>) -> Self {
        Self::with(files, fine(), fine())
    }

    pub(super) fn with(files: Vec<(&'static str, Vec<u8>)>, hub_fault: Fault, store_fault: Fault) -> Self {
        let files = files.into_iter().map(|(name, bytes)| (name.to_owned(), bytes)).collect();
        let repo = Arc::new(Mutex::new(Repo { commit: COMMIT.to_owned(), files }));
        let (for_store, for_hub) = (Arc::clone(&repo), Arc::clone(&repo));
        let store = Server::start(move |count, request| {
            store_fault(count, request).unwrap_or_else(|| stored(&for_store.lock().unwrap(), request))
        });
        let store_url = store.url();
        let hub = Server::start(move |count, request| {
            hub_fault(count, request).unwrap_or_else(|| resolve(&for_hub.lock().unwrap(), &store_url, request))
        });
        Self { hub, store, repo }
    }

    /// A client of this hub with a cache in a folder, a token, and short waits.
    pub(super) fn client(&self, cache: &Path) -> ModelHub {
        ModelHub::new(self.config(cache)).unwrap()
    }

    pub(super) fn config(&self, cache: &Path) -> HubConfig {
        HubConfig {
            endpoint: self.hub.url(),
            token: Some(HubToken::new(TOKEN).unwrap()),
            first_wait: Duration::from_millis(1),
            ..HubConfig::new(cache.to_owned())
        }
    }

    /// Makes a commit that changes a file.
    pub(super) fn commit(&self, commit: &str, file: &str, bytes: &[u8]) {
        let mut repo = self.repo.lock().unwrap();
        repo.commit = commit.to_owned();
        repo.files.insert(file.to_owned(), bytes.to_vec());
    }

    /// How many requests both servers have got so far.
    pub(super) fn requests(&self) -> usize {
        self.hub.requests().len() + self.store.requests().len()
    }
}

pub(super) fn is_large(file: &str) -> bool {
    [".safetensors", ".gguf", ".bin"].iter().any(|end| file.ends_with(end))
}

pub(super) fn sha256(bytes: &[u8]) -> String {
    format!("{:x}", Sha256::digest(bytes))
}

pub(super) fn git(bytes: &[u8]) -> String {
    let hash = Sha1::new().chain_update(format!("blob {}\0", bytes.len())).chain_update(bytes).finalize();
    format!("{hash:x}")
}

fn resolve(repo: &Repo, store: &str, request: &Request) -> Reply {
    let wrong = |status, code: &str| Reply::new(status, vec![("X-Error-Code", code.to_owned())], Vec::new());
    let Some(rest) = request.path.strip_prefix("/org/name/resolve/") else { return wrong(401, "RepoNotFound") };
    let (revision, file) = rest.split_once('/').unwrap();
    if revision != "main" && revision.len() != 40 {
        return wrong(404, "RevisionNotFound");
    }
    let commit = if revision == "main" { repo.commit.clone() } else { revision.to_owned() };
    let Some(bytes) = repo.files.get(file) else {
        let headers = vec![("X-Error-Code", "EntryNotFound".to_owned()), ("X-Repo-Commit", commit)];
        return Reply::new(404, headers, b"Entry not found".to_vec());
    };
    if !is_large(file) {
        return Reply::new(
            200,
            vec![("X-Repo-Commit", commit), ("ETag", format!("\"{}\"", git(bytes)))],
            bytes.clone(),
        );
    }
    let headers = vec![
        ("X-Repo-Commit", commit),
        ("X-Linked-Etag", format!("\"{}\"", sha256(bytes))),
        ("X-Linked-Size", bytes.len().to_string()),
        // As on the real hub, the redirect's own page has an etag too.
        ("ETag", "W/\"bb-redirect\"".to_owned()),
        ("Location", format!("{store}/{file}?signature=s3cret")),
    ];
    Reply::new(302, headers, b"Found".to_vec())
}

fn stored(repo: &Repo, request: &Request) -> Reply {
    if request.method == "HEAD" {
        // A signed address works with one method only.
        return Reply::status(403);
    }
    let file = request.path.trim_start_matches('/').split('?').next().unwrap();
    let bytes = &repo.files[file];
    let from = request
        .headers
        .get("range")
        .map(|range| -> usize { range.strip_prefix("bytes=").unwrap().strip_suffix('-').unwrap().parse().unwrap() });
    match from {
        None => Reply::new(200, vec![("ETag", "\"another\"".to_owned())], bytes.clone()),
        Some(from) if from >= bytes.len() => Reply::status(416),
        Some(from) => {
            let range = format!("bytes {from}-{}/{}", bytes.len() - 1, bytes.len());
            Reply::new(206, vec![("Content-Range", range)], bytes[from..].to_vec())
        }
    }
}
