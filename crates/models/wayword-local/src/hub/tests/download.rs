//! Tests downloads over connections that break, and from servers with wrong answers.

use super::{
    fake::{COMMIT, FakeHub, Fault, TOKEN, bytes, fine, model, sha256},
    folder, problem,
    server::Reply,
};
use crate::hub::{DownloadProgress, HubConfig, ModelHub, ModelName, NeededFiles};
use std::{
    fs,
    net::TcpListener,
    path::{Path, PathBuf},
    sync::Mutex,
    thread,
};

/// The path of the weights until they are complete.
fn incomplete(cache: &Path) -> PathBuf {
    cache.join("models--org--name/blobs").join(format!("{}.incomplete", sha256(&bytes(3 << 20))))
}

fn is_whole(cache: &Path) -> bool {
    let path = cache.join("models--org--name/snapshots").join(COMMIT).join("model.safetensors");
    fs::read(path).is_ok_and(|read| read == bytes(3 << 20)) && !incomplete(cache).exists()
}

/// The ranges that were requested from the storage; "" for a request without one.
fn ranges(fake: &FakeHub) -> Vec<String> {
    fake.store.requests().iter().map(|request| request.headers.get("range").cloned().unwrap_or_default()).collect()
}

fn store_fault(files: impl Fn(usize) -> Option<Reply> + Send + Sync + 'static) -> FakeHub {
    FakeHub::with(model(), fine(), Box::new(move |count, _| files(count)))
}

fn cut(sent: usize) -> Reply {
    Reply { sent, ..Reply::new(200, Vec::new(), bytes(3 << 20)) }
}

#[test]
fn a_token_goes_to_the_hub_and_not_along_a_redirect() {
    let cache = tempfile::tempdir().unwrap();
    let fake = FakeHub::start(model());
    let hub = fake.client(cache.path());
    folder(&hub, "hf/org/name").unwrap();
    let bearer = format!("Bearer {TOKEN}");
    assert!(fake.hub.requests().iter().all(|request| request.headers.get("authorization") == Some(&bearer)));
    let stored = fake.store.requests();
    assert_eq!(stored.len(), 1);
    assert!(!stored[0].headers.contains_key("authorization") && stored[0].method == "GET", "{stored:?}");
    assert!(!format!("{hub:?}").contains(TOKEN));
    for (path, bytes) in files(cache.path()) {
        assert!(!String::from_utf8_lossy(&bytes).contains(TOKEN), "{}", path.display());
    }
}

fn files(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            found.push((path.clone(), fs::read(&path).unwrap()));
        }
    }
    found
}

#[test]
fn a_connection_that_breaks_is_taken_up_where_it_ended() {
    let cache = tempfile::tempdir().unwrap();
    let fake = store_fault(|count| (count == 0).then(|| cut(2 << 20)));
    folder(&fake.client(cache.path()), "hf/org/name").unwrap();
    assert!(is_whole(cache.path()));
    let [first, second] = &ranges(&fake)[..] else { panic!("{:?}", ranges(&fake)) };
    let from: u64 = second.strip_prefix("bytes=").unwrap().strip_suffix('-').unwrap().parse().unwrap();
    assert!(first.is_empty() && from > 1 << 20 && from <= 2 << 20, "{second}");
}

#[test]
fn a_later_command_goes_on_where_an_earlier_one_was_killed() {
    let cache = tempfile::tempdir().unwrap();
    fs::create_dir_all(incomplete(cache.path()).parent().unwrap()).unwrap();
    fs::write(incomplete(cache.path()), &bytes(3 << 20)[..1000]).unwrap();
    let fake = FakeHub::start(model());
    folder(&fake.client(cache.path()), "hf/org/name").unwrap();
    assert!(is_whole(cache.path()));
    assert_eq!(ranges(&fake), ["bytes=1000-"]);
}

#[test]
fn a_complete_partial_file_is_only_checked() {
    let cache = tempfile::tempdir().unwrap();
    fs::create_dir_all(incomplete(cache.path()).parent().unwrap()).unwrap();
    fs::write(incomplete(cache.path()), bytes(3 << 20)).unwrap();
    let fake = FakeHub::start(model());
    folder(&fake.client(cache.path()), "hf/org/name").unwrap();
    assert!(is_whole(cache.path()) && ranges(&fake).is_empty());
}

#[test]
fn a_wrong_beginning_is_thrown_away() {
    // Longer than the file, shorter, and of the same length.
    for (length, expected) in [(4 << 20, &[""][..]), (1000, &["bytes=1000-", ""]), (3 << 20, &[""])] {
        let cache = tempfile::tempdir().unwrap();
        fs::create_dir_all(incomplete(cache.path()).parent().unwrap()).unwrap();
        fs::write(incomplete(cache.path()), vec![7; length]).unwrap();
        let fake = FakeHub::start(model());
        folder(&fake.client(cache.path()), "hf/org/name").unwrap();
        assert!(is_whole(cache.path()));
        assert_eq!(ranges(&fake), expected, "{length}");
    }
}

#[test]
fn a_server_without_ranges_gives_all_again() {
    let whole: Fault = Box::new(|_, _| Some(Reply::new(200, Vec::new(), bytes(3 << 20))));
    let other_part: Fault = Box::new(|count, _| {
        let range = vec![("Content-Range", "bytes 0-99/100".to_owned())];
        (count == 0).then(|| Reply::new(206, range, bytes(100)))
    });
    let refuses: Fault = Box::new(|count, _| (count == 0).then(|| Reply::status(416)));
    for fault in [whole, other_part, refuses] {
        let cache = tempfile::tempdir().unwrap();
        fs::create_dir_all(incomplete(cache.path()).parent().unwrap()).unwrap();
        fs::write(incomplete(cache.path()), &bytes(3 << 20)[..1000]).unwrap();
        let fake = FakeHub::with(model(), fine(), fault);
        folder(&fake.client(cache.path()), "hf/org/name").unwrap();
        assert!(is_whole(cache.path()));
    }
}

#[test]
fn bytes_of_another_hash_never_reach_a_snapshot() {
    let cache = tempfile::tempdir().unwrap();
    let mut wrong = bytes(3 << 20);
    wrong[12345] ^= 1;
    let fake = store_fault(move |_| Some(Reply::new(200, Vec::new(), wrong.clone())));
    let problem = problem(&fake.client(cache.path()), "hf/org/name");
    assert!(problem.contains("does not have the hash") && problem.contains("model.safetensors"), "{problem}");
    assert!(!problem.contains("s3cret"), "{problem}");
    let root = cache.path().join("models--org--name");
    assert!(!root.join("snapshots").join(COMMIT).join("model.safetensors").exists());
    assert!(!root.join("blobs").join(sha256(&bytes(3 << 20))).exists() && !incomplete(cache.path()).exists());
    assert!(!root.join("refs/main").exists());
    assert_eq!(fake.store.requests().len(), 1, "gigabytes are not fetched twice for the same lie");
}

#[test]
fn bytes_beyond_the_announced_size_are_refused() {
    let cache = tempfile::tempdir().unwrap();
    let fake = store_fault(|_| Some(Reply::new(200, Vec::new(), bytes((3 << 20) + 1))));
    let problem = problem(&fake.client(cache.path()), "hf/org/name");
    assert!(problem.contains("3145728 bytes"), "{problem}");
    assert_eq!(fs::metadata(incomplete(cache.path())).unwrap().len(), 0);
}

#[test]
fn a_server_that_breaks_off_for_ever_is_given_up() {
    for sent in [0, 1000] {
        let cache = tempfile::tempdir().unwrap();
        let fake = store_fault(move |_| Some(cut(sent)));
        let problem = problem(&fake.client(cache.path()), "hf/org/name");
        assert!(problem.contains("5 times in a row") && problem.contains("continues from there"), "{problem}");
        assert_eq!(fake.store.requests().len(), 5);
    }
}

#[test]
fn two_concurrent_fetches_download_a_file_once() {
    struct Seen(Mutex<Vec<(String, u64)>>);
    impl DownloadProgress for Seen {
        fn bytes_arrived(&self, file: &str, done: u64, _: Option<u64>) {
            self.0.lock().unwrap().push((file.to_owned(), done));
        }
    }
    let cache = tempfile::tempdir().unwrap();
    let fake = FakeHub::start(model());
    let (name, seen) = (ModelName::parse("hf/org/name").unwrap(), Seen(Mutex::default()));
    thread::scope(|scope| {
        for _ in 0..4 {
            let hub = fake.client(cache.path());
            let (name, seen) = (&name, &seen);
            scope.spawn(move || hub.model_folder(name, &NeededFiles::for_any_architecture(name), seen).unwrap());
        }
    });
    assert!(is_whole(cache.path()));
    assert_eq!(fake.store.requests().len(), 1);
    let seen = seen.0.into_inner().unwrap();
    assert!(
        seen.contains(&("model.safetensors".to_owned(), 3 << 20)) && seen.contains(&("config.json".to_owned(), 18))
    );
}

#[test]
fn redirects_in_circles_or_to_no_address_end() {
    for to in ["/org/name/resolve/main/config.json", "ftp://127.0.0.1/x", "https://user:s3cret@127.0.0.1/x", ""] {
        let cache = tempfile::tempdir().unwrap();
        let fault: Fault = Box::new(move |_, _| Some(Reply::new(302, vec![("Location", to.to_owned())], Vec::new())));
        let fake = FakeHub::with(model(), fault, fine());
        let problem = problem(&fake.client(cache.path()), "hf/org/name");
        assert!(problem.contains("redirect") && !problem.contains("s3cret"), "{problem}");
        assert!(fake.requests() <= 10);
    }
}

#[test]
fn a_model_that_was_renamed_is_found_under_its_new_name() {
    let cache = tempfile::tempdir().unwrap();
    let fault: Fault = Box::new(|_, request| {
        let to = request.path.strip_prefix("/old/title/").map(|rest| format!("/org/name/{rest}"))?;
        Some(Reply::new(307, vec![("Location", to)], Vec::new()))
    });
    let fake = FakeHub::with(model(), fault, fine());
    let found = folder(&fake.client(cache.path()), "hf/old/title").unwrap();
    assert_eq!(found.identity, COMMIT);
    assert!(fake.hub.requests().iter().all(|request| request.headers.contains_key("authorization")));
}

#[test]
fn answers_without_a_commit_or_a_hash_are_refused() {
    let (commit, etag) = (("X-Repo-Commit", COMMIT.to_owned()), ("ETag", "\"abc\"".to_owned()));
    let other = ("X-Repo-Commit", "../../etc".to_owned());
    let whole = ("ETag", format!("\"{}\"", super::fake::git(b"{}")));
    for headers in [vec![], vec![commit.clone()], vec![commit, etag], vec![whole.clone()], vec![other, whole]] {
        let cache = tempfile::tempdir().unwrap();
        let fault: Fault = Box::new(move |_, _| Some(Reply::new(200, headers.clone(), b"{}".to_vec())));
        let fake = FakeHub::with(model(), fault, fine());
        let problem = problem(&fake.client(cache.path()), "hf/org/name");
        assert!(problem.contains("the answer has no") && problem.contains("HF_ENDPOINT"), "{problem}");
        assert_eq!(fs::read_dir(cache.path()).unwrap().count(), 0, "nothing was written");
    }
}

#[test]
fn an_answer_of_another_commit_than_asked_is_refused() {
    let cache = tempfile::tempdir().unwrap();
    let fault: Fault = Box::new(|_, request| {
        let headers = vec![("X-Repo-Commit", "f".repeat(40)), ("ETag", super::fake::git(b"{}"))];
        request.path.contains("tokenizer.json").then(|| Reply::new(200, headers, b"{}".to_vec()))
    });
    let fake = FakeHub::with(model(), fault, fine());
    let problem = problem(&fake.client(cache.path()), "hf/org/name");
    assert!(problem.contains("another commit"), "{problem}");
}

#[test]
fn an_unreachable_machine_is_reported_with_a_hint() {
    // A port that was free a moment ago.
    let endpoint = format!("http://{}", TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap());
    let cache = tempfile::tempdir().unwrap();
    let config = HubConfig { endpoint, ..HubConfig::new(cache.path().to_owned()) };
    let problem = problem(&ModelHub::new(config).unwrap(), "hf/org/name");
    assert!(problem.contains("127.0.0.1") && problem.contains("WAYWORD_OFFLINE=1"), "{problem}");
}
