//! Answers that nobody asked for: none is taken for the answer to another call.

use crate::{
    asked, model, run,
    server::{Server, answer},
};
use std::{io::Write, net::TcpStream, thread, time::Duration};

/// A complete response.
fn response(text: &str) -> String {
    let body = answer(text);
    format!("HTTP/1.1 200 OK\r\ncontent-type: application/json\r\ncontent-length: {}\r\n\r\n{body}", body.len())
}

/// The answers to five calls, of a server that answers each call with its question and does something odd beside it.
fn answers(odd: impl Fn(usize, &str, &mut TcpStream) + Send + Sync + 'static) -> Vec<String> {
    let server = Server::start(move |count, request, stream| {
        let body: serde_json::Value = serde_json::from_str(request.split_once("\r\n\r\n").unwrap().1).unwrap();
        odd(count, body["messages"][0]["content"].as_str().unwrap(), stream);
        true
    });
    let model = model(&server, "concurrency = 1", &run());
    let answers = (0..5).map(|at| {
        let text = asked(&model, &format!("Question {at}?")).unwrap().text;
        // The stray answer has arrived by the time of the next call.
        thread::sleep(Duration::from_millis(60));
        text
    });
    answers.collect()
}

fn questions() -> Vec<String> {
    (0..5).map(|at| format!("Question {at}?")).collect()
}

#[test]
fn two_answers_in_one_piece() {
    let told = answers(|_, question, stream| {
        stream.write_all((response(question) + &response("a stray")).as_bytes()).unwrap();
    });
    assert_eq!(told, questions());
}

#[test]
fn a_second_answer_in_a_piece_of_its_own() {
    let told = answers(|_, question, stream| {
        stream.write_all(response(question).as_bytes()).unwrap();
        thread::sleep(Duration::from_millis(20));
        let _ = stream.write_all(response("a stray").as_bytes());
    });
    assert_eq!(told, questions());
}

#[test]
fn bytes_behind_the_end_of_a_body() {
    for odd in ["\r\n", "x", "HTTP/1.1 200 OK\r\ncontent-length: 900\r\n\r\n{"] {
        let told = answers(move |_, question, stream| {
            let _ = stream.write_all((response(question) + odd).as_bytes());
        });
        assert_eq!(told, questions(), "{odd:?}");
    }
}

#[test]
fn a_body_without_a_length_and_one_in_chunks() {
    let told = answers(|_, question, stream| {
        let body = answer(question);
        let chunks = format!("{:x}\r\n{body}\r\n0\r\n\r\n", body.len());
        let head = "HTTP/1.1 200 OK\r\ntransfer-encoding: chunked\r\n\r\n";
        stream.write_all(format!("{head}{chunks}{}", response("a stray")).as_bytes()).unwrap();
    });
    assert_eq!(told, questions());
}

/// Servers close idle connections with an answer of this kind.
#[test]
fn an_answer_to_nothing_at_the_end_of_an_idle_connection() {
    let told = answers(|_, question, stream| {
        stream.write_all(response(question).as_bytes()).unwrap();
        thread::sleep(Duration::from_millis(20));
        let _ = stream.write_all(b"HTTP/1.1 408 Request Timeout\r\ncontent-length: 0\r\nconnection: close\r\n\r\n");
        let _ = stream.shutdown(std::net::Shutdown::Both);
    });
    assert_eq!(told, questions());
}

/// An interim answer is none, and the one behind it belongs to the call.
#[test]
fn an_interim_answer() {
    for interim in ["HTTP/1.1 100 Continue\r\n\r\n", "HTTP/1.1 103 Early Hints\r\nlink: x\r\n\r\n"] {
        let told = answers(move |_, question, stream| {
            stream.write_all((interim.to_owned() + &response(question)).as_bytes()).unwrap();
        });
        assert_eq!(told, questions(), "{interim:?}");
    }
}
