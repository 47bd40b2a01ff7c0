//! Errors of a store that does not answer, or refuses. A server of this test plays the store; the variables of the provider
//! name its address.

#![cfg(all(feature = "cloud", unix))]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::{
    io::{BufReader, Write},
    net::TcpListener,
    process::Command,
};
use wayword_queue::cloud::{CloudBucket, CloudError};
use wayword_testkit::read_http_request;

const SECRET: &str = "hunter2hunter2";

/// Runs one test of this file in another process, because environment variables apply to a whole process.
fn in_a_process(test: &str, endpoint: &str) {
    with_http(test, endpoint, "true");
}

fn with_http(test: &str, endpoint: &str, allow_http: &str) {
    let run = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", &format!("cloud_lost::{test}"), "--ignored", "--nocapture"])
        .env("AWS_ENDPOINT_URL", endpoint)
        .env("AWS_ALLOW_HTTP", allow_http)
        .env("AWS_ACCESS_KEY_ID", "AKIAHIDDEN")
        .env("AWS_SECRET_ACCESS_KEY", SECRET)
        .env("AWS_REGION", "us-east-1")
        .output()
        .unwrap();
    let text = format!("{}{}", String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success() && text.contains("1 passed"), "{text}");
    assert!(!text.contains(SECRET) && !text.contains("AKIAHIDDEN"), "{text}");
}

/// Answers every request in the same way.
fn server(status: &'static str, body: &'static str) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("http://{}", listener.local_addr().unwrap());
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            let mut stream = stream.unwrap();
            read_http_request(&mut BufReader::new(&stream));
            let length = body.len();
            let _ = write!(stream, "HTTP/1.1 {status}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n{body}");
        }
    });
    address
}

#[test]
fn a_refusal_is_an_error_of_its_kind_without_the_text_of_the_server() {
    let forbidden = "<Error><Code>AccessDenied</Code><Key>AKIAHIDDEN hunter2hunter2</Key></Error>";
    in_a_process("says_no_permission", &server("403 Forbidden", forbidden));
    let unknown = "<Error><Code>InvalidAccessKeyId</Code><Key>AKIAHIDDEN hunter2hunter2</Key></Error>";
    in_a_process("says_no_credentials", &server("403 Forbidden", unknown));
    in_a_process("says_no_bucket", &server("404 Not Found", "<Error><Code>NoSuchBucket</Code></Error>"));
}

#[test]
fn a_store_without_conditional_writes_is_an_error_with_a_hint() {
    let body = "<Error><Code>NotImplemented</Code><Header>If-None-Match</Header></Error>";
    in_a_process("says_no_put_new", &server("501 Not Implemented", body));
}

#[test]
fn an_endpoint_without_tls_is_refused_unless_it_is_allowed() {
    with_http("says_no_tls", &server("200 OK", ""), "false");
}

#[test]
fn a_store_that_is_not_there_may_work_later() {
    let closed = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    in_a_process("says_no_connection", &format!("http://{closed}"));
}

#[test]
fn put_new_reports_a_network_error_while_writers_collide() {
    let body = "<Error><Code>ConditionalRequestConflict</Code></Error>";
    in_a_process("says_try_again", &server("409 Conflict", body));
    let body = "<Error><Code>ContainerBeingDeleted</Code></Error>";
    in_a_process("says_no_bucket_to_a_new_object", &server("409 Conflict", body));
}

#[test]
fn a_hostile_name_in_an_answer_is_not_fetched() {
    for key in ["a/data/../../x", "a/data//x", "a/data/a\\..\\x", "a/data/&#27;[2J", "a/data/.wayword-fetched.json"] {
        let about = "<LastModified>2026-01-01T00:00:00.000Z</LastModified><ETag>1</ETag><Size>1</Size>";
        let body = format!("<ListBucketResult><Contents><Key>{key}</Key>{about}</Contents></ListBucketResult>");
        in_a_process("refuses_the_name", &server("200 OK", body.leak()));
    }
}

#[test]
fn a_variable_that_cannot_be_used_is_an_error_without_its_value() {
    with_http("says_wrong_variable", "http://localhost", SECRET);
}

#[test]
fn a_store_that_ignores_the_condition_is_found_out() {
    in_a_process("check_says_no_put_new", &server("200 OK\r\nETag: \"a\"", ""));
}

#[test]
#[ignore = "run by another test, with variables"]
fn says_no_permission() {
    let error = CloudBucket::open("s3://bucket/a").unwrap().put_object("b", "x").unwrap_err();
    assert!(matches!(error, CloudError::Permission { .. }), "{error:?}");
    assert!(error.to_string().contains("s3://bucket/a/b"), "{error}");
    println!("{error} {error:?}");
}

#[test]
#[ignore = "run by another test, with variables"]
fn says_no_credentials() {
    let error = CloudBucket::open("s3://bucket/a").unwrap().get_object("b", 1).unwrap_err();
    assert!(matches!(error, CloudError::Credentials { .. }), "{error:?}");
    println!("{error} {error:?}");
}

#[test]
#[ignore = "run by another test, with variables"]
fn says_no_bucket() {
    let bucket = CloudBucket::open("s3://bucket/a").unwrap();
    for error in [
        bucket.get_object("b", 1).unwrap_err(),
        bucket.put_object("b", "x").unwrap_err(),
        bucket.list_objects("").unwrap_err(),
    ] {
        assert!(matches!(error, CloudError::NoBucket { .. }), "{error:?}");
    }
}

#[test]
#[ignore = "run by another test, with variables"]
fn says_no_put_new() {
    let error = CloudBucket::open("s3://bucket/a").unwrap().put_new("b", "x").unwrap_err();
    assert!(matches!(error, CloudError::NoPutNew { .. }), "{error:?}");
}

#[test]
#[ignore = "run by another test, with variables"]
fn check_says_no_put_new() {
    let error = CloudBucket::open("s3://bucket/a").unwrap().check_put_new().unwrap_err();
    assert!(matches!(error, CloudError::NoPutNew { .. }), "{error:?}");
}

#[test]
#[ignore = "run by another test, with variables"]
fn says_no_tls() {
    let error = CloudBucket::open("s3://bucket/a").unwrap().put_object("b", "x").unwrap_err();
    assert!(error.to_string().contains("has no TLS") && !error.is_lost(), "{error:?}");
}

#[test]
#[ignore = "run by another test, with variables"]
fn says_no_connection() {
    let error = CloudBucket::open("s3://bucket/a").unwrap().put_object("b", "x").unwrap_err();
    assert!(matches!(error, CloudError::Network { .. }) && error.is_lost(), "{error:?}");
}

#[test]
#[ignore = "run by another test, with variables"]
fn says_try_again() {
    let error = CloudBucket::open("s3://bucket/a").unwrap().put_new("b", "x").unwrap_err();
    assert!(error.is_lost(), "{error:?}");
}

#[test]
#[ignore = "run by another test, with variables"]
fn says_no_bucket_to_a_new_object() {
    let error = CloudBucket::open("s3://bucket/a").unwrap().put_new("b", "x").unwrap_err();
    assert!(matches!(error, CloudError::NoBucket { .. }), "{error:?}");
}

#[test]
#[ignore = "run by another test, with variables"]
fn refuses_the_name() {
    let here = tempfile::tempdir().unwrap();
    let bucket = CloudBucket::open("s3://bucket/a").unwrap();
    let error = bucket.fetch_folder("data", here.path(), 1 << 30, &|_, _| {}).unwrap_err();
    assert!(matches!(error, CloudError::Name { .. }), "{error:?}");
    assert_eq!(std::fs::read_dir(here.path()).unwrap().count(), 0);
}

#[test]
#[ignore = "run by another test, with variables"]
fn says_wrong_variable() {
    let error = CloudBucket::open("s3://bucket/a").unwrap_err();
    assert!(error.to_string().contains("variable of the provider"), "{error:?}");
}
