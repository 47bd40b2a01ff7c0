//! Complete answers that cannot be read: each call is bought at most twice, and the message names what came.

use crate::{
    asked, model, run,
    server::{Server, answer, reply},
};
use std::{io::Write, net::TcpStream, thread, time::Duration};
use wayword_core::{ChatMessage, Image, LanguageModel, ModelError};

/// Writes a complete response with any bytes as its body.
fn reply_bytes(stream: &mut TcpStream, headers: &str, body: &[u8]) -> bool {
    let head = format!("HTTP/1.1 200 OK\r\n{headers}content-length: {}\r\n\r\n", body.len());
    stream.write_all(&[head.as_bytes(), body].concat()).is_ok()
}

#[test]
fn what_cannot_be_read_is_bought_twice_and_named() {
    let gzip = [0x1f_u8, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3, 1, 2, 3];
    let cases: [(&str, &[u8], &str); 9] = [
        ("", b"Hello there", "a text that is not JSON, which begins \"Hello there\" (2 attempts); give --base-url"),
        ("", b"{\"choices\":[{\"message\"", "JSON that breaks off after 22 bytes"),
        ("", b"{\"choices\": oops}", "JSON with an error in it"),
        ("", b"{\"choices\":[]}", "the answer has no choices, which begins \"{\\\"choices\\\":[]}\""),
        ("", b"{\"message\":{\"content\":\"hi\"},\"done\":true}", "set dialect"),
        ("content-encoding: gzip\r\n", &gzip, "compressed (gzip)"),
        ("", b"data: {\"choices\":[{\"delta\":{\"content\":\"A\"}}]}\n\n", "a stream that breaks off"),
        ("", b"", "the answer is empty"),
        ("", b"{\"error\":\"upstream died\"}", "upstream died"),
    ];
    for (headers, body, words) in cases {
        let (headers, body) = (headers.to_owned(), body.to_vec());
        let server = Server::start(move |_, _, stream| reply_bytes(stream, &headers, &body));
        let told = asked(&model(&server, "", &run()), "Well?").unwrap_err();
        assert!(matches!(told, ModelError::Failed { .. }) && told.to_string().contains(words), "{told}");
        assert_eq!(server.requests().len(), 2, "{told}");
        assert!(server.requests()[0].contains("accept-encoding: identity"), "{:?}", server.requests());
    }
}

#[test]
fn what_never_can_be_read_stops_the_run() {
    let server = Server::start(|_, _, stream| reply(stream, 200, "", "{\"choices\":[]}"));
    let model = model(&server, "", &run());
    assert!(!asked(&model, "One?").unwrap_err().ends_run());
    let told = asked(&model, "Two?").unwrap_err();
    assert!(told.ends_run() && told.to_string().contains("gave no answer that can be read"), "{told}");
    assert!(asked(&model, "Three?").unwrap_err().ends_run());
    assert_eq!(server.requests().len(), 4);
}

#[test]
fn answers_in_other_charsets_and_streams_are_read() {
    let json = answer("A café.");
    let latin: Vec<u8> = json.chars().map(|c| c as u8).collect();
    let utf_16: Vec<u8> = json.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let marked = [b"\xef\xbb\xbf", json.as_bytes()].concat();
    let stream = "data: {\"choices\":[{\"delta\":{\"content\":\"A café.\"}}]}\r\n\r\ndata: [DONE]\r\n\r\n";
    for (headers, body) in [
        ("content-type: application/json; charset=latin1\r\n", latin),
        ("content-type: application/json; charset=utf-16\r\n", utf_16),
        ("", marked),
        ("content-type: text/event-stream\r\n", stream.as_bytes().to_vec()),
    ] {
        let server = Server::start(move |_, _, stream| reply_bytes(stream, headers, &body));
        assert_eq!(asked(&model(&server, "", &run()), "Well?").unwrap().text, "A café.", "{headers}");
        assert_eq!(server.requests().len(), 1);
    }
}

/// Asks many questions with a picture at the same time, and returns the errors.
fn errors_of_pictures(server: &Server) -> Vec<ModelError> {
    let image = std::sync::Arc::new(Image::new(8, 8, vec![0; 8 * 8 * 3]).unwrap());
    let request = |at: usize| {
        let mut request = crate::ask("Well?");
        request.messages =
            vec![ChatMessage::about_images(format!("Question {at}?"), vec![std::sync::Arc::clone(&image)])];
        request
    };
    let requests: Vec<_> = (0..12).map(request).collect();
    model(server, "", &run()).complete_requests(&requests).into_iter().filter_map(Result::err).collect()
}

/// Twelve calls are made together, and each would fail alike.
#[test]
fn a_fault_that_every_call_meets_is_met_once() {
    let blind = r#"{"error":{"message":"image input is not supported"}}"#;
    for (status, body, hint) in [
        (400, blind, "choose a vision model with --see"),
        (500, blind, "choose a vision model with --see"),
        (404, "<html>404</html>", "/v1"),
        (404, r#"{"detail":"Not Found"}"#, "/v1"),
        (401, "{}", "needs a key"),
        (403, "<html>Forbidden</html>", "firewall"),
        (404, r#"{"error":{"message":"The model `m` does not exist"}}"#, "name of the model"),
    ] {
        let server = Server::start(move |_, _, stream| {
            thread::sleep(Duration::from_millis(20));
            reply(stream, status, "", body)
        });
        let errors = errors_of_pictures(&server);
        assert_eq!(errors.len(), 12);
        assert!(
            errors.iter().all(|error| error.ends_run() && error.to_string().contains(hint)),
            "{status}: {:?}",
            errors[0]
        );
        assert_eq!(server.requests().len(), 1, "{status} {body}");
    }
}

#[test]
fn a_context_that_is_too_short_for_every_call_stops_after_four() {
    let body = r#"{"error":{"message":"request (9412 tokens) exceeds the available context size"}}"#;
    let server = Server::start(move |_, _, stream| reply(stream, 400, "", body));
    let errors = errors_of_pictures(&server);
    assert_eq!(server.requests().len(), 4);
    assert_eq!(errors.iter().filter(|error| !error.ends_run()).count(), 3);
    assert!(errors.iter().all(|error| error.to_string().contains("context_tokens")), "{errors:?}");
}
