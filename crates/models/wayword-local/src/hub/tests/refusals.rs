//! Tests the messages for refusals of the hub, and which failures are tried again.

use super::{
    fake::{FakeHub, Fault, TOKEN, fine, model},
    folder, problem,
    server::Reply,
};
use crate::hub::{HubConfig, ModelHub};

fn refusing(status: u16, code: &str) -> FakeHub {
    let code = code.to_owned();
    let fault: Fault = Box::new(move |_, _| Some(Reply::new(status, vec![("X-Error-Code", code.clone())], Vec::new())));
    FakeHub::with(model(), fault, fine())
}

#[test]
fn each_refusal_has_a_hint() {
    for (status, code, says) in [
        (401, "GatedRepo", "accept its terms"),
        (403, "GatedRepo", "accept its terms"),
        (401, "RepoNotFound", "the token in HF_TOKEN gives no access to"),
        (403, "", "the token in HF_TOKEN gives no access to"),
        (404, "RepoNotFound", "there is no org/name, or it is private"),
        (404, "RevisionNotFound", "org/name has no revision v2"),
        (404, "EntryNotFound", "the model has no config.json"),
        (418, "", "status 418"),
    ] {
        let cache = tempfile::tempdir().unwrap();
        let fake = refusing(status, code);
        let problem = problem(&fake.client(cache.path()), "hf/org/name@v2");
        let address = format!("{}/org/name/resolve/v2/config.json: ", fake.hub.url());
        assert!(problem.starts_with(&address) && problem.contains(says), "{status} {code}: {problem}");
        assert!(problem.contains("\nhint: ") && !problem.contains(TOKEN), "{problem}");
        assert_eq!(fake.requests(), 1, "{status} {code}");
    }
}

#[test]
fn without_a_token_a_private_model_asks_for_one() {
    let cache = tempfile::tempdir().unwrap();
    let fake = refusing(401, "RepoNotFound");
    let hub = ModelHub::new(HubConfig { token: None, ..fake.config(cache.path()) }).unwrap();
    let problem = problem(&hub, "hf/org/name");
    assert!(problem.contains("or it is private") && problem.contains("HF_TOKEN"), "{problem}");
    assert!(!fake.hub.requests()[0].headers.contains_key("authorization"));
}

#[test]
fn faults_that_pass_are_waited_out() {
    for status in [500, 503, 429, 408] {
        let cache = tempfile::tempdir().unwrap();
        let fault: Fault = Box::new(move |count, _| {
            (count % 3 < 2).then(|| Reply::new(status, vec![("Retry-After", "0".to_owned())], Vec::new()))
        });
        let fake = FakeHub::with(model(), fault, fine());
        assert!(folder(&fake.client(cache.path()), "hf/org/name").is_ok(), "{status}");
    }
}

#[test]
fn faults_that_stay_are_given_up() {
    let cache = tempfile::tempdir().unwrap();
    let fake = refusing(503, "");
    let problem = problem(&fake.client(cache.path()), "hf/org/name");
    assert!(problem.contains("status 503 (5 times in a row)"), "{problem}");
    assert_eq!(fake.requests(), 5);
}

#[test]
fn client_refuses_an_invalid_endpoint_without_repeating_it() {
    let config = HubConfig { endpoint: "https://me:hunter2@host".to_owned(), ..HubConfig::new("/nowhere".into()) };
    let problem = ModelHub::new(config).unwrap_err().to_string();
    assert!(problem.contains("HF_ENDPOINT") && !problem.contains("hunter2"), "{problem}");
}
