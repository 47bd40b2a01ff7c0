//! Services that answer every request in one wrong way: how many requests a run pays for, and what it says.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::Building;
use std::{
    io::{BufReader, Write},
    net::TcpListener,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};
use wayword_testkit::read_http_request;

/// A service that gives every question the same answer, and lists no models. It counts the questions.
struct StubbornService {
    base_url: String,
    questions: Arc<AtomicUsize>,
}

impl StubbornService {
    fn start(status: u16, body: &'static str) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let base_url = format!("http://{}", listener.local_addr().unwrap());
        let questions = Arc::new(AtomicUsize::new(0));
        let count = Arc::clone(&questions);
        thread::spawn(move || {
            for stream in listener.incoming().map_while(Result::ok) {
                let count = Arc::clone(&count);
                thread::spawn(move || {
                    let mut reader = BufReader::new(stream.try_clone().unwrap());
                    let mut stream = stream;
                    while let Some((head, _)) = read_http_request(&mut reader) {
                        count.fetch_add(usize::from(head.starts_with("POST")), Ordering::SeqCst);
                        let head = format!("HTTP/1.1 {status} X\r\ncontent-length: {}\r\n\r\n", body.len());
                        if stream.write_all((head + body).as_bytes()).is_err() {
                            return;
                        }
                    }
                });
            }
        });
        Self { base_url, questions }
    }

    /// What `generate` and `doctor` print, and the number of the questions of `generate`.
    fn told(&self, building: &Building) -> (Option<i32>, String, String, usize) {
        let models = ["--see", "server/eye", "--base-url", &self.base_url, "--ledger", "ledger.db"];
        let walks = ["--hops", "3..7", "--style", "r2r", "--evidence", "captions", "--paths", "6"];
        let ran = building.generate("run", &[&models[..], &walks].concat());
        let questions = self.questions.load(Ordering::SeqCst);
        let place = ["doctor", "--platform", "matterport", "--data", "data"];
        let doctor = building.wayword(&[&place[..], &models].concat());
        (ran.code, ran.out + &ran.err, doctor.out, questions)
    }
}

fn building() -> Building {
    let building = Building::new();
    wayword_testkit::write_distinct_skyboxes(&building.data()).unwrap();
    building
}

#[test]
fn what_every_call_meets_is_met_once_and_doctor_gives_the_same_advice() {
    for (status, body, advice) in [
        (404, "<html><body>404</body></html>", "ends in /v1"),
        (404, r#"{"detail":"Not Found"}"#, "ends in /v1"),
        (400, r#"{"error":{"message":"image input is not supported"}}"#, "choose a vision model with --see"),
        (403, r#"{"error":{"message":"no"}}"#, "it needs a key"),
    ] {
        let service = StubbornService::start(status, body);
        let (code, error, doctor, questions) = service.told(&building());
        assert_eq!((code, questions), (Some(5), 1), "{status} {body}: {error}");
        assert!(error.contains(advice) && doctor.contains(advice), "{status} {body}: {error}\n{doctor}");
    }
}

#[test]
fn answers_that_cannot_be_read_are_bought_twice_at_most() {
    for (body, what, questions_at_most) in [
        ("<html><head><title>Sign in</title></head></html>", "a page of HTML with the title \"Sign in\"", 2),
        ("{\"choices\":[]}", "no choices", 4),
        ("data: {\"choices\":[{\"delta\":{\"content\":\"A\"}}]}\n\n", "a stream that breaks off", 4),
    ] {
        let service = StubbornService::start(200, body);
        let (code, error, doctor, questions) = service.told(&building());
        assert_eq!(code, Some(5), "{body}: {error}");
        assert!(questions <= questions_at_most && error.contains(what) && doctor.contains(what), "{error}\n{doctor}");
    }
}
