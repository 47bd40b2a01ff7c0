//! Models and services as the rest of the program uses them.

use crate::{
    ask, asked, model, run,
    server::{Server, answer, reply},
    services,
};
use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};
use wayword_core::{ChatMessage, FinishReason, Image, LanguageModel};
use wayword_ledger::{Ledger, RunLimits};
use wayword_remote::{CheckLevel, ModelServices, PriceTable, RemoteConfig};

/// A server that answers with the question.
fn echo() -> Server {
    Server::start(|_, request, stream| {
        let body: serde_json::Value = serde_json::from_str(request.split_once("\r\n\r\n").unwrap().1).unwrap();
        let text = body["messages"][0]["content"].as_str().unwrap();
        if text == "bad" { reply(stream, 400, "", "{}") } else { reply(stream, 200, "", &answer(text)) }
    })
}

#[test]
fn a_batch_is_answered_in_its_order_and_one_failure_is_one() {
    let server = echo();
    let texts: Vec<String> = (0..40).map(|i| if i == 17 { "bad".to_owned() } else { format!("text {i}") }).collect();
    let requests: Vec<_> = texts.iter().map(|text| ask(text)).collect();
    let replies = model(&server, "concurrency = 4", &run()).complete_requests(&requests);
    for (text, reply) in texts.iter().zip(replies) {
        match reply {
            Ok(reply) => assert_eq!((&reply.text, reply.finish), (text, FinishReason::Stop)),
            Err(error) => assert_eq!((text.as_str(), error.ends_run()), ("bad", false)),
        }
    }
    assert!(model(&server, "", &run()).complete_requests(&[]).is_empty());
}

#[test]
fn a_call_is_made_once() {
    let server = echo();
    let run = run();
    let model = model(&server, "", &run);
    for _ in 0..3 {
        assert_eq!(asked(&model, "Hello?").unwrap().text, "Hello?");
    }
    assert_eq!(server.requests().len(), 1);
    let mut anew = ask("Hello?");
    anew.replicate = 1;
    assert!(model.complete_requests(&[anew])[0].is_ok());
    assert_eq!(server.requests().len(), 2);
}

#[test]
fn a_recording_answers_without_any_service() {
    let server = echo();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("calls.jsonl");
    let recorded = run();
    assert!(asked(&model(&server, "", &recorded), "Hello?").is_ok());
    recorded.record_calls(&file, std::fs::File::create(&file).unwrap()).unwrap();
    let replayed = Ledger::replay_recording(&file).unwrap().start_run("replay", RunLimits::default()).unwrap();
    // A replay needs no key.
    let model = model(&server, "key_env = \"WAYWORD_NO_SUCH_KEY\"", &replayed);
    assert_eq!(asked(&model, "Hello?").unwrap().text, "Hello?");
    let error = asked(&model, "Something else?").unwrap_err();
    assert!(!error.ends_run() && error.to_string().contains("has no call to"), "{error}");
    assert_eq!(server.requests().len(), 1);
}

#[test]
fn a_spent_budget_stops_with_a_hint_how_to_continue() {
    let server = echo();
    let limits = RunLimits { max_calls: Some(2), ..RunLimits::default() };
    let run = Ledger::in_memory().unwrap().start_run("test", limits).unwrap();
    let model = model(&server, "", &run);
    assert!(asked(&model, "One?").is_ok() && asked(&model, "Two?").is_ok());
    let error = asked(&model, "Three?").unwrap_err();
    assert!(error.ends_run() && error.to_string().contains("larger --max-calls"), "{error}");
    assert!(asked(&model, "One?").is_ok());
    assert_eq!(server.requests().len(), 2);
}

#[test]
fn the_cost_of_a_call_is_computed_and_limited() {
    let server = echo();
    let row = "\"server/m\" = { usd_per_million_in = 1e5, usd_per_million_out = 1e5, as_of = \"2026-01-01\" }";
    let ledger = Ledger::in_memory().unwrap();
    let replies = |max_usd: f64| {
        let run = ledger.start_run("test", RunLimits { max_usd: Some(max_usd), ..RunLimits::default() }).unwrap();
        let config = RemoteConfig {
            base_url: Some(server.base_url()),
            prices: PriceTable::from_toml(row).unwrap(),
            needs_prices: true,
            ..RemoteConfig::default()
        };
        let reply = asked(&ModelServices::new(config, run.clone()).unwrap().model("server/m").unwrap(), "Hello?");
        (reply, run.totals().usd)
    };
    // At most 20 tokens come out, at 10 cents each.
    let (refused, _) = replies(2.0);
    assert!(refused.unwrap_err().to_string().contains("larger --max-usd"));
    assert!(server.requests().is_empty());
    // Ten tokens in and two out were counted by the service.
    let (answered, usd) = replies(20.0);
    assert!(answered.is_ok() && (usd - 1.2).abs() < 1e-9, "{usd}");
}

#[test]
fn a_picture_is_sent_as_jpeg_and_stored_as_a_hash() {
    let server = Server::start(|_, _, stream| reply(stream, 200, "", &answer("Red.")));
    let folder = tempfile::tempdir().unwrap();
    let run = run();
    let image = Arc::new(Image::new(600, 400, [200, 0, 0].repeat(600 * 400)).unwrap());
    let mut request = ask("Colour?");
    request.messages = vec![ChatMessage::about_images("Colour?", vec![image])];
    assert_eq!(model(&server, "", &run).complete_requests(&[request])[0].as_ref().unwrap().text, "Red.");
    assert!(server.requests()[0].contains("data:image/jpeg;base64,/9j/"));
    let file = folder.path().join("calls.jsonl");
    assert_eq!(run.record_calls(&file, std::fs::File::create(&file).unwrap()).unwrap(), 1);
    let row = std::fs::read_to_string(&file).unwrap();
    assert!(
        row.contains("\"image_sha256\":\"") && row.contains("\"picture_px\":512") && !row.contains("/9j/"),
        "{row}"
    );
}

#[test]
fn one_base_url_is_for_one_provider() {
    let server = echo();
    let services = services(&server, "", &run());
    services.model("server/a").unwrap();
    services.model("server/b").unwrap();
    let error = services.model("ollama/c").unwrap_err().to_string();
    assert!(error.contains("[providers.server]") && error.contains("[providers.ollama]"), "{error}");
}

#[test]
fn a_bound_on_money_needs_prices() {
    let config = RemoteConfig { needs_prices: true, ..RemoteConfig::default() };
    let services = ModelServices::new(config, run()).unwrap();
    assert!(services.model("openai/gpt-4o-mini").unwrap().price().is_some());
    assert_eq!(services.model("ollama/qwen3").unwrap().price().unwrap().cost_usd(1000, 1000), 0.0);
    let error = services.model("openrouter/who/knows").unwrap_err().to_string();
    assert!(error.contains("--prices FILE"), "{error}");
}

/// A provider that is free on your own machine may be a paid service elsewhere.
#[test]
fn a_provider_that_is_not_local_is_not_free() {
    let mut config: RemoteConfig = toml::from_str("[providers.ollama]\nlocal = false").unwrap();
    config.needs_prices = true;
    let services = ModelServices::new(config, run()).unwrap();
    assert!(services.model("ollama/qwen3").is_err());
    assert!(services.model("vllm/qwen3").is_ok());
}

/// If the program believed the count, one answer would delay all requests for years.
#[test]
fn an_impossible_count_of_tokens_is_replaced_by_an_estimate() {
    let server = Server::start(|_, _, stream| {
        let usage = r#""usage":{"prompt_tokens":18446744073709551615,"completion_tokens":18446744073709551615}"#;
        reply(stream, 200, "", &format!(r#"{{"choices":[{{"message":{{"content":"fine"}}}}],{usage}}}"#))
    });
    let run = run();
    let model = model(&server, "tokens_per_minute = 1000000", &run);
    for text in ["One?", "Two?"] {
        assert_eq!(asked(&model, text).unwrap().text, "fine");
    }
    assert!(run.totals().tokens_in < 100 && run.totals().tokens_out < 100, "{:?}", run.totals());
}

#[test]
fn settings_that_make_no_sense_are_refused() {
    for settings in [
        "attempts = 0",
        "picture_px = 0",
        "timeout_s = 0",
        "timeout_s = nan",
        "concurrency = 0",
        "concurrency = { most = 99999 }",
    ] {
        assert!(ModelServices::new(toml::from_str(settings).unwrap(), run()).is_err(), "{settings}");
    }
}

/// The findings of `check`: level and text.
fn findings(server: &Server) -> Vec<(CheckLevel, String)> {
    services(server, "attempts = 1", &run())
        .check_model("server/m", true)
        .into_iter()
        .map(|finding| (finding.level, finding.what))
        .collect()
}

#[test]
fn check_finds_no_problem_with_a_working_model() {
    let server = Server::start(|_, request, stream| {
        let body = if request.starts_with("GET") { r#"{"data":[{"id":"m"}]}"#.to_owned() } else { answer("Red") };
        reply(stream, 200, "", &body)
    });
    let found = findings(&server);
    let levels: Vec<CheckLevel> = found.iter().map(|(level, _)| *level).collect();
    use CheckLevel::{Ok, Warning};
    assert_eq!(levels, [Ok, Ok, Ok, Warning, Ok, Ok], "{found:?}");
    assert!(found[3].1.contains("the price of") && found[5].1.ends_with("sees"), "{found:?}");
    // A model that only writes gets no picture.
    let before = server.requests().len();
    let found = services(&server, "attempts = 1", &run()).check_model("server/m", false);
    assert_eq!((found.len(), server.requests().len()), (5, before + 2));
}

#[test]
fn check_finds_a_model_that_is_blind_or_missing() {
    let server = Server::start(|_, request, stream| {
        let body = if request.starts_with("GET") { r#"{"data":[{"id":"other"}]}"#.to_owned() } else { answer("Blue") };
        reply(stream, 200, "", &body)
    });
    let found = findings(&server);
    assert!(found[2].0 == CheckLevel::Warning && found[2].1.contains("does not list m"), "{found:?}");
    assert!(found[5].0 == CheckLevel::Warning && found[5].1.contains("red square and said: Blue"), "{found:?}");
    let closed = Server::start(|_, _, stream| reply(stream, 401, "", "{}"));
    assert_eq!(findings(&closed).last().unwrap().0, CheckLevel::Problem);
}

/// An answer in the ledger does not show that the model works now.
#[test]
fn check_ignores_answers_of_earlier_checks() {
    let works = Arc::new(AtomicBool::new(true));
    let seen = Arc::clone(&works);
    let server = Server::start(move |_, request, stream| match request.starts_with("GET") {
        true => reply(stream, 200, "", r#"{"data":[{"id":"m"}]}"#),
        false if seen.load(Ordering::SeqCst) => reply(stream, 200, "", &answer("ready")),
        false => reply(stream, 500, "", "{}"),
    });
    let services = services(&server, "attempts = 1", &run());
    assert_eq!(services.check_model("server/m", false).last().unwrap().level, CheckLevel::Ok);
    works.store(false, Ordering::SeqCst);
    // The time distinguishes two checks.
    thread::sleep(Duration::from_millis(5));
    assert_eq!(services.check_model("server/m", false).last().unwrap().level, CheckLevel::Problem);
}
