//! The site over HTTP, in process.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::{
    collections::BTreeMap,
    io::{Read as _, Write as _},
    net::{SocketAddr, TcpStream},
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc,
    },
    thread::{self, JoinHandle},
    time::Duration,
};
use tempfile::TempDir;
use wayword_core::{DoubtGrade, Heading, SceneId, ViewpointId};
use wayword_study::{
    ConditionKind, FilmPicture, ListenOptions, RecruiterSettings, SiteAddress, SiteSecurity, Study, StudyCondition,
    StudyDesign, StudyItem, StudyRoute, StudyScene, StudySettings, StudyTask, StudyText, StudyViewpoint, TextMark,
    serve_study,
};

/// Words that no page may have: the conditions, the scene, the route, the goal.
const SECRETS: [&str; 5] = ["condition-x", "condition-y", "scene-s", "route-r", "goal-g"];

fn study(folder: &Path, mode: StudyTask) -> Study {
    let viewpoint = |name: &str| ViewpointId::new(name).unwrap();
    let place = |at: f64, neighbours: &[&str]| StudyViewpoint {
        position: [at, 0.0, 1.5],
        level: None,
        neighbours: neighbours.iter().map(|name| viewpoint(name)).collect(),
        panorama: "picture.jpg".into(),
    };
    let places = [("start", place(0.0, &["goal-g"])), ("goal-g", place(2.0, &["start"]))];
    let scene = SceneId::new("scene-s").unwrap();
    let route = |id| StudyRoute {
        id,
        name: format!("route-r{id}"),
        scene: scene.clone(),
        viewpoints: ["start", "goal-g"].map(viewpoint).to_vec(),
        start_heading: Heading::NORTH,
        film: vec![FilmPicture { file: "picture.jpg".into(), alt: "The walk begins.".into() }],
    };
    let told = |name: &str| StudyText {
        condition: name.into(),
        text: "Go to the <b>door</b> & stop.".into(),
        ..StudyText::default()
    };
    let texts = match mode {
        StudyTask::Pair => vec![told("condition-x"), told("condition-y")],
        _ => vec![told("condition-x")],
    };
    let item = |id, is_practice| StudyItem { id, route: id, is_practice, texts: texts.clone() };
    let plan = StudyDesign {
        mode,
        seed: 1,
        per_item: 2,
        per_participant: 1,
        conditions: vec![StudyCondition {
            name: "condition-x".into(),
            kind: ConditionKind::Run,
            source: String::new(),
            shows_doubts: false,
        }],
        style: String::new(),
    };
    let settings = StudySettings {
        questions: Vec::new(),
        attention_checks: 0,
        contact: "A. Person, a@example.org".into(),
        ..StudySettings::for_mode(mode, 1)
    };
    let scenes =
        vec![StudyScene { scene: scene.clone(), places: places.map(|(name, place)| (viewpoint(name), place)).into() }];
    Study {
        folder: folder.to_owned(),
        plan,
        settings,
        items: vec![item(0, false), item(1, true)],
        routes: vec![route(0), route(1)],
        scenes,
    }
}

/// A site in a thread, until it is dropped.
struct Site {
    study: Study,
    address: SocketAddr,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    _folder: TempDir,
}

fn listen(security: SiteSecurity) -> ListenOptions {
    ListenOptions { address: "127.0.0.1:0".parse().unwrap(), security, public: None }
}

impl Site {
    fn new(mode: StudyTask, set: impl FnOnce(&mut StudySettings)) -> Self {
        Self::with(mode, |study| set(&mut study.settings))
    }

    fn with(mode: StudyTask, set: impl FnOnce(&mut Study)) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let mut study = study(folder.path(), mode);
        set(&mut study);
        study.create().unwrap();
        std::fs::write(study.pictures_folder().join("picture.jpg"), b"a picture").unwrap();
        let (told, started) = mpsc::channel();
        let stop = Arc::new(AtomicBool::new(false));
        let (served, ending) = (study.clone(), Arc::clone(&stop));
        let thread = thread::spawn(move || {
            let tell = |started: &SiteAddress| told.send(started.address).unwrap();
            serve_study(served, &listen(SiteSecurity::Loopback), tell, || ending.load(Ordering::Relaxed)).unwrap();
        });
        let address = started.recv().unwrap();
        Self { study, address, stop, thread: Some(thread), _folder: folder }
    }

    fn browser(&self) -> Browser {
        Browser { address: self.address, origin: format!("http://{}", self.address), cookies: BTreeMap::new() }
    }

    /// The browser of a participant who has consented.
    fn participant(&self) -> Browser {
        let token = self.study.invite_participants(1).unwrap().tokens.remove(0);
        let mut browser = self.browser();
        browser.get(&format!("/t/{token}"));
        assert_eq!(browser.post("/consent", "agree=yes").status, 303);
        browser
    }
}

impl Drop for Site {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap();
    }
}

struct Browser {
    address: SocketAddr,
    origin: String,
    cookies: BTreeMap<String, String>,
}

#[derive(Debug, Clone)]
struct Answer {
    status: u16,
    headers: BTreeMap<String, String>,
    body: String,
}

impl Answer {
    fn field(&self, name: &str) -> String {
        let after = self.body.split(&format!("name=\"{name}\" value=\"")).nth(1);
        after.and_then(|rest| rest.split('"').next()).unwrap_or_default().to_owned()
    }

    fn is_page(&self, name: &str) -> bool {
        self.body.contains(&format!("data-page=\"{name}\""))
    }
}

impl Browser {
    fn get(&mut self, path: &str) -> Answer {
        self.send("GET", path, "", "")
    }

    fn post(&mut self, path: &str, body: &str) -> Answer {
        self.send("POST", path, body, "")
    }

    fn send(&mut self, method: &str, path: &str, body: &str, more: &str) -> Answer {
        let cookies: Vec<String> = self.cookies.iter().map(|(name, value)| format!("{name}={value}")).collect();
        let head = format!(
            "{method} {path} HTTP/1.1\r\nHost: {}\r\nOrigin: {}\r\nCookie: {}\r\nConnection: close\r\n{more}\
             Content-Type: application/x-www-form-urlencoded\r\nContent-Length: {}\r\n\r\n{body}",
            self.address,
            self.origin,
            cookies.join("; "),
            body.len()
        );
        let answer = raw(self.address, head.as_bytes());
        for (name, value) in &answer.headers {
            if name.starts_with("set-cookie") {
                let (name, value) = value.split(';').next().unwrap().split_once('=').unwrap();
                match value {
                    "" => self.cookies.remove(name),
                    value => self.cookies.insert(name.to_owned(), value.to_owned()),
                };
            }
        }
        answer
    }
}

fn raw(address: SocketAddr, bytes: &[u8]) -> Answer {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    // The server may answer and close before it has read all.
    let _ = stream.write_all(bytes);
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    let answer = String::from_utf8_lossy(&answer).into_owned();
    let (head, body) = answer.split_once("\r\n\r\n").unwrap_or_default();
    let headers = head.lines().skip(1).enumerate().filter_map(|(number, line)| {
        let (name, value) = line.split_once(": ")?;
        let name = name.to_ascii_lowercase();
        Some((if name == "set-cookie" { format!("{name}{number}") } else { name }, value.to_owned()))
    });
    Answer {
        status: head.split_whitespace().nth(1).and_then(|status| status.parse().ok()).unwrap_or(0),
        headers: headers.collect(),
        body: body.to_owned(),
    }
}

#[test]
fn every_answer_has_its_headers() {
    let site = Site::new(StudyTask::Rate, |_| {});
    let mut browser = site.participant();
    let mut all = ["/", "/style.css", "/nowhere", "/withdraw", "/t/x"].map(|path| browser.get(path)).to_vec();
    all.push(browser.send("POST", "/consent", "agree=yes", "X-Forwarded-Proto: https\r\n"));
    all.push(browser.send("DELETE", "/", "", ""));
    for answer in all {
        let header = |name: &str| answer.headers.get(name).cloned().unwrap_or_default();
        assert!(header("content-security-policy").starts_with("default-src 'none'"), "{answer:?}");
        assert_eq!((header("x-content-type-options"), header("cache-control")), ("nosniff".into(), "no-store".into()));
        assert_eq!((header("referrer-policy"), header("x-frame-options")), ("same-origin".into(), "DENY".into()));
        assert!(header("location") == "/" || header("location").is_empty(), "{answer:?}");
        assert!(header("strict-transport-security").is_empty(), "there is no TLS here");
    }
}

#[test]
fn marks_are_shown_with_their_alternatives_and_escaped() {
    let mark = |span, words: &[Option<&str>]| TextMark {
        span,
        grade: DoubtGrade::Likely,
        alternatives: words.iter().map(|words| words.map(str::to_owned)).collect(),
    };
    let marks = vec![
        mark([0, 2], &[Some("Come <i>back</i>"), None]),
        // A file may hold anything: these are not in the text, or overlap the first.
        mark([1, 4], &[]),
        mark([7, 900], &[]),
        mark([21, 25], &[]),
    ];
    let site = Site::with(StudyTask::Follow, |study| {
        study.plan.conditions[0].shows_doubts = true;
        study.items.iter_mut().for_each(|item| item.texts[0].marks.clone_from(&marks));
    });
    let page = site.participant().get("/");
    assert!(page.is_page("follow"), "{page:?}");
    assert!(page.body.contains("<mark class=\"likely\">Go</mark>"), "{}", page.body);
    assert!(page.body.contains("<b>Come &lt;i&gt;back&lt;&#x2f;i&gt;</b> or <i>leave it out</i>"), "{}", page.body);
    assert!(page.body.contains(" to the &lt;b&gt;door"), "{}", page.body);
}

#[test]
fn no_page_names_a_condition_a_path_or_a_goal() {
    for mode in [StudyTask::Rate, StudyTask::Pair, StudyTask::Follow] {
        let site = Site::new(mode, |settings| settings.write_first = false);
        let mut browser = site.participant();
        let mut pages = 0;
        loop {
            let page = browser.get("/");
            pages += 1;
            for secret in SECRETS {
                assert!(
                    !page.body.contains(secret) && !format!("{:?}", page.headers).contains(secret),
                    "{secret}: {page:?}"
                );
            }
            let slot = page.field("slot");
            let (path, body) = match () {
                () if page.is_page("rate") => ("/answer", format!("slot={slot}&q0=1&q1=1&q2=1&q3=1")),
                () if page.is_page("pair") => ("/answer", format!("slot={slot}&choice=bad")),
                () if page.is_page("follow") && page.field("seq") == "0" => {
                    ("/move", format!("slot={slot}&seq=0&to=0"))
                }
                () if page.is_page("follow") => ("/stop", format!("slot={slot}&seq=1&looks=0")),
                () if page.is_page("follow_after") => ("/answer", format!("slot={slot}&s0=1&s1=1&s2=1")),
                () => {
                    assert!(page.is_page("done"), "{page:?}");
                    break;
                }
            };
            assert_eq!(browser.post(path, &body).status, 303);
        }
        assert!(pages >= 3);
        assert_eq!(site.study.read_progress().unwrap().rows[0].answered, 1);
    }
}

#[test]
fn free_text_stays_text() {
    let site = Site::new(StudyTask::Rate, |_| {});
    let mut browser = site.participant();
    let page = browser.get("/");
    assert!(page.is_page("watch"), "{page:?}");
    let slot = page.field("slot");
    let text = "%3Cscript%3Ealert(1)%3C%2Fscript%3E%22%27%3E";
    assert_eq!(browser.post("/write", &format!("slot={slot}&own_text={text}")).status, 303);
    let page = browser.get("/");
    assert!(page.body.contains("&lt;script&gt;") && !page.body.contains("<script>alert"), "{page:?}");
    assert!(page.body.contains("Go to the &lt;b&gt;door&lt;"), "an instruction is text too");
}

#[test]
fn an_incomplete_form_comes_back_with_the_filled_in_fields() {
    let site = Site::new(StudyTask::Rate, |settings| settings.write_first = false);
    let mut browser = site.participant();
    let slot = browser.get("/").field("slot");
    let page = browser.post("/answer", &format!("slot={slot}&q0=3&q1=4"));
    assert_eq!(page.status, 422);
    assert!(page.body.contains("role=\"alert\"") && page.body.contains("checked"), "{page:?}");
    assert_eq!(site.study.read_progress().unwrap().rows[0].answered, 0);
}

#[test]
fn a_recruiters_id_leaves_the_address() {
    let site = Site::new(StudyTask::Pair, |settings| {
        settings.recruiter = RecruiterSettings::Parameters {
            person: "PROLIFIC_PID".into(),
            session: "SESSION_ID".into(),
            study: "STUDY_ID".into(),
            only_study: String::new(),
        };
        settings.codes.done = "C0DE".into();
        settings.codes.return_url = "https://app.prolific.com/submissions/complete?cc={code}".into();
    });
    let mut browser = site.browser();
    let came = browser.get("/join?PROLIFIC_PID=5f5f5f&STUDY_ID=s&SESSION_ID=x");
    assert_eq!((came.status, came.headers["location"].as_str()), (303, "/"));
    assert!(browser.get("/").is_page("consent"));
    assert_eq!(browser.post("/consent", "agree=yes").status, 303);
    assert!(!format!("{:?}", browser.cookies).contains("arrival"), "{:?}", browser.cookies);
    // Another device with the same link is the same person; another link of the same person leads nowhere.
    let mut other = site.browser();
    other.get("/join?PROLIFIC_PID=5f5f5f&STUDY_ID=s&SESSION_ID=x");
    assert_eq!(other.get("/").field("slot"), browser.get("/").field("slot"));
    assert_eq!(site.browser().get("/join?PROLIFIC_PID=5f5f5f&STUDY_ID=s&SESSION_ID=y").status, 403);
    for _ in 0..2 {
        let slot = browser.get("/").field("slot");
        assert_eq!(browser.post("/answer", &format!("slot={slot}&choice=a")).status, 303);
    }
    let done = browser.get("/");
    assert!(done.body.contains("complete?cc=C0DE") && done.body.contains("<output>C0DE</output>"), "{done:?}");
    assert!(!done.body.contains("5f5f5f"));
}

#[test]
fn declining_the_consent_leaves_no_data_behind() {
    let site = Site::new(StudyTask::Pair, |settings| settings.codes.no_consent = "N0".into());
    let token = site.study.invite_participants(1).unwrap().tokens.remove(0);
    let mut browser = site.browser();
    browser.get(&format!("/t/{token}"));
    let page = browser.post("/consent", "agree=no");
    assert!(page.is_page("done") && page.body.contains("N0"), "{page:?}");
    assert!(site.study.clone().into_data().unwrap().participants.is_empty());
}

#[test]
fn forms_of_other_sites_and_old_tabs_have_no_effect() {
    let site = Site::new(StudyTask::Pair, |_| {});
    let mut browser = site.participant();
    let slot = browser.get("/").field("slot");
    let answer = format!("slot={slot}&choice=a");
    browser.origin = "https://evil.example".into();
    assert_eq!(browser.post("/answer", &answer).status, 403);
    browser.origin = format!("http://{}", site.address);
    assert_eq!(browser.post("/answer", &format!("{answer}&who=somebody-else")).status, 409);
    assert_eq!(browser.get("/").field("slot"), slot, "nothing was answered");
    assert_eq!(browser.post("/answer", &answer).status, 303);
    assert_ne!(browser.get("/").field("slot"), slot);
}

#[test]
fn an_old_page_still_counts_after_the_link_was_opened_again() {
    let site = Site::new(StudyTask::Pair, |_| {});
    let token = site.study.invite_participants(1).unwrap().tokens.remove(0);
    let mut browser = site.browser();
    browser.get(&format!("/t/{token}"));
    browser.post("/consent", "agree=yes");
    let old = browser.get("/");
    browser.get(&format!("/t/{token}"));
    let form = format!("who={}&slot={}&choice=a", old.field("who"), old.field("slot"));
    assert_eq!(browser.post("/answer", &form).status, 303);
    assert_ne!(browser.get("/").field("slot"), old.field("slot"), "it was answered");
}

#[test]
fn consent_to_a_changed_page_is_asked_for_again() {
    let site = Site::new(StudyTask::Pair, |_| {});
    let token = site.study.invite_participants(1).unwrap().tokens.remove(0);
    let mut browser = site.browser();
    browser.get(&format!("/t/{token}"));
    let version = browser.get("/").field("version");
    assert_eq!(browser.post("/consent", "agree=yes&version=of-yesterday").status, 422);
    assert_eq!(browser.post("/consent", &format!("agree=yes&version={version}")).status, 303);
}

#[test]
fn a_participant_with_deleted_answers_cannot_come_in_again() {
    let site = Site::new(StudyTask::Pair, |_| {});
    let token = site.study.invite_participants(1).unwrap().tokens.remove(0);
    let mut browser = site.browser();
    browser.get(&format!("/t/{token}"));
    browser.post("/consent", "agree=yes");
    let cookies = browser.cookies.clone();
    for _ in 0..2 {
        // The reply to the first was lost: the browser still has its cookie.
        browser.cookies.clone_from(&cookies);
        let gone = browser.post("/withdraw", "delete=yes");
        assert!(gone.is_page("done") && gone.body.contains("deleted"), "{gone:?}");
    }
    assert_eq!(site.browser().get(&format!("/t/{token}")).status, 403);
    assert!(site.study.clone().into_data().unwrap().participants.is_empty());
    let log = site.study.folder.join("study.db-wal");
    assert!(std::fs::metadata(log).map_or(0, |log| log.len()) < 100_000);
}

#[test]
fn no_path_leads_out() {
    let site = Site::new(StudyTask::Follow, |_| {});
    let mut browser = site.participant();
    let slot = browser.get("/").field("slot");
    assert_eq!(browser.get(&format!("/look/{slot}/0.jpg")).body, "a picture");
    for path in [
        "1.jpg",
        "-1.jpg",
        "../../study.toml",
        "%2e%2e%2fstudy.db",
        "..%5c..%5cplan.json",
        "0.jpg%00",
        "%ff.jpg",
        "0.png",
        "99999999999999999999.jpg",
    ] {
        let answer = browser.get(&format!("/look/{slot}/{path}"));
        assert_eq!(answer.status, 404, "{path}: {answer:?}");
        assert!(answer.is_page("message") && !answer.body.contains(".rs"), "{answer:?}");
    }
    assert_eq!(site.participant().get(&format!("/look/{slot}/0.jpg")).status, 404, "it is somebody else's");
    assert_eq!(site.browser().get(&format!("/look/{slot}/0.jpg")).status, 403);
}

#[test]
fn oversized_requests_are_refused() {
    let site = Site::new(StudyTask::Rate, |_| {});
    let mut browser = site.participant();
    let slot = browser.get("/").field("slot");
    assert_eq!(browser.post("/write", &format!("slot={slot}&own_text={}", "a".repeat(1001))).status, 422);
    assert_eq!(browser.post("/write", &"a".repeat(20_000)).status, 413);
    let head = format!("GET / HTTP/1.1\r\nHost: x\r\nX: {}\r\n\r\n", "a".repeat(200_000));
    assert!([0, 431].contains(&raw(site.address, head.as_bytes()).status));
    assert_eq!(browser.get("/").field("slot"), slot);
}

#[test]
fn an_open_address_needs_tls() {
    let folder = tempfile::tempdir().unwrap();
    let study = study(folder.path(), StudyTask::Pair);
    study.create().unwrap();
    let open = |security| ListenOptions { address: "0.0.0.0:0".parse().unwrap(), ..listen(security) };
    let refused =
        |study: &Study, security| serve_study(study.clone(), &open(security), |_| (), || true).unwrap_err().to_string();
    assert!(refused(&study, SiteSecurity::Loopback).contains("--insecure-lan"));
    let mut nobody = study.clone();
    nobody.settings.contact = " ".into();
    assert!(refused(&nobody, SiteSecurity::InsecureLan).contains("contact"));
    let mut url = String::new();
    serve_study(study.clone(), &open(SiteSecurity::SelfSigned), |started| url.clone_from(&started.url), || true)
        .unwrap();
    assert!(url.starts_with("https://"), "{url}");
    let key = std::fs::read_to_string(folder.path().join("self-signed.key")).unwrap();
    // The certificate stays the same, because browsers were set to trust it.
    serve_study(study, &open(SiteSecurity::SelfSigned), |_| (), || true).unwrap();
    assert_eq!(std::fs::read_to_string(folder.path().join("self-signed.key")).unwrap(), key);
}
