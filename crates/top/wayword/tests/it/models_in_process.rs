//! `wayword models`, against a hub on this machine.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::{Ran, command, run};
use std::path::Path;

/// `wayword models ARGS` without the user's hub settings, and with a cache in a folder.
fn models(cache: &Path, args: &[&str], variables: &[(&str, &str)]) -> Ran {
    let mut command = command(&[&["models"], args].concat());
    for name in ["HF_HOME", "HF_TOKEN", "HF_ENDPOINT", "HF_HUB_OFFLINE", "TRANSFORMERS_OFFLINE", "WAYWORD_OFFLINE"] {
        command.env_remove(name);
    }
    run(command.env("HF_HUB_CACHE", cache).envs(variables.iter().copied()))
}

#[cfg(not(feature = "local"))]
#[test]
fn models_in_a_build_without_them_hints_at_the_feature() {
    for args in [&["list"][..], &["fetch", "hf/org/name"], &["path", "hf/org/name"]] {
        let ran = models(Path::new("/nowhere"), args, &[]);
        assert!(ran.refused().contains("--features full"), "{ran:?}");
    }
}

#[cfg(feature = "local")]
mod with_models {
    use super::models;
    use sha2::{Digest, Sha256};
    use std::{
        fs,
        io::{BufRead, BufReader, Write},
        net::TcpListener,
        sync::{Arc, Mutex},
        thread,
    };

    const COMMIT: &str = "0123456789abcdef0123456789abcdef01234567";
    const TOKEN: &str = "hf_test_0123456789";
    const NAME: &str = "hf/org/name:small.gguf";
    const BYTES: &[u8] = b"GGUF and more";

    /// A hub with one file; it keeps the heads of its requests.
    fn hub() -> (String, Arc<Mutex<Vec<String>>>) {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let (url, heads) = (format!("http://{}", listener.local_addr().unwrap()), Arc::default());
        let seen: Arc<Mutex<Vec<String>>> = Arc::clone(&heads);
        thread::spawn(move || {
            for mut stream in listener.incoming().map_while(Result::ok) {
                let lines = BufReader::new(stream.try_clone().unwrap()).lines().map_while(Result::ok);
                let head: Vec<String> = lines.take_while(|line| !line.is_empty()).collect();
                let hash: String = Sha256::digest(BYTES).iter().map(|byte| format!("{byte:02x}")).collect();
                let answer = format!(
                    "HTTP/1.1 200 OK\r\nconnection: close\r\nx-repo-commit: {COMMIT}\r\netag: \"{hash}\"\r\ncontent-length: {}\r\n\r\n",
                    BYTES.len()
                );
                stream.write_all(answer.as_bytes()).unwrap();
                if head.first().is_some_and(|first| first.starts_with("GET")) {
                    stream.write_all(BYTES).unwrap();
                }
                seen.lock().unwrap().push(head.join("\n"));
            }
        });
        (url, heads)
    }

    #[test]
    fn a_model_is_fetched_listed_and_found() {
        let cache = tempfile::tempdir().unwrap();
        let (url, heads) = hub();
        let reach = [("HF_ENDPOINT", url.as_str()), ("HF_TOKEN", TOKEN)];
        assert_eq!(models(cache.path(), &["list", "--json"], &[]).json()["models"], serde_json::json!([]));

        let ran = models(cache.path(), &["fetch", NAME], &reach);
        let file = cache.path().join("models--org--name/snapshots").join(COMMIT).join("small.gguf");
        assert_eq!((ran.code, ran.out.trim_end()), (Some(0), file.to_str().unwrap()), "{ran:?}");
        assert_eq!(fs::read(&file).unwrap(), BYTES);
        assert_eq!(ran.err, "fetching small.gguf: 0 B of 13 B so far\n");
        let sent = heads.lock().unwrap().len();
        assert!(heads.lock().unwrap().iter().all(|head| head.contains(&format!("Bearer {TOKEN}"))));

        let found = models(cache.path(), &["path", NAME, "--json"], &reach).json();
        assert_eq!((&found["file"], &found["identity"]), (&file.to_str().unwrap().into(), &COMMIT.into()));
        let listed = models(cache.path(), &["list"], &reach);
        assert!(listed.out.starts_with("hf/org/name ") && listed.out.contains("0123456789ab "), "{listed:?}");
        assert!(listed.out.contains("13 B in   1 file  main\n1 model in "), "{listed:?}");
        assert_eq!(heads.lock().unwrap().len(), sent, "path and list asked the hub");
        for said in [ran.err, listed.out, listed.err] {
            assert!(!said.contains(TOKEN), "{said}");
        }
    }

    #[test]
    fn path_works_offline_without_a_request() {
        let cache = tempfile::tempdir().unwrap();
        let (url, heads) = hub();
        for off in ["WAYWORD_OFFLINE", "HF_HUB_OFFLINE"] {
            let ran = models(cache.path(), &["fetch", NAME], &[("HF_ENDPOINT", &url), (off, "1")]);
            let belongs = cache.path().join("models--org--name/snapshots/main/small.gguf");
            let told = ran.refused();
            assert!(told.starts_with(&format!("error: {}: ", belongs.display())), "{told}");
            assert!(told.contains(&format!("{url}/org/name/resolve/main/small.gguf")), "{told}");
        }
        assert_eq!(heads.lock().unwrap().len(), 0);
    }

    #[test]
    fn wrong_names_and_endpoints_are_refused_with_a_hint() {
        let cache = tempfile::tempdir().unwrap();
        let told = models(cache.path(), &["fetch", "blip-vqa-base"], &[]);
        assert!(told.refused().contains("hint: names are hf/ORG/NAME"), "{told:?}");
        let told = models(cache.path(), &["fetch", NAME], &[("HF_ENDPOINT", "ftp://me:hunter2@host")]);
        assert!(told.refused().contains("HF_ENDPOINT") && !told.err.contains("hunter2"), "{told:?}");
    }
}
