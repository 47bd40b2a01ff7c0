//! `wayword study` as its users see it: a study is made, people take part in it over HTTP, the site is killed, and the results are there.

#![cfg(feature = "study")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::{Ran, command, run};
use serde_json::Value;
use std::{
    collections::BTreeMap,
    io::{BufRead as _, BufReader, Read as _, Write as _},
    net::TcpStream,
    path::Path,
    process::{Child, Stdio},
    time::Duration,
};

/// A site that runs until it is dropped.
struct Site {
    child: Child,
    address: String,
    links: Vec<String>,
}

impl Site {
    fn of(study: &Path, links: &str) -> Self {
        let mut command = command(&[
            "study",
            "serve",
            study.to_str().unwrap(),
            "--listen",
            "127.0.0.1:0",
            "--links",
            links,
            "--json",
        ]);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
        let told: Value = serde_json::from_str(&line).unwrap();
        let address = told["url"].as_str().unwrap().trim_start_matches("http://").to_owned();
        let path =
            |link: &Value| link.as_str().unwrap().split_once("/t/").map(|(_, token)| format!("/t/{token}")).unwrap();
        Self { child, address, links: told["links"].as_array().unwrap().iter().map(path).collect() }
    }
}

impl Drop for Site {
    fn drop(&mut self) {
        // SIGKILL: acknowledged answers have to survive it.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A participant's browser, without script.
struct Browser {
    address: String,
    cookies: BTreeMap<String, String>,
    page: String,
    status: u16,
}

impl Browser {
    fn at(site: &Site) -> Self {
        Self { address: site.address.clone(), cookies: BTreeMap::new(), page: String::new(), status: 0 }
    }

    fn send(&mut self, method: &str, path: &str, body: &str) -> Option<String> {
        let cookies: Vec<String> = self.cookies.iter().map(|(name, value)| format!("{name}={value}")).collect();
        let address = &self.address;
        let request = format!(
            "{method} {path} HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{address}\r\nCookie: {}\r\nConnection: close\r\n\
             Content-Type: application/x-www-form-urlencoded\r\nContent-Length: {}\r\n\r\n{body}",
            cookies.join("; "),
            body.len()
        );
        let mut stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let end = answer.windows(4).position(|window| window == b"\r\n\r\n").unwrap();
        let head = String::from_utf8(answer[..end].to_vec()).unwrap();
        self.status = head.split_whitespace().nth(1).unwrap().parse().unwrap();
        self.page = String::from_utf8_lossy(&answer[end + 4..]).into_owned();
        let mut location = None;
        for line in head.lines() {
            let (name, value) = line.split_once(": ").unwrap_or_default();
            match name.to_ascii_lowercase().as_str() {
                "set-cookie" => {
                    let (name, value) = value.split(';').next().unwrap().split_once('=').unwrap();
                    if value.is_empty() {
                        self.cookies.remove(name);
                    } else {
                        self.cookies.insert(name.to_owned(), value.to_owned());
                    }
                }
                "location" => location = Some(value.to_owned()),
                _ => {}
            }
        }
        location
    }

    fn get(&mut self, path: &str) {
        let mut next = self.send("GET", path, "");
        while let Some(path) = next {
            next = self.send("GET", &path, "");
        }
    }

    /// Sends a form; the server has to acknowledge it.
    fn post(&mut self, path: &str, body: &str) {
        let onwards = self.send("POST", path, body);
        assert_eq!(self.status, 303, "{path} {body}: {}", self.page);
        self.get(&onwards.unwrap());
    }

    /// The page, by its name.
    fn name(&self) -> &str {
        self.page.split("data-page=\"").nth(1).and_then(|rest| rest.split('"').next()).unwrap_or("none")
    }

    fn field(&self, name: &str) -> String {
        let after = self.page.split(&format!("name=\"{name}\" value=\"")).nth(1);
        after.and_then(|rest| rest.split('"').next()).unwrap_or_default().to_owned()
    }

    /// Fills in the page with some valid answer. `false` at the end.
    fn go_on(&mut self, steps: usize) -> bool {
        let slot = self.field("slot");
        match self.name() {
            "consent" => self.post("/consent", "agree=yes"),
            "understood" => {
                let right = if self.page.contains("film") || self.page.contains("watch") { RATING } else { WALKING };
                self.post("/understood", &format!("try={}&{right}", self.field("try")));
            }
            "follow" => {
                let seq: usize = self.field("seq").parse().unwrap();
                if seq < steps {
                    self.post("/move", &format!("slot={slot}&seq={seq}&to={}", self.field("to")));
                } else {
                    self.post("/stop", &format!("slot={slot}&seq={seq}&looks=3"));
                }
            }
            "follow_after" => self.post("/answer", &format!("slot={slot}&s0=4&s1=5&s2=2")),
            "watch" => self.post("/write", &format!("slot={slot}&own_text=%3Dcmd%28%29+%3Cscript%3E")),
            "rate" => self.post("/answer", &format!("slot={slot}&q0=2&q1=4&q2=1&q3=5")),
            "pair" => self.post("/answer", &format!("slot={slot}&choice=a")),
            "attention" => {
                let asked =
                    LEVELS.iter().position(|level| self.page.contains(&format!("\u{201c}{level}\u{201d}"))).unwrap();
                self.post("/attention", &format!("number={}&choice={}", self.field("number"), asked + 1));
            }
            "done" => return false,
            name => panic!("{name}: {}", self.page),
        }
        true
    }
}

/// The right answers to the questions about walking, and about rating.
const WALKING: &str = "q0=1&q1=0";
const RATING: &str = "q0=2&q1=0";
const LEVELS: [&str; 5] = ["Strongly disagree", "Disagree", "Neither agree nor disagree", "Agree", "Strongly agree"];

fn wayword(folder: &Path, args: &[&str]) -> Ran {
    let ran = run(command(args).current_dir(folder));
    assert_eq!(ran.code, Some(0), "{args:?}: {ran:?}");
    ran
}

/// A run of three paths in a generated house.
fn houses() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    wayword(
        folder.path(),
        &["generate", "--paths", "3", "--scan", "house2-1", "--style", "r2r", "--seed", "3", "--out", "run"],
    );
    folder
}

#[test]
fn people_walk_through_kills_and_their_walks_are_scored() {
    let folder = houses();
    let make = [
        "study",
        "new",
        "--run",
        "ours=run#r2r",
        "--include",
        "other-path",
        "--mode",
        "follow",
        "--items",
        "2",
        "--per-item",
        "1",
    ];
    let made = wayword(folder.path(), &[&make[..], &["--out", "study", "--json"]].concat()).json();
    assert_eq!((made["items"].as_u64(), made["has_practice"].as_bool()), (Some(4), Some(true)), "{made}");
    let study = folder.path().join("study");
    let site = Site::of(&study, "2");
    let links = site.links.clone();
    let mut first = Browser::at(&site);
    first.get(&links[0]);
    assert_eq!(first.name(), "consent");
    for _ in 0..5 {
        assert!(first.go_on(2));
    }
    let before = first.page.clone();
    drop(site);

    // The same cookie and the same link go on at the same place, on a server that was killed.
    let site = Site::of(&study, "0");
    first.address.clone_from(&site.address);
    first.get("/");
    assert_eq!(first.page, before);
    let mut other_device = Browser::at(&site);
    other_device.get(&links[0]);
    assert_eq!(other_device.name(), first.name());
    assert_eq!(other_device.field("slot"), first.field("slot"));
    while first.go_on(2) {}
    let mut second = Browser::at(&site);
    second.get(&links[1]);
    while second.go_on(0) {}

    let status = wayword(folder.path(), &["study", "status", "study", "--json"]).json();
    assert_eq!(status["participants"]["complete"], 2, "{status}");
    assert!(status["rows"].as_array().unwrap().iter().all(|row| row["answered"] == 2), "{status}");
    let page = fs_text(&study.join("study.db"));
    assert!(!page.contains(links[0].trim_start_matches("/t/")), "a token stands in the database");
}

#[test]
fn answers_become_tables_and_can_be_forgotten() {
    let folder = houses();
    let folder = folder.path();
    let make = [
        "study",
        "new",
        "--run",
        "ours=run#r2r",
        "--include",
        "other-path",
        "--mode",
        "rate",
        "--items",
        "2",
        "--per-item",
        "2",
    ];
    wayword(folder, &[&make[..], &["--out", "study"]].concat());
    let site = Site::of(&folder.join("study"), "3");
    for link in &site.links[..2] {
        let mut person = Browser::at(&site);
        person.get(link);
        while person.go_on(0) {}
    }
    let mut leaves = Browser::at(&site);
    leaves.get(&site.links[2]);
    leaves.post("/consent", "agree=yes");
    leaves.send("POST", "/withdraw", "delete=yes");
    assert!(leaves.page.contains("deleted"), "{}", leaves.page);
    drop(site);
    let planned = wayword(folder, &["study", "plan", "study"]).out;
    assert!(planned.contains("participants"), "{planned}");
    let written = wayword(folder, &["study", "results", "study", "--out", "tables", "--json"]).json();
    assert_eq!(written["answers"], 4, "{written}");
    let answers = fs_text(&folder.join("tables/answers.csv"));
    assert!(answers.contains("'=cmd() <script>"), "{answers}");
    let page = fs_text(&folder.join("tables/index.html"));
    assert!(page.contains("ours") && !page.contains("<script"), "no script");
    let status = wayword(folder, &["study", "status", "study", "--participants", "--json"]).json();
    assert_eq!(
        (status["forgotten"].as_u64(), status["participants"]["complete"].as_u64()),
        (Some(1), Some(2)),
        "{status}"
    );
    let id = status["list"][0]["id"].as_str().unwrap();
    let dry = wayword(folder, &["study", "forget", "study", "--participant", id, "--dry-run"]).out;
    assert!(dry.contains("would remove") && dry.contains("tables"), "{dry}");
    wayword(folder, &["study", "forget", "study", "--participant", id]);
    wayword(folder, &["study", "close", "study"]);
    let status = wayword(folder, &["study", "status", "study"]).out;
    assert!(
        status.starts_with("closed") && status.contains("2 forgotten") && status.contains("1 complete"),
        "{status}"
    );
}

#[test]
fn pictures_of_others_need_the_right_and_a_recording_is_not_walked() {
    let building = crate::common::Building::new();
    building.run_over_episodes("run");
    let new = |args: &[&str]| {
        building.wayword(&[&["study", "new", "--run", "ours=run#r2r", "--out", "study"], args].concat())
    };
    let refused = new(&["--mode", "rate", "--platform", "matterport", "--data", "data"]);
    assert!(refused.refused().contains("--i-have-the-right"));
    let refused = new(&["--mode", "follow", "--platform", "recording", "--data", "data"]);
    assert_eq!(refused.code, Some(1), "{refused:?}");
    let refused = new(&["--mode", "pair"]);
    assert!(refused.refused().contains("one condition"), "{refused:?}");
    let refused = new(&["--mode", "rate", "--include", "people"]);
    assert!(refused.refused().contains("--episodes"), "{refused:?}");
    assert!(building.wayword(&["study", "serve", "nowhere"]).refused().contains("study new"));
    assert!(!building.path("study/plan.json").exists());
}

#[test]
fn the_same_texts_with_marks_and_without_are_two_conditions() {
    let folder = houses();
    let folder = folder.path();
    // A wrong turn in every text, so that there are words to mark. Its spans would lie elsewhere.
    let records = fs_text(&folder.join("run/instructions.jsonl"));
    let with_wrong_turns = |line: &str| {
        let mut record: Value = serde_json::from_str(line).unwrap();
        let text = record["text"].as_str().unwrap();
        record["text"] = text.replace("right", "\u{0}").replace("left", "right").replace('\u{0}', "left").into();
        (record["mentions"], record["parts"]) = (Value::Array(Vec::new()), Value::Array(Vec::new()));
        record["findings"] = Value::Array(Vec::new());
        format!("{record}\n")
    };
    std::fs::write(folder.join("wrong.jsonl"), records.lines().map(with_wrong_turns).collect::<String>()).unwrap();
    let sets = ["--run", "plain=wrong.jsonl", "--run", "marked=wrong.jsonl", "--doubts", "marked", "--per-item", "1"];
    let make = [&["study", "new", "--mode", "follow", "--items", "2", "--out", "study", "--json"], &sets[..]].concat();
    wayword(folder, &make);
    let study = folder.join("study");
    let items = fs_text(&study.join("items.jsonl"));
    let items: Vec<Value> = items.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let told: Vec<&Value> =
        items.iter().filter(|item| item["is_practice"] != true).map(|item| &item["texts"][0]).collect();
    let of = |condition: &str| -> Vec<&Value> {
        told.iter().copied().filter(|told| told["condition"] == condition).collect()
    };
    assert!(of("plain").iter().all(|told| told.get("marks").is_none()), "{told:?}");
    assert!(of("marked").iter().any(|told| told.get("marks").is_some()), "{told:?}");
    let texts = |condition: &str| of(condition).iter().map(|told| told["text"].clone()).collect::<Vec<_>>();
    assert_eq!(texts("plain"), texts("marked"));
    let site = Site::of(&study, "2");
    let mut pages = String::new();
    for link in &site.links {
        let mut person = Browser::at(&site);
        person.get(link);
        while person.go_on(0) {
            pages.push_str(&person.page);
        }
    }
    assert!(pages.contains("<mark class=") && pages.contains("The marked words may be wrong"), "no marks");
    assert!(pages.contains("Some words may be marked"), "nobody is told of marks");
    drop(site);
    wayword(folder, &["study", "results", "study", "--out", "tables"]);
    assert!(fs_text(&folder.join("tables/items.csv")).lines().next().unwrap().contains("marks"));
    assert!(fs_text(&folder.join("tables/index.html")).contains("(doubts marked)"));
}

#[test]
fn marks_are_refused_without_walking_or_for_an_unknown_set() {
    let folder = houses();
    let new = |args: &[&str]| {
        run(command(&[&["study", "new", "--run", "a=run#r2r", "--out", "study"], args].concat())
            .current_dir(folder.path()))
    };
    let refused = new(&["--mode", "follow", "--doubts", "b"]);
    assert!(refused.refused().contains("there are: a"), "{refused:?}");
    let refused = new(&["--mode", "rate", "--doubts", "a"]);
    assert!(refused.refused().contains("only for people who walk"), "{refused:?}");
}

fn fs_text(file: &Path) -> String {
    String::from_utf8_lossy(&std::fs::read(file).unwrap()).into_owned()
}
