//! Tests that every object store must pass: in memory, in a folder, and in those that `WAYWORD_TEST_S3` and
//! `WAYWORD_TEST_AZURE` name (`trials/scale/objects.sh` starts two simulators for them).

#![cfg(feature = "cloud")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::{
    fs,
    path::Path,
    sync::{
        Mutex,
        atomic::{AtomicU32, Ordering},
    },
};
use tempfile::TempDir;
use wayword_queue::cloud::{CloudBucket, CloudError, FETCH_INDEX_FILE, FetchSummary, SendSummary};

/// A bucket, and the folder that it may be in.
struct Place {
    bucket: CloudBucket,
    folder: Option<TempDir>,
}

fn memory() -> Option<Place> {
    Some(Place { bucket: CloudBucket::in_memory().unwrap(), folder: None })
}

fn folder() -> Option<Place> {
    let folder = tempfile::tempdir().unwrap();
    let bucket = CloudBucket::open(&format!("file://{}/new/folder", folder.path().display())).unwrap();
    Some(Place { bucket, folder: Some(folder) })
}

/// A new prefix in the bucket that a variable names.
#[allow(clippy::print_stderr, reason = "a test that is skipped says so")]
fn named(variable: &str) -> Option<Place> {
    static NUMBER: AtomicU32 = AtomicU32::new(0);
    let Ok(url) = std::env::var(variable) else {
        eprintln!("skipped: {variable} names no bucket");
        return None;
    };
    let url = format!("{url}/{}-{}", std::process::id(), NUMBER.fetch_add(1, Ordering::Relaxed));
    Some(Place { bucket: CloudBucket::open(&url).unwrap(), folder: None })
}

fn s3() -> Option<Place> {
    named("WAYWORD_TEST_S3")
}

fn azure() -> Option<Place> {
    named("WAYWORD_TEST_AZURE")
}

/// Each behaviour is one test in each store.
macro_rules! in_every_store {
    ($($behaviour:ident),* $(,)?) => { in_every_store!(@stores [memory folder s3 azure] $($behaviour),*); };
    (@stores [$($store:ident)*] $($behaviour:ident),*) => {
        in_every_store!(@each [$($store)*] [$($behaviour)*]);
    };
    (@each [$store:ident $($rest:ident)*] [$($behaviour:ident)*]) => {
        mod $store {
            $(#[test] fn $behaviour() {
                if let Some(place) = super::$store() { super::$behaviour(&place); }
            })*
        }
        in_every_store!(@each [$($rest)*] [$($behaviour)*]);
    };
    (@each [] [$($behaviour:ident)*]) => {};
}

in_every_store!(
    an_object_that_was_written_is_read_listed_and_removed,
    of_eight_writers_of_a_new_object_one_wins,
    the_store_lets_one_writer_win,
    an_object_that_is_too_large_is_not_read,
    list_returns_only_objects_below_the_prefix,
    a_folder_that_was_sent_is_fetched_again,
    a_large_file_is_sent_and_fetched_in_parts,
    a_fetch_takes_only_what_is_missing_or_changed,
    a_fetch_that_would_be_too_large_takes_nothing,
    a_fetch_does_not_follow_a_link_out_of_its_folder,
    a_hostile_name_is_refused_by_every_call,
    names_with_spaces_percents_and_letters_of_all_kinds_are_kept,
    fetch_folder_skips_empty_objects_that_represent_folders,
);

const MANY: u64 = 1 << 30;

fn quiet(_: u64, _: u64) {}

fn fill(folder: &Path) {
    fs::create_dir_all(folder.join("deep/er")).unwrap();
    fs::write(folder.join("a.json"), "{}").unwrap();
    fs::write(folder.join("deep/empty"), "").unwrap();
    fs::write(folder.join("deep/er/b.bin"), vec![7; 100_000]).unwrap();
}

fn an_object_that_was_written_is_read_listed_and_removed(place: &Place) {
    let bucket = &place.bucket;
    assert_eq!(bucket.get_object("chunks/1", 10).unwrap(), None);
    bucket.put_object("chunks/1", "one").unwrap();
    bucket.put_object("chunks/1", "two").unwrap();
    assert_eq!(bucket.get_object("chunks/1", 3).unwrap().unwrap(), b"two");
    let entries = bucket.list_objects("").unwrap();
    assert_eq!(entries.len(), 1);
    assert_eq!((entries[0].name.as_str(), entries[0].bytes), ("chunks/1", 3));
    assert!(entries[0].version.is_some());
    bucket.remove_object("chunks/1").unwrap();
    bucket.remove_object("chunks/1").unwrap();
    assert_eq!(bucket.list_objects("").unwrap(), []);
}

fn of_eight_writers_of_a_new_object_one_wins(place: &Place) {
    for round in 0..5 {
        let name = format!("marks/{round}");
        let winners = Mutex::new(Vec::new());
        std::thread::scope(|scope| {
            for writer in 0..8 {
                let (name, winners) = (&name, &winners);
                scope.spawn(move || {
                    if place.bucket.put_new(name, format!("writer {writer}")).unwrap() {
                        winners.lock().unwrap().push(writer);
                    }
                });
            }
        });
        let winners = winners.into_inner().unwrap();
        assert_eq!(winners.len(), 1, "winners: {winners:?}");
        let there = place.bucket.get_object(&name, 100).unwrap().unwrap();
        assert_eq!(there, format!("writer {}", winners[0]).as_bytes());
    }
}

fn the_store_lets_one_writer_win(place: &Place) {
    place.bucket.check_put_new().unwrap();
    assert_eq!(place.bucket.list_objects("").unwrap(), [], "the check leaves nothing");
}

fn an_object_that_is_too_large_is_not_read(place: &Place) {
    place.bucket.put_object("big", vec![0; 1000]).unwrap();
    let error = place.bucket.get_object("big", 999).unwrap_err();
    assert!(matches!(error, CloudError::TooLarge { bytes: 1000, most: 999, .. }), "{error}");
}

fn list_returns_only_objects_below_the_prefix(place: &Place) {
    for name in ["run/b", "run/a/1", "run-2/c", "runner"] {
        place.bucket.put_object(name, "x").unwrap();
    }
    let names: Vec<_> = place.bucket.list_objects("run").unwrap().into_iter().map(|entry| entry.name).collect();
    assert_eq!(names, ["run/a/1", "run/b"]);
}

fn a_folder_that_was_sent_is_fetched_again(place: &Place) {
    let (from, to) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    fill(from.path());
    #[cfg(unix)]
    std::os::unix::fs::symlink("/etc/hostname", from.path().join("link")).unwrap();
    let sent = place.bucket.send_folder(from.path(), "attempt-1").unwrap();
    assert_eq!(sent, SendSummary { files: 3, bytes: 100_002 }, "links are not sent");
    assert_eq!(place.bucket.send_folder(from.path(), "attempt-1").unwrap(), sent, "once more does no harm");
    let seen = Mutex::new(Vec::new());
    let fetched =
        place.bucket.fetch_folder("attempt-1", to.path(), MANY, &|done, all| seen.lock().unwrap().push((done, all)));
    assert_eq!(fetched.unwrap(), FetchSummary { files: 3, bytes: 100_002, kept: 0 });
    for name in ["a.json", "deep/empty", "deep/er/b.bin"] {
        assert_eq!(fs::read(from.path().join(name)).unwrap(), fs::read(to.path().join(name)).unwrap());
    }
    let seen = seen.into_inner().unwrap();
    assert_eq!((seen[0], seen[seen.len() - 1]), ((0, 100_002), (100_002, 100_002)));
}

fn a_large_file_is_sent_and_fetched_in_parts(place: &Place) {
    let (from, to) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    // More than four parts, and two requests; no part is like another.
    let bytes: Vec<u8> = (0..34_000_001u32).map(|at| (at.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    fs::write(from.path().join("scene.glb"), &bytes).unwrap();
    place.bucket.send_folder(from.path(), "data").unwrap();
    place.bucket.fetch_folder("data", to.path(), MANY, &quiet).unwrap();
    assert!(fs::read(to.path().join("scene.glb")).unwrap() == bytes);
}

fn a_fetch_takes_only_what_is_missing_or_changed(place: &Place) {
    let (from, to) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    fill(from.path());
    place.bucket.send_folder(from.path(), "data").unwrap();
    let fetch = || place.bucket.fetch_folder("data", to.path(), MANY, &quiet).unwrap();
    assert_eq!(fetch().files, 3);
    assert_eq!(fetch(), FetchSummary { files: 0, bytes: 0, kept: 3 });
    // The same size, another content.
    place.bucket.put_object("data/a.json", "[]").unwrap();
    fs::remove_file(to.path().join("deep/empty")).unwrap();
    fs::write(to.path().join("deep/er/b.bin"), "half").unwrap();
    assert_eq!(fetch().files, 3);
    assert_eq!(fs::read(to.path().join("a.json")).unwrap(), b"[]");
    assert_eq!(fs::read(to.path().join("deep/er/b.bin")).unwrap().len(), 100_000);
    fs::write(to.path().join(FETCH_INDEX_FILE), "broken").unwrap();
    assert_eq!(fetch().files, 3, "a broken index is no index");
    fs::write(to.path().join("deep/b.bin.wayword-part"), "ha").unwrap();
    let sent = place.bucket.send_folder(to.path(), "again").unwrap();
    assert_eq!(sent.files, 3, "neither the index nor an unfinished file is sent");
}

fn a_fetch_that_would_be_too_large_takes_nothing(place: &Place) {
    let to = tempfile::tempdir().unwrap();
    place.bucket.put_object("data/a", vec![0; 600]).unwrap();
    place.bucket.put_object("data/b", vec![0; 600]).unwrap();
    let error = place.bucket.fetch_folder("data", to.path(), 1000, &quiet).unwrap_err();
    assert!(matches!(error, CloudError::TooLarge { bytes: 1200, most: 1000, .. }), "{error}");
    assert_eq!(fs::read_dir(to.path()).unwrap().count(), 0);
}

fn a_fetch_does_not_follow_a_link_out_of_its_folder(place: &Place) {
    let (to, elsewhere) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    place.bucket.put_object("data/a", "1").unwrap();
    place.bucket.put_object("data/sub/b", "2").unwrap();
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(elsewhere.path(), to.path().join("sub")).unwrap();
        let error = place.bucket.fetch_folder("data", to.path(), MANY, &quiet).unwrap_err();
        assert!(matches!(error, CloudError::Local { .. }), "{error}");
        assert_eq!(fs::read_dir(elsewhere.path()).unwrap().count(), 0);
        fs::remove_file(to.path().join("sub")).unwrap();
    }
    // The same call goes on: what had arrived is kept.
    let fetched = place.bucket.fetch_folder("data", to.path(), MANY, &quiet).unwrap();
    assert_eq!(fetched.files + fetched.kept, 2);
    assert_eq!(fs::read(to.path().join("sub/b")).unwrap(), b"2");
}

fn a_hostile_name_is_refused_by_every_call(place: &Place) {
    let bucket = &place.bucket;
    let here = tempfile::tempdir().unwrap();
    for name in ["../a", "/a", "a//b", "a/./b", "a\\b", "a\x1b[2J", "a/"] {
        let refused = [
            bucket.put_object(name, "x").unwrap_err(),
            bucket.put_new(name, "x").unwrap_err(),
            bucket.get_object(name, 1).unwrap_err(),
            bucket.list_objects(name).unwrap_err(),
            bucket.remove_object(name).unwrap_err(),
            bucket.send_folder(here.path(), name).unwrap_err(),
            bucket.fetch_folder(name, here.path(), 1, &quiet).unwrap_err(),
        ];
        for error in refused {
            assert!(matches!(error, CloudError::Name { .. }), "{name:?}: {error}");
            assert!(!error.to_string().contains('\x1b'));
        }
    }
}

fn names_with_spaces_percents_and_letters_of_all_kinds_are_kept(place: &Place) {
    let names = ["a b", "a%20b", "a+b", "k=v&x", "wohn zimmer/übersicht.json", "客厅"];
    for name in names {
        place.bucket.put_object(&format!("all/{name}"), name).unwrap();
    }
    let to = tempfile::tempdir().unwrap();
    place.bucket.fetch_folder("all", to.path(), MANY, &quiet).unwrap();
    for name in names {
        assert_eq!(fs::read_to_string(to.path().join(name)).unwrap(), name);
    }
}

fn fetch_folder_skips_empty_objects_that_represent_folders(place: &Place) {
    if place.folder.is_some() {
        return;
    }
    place.bucket.put_object("data/sub", "").unwrap();
    place.bucket.put_object("data/sub/a", "x").unwrap();
    let to = tempfile::tempdir().unwrap();
    assert_eq!(place.bucket.fetch_folder("data", to.path(), MANY, &quiet).unwrap().files, 1);
    place.bucket.put_object("data/sub", "y").unwrap();
    let error = place.bucket.fetch_folder("data", to.path(), MANY, &quiet).unwrap_err();
    assert!(matches!(error, CloudError::Name { .. }), "{error}");
}

#[cfg(unix)]
#[test]
fn a_hostile_name_in_the_store_is_not_fetched() {
    let place = folder().unwrap();
    let root = place.folder.as_ref().unwrap().path().join("new/folder/data");
    for name in ["a\\..\\b", "a\nb", FETCH_INDEX_FILE, "a.wayword-part"] {
        fs::create_dir_all(&root).unwrap();
        fs::write(root.join(name), "x").unwrap();
        let to = tempfile::tempdir().unwrap();
        let error = place.bucket.fetch_folder("data", to.path(), MANY, &quiet).unwrap_err();
        assert!(matches!(error, CloudError::Name { .. }), "{name:?}: {error}");
        assert_eq!(fs::read_dir(to.path()).unwrap().count(), 0);
        fs::remove_dir_all(&root).unwrap();
    }
}

#[test]
fn an_address_with_a_secret_is_refused_and_not_repeated() {
    let secrets = [
        "s3://AKIAHIDDEN:hunter2@bucket/a",
        "s3://hunter2@bucket/a",
        "gs://bucket/a?X-Goog-Signature=hunter2",
        "az://container/a?sv=1&sig=hunter2",
        "https://account.blob.core.windows.net/container?sig=hunter2",
        "abfss://container:hunter2@account.dfs.core.windows.net/a",
        "s3://bucket/a#hunter2",
        "https://user:hunter2@example.org/a",
        "s3://hunter2:443/bucket/a",
        "s3://bucket/../hunter2",
        "s3://[hunter2",
        "s3://AKIAHIDDEN:hunter2/x@bucket/a",
    ];
    for url in secrets {
        let error = CloudBucket::open(url).unwrap_err();
        let text = format!("{error} {error:?}");
        assert!(matches!(error, CloudError::Address { .. }), "{text}");
        assert!(!text.contains("hunter2") && text.contains("hint"), "{text}");
    }
}

#[test]
fn a_server_of_another_kind_is_refused() {
    for url in ["https://example.org/data", "http://example.org/data", "ftp://example.org", "memory:///a", "s3:///a"] {
        assert!(matches!(CloudBucket::open(url).unwrap_err(), CloudError::Address { .. }), "{url}");
    }
}

#[test]
fn a_bucket_shows_its_address_and_none_of_its_settings() {
    let place = folder().unwrap();
    assert_eq!(format!("{:?}", place.bucket), format!("Bucket {{ address: \"{}\", .. }}", place.bucket));
}

#[test]
fn a_call_inside_an_asynchronous_task_is_an_error_and_no_panic() {
    let bucket = CloudBucket::in_memory().unwrap();
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
    let answer = runtime.block_on(async { bucket.list_objects("") });
    assert!(matches!(answer.unwrap_err(), CloudError::InsideAsync));
}
