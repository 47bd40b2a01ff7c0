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
    ConditionKind, ConsentLink, ENGLISH_TEXTS, EndQuestion, EndQuestionKind, FilmPicture, ListenOptions, PageTexts,
    ParticipantAnswer, RecruiterSettings, SiteAddress, SiteSecurity, Study, StudyCondition, StudyDesign, StudyItem,
    StudyRoute, StudyScene, StudySettings, StudyTask, StudyText, StudyViewpoint, TextMark, WindowSize, preview_study,
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
        bends: BTreeMap::new(),
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
    // Each route has texts of its own, because nobody gets a text twice.
    let told = |name: &str, route: u32| StudyText {
        condition: name.into(),
        text: format!("Go to the <b>door</b> & stop.{}", "!".repeat(route as usize)),
        ..StudyText::default()
    };
    let item = |id, is_practice| {
        let names: &[&str] = if mode == StudyTask::Pair { &["condition-x", "condition-y"] } else { &["condition-x"] };
        StudyItem { id, route: id, is_practice, texts: names.iter().map(|name| told(name, id)).collect() }
    };
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
        texts: PageTexts::default(),
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
        assert!(["", "/", "/?arrived"].contains(&header("location").as_str()), "{answer:?}");
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
fn a_walk_for_practice_says_how_it_went_and_can_be_walked_again() {
    let site = Site::with(StudyTask::Follow, |study| {
        let goal = ViewpointId::new("goal-g").unwrap();
        study.scenes[0].places.get_mut(&goal).unwrap().position[0] = 3.5;
    });
    let mut browser = site.participant();
    let page = browser.get("/");
    let slot = page.field("slot");
    assert!(page.is_page("follow") && page.body.contains("<h1 tabindex=\"-1\">Follow the directions</h1>"), "{page:?}");
    // The goal lies behind the one way.
    assert_eq!(browser.post("/stop", &format!("slot={slot}&seq=0&looks=0")).status, 303);
    let after = browser.get("/");
    assert!(
        after.is_page("follow_after") && after.body.contains("You did not arrive.</b> The directions end 4\u{a0}m"),
        "{}",
        after.body
    );
    assert_eq!(browser.post("/again", &format!("slot={slot}")).status, 303);
    let page = browser.get("/");
    assert!(page.is_page("follow") && page.field("seq") == "0" && page.field("slot") == slot, "{page:?}");
    assert_eq!(browser.post("/move", &format!("slot={slot}&seq=0&to=0")).status, 303);
    assert_eq!(browser.post("/stop", &format!("slot={slot}&seq=1&looks=0")).status, 303);
    assert!(browser.get("/").body.contains("You arrived."));
    let answer = format!("slot={slot}&window=1400+1000+1+mouse&s0=1&s1=1&s2=1");
    assert_eq!(browser.post("/answer", &answer).status, 303);
    // A walk that counts is made once, and nobody is told how it went.
    let slot = browser.get("/").field("slot");
    assert_eq!(browser.post("/stop", &format!("slot={slot}&seq=0&looks=0")).status, 303);
    let after = browser.get("/");
    assert!(!after.body.contains("arrive") && !after.body.contains("again"), "{}", after.body);
    assert_eq!(browser.post("/again", &format!("slot={slot}")).status, 409);
    let answered = site.study.clone().into_data().unwrap().slots;
    let window = Some(WindowSize { width_px: 1400, height_px: 1000, pixel_ratio: 1, has_touch: false });
    assert!(
        answered
            .iter()
            .any(|slot| matches!(slot.answer, Some(ParticipantAnswer::Follow { window: kept, .. }) if kept == window)),
        "{answered:?}"
    );
}

#[test]
fn the_ways_from_a_place_have_names_of_their_own() {
    let site = Site::new(StudyTask::Follow, |_| {});
    let page = site.participant().get("/");
    assert!(page.body.contains("data-spot-slope=") && !page.body.contains("(0\u{a0}m)"), "{}", page.body);
    assert!(page.body.contains(">Go to the right (2\u{a0}m)</button>"), "{}", page.body);
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
    assert_eq!((came.status, came.headers["location"].as_str()), (303, "/?arrived"));
    assert_eq!(browser.get("/?arrived").headers["location"], "/");
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
    assert_eq!(browser.post("/answer", &"a".repeat(20_000)).status, 413);
    assert_eq!(browser.post("/write", &"a".repeat(600_000)).status, 413);
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

/// A site of comparisons with questions at the end, and a participant who has answered all items.
fn at_the_end() -> (Site, Browser) {
    let question = |name: &str, kind, answers: &[&str], optional| EndQuestion {
        name: name.into(),
        text: format!("What about <i>{name}</i>?"),
        kind,
        answers: answers.iter().map(|one| (*one).into()).collect(),
        optional,
        max_chars: if kind == EndQuestionKind::Text { 20 } else { 0 },
    };
    let site = Site::new(StudyTask::Pair, |settings| {
        settings.codes.done = "C0DE".into();
        settings.end = vec![
            question("age", EndQuestionKind::Choice, &["under 30", "30 or more"], false),
            question("often", EndQuestionKind::Scale, &["never", "sometimes", "daily"], false),
            question("remarks", EndQuestionKind::Text, &[], true),
        ];
    });
    let mut browser = site.participant();
    for _ in 0..2 {
        let slot = browser.get("/").field("slot");
        assert_eq!(browser.post("/answer", &format!("slot={slot}&choice=a&pictures=1")).status, 303);
    }
    (site, browser)
}

#[test]
fn questions_at_the_end_are_shown_checked_and_stored_before_the_code() {
    let (site, mut browser) = at_the_end();
    let page = browser.get("/");
    assert!(page.is_page("end") && page.body.contains("What about &lt;i&gt;age&lt;&#x2f;i&gt;?"), "{page:?}");
    assert!(!page.body.contains("C0DE") && page.body.contains("maxlength=\"20\""), "{page:?}");
    for (form, kept) in [
        ("end_age=1&end_remarks=fine", "fine"),
        ("end_age=3&end_often=2", "value=\"2\" required checked"),
        ("end_age=1&end_often=2&end_remarks=123456789012345678901", "123456789012345678901"),
    ] {
        let page = browser.post("/end", form);
        assert_eq!(page.status, 422, "{form}");
        assert!(page.body.contains("role=\"alert\"") && page.body.contains(kept), "{form}: {page:?}");
    }
    assert_eq!(browser.post("/end", "end_age=2&end_often=3&end_remarks=%3Cb%3E").status, 303);
    assert!(browser.get("/").body.contains("C0DE"));
    let person = &site.study.clone().into_data().unwrap().participants[0];
    let answers: Vec<(&str, Option<usize>)> = person.end.iter().map(|one| (one.answer.as_str(), one.number)).collect();
    assert_eq!(answers, [("30 or more", Some(2)), ("daily", Some(3)), ("<b>", None)]);
}

#[test]
fn the_code_is_shown_again_after_the_study_is_closed() {
    let (site, mut browser) = at_the_end();
    site.study.close(false).unwrap();
    assert!(browser.get("/").body.contains("<output>C0DE</output>"), "without the questions at the end");
    let site = Site::new(StudyTask::Pair, |settings| settings.codes.done = "C0DE".into());
    let token = site.study.invite_participants(1).unwrap().tokens.remove(0);
    let mut browser = site.browser();
    browser.get(&format!("/t/{token}"));
    browser.post("/consent", "agree=yes");
    for _ in 0..2 {
        let slot = browser.get("/").field("slot");
        browser.post("/answer", &format!("slot={slot}&choice=a"));
    }
    site.study.close(false).unwrap();
    let mut other_device = site.browser();
    other_device.get(&format!("/t/{token}"));
    assert!(other_device.get("/").body.contains("<output>C0DE</output>"));
}

#[test]
fn a_recruited_participant_sees_the_code_after_closing_in_the_same_browser() {
    let site = Site::new(StudyTask::Pair, |settings| {
        let [person, session] = ["PROLIFIC_PID", "SESSION_ID"].map(str::to_owned);
        settings.recruiter =
            RecruiterSettings::Parameters { person, session, study: String::new(), only_study: String::new() };
        settings.codes.done = "C0DE".into();
    });
    let link = "/join?PROLIFIC_PID=5f5f5f&SESSION_ID=x";
    let mut browser = site.browser();
    browser.get(link);
    browser.post("/consent", "agree=yes");
    for _ in 0..2 {
        let slot = browser.get("/").field("slot");
        browser.post("/answer", &format!("slot={slot}&choice=a"));
    }
    site.study.close(false).unwrap();
    assert_eq!(browser.get(link).status, 303);
    assert!(browser.get("/").body.contains("<output>C0DE</output>"));
    assert_eq!(site.browser().get(link).status, 410, "the ids are gone, so another browser is a stranger");
}

#[test]
fn a_browser_without_cookies_is_told_so() {
    let site = Site::new(StudyTask::Pair, |_| {});
    let token = site.study.invite_participants(1).unwrap().tokens.remove(0);
    let mut browser = site.browser();
    let came = browser.get(&format!("/t/{token}"));
    browser.cookies.clear();
    let page = browser.get(&came.headers["location"]);
    assert_eq!(page.status, 403);
    assert!(page.body.contains("does not keep cookies"), "{page:?}");
    browser.get(&format!("/t/{token}"));
    assert_eq!(browser.get("/?arrived").headers["location"], "/");
    assert!(browser.get("/").is_page("consent"));
}

#[test]
fn a_text_that_is_too_long_comes_back_whole() {
    let site = Site::new(StudyTask::Rate, |_| {});
    let mut browser = site.participant();
    let slot = browser.get("/").field("slot");
    // 10,000 letters, each of six bytes as a form sends it.
    let page = browser.post("/write", &format!("slot={slot}&own_text={}", "%C3%A9".repeat(10_000)));
    assert_eq!(page.status, 422);
    assert!(
        page.body.contains(&"é".repeat(10_000)) && page.body.contains("At most 1000 characters"),
        "{}",
        page.status
    );
}

#[test]
fn pages_speak_the_language_of_the_texts() {
    let german = ENGLISH_TEXTS
        .replace("language = \"en\"", "language = \"ar\"")
        .replace("\"Compare two sets of directions\"", "\"Vergleichen <b>Sie</b>\"")
        .replace("\"Play\"", "\"Ab\\\"spielen\"");
    let site = Site::with(StudyTask::Pair, |study| study.texts = PageTexts::parse(&german).unwrap());
    assert_eq!(Study::open(&site.study.folder).unwrap().texts, site.study.texts, "the folder keeps the words");
    let mut browser = site.participant();
    let page = browser.get("/");
    assert!(page.body.contains("<html lang=\"ar\" dir=\"rtl\">"), "{page:?}");
    assert!(page.body.contains("Vergleichen &lt;b&gt;Sie"), "{page:?}");
    assert!(page.body.contains("dir=\"auto\" lang=\"en\""), "the instructions are English");
    assert!(browser.get("/script.js").body.contains(r#""play":"Ab\"spielen""#));
    let wrong = ENGLISH_TEXTS.replace("go_on =", "goon =");
    std::fs::write(site.study.folder.join("texts.toml"), wrong).unwrap();
    let told = Study::open(&site.study.folder).unwrap_err().to_string();
    assert!(told.contains("texts.toml") && told.contains("did you mean") && told.contains("study texts"), "{told}");
}

#[test]
fn the_consent_page_names_the_approval_and_shows_links() {
    let site = Site::new(StudyTask::Pair, |settings| {
        settings.ethics = "Board of <x>, 12/2026".into();
        settings.links = vec![ConsentLink { text: "Data & rights".into(), url: "https://example.org/a?b=1&c".into() }];
    });
    let token = site.study.invite_participants(1).unwrap().tokens.remove(0);
    let mut browser = site.browser();
    browser.get(&format!("/t/{token}"));
    let page = browser.get("/");
    assert!(
        page.body.contains("Board of &lt;x&gt;, 12&#x2f;2026") && page.body.contains("Data &amp; rights"),
        "{page:?}"
    );
    assert!(page.body.contains("rel=\"noopener noreferrer\""), "{page:?}");
}

#[test]
fn a_preview_is_marked_and_stores_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut study = study(folder.path(), StudyTask::Pair);
    study.settings.recruiter = RecruiterSettings::Parameters {
        person: "a".into(),
        session: "b".into(),
        study: String::new(),
        only_study: String::new(),
    };
    study.create().unwrap();
    std::fs::write(study.pictures_folder().join("picture.jpg"), b"a picture").unwrap();
    let before = std::fs::read(folder.path().join("study.db")).unwrap();
    let (told, started) = mpsc::channel();
    let stop = Arc::new(AtomicBool::new(false));
    let (shown, ending) = (study.clone(), Arc::clone(&stop));
    let thread = thread::spawn(move || {
        let tell = |started: &SiteAddress| told.send(started.address).unwrap();
        preview_study(shown, &listen(SiteSecurity::Loopback), tell, || ending.load(Ordering::Relaxed)).unwrap();
    });
    let address = started.recv().unwrap();
    // Each visit of the link begins anew.
    for _ in 0..3 {
        let mut browser = Browser { address, origin: format!("http://{address}"), cookies: BTreeMap::new() };
        assert_eq!(browser.get("/preview").status, 303);
        let mut pages = vec![browser.get("/")];
        assert!(pages[0].is_page("consent"), "{pages:?}");
        browser.post("/consent", "agree=yes");
        for _ in 0..2 {
            let page = browser.get("/");
            browser.post("/answer", &format!("slot={}&choice=a", page.field("slot")));
            pages.push(page);
        }
        pages.extend([browser.get("/"), browser.get("/withdraw"), browser.get("/nowhere")]);
        assert!(pages[3].is_page("done"), "{pages:?}");
        assert!(pages.iter().all(|page| page.body.contains("class=\"preview\"")), "{pages:?}");
    }
    stop.store(true, Ordering::Relaxed);
    thread.join().unwrap();
    assert_eq!(std::fs::read(folder.path().join("study.db")).unwrap(), before);
    assert!(study.into_data().unwrap().participants.is_empty());
    let site = Site::new(StudyTask::Pair, |_| {});
    assert_eq!(site.browser().get("/preview").status, 404, "participants have no such link");
    assert!(!site.participant().get("/").body.contains("class=\"preview\""));
}

#[test]
fn a_second_server_of_one_study_is_refused_at_once() {
    let site = Site::new(StudyTask::Pair, |_| {});
    let second = serve_study(site.study.clone(), &listen(SiteSecurity::Loopback), |_| (), || true);
    assert!(second.unwrap_err().to_string().contains("serves this study already"));
    // A preview, status and results go on beside it.
    preview_study(site.study.clone(), &listen(SiteSecurity::Loopback), |_| (), || true).unwrap();
    site.study.read_progress().unwrap();
    let study = site.study.clone();
    let folder = tempfile::tempdir().unwrap();
    drop(site);
    // The folder is gone with the site; another one, whose server has ended, can be served again.
    let study = Study { folder: folder.path().to_owned(), ..study };
    study.create().unwrap();
    for _ in 0..2 {
        serve_study(study.clone(), &listen(SiteSecurity::Loopback), |_| (), || true).unwrap();
    }
}

/// The words of all pages, with another letter in the place of each letter of the alphabet.
fn foreign_texts() -> PageTexts {
    let mut foreign = String::new();
    for line in ENGLISH_TEXTS.lines() {
        let Some((key, text)) = line.split_once(" = ").filter(|(key, _)| !key.starts_with(['#', '['])) else {
            foreign.extend([line, "\n"]);
            continue;
        };
        let mut in_braces = false;
        let letter = |letter: char| {
            in_braces = (in_braces || letter == '{') && letter != '}';
            if letter.is_ascii_alphabetic() && !in_braces { 'ж' } else { letter }
        };
        let text: String = if key == "language" { "\"ru\"".to_owned() } else { text.chars().map(letter).collect() };
        foreign.extend([key, " = ", &text, "\n"]);
    }
    PageTexts::parse(&foreign).unwrap()
}

/// What somebody reads or hears on a page: its text, and the attributes that stand for text.
fn words_of(page: &str) -> String {
    let (mut words, mut rest) = (String::new(), page);
    while let Some((before, after)) = rest.split_once('<') {
        words.push_str(before);
        let (tag, after) = after.split_once('>').unwrap();
        for name in ["aria-label=\"", "alt=\"", "title=\"", "placeholder=\"", "data-words=\""] {
            words.extend(tag.split(name).skip(1).filter_map(|value| value.split('"').next()));
        }
        rest = after;
        words.push(' ');
    }
    // Escaped characters are no words.
    words.split('&').map(|part| part.split_once(';').map_or(part, |(_, after)| after)).collect()
}

/// The first two letters of the alphabet in a row.
fn first_english(words: &str) -> Option<usize> {
    words.as_bytes().windows(2).position(|pair| pair.iter().all(u8::is_ascii_alphabetic))
}

#[test]
fn no_page_of_a_translated_study_has_an_english_word() {
    for mode in [StudyTask::Follow, StudyTask::Rate, StudyTask::Pair] {
        let texts = foreign_texts();
        let site = Site::with(mode, |study| {
            study.settings = StudySettings {
                contact: "Ж. Ж.".into(),
                ethics: "ж 7".into(),
                attention_checks: 2,
                end: vec![EndQuestion {
                    name: "a".into(),
                    text: "ж?".into(),
                    kind: EndQuestionKind::Text,
                    answers: Vec::new(),
                    optional: true,
                    max_chars: 20,
                }],
                ..StudySettings::in_language(mode, 1, &texts)
            };
            study.texts = texts;
            for text in study.items.iter_mut().flat_map(|item| &mut item.texts) {
                text.text = format!("ж ж {}.", "!".repeat(text.text.len()));
                let grades = [DoubtGrade::Likely, DoubtGrade::Uncertain].into_iter().zip([[0, 2], [3, 5]]);
                let marks =
                    grades.map(|(grade, span)| TextMark { span, grade, alternatives: vec![Some("ж".into()), None] });
                text.marks = marks.collect();
            }
            let start = ViewpointId::new("start").unwrap();
            study.scenes[0].places.get_mut(&start).unwrap().position[0] = -1.5;
        });
        let token = site.study.invite_participants(1).unwrap().tokens.remove(0);
        let mut browser = site.browser();
        let mut pages = vec![browser.get("/?arrived"), browser.get("/")];
        browser.get(&format!("/t/{token}"));
        pages.push(browser.get("/"));
        pages.push(browser.post("/consent", "agree=yes&version=old"));
        browser.post("/consent", "agree=yes");
        let mut names = Vec::new();
        for turn in 0..40 {
            let page = browser.get("/");
            let slot = page.field("slot");
            let name =
                page.body.split("data-page=\"").nth(1).and_then(|rest| rest.split('"').next()).unwrap().to_owned();
            pages.push(page.clone());
            match name.as_str() {
                "understood" => {
                    pages.push(browser.post("/understood", "try=0&q0=1"));
                    let right = if mode == StudyTask::Rate { "q0=2&q1=0" } else { "q0=1&q1=0" };
                    // Wrong at first, then right.
                    let answers = if page.field("try") == "0" { "q0=0&q1=1" } else { right };
                    browser.post("/understood", &format!("try={}&{answers}", page.field("try")));
                }
                "follow" if turn % 2 == 0 && page.field("seq") == "0" => {
                    pages.push(browser.post("/move", &format!("slot={slot}&seq=0")));
                    browser.post("/move", &format!("slot={slot}&seq=0&to=0"));
                }
                "follow" => {
                    browser.post("/stop", &format!("slot={slot}&seq={}&looks=0", page.field("seq")));
                    if pages.len() < 12 {
                        pages.push(browser.get("/"));
                        browser.post("/again", &format!("slot={slot}"));
                    }
                }
                "follow_after" => {
                    pages.push(browser.post("/answer", &format!("slot={slot}")));
                    browser.post("/answer", &format!("slot={slot}&s0=1&s1=1&s2=1"));
                }
                "watch" => {
                    pages.push(browser.post("/write", &format!("slot={slot}")));
                    browser.post("/write", &format!("slot={slot}&own_text=1"));
                }
                "rate" => {
                    browser.post("/answer", &format!("slot={slot}&q0=1&q1=1&q2=1&q3=1"));
                }
                "pair" => {
                    pages.push(browser.post("/answer", &format!("slot={slot}")));
                    browser.post("/answer", &format!("slot={slot}&choice=a"));
                }
                "attention" => {
                    browser.post("/attention", &format!("number={}&choice=1", page.field("number")));
                }
                "end" => {
                    browser.post("/end", "");
                }
                name => {
                    assert_eq!(name, "done");
                    break;
                }
            }
            names.push(name);
        }
        assert!(names.iter().any(|name| name == "end") && names.iter().any(|name| name == "attention"), "{names:?}");
        pages.extend([browser.get("/withdraw"), browser.post("/withdraw", ""), browser.get("/nowhere")]);
        pages.push(browser.send("POST", "/answer", "", "Sec-Fetch-Site: cross-site\r\n"));
        for page in pages.iter().filter(|page| page.body.contains("<html")) {
            let words = words_of(&page.body.replace(&page.field("version"), "").replace("ж ж", ""));
            if let Some(at) = first_english(&words) {
                panic!(
                    "{mode:?}: English words: {:?}\n{}",
                    words[at..].chars().take(60).collect::<String>(),
                    page.body
                );
            }
        }
        assert!(pages.len() > 12, "{}", pages.len());
    }
}

#[test]
fn the_script_has_no_words_of_its_own() {
    let site = Site::with(StudyTask::Follow, |study| study.texts = foreign_texts());
    let script = site.browser().get("/script.js").body;
    let code = script
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .map(|line| line.split("  //").next().unwrap());
    // What is no word for people: a directive of the language, and names that only the script reads.
    let known = ["use strict", "wayword-study ", "(prefers-reduced-motion: reduce)"];
    for line in code {
        for quote in ['\'', '`', '"'] {
            for literal in line.split(quote).skip(1).step_by(2).filter(|literal| !known.contains(literal)) {
                let spaced = literal
                    .split(' ')
                    .filter(|word| word.len() > 1 && word.bytes().all(|byte| byte.is_ascii_alphabetic()));
                let is_selector = literal.contains(['.', '#', '[', '$', '(', ',']);
                assert!(spaced.count() < 2 || is_selector, "{literal:?} in {line}");
                let is_sentence = literal.starts_with(|letter: char| letter.is_ascii_uppercase())
                    && literal.ends_with(['.', '!', '?']);
                assert!(!is_sentence, "{literal:?} in {line}");
            }
        }
    }
    assert!(script.contains("\"turned_left\":\"ж"), "{}", &script[..200]);
}

#[test]
fn what_is_recorded_stands_on_the_consent_page_and_belongs_to_its_version() {
    let consent = |mode: StudyTask| {
        let site = Site::new(mode, |_| {});
        let token = site.study.invite_participants(1).unwrap().tokens.remove(0);
        let mut browser = site.browser();
        browser.get(&format!("/t/{token}"));
        browser.get("/")
    };
    let (walked, watched) = (consent(StudyTask::Follow), consent(StudyTask::Pair));
    for word in ["browser window", "pixel density", "touchscreen or a mouse", "each step"] {
        assert!(walked.body.contains(word) && !watched.body.contains(word), "{word}: {}", walked.body);
    }
    assert!(watched.body.contains("how many of the pictures"), "{}", watched.body);
    assert_ne!(walked.field("version"), watched.field("version"));
}

#[test]
fn a_closed_study_still_gives_its_code_to_those_who_finished() {
    let site = Site::new(StudyTask::Pair, |settings| settings.codes.done = "C0DE".into());
    let mut browser = site.participant();
    for _ in 0..2 {
        let slot = browser.get("/").field("slot");
        browser.post("/answer", &format!("slot={slot}&choice=a"));
    }
    site.study.close(true).unwrap();
    assert!(browser.get("/").body.contains("<output>C0DE</output>"));
    assert!(site.study.invite_participants(1).unwrap_err().to_string().contains("is closed"));
}
