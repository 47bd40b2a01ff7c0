//! A key reaches the service and no other place: no error, file or debug output contains it.

use crate::{
    asked, run,
    server::{Server, answer, reply},
};
use std::{path::Path, process::Command, thread};
use wayword_ledger::{Ledger, RunLimits};
use wayword_remote::{ModelServices, RemoteConfig};

const VARIABLE: &str = "WAYWORD_PLANTED_KEY";
const KEY: &str = "sk-planted-5f1d9e0c77aa";

/// A variable can only be set for a new process, so this test starts itself again with the variable.
#[test]
fn no_key_is_in_any_error_file_or_debug_output() {
    let child = Command::new(std::env::current_exe().unwrap())
        .args(["keys::with_a_key", "--ignored", "--nocapture"])
        .env(VARIABLE, KEY)
        .output()
        .unwrap();
    let printed = String::from_utf8_lossy(&child.stdout).into_owned() + &String::from_utf8_lossy(&child.stderr);
    assert!(child.status.success(), "{printed}");
    assert!(printed.contains("3 passed") && !printed.contains(KEY), "{printed}");
}

#[test]
#[ignore = "run by the test above, with a key in its environment"]
fn with_a_key_errors_are_scrubbed() {
    let folder = tempfile::tempdir().unwrap();
    let services = [("openai", "authorization: bearer "), ("anthropic", "x-api-key: "), ("gemini", "x-goog-api-key: ")];
    thread::scope(|scope| {
        for (dialect, header) in services {
            let folder = folder.path();
            scope.spawn(move || says_the_key_back(dialect, header, folder));
        }
    });
    for file in std::fs::read_dir(folder.path()).unwrap() {
        let bytes = std::fs::read(file.unwrap().path()).unwrap();
        assert!(!bytes.windows(KEY.len()).any(|window| window == KEY.as_bytes()));
    }
}

#[test]
#[ignore = "run by the test above, with a key in its environment"]
fn with_a_key_answers_are_scrubbed() {
    let server = Server::start(|_, _, stream| reply(stream, 200, "", &answer(&format!("Your key is {KEY}."))));
    let config = RemoteConfig {
        base_url: Some(server.base_url()),
        key_env: Some(VARIABLE.to_owned()),
        ..RemoteConfig::default()
    };
    let model = ModelServices::new(config, run()).unwrap().model("server/m").unwrap();
    assert_eq!(asked(&model, "Well?").unwrap().text, "Your key is ***.");
}

#[test]
#[ignore = "run by the test above, with a key in its environment"]
fn with_a_key_texts_of_filters_and_lists_are_scrubbed() {
    let server = Server::start(|_, request, stream| {
        let list = format!(r#"{{"models":[{{"name":"{KEY}"}}]}}"#);
        let blocked = format!(r#"{{"promptFeedback":{{"blockReason":"{KEY}"}}}}"#);
        reply(stream, 200, "", if request.starts_with("GET") { &list } else { &blocked })
    });
    let settings =
        format!("base_url = \"{}\"\nkey_env = \"{VARIABLE}\"\nproviders.mine.dialect = \"gemini\"", server.base_url());
    let services = ModelServices::new(toml::from_str::<RemoteConfig>(&settings).unwrap(), run()).unwrap();
    let shown =
        format!("{:?} {:?}", services.check_model("mine/m", true), asked(&services.model("mine/m").unwrap(), "Well?"));
    assert!(shown.matches("***").count() == 3 && !shown.contains(KEY), "{shown}");
}

#[test]
fn a_key_in_the_wrong_place_is_not_repeated() {
    for config in [
        RemoteConfig { key_env: Some(KEY.to_owned()), ..RemoteConfig::default() },
        RemoteConfig { base_url: Some(format!("https://me:{KEY}@host/v1")), ..RemoteConfig::default() },
        RemoteConfig { base_url: Some(format!("https://host/v1?key={KEY}")), ..RemoteConfig::default() },
    ] {
        let services = ModelServices::new(config, run()).unwrap();
        let error = services.model("openai/m").unwrap_err();
        let shown = format!("{services:?} {error} {error:?} {:?}", services.check_model("openai/m", true));
        assert!(!shown.contains(KEY), "{shown}");
    }
}

#[test]
fn a_missing_key_stops_before_anything_is_sent() {
    let server = Server::start(|_, _, stream| reply(stream, 200, "", &answer("fine")));
    let config = RemoteConfig {
        base_url: Some(server.base_url()),
        key_env: Some("WAYWORD_NO_SUCH_KEY".to_owned()),
        ..RemoteConfig::default()
    };
    let model = ModelServices::new(config, run()).unwrap().model("server/m").unwrap();
    let error = asked(&model, "Well?").unwrap_err();
    assert!(error.ends_run() && error.to_string().contains("export WAYWORD_NO_SUCH_KEY="), "{error}");
    assert!(server.requests().is_empty());
}

/// Talks to a service that repeats the key in every possible way.
fn says_the_key_back(dialect: &str, header: &str, folder: &Path) {
    let server = Server::start(|count, _, stream| match count % 6 {
        0 => reply(stream, 500, "", &format!(r#"{{"error":{{"message":"key {KEY}"}}}}"#)),
        1 => reply(stream, 200, "", &format!("{KEY} is no JSON")),
        2 => reply(stream, 200, "", &format!(r#"{{"error":"{KEY}"}}"#)),
        3 => reply(stream, 502, &format!("x-key: {KEY}\r\n"), KEY),
        4 => reply(stream, 400, "", &format!(r#"{{"error":{{"message":"{KEY}"}}}}"#)),
        _ => reply(stream, 401, "", &format!(r#"{{"error":{{"message":"wrong key {KEY}"}}}}"#)),
    });
    let ledger = Ledger::open(&folder.join(format!("{dialect}.sqlite"))).unwrap();
    let run = ledger.start_run("test", RunLimits::default()).unwrap();
    let settings = format!(
        "base_url = \"{}\"\nkey_env = \"{VARIABLE}\"\nproviders.mine.dialect = \"{dialect}\"",
        server.base_url()
    );
    let services = ModelServices::new(toml::from_str::<RemoteConfig>(&settings).unwrap(), run).unwrap();
    let model = services.model("mine/m").unwrap();
    let ask = |text: &str| asked(&model, text).unwrap_err();
    let (unread, refused, stopped) = (ask("One?"), ask("Two?"), ask("Three?"));
    assert!(!unread.ends_run() && !refused.ends_run() && stopped.ends_run(), "{dialect}: {unread:?} {stopped:?}");
    let shown = format!(
        "{unread} {unread:?} {refused} {refused:?} {stopped} {stopped:?} {services:?} {model:?} {:?}",
        services.check_model("mine/m", true)
    );
    assert!(shown.contains("***") && !shown.contains(KEY), "{shown}");
    let requests = server.requests();
    assert!(requests.iter().all(|request| request.to_lowercase().contains(&format!("{header}{KEY}"))), "{requests:?}");
    assert!(requests.iter().all(|request| !request.lines().next().unwrap().contains(KEY)));
}
