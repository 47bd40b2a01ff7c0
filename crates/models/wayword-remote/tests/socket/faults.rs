//! Faults of every kind.

use crate::{
    asked, model, run,
    server::{Server, answer, ended, reply},
    services,
};
use std::{
    io::Write,
    net::TcpStream,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
    time::{Duration, Instant},
};
use wayword_core::ModelError;

/// Does something odd to the first request, and answers all later ones.
fn at_first(odd: impl Fn(&mut TcpStream) -> bool + Send + Sync + 'static) -> Server {
    Server::start(
        move |count, _, stream| if count == 0 { odd(stream) } else { reply(stream, 200, "", &answer("fine")) },
    )
}

/// Checks that another attempt follows a fault, and is answered.
fn is_asked_again(server: &Server) {
    let reply = asked(&model(server, "", &run()), "Well?").unwrap();
    assert_eq!(reply.text, "fine");
    assert_eq!(server.requests().len(), 2);
}

#[test]
fn a_reset_in_mid_body_is_asked_again() {
    is_asked_again(&at_first(|stream| {
        stream.write_all(b"HTTP/1.1 200 OK\r\ncontent-length: 1000\r\n\r\n{\"choices\":").unwrap();
        false
    }));
}

#[test]
fn a_connection_that_is_cut_before_an_answer_is_asked_again() {
    is_asked_again(&at_first(|_| false));
}

#[test]
fn json_that_is_cut_is_asked_again() {
    is_asked_again(&at_first(|stream| reply(stream, 200, "", &answer("a sofa")[..40])));
}

#[test]
fn no_http_at_all_is_asked_again() {
    is_asked_again(&at_first(|stream| {
        stream.write_all(b"220 smtp ready\r\n\r\n").unwrap();
        false
    }));
}

#[test]
fn errors_under_a_status_of_success_are_asked_again() {
    is_asked_again(&at_first(|stream| reply(stream, 200, "", r#"{"error":{"message":"upstream died"}}"#)));
    is_asked_again(&at_first(|stream| reply(stream, 200, "", r#"{"choices":[]}"#)));
    is_asked_again(&at_first(|stream| reply(stream, 200, "", "null")));
    let half =
        r#"{"choices":[{"message":{"content":"A so"},"finish_reason":"error","error":{"code":502,"message":"died"}}]}"#;
    is_asked_again(&at_first(move |stream| reply(stream, 200, "", half)));
}

#[test]
fn an_overloaded_service_is_given_the_time_it_asks_for() {
    for headers in ["retry-after: 1\r\n", "retry-after-ms: 1000\r\n", "x-ratelimit-reset-requests: 1s\r\n"] {
        let start = Instant::now();
        is_asked_again(&at_first(move |stream| reply(stream, 429, headers, "{}")));
        assert!(start.elapsed() >= Duration::from_secs(1), "{headers}");
    }
}

#[test]
fn a_wait_of_a_day_stops_the_run() {
    let server = at_first(|stream| reply(stream, 429, "retry-after: 86400\r\n", "{}"));
    let error = asked(&model(&server, "", &run()), "Well?").unwrap_err();
    assert!(matches!(&error, ModelError::Stopped { hint, .. } if hint.contains("later")), "{error}");
}

#[test]
fn a_trickle_ends_in_time() {
    let server = Server::start(|_, _, stream| {
        let mut open = stream.write_all(b"HTTP/1.1 200 OK\r\ncontent-length: 100000\r\n\r\n").is_ok();
        while open {
            open = stream.write_all(b" ").is_ok();
            thread::sleep(Duration::from_millis(20));
        }
        false
    });
    let start = Instant::now();
    let error = asked(&model(&server, "timeout_s = 0.5\nattempts = 1", &run()), "Well?").unwrap_err().to_string();
    assert_eq!(error, "server/m: no complete answer in time; give it more time with --timeout-s (1 attempt)");
    assert!(start.elapsed() < Duration::from_secs(10));
}

#[test]
fn a_body_without_end_is_cut_off() {
    let written = Arc::new(AtomicUsize::new(0));
    let count = Arc::clone(&written);
    let server = Server::start(move |_, _, stream| {
        let mut open = stream.write_all(b"HTTP/1.1 200 OK\r\n\r\n").is_ok();
        while open && count.load(Ordering::SeqCst) < 200 << 20 {
            open = stream.write_all(&[b' '; 1 << 16]).is_ok();
            count.fetch_add(1 << 16, Ordering::SeqCst);
        }
        false
    });
    let error = asked(&model(&server, "", &run()), "Well?").unwrap_err().to_string();
    assert_eq!(error, "server/m: the answer is longer than 8 MiB");
    assert_eq!(server.requests().len(), 1);
    // The rest of the body stayed in the sockets' buffers.
    assert!(written.load(Ordering::SeqCst) < 100 << 20);
}

#[test]
fn a_redirect_is_not_followed() {
    let elsewhere = Server::start(|_, _, stream| reply(stream, 200, "", &answer("fine")));
    let to = format!("location: {}/chat/completions\r\n", elsewhere.base_url());
    for status in [301, 302, 307, 308] {
        let to = to.clone();
        let server = at_first(move |stream| reply(stream, status, &to, ""));
        let error = asked(&model(&server, "", &run()), "Well?").unwrap_err();
        assert!(matches!(&error, ModelError::Stopped { hint, .. } if hint.contains("redirects")), "{status} {error}");
    }
    assert!(elsewhere.requests().is_empty());
}

#[test]
fn attempts_are_counted_and_then_given_up() {
    let server = Server::start(|_, _, stream| reply(stream, 500, "", r#"{"error":"boom"}"#));
    let error = asked(&model(&server, "attempts = 3", &run()), "Well?").unwrap_err().to_string();
    assert_eq!(error, "server/m: status 500: boom (3 attempts)");
    assert_eq!(server.requests().len(), 3);
}

#[test]
fn a_request_that_is_wrong_is_not_repeated() {
    let server = Server::start(|_, _, stream| reply(stream, 400, "", r#"{"error":{"message":"too long"}}"#));
    let error = asked(&model(&server, "", &run()), "Well?").unwrap_err().to_string();
    assert_eq!(error, "server/m: status 400: too long");
    assert_eq!(server.requests().len(), 1);
}

#[test]
fn silence_is_asked_again_once() {
    let server = Server::start(|_, _, stream| reply(stream, 200, "", &answer(" \n")));
    let error = asked(&model(&server, "", &run()), "Well?").unwrap_err().to_string();
    assert_eq!(error, "server/m: empty answer (2 attempts)");
}

#[test]
fn error_explains_that_thinking_used_up_the_tokens() {
    let server = Server::start(|_, _, stream| reply(stream, 200, "", &ended("<think>a sofa, or is it", "length")));
    let error = asked(&model(&server, "", &run()), "Well?").unwrap_err().to_string();
    assert!(error.contains("spent all its tokens on thinking") && error.contains("reasoning_effort"), "{error}");
    assert_eq!(server.requests().len(), 1);
}

#[test]
fn a_refused_key_ends_everything_at_once() {
    let server = Server::start(|_, _, stream| reply(stream, 401, "", r#"{"error":{"message":"bad key"}}"#));
    let model = model(&server, "concurrency = 1", &run());
    for text in ["One?", "Two?", "Three?"] {
        let error = asked(&model, text).unwrap_err();
        assert!(error.ends_run(), "{error}");
        assert!(error.to_string().contains("bad key"), "{error}");
    }
    assert_eq!(server.requests().len(), 1);
}

#[test]
fn a_stopped_run_ends_its_waits_at_once() {
    let server = Server::start(|_, _, stream| reply(stream, 429, "retry-after: 300\r\n", "{}"));
    let run = run();
    let model = model(&server, "", &run);
    let start = Instant::now();
    thread::scope(|scope| {
        let waiting: Vec<_> = ["One?", "Two?"].map(|text| scope.spawn(|| asked(&model, text))).into();
        while server.requests().is_empty() {
            thread::sleep(Duration::from_millis(5));
        }
        run.stop();
        for thread in waiting {
            assert!(thread.join().unwrap().unwrap_err().ends_run());
        }
    });
    assert!(start.elapsed() < Duration::from_secs(30));
}

#[test]
fn error_names_an_address_where_no_service_answers() {
    let server = Server::start(|_, _, _| false);
    let settings = "attempts = 1\n[providers.mine]\ndialect = \"openai\"\nbase_url = \"http://127.0.0.1:1/v1\"";
    let config = toml::from_str(settings).unwrap();
    let services = wayword_remote::ModelServices::new(config, run()).unwrap();
    let error = asked(&services.model("mine/m").unwrap(), "Well?").unwrap_err().to_string();
    assert_eq!(error, "mine/m: nothing answers at http://127.0.0.1:1/v1 (1 attempt)");
    assert!(server.requests().is_empty());
}

/// A refusal is told to the one who asked, in words that every role knows, after one request.
#[test]
fn a_refusal_in_its_own_field_is_an_answer() {
    let body = r#"{"choices":[{"message":{"content":null,"refusal":"I will not do that."},"finish_reason":"stop"}]}"#;
    let server = Server::start(move |_, _, stream| reply(stream, 200, "", body));
    let told = asked(&model(&server, "", &run()), "Well?").unwrap().text;
    assert!(told.starts_with("I'm sorry, I can't help with that") && told.ends_with("I will not do that."), "{told}");
    assert_eq!(server.requests().len(), 1);
}

#[test]
fn a_stream_that_nobody_asked_for_is_joined_and_a_page_of_html_stops() {
    let stream_body = "data: {\"choices\":[{\"delta\":{\"content\":\"fi\"}}]}\n\ndata: {\"choices\":[{\"delta\":{\"content\":\"ne\"},\"finish_reason\":\"stop\"}]}\n\ndata: [DONE]\n\n";
    let server = Server::start(move |_, _, stream| reply(stream, 200, "", stream_body));
    assert_eq!(asked(&model(&server, "", &run()), "Well?").unwrap().text, "fine");
    let page =
        Server::start(|_, _, stream| reply(stream, 200, "", "<!DOCTYPE html><html><title>Sign in</title></html>"));
    let told = asked(&model(&page, "", &run()), "Well?").unwrap_err();
    assert!(matches!(&told, ModelError::Stopped { hint, .. } if hint.contains("base_url")), "{told:?}");
    assert_eq!((server.requests().len(), page.requests().len()), (1, 2));
    // In mid-run a page is a passing trouble of a proxy: it is asked for again, once.
    let trouble = Server::start(|count, _, stream| match count {
        1 | 3 | 4 => reply(stream, 200, "", "<html>502</html>"),
        _ => reply(stream, 200, "", &answer("fine")),
    });
    let model = model(&trouble, "", &run());
    assert_eq!(["Well?", "And now?"].map(|text| asked(&model, text).unwrap().text), ["fine", "fine"]);
    let told = asked(&model, "And then?").unwrap_err();
    assert!(!told.ends_run() && told.to_string().contains("a page of HTML (2 attempts)"), "{told}");
    assert_eq!(trouble.requests().len(), 5);
}

/// A service that counts far fewer tokens than were sent cuts the prompt.
#[test]
fn a_prompt_that_is_cut_is_noted_with_the_setting() {
    let body = r#"{"choices":[{"message":{"content":"fine"},"finish_reason":"stop"}],"usage":{"prompt_tokens":400}}"#;
    let server = Server::start(move |_, _, stream| reply(stream, 200, "", body));
    let services = services(&server, "", &run());
    let long = "past the sofa ".repeat(400);
    let model = services.model("server/m").unwrap();
    asked(&model, "Well?").unwrap();
    assert_eq!(services.notes(), Vec::<String>::new());
    asked(&model, &long).unwrap();
    assert!(services.notes()[0].contains("read 400 tokens of a prompt of about 14"), "{:?}", services.notes());
}
