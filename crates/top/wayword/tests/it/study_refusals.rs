//! What `wayword study` refuses and says of closed studies, private folders and impossible flags.

#![cfg(feature = "study")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::{Ran, command, run};
use serde_json::Value;
use std::{
    fs,
    io::{BufRead as _, BufReader, Read as _, Write as _},
    net::{TcpListener, TcpStream},
    path::Path,
    process::Stdio,
};

fn wayword(folder: &Path, args: &[&str]) -> Ran {
    run(command(args).current_dir(folder))
}

/// A folder with a study of two paths, in which people walk.
fn studied() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let generate = "generate --paths 4 --scan house2-1 --style r2r --seed 3 --out run";
    let new = "study new --run ours=run#r2r --include other-path,corrupted --mode follow --items 2 --per-item 1 --out ST --json";
    for words in [generate, new] {
        let made = wayword(folder.path(), &words.split(' ').collect::<Vec<_>>());
        assert_eq!(made.code, Some(0), "{made:?}");
    }
    folder
}

fn files_of(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).unwrap().map(|file| file.unwrap().file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.filter(|name| !name.starts_with("study.db-")).collect();
    names.sort();
    names
}

#[test]
fn a_study_refuses_outputs_in_its_folder_links_after_its_end_and_wrong_flags() {
    let folder = studied();
    let folder = folder.path();
    let before = files_of(&folder.join("ST"));
    let refuse = |words: &str, said: &[&str]| {
        let refused = wayword(folder, &words.split(' ').collect::<Vec<_>>());
        assert!([Some(1), Some(2)].contains(&refused.code), "{words}: {refused:?}");
        for said in said {
            assert!(refused.err.contains(said), "{words}: {said}: {refused:?}");
        }
    };
    // Nothing that is made to be passed on lands in the private folder.
    refuse("study results ST --out ST", &["private", "beside the study"]);
    refuse("study results ST --out ST/pictures", &["private"]);
    refuse("study results ST --out ST/new/deep", &["private"]);
    refuse("study plan ST --out ST/study.toml", &["private"]);
    refuse("study plan ST --out ST/sheet.md", &["private"]);
    refuse("study new --run ours=run#r2r --mode follow --out ST/inner", &["private"]);
    assert_eq!(files_of(&folder.join("ST")), before, "nothing was written");
    fs::write(folder.join("taken"), "mine").unwrap();
    refuse("study results ST --out taken", &["taken"]);
    refuse("study plan ST --out taken", &["already", "new file"]);
    // Flags in the wrong unit or form.
    refuse(
        "study plan ST --base 0.5",
        &["--base 0.5 with an effect of 20 points gives a share of -9.5 %", "did you mean 50?"],
    );
    refuse("study serve ST --listen localhost", &["the port is missing", "127.0.0.1:8080"]);
    refuse("study serve ST --listen :80999", &["is no port"]);
    let used = TcpListener::bind("127.0.0.1:0").unwrap();
    let listen = used.local_addr().unwrap();
    refuse(&format!("study serve ST --listen {listen}"), &["in use by another program", "another port"]);
    refuse("study serve ST --tls taken taken", &["taken: it holds no certificate"]);
    let doubted = wayword(folder, &["study", "plan", "ST", "--effect", "0.2"]);
    assert!(doubted.err.contains("did you mean --effect 20?") && doubted.out.contains("0.2 points"), "{doubted:?}");
    // Folders that are no study, and files that are missing or wrong.
    refuse("study status nowhere", &["there is no such folder"]);
    refuse("study status run", &["this folder holds no study"]);
    refuse("study results taken --out tables", &["this is no folder"]);
    let settings = fs::read_to_string(folder.join("ST/study.toml")).unwrap();
    let minutes = settings.lines().find(|line| line.starts_with("minutes")).unwrap().to_owned();
    fs::write(folder.join("ST/study.toml"), settings.replace(&minutes, "minutes = -6")).unwrap();
    refuse("study status ST", &["study.toml", "minutes = -6", "give a whole number"]);
    fs::write(folder.join("ST/study.toml"), settings).unwrap();
    let routes = fs::read(folder.join("ST/routes.jsonl")).unwrap();
    fs::remove_file(folder.join("ST/routes.jsonl")).unwrap();
    refuse("study status ST", &["routes.jsonl: this file of the study is missing", "put back"]);
    fs::write(folder.join("ST/routes.jsonl"), routes).unwrap();
    // Links are new each time, and the earlier ones stay valid.
    let made = wayword(folder, &["study", "invite", "ST", "--links", "2"]);
    assert!(!made.err.contains("earlier"), "{made:?}");
    let again = wayword(folder, &["study", "invite", "ST", "--links", "1"]);
    assert!(again.err.contains("this link is new; 2 earlier links that nobody has used stay valid"), "{again:?}");
    refuse("study invite ST --links 0", &["give a whole number, 1 or more"]);
    // After the end there are none.
    assert_eq!(wayword(folder, &["study", "close", "ST"]).code, Some(0));
    for words in ["study invite ST --links 1", "study serve ST --listen 127.0.0.1:0 --links 1"] {
        refuse(words, &["ST is closed: it takes no more answers"]);
    }
    assert_eq!(wayword(folder, &["study", "results", "ST", "--out", "tables"]).code, Some(0));
}

#[test]
fn a_closed_study_is_served_and_says_so() {
    let folder = studied();
    assert_eq!(wayword(folder.path(), &["study", "close", "ST"]).code, Some(0));
    let serve = ["study", "serve", "ST", "--listen", "127.0.0.1:0", "--json"];
    let mut child =
        command(&serve).current_dir(folder.path()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
    let told: Value = serde_json::from_str(&line).unwrap();
    let address = told["url"].as_str().unwrap().trim_start_matches("http://").to_owned();
    let mut stream = TcpStream::connect(&address).unwrap();
    write!(stream, "GET /style.css HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n").unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    let _ = child.kill();
    let _ = child.wait();
    assert_eq!(told["is_closed"], true, "{told}");
    assert!(told["links"].as_array().unwrap().is_empty() && answer.starts_with("HTTP/1.1 200"), "{told} {answer}");
}

#[test]
fn a_new_study_says_what_practice_takes_and_shows_no_text_of_it_again() {
    let folder = studied();
    let text = fs::read_to_string(folder.path().join("ST/items.jsonl")).unwrap();
    let items: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let practice = items.iter().find(|item| item["is_practice"] == true).unwrap();
    let shown = &practice["texts"][0]["text"];
    let again = items.iter().filter(|item| item["is_practice"] != true && &item["texts"][0]["text"] == shown);
    assert_eq!(again.count(), 0, "{text}");
    let new = |items: &str, out: &str| {
        let args = ["study", "new", "--run", "ours=run#r2r", "--mode", "follow", "--items", items, "--out", out];
        let made = wayword(folder.path(), &args);
        assert_eq!(made.code, Some(0), "{made:?}");
        made
    };
    let made = new("4", "all");
    assert!(
        made.err
            .contains("--items 4: only 4 paths have a text of every condition: 3 in the study, and one for practice"),
        "{made:?}"
    );
    let made = new("3", "fewer");
    assert!(made.out.contains("3 paths and one more for practice") && !made.err.contains("only"), "{made:?}");
}
