//! A minimal HTTP/1.1 server: one request with a JSON body on one connection.

use serde_json::Value;
use std::{
    io::{self, BufRead, BufReader, Read, Write},
    net::TcpStream,
    time::Duration,
};

/// Longest head of a request, bytes; a longer one counts as broken off.
const MAX_HEAD_BYTES: u64 = 16 << 10;
/// Longest body of a request, bytes; the rest is not read.
const MAX_BODY_BYTES: u64 = 16 << 20;

/// Reads a request, sends the answer, and closes the connection.
pub(super) fn serve_request(stream: TcpStream, answer: impl FnOnce(&Value) -> Value) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_read_timeout(Some(Duration::from_secs(10)))?;
    stream.set_write_timeout(Some(Duration::from_secs(10)))?;
    let mut reader = BufReader::new(stream);
    let mut head = (&mut reader).take(MAX_HEAD_BYTES);
    let mut length = 0;
    loop {
        let mut line = String::new();
        if head.read_line(&mut line)? == 0 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        let Some((name, value)) = line.split_once(':') else { if line.trim().is_empty() { break } else { continue } };
        if name.eq_ignore_ascii_case("content-length") {
            length = value.trim().parse().unwrap_or(0);
        }
    }
    let mut body = Vec::new();
    reader.by_ref().take(length.min(MAX_BODY_BYTES)).read_to_end(&mut body)?;
    let (status, content) = match serde_json::from_slice(&body) {
        Ok(request) => ("200 OK", answer(&request).to_string()),
        Err(_) => ("400 Bad Request", r#"{"message":"no JSON"}"#.to_owned()),
    };
    let length = content.len();
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: application/json\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n"
    );
    let stream = reader.get_mut();
    stream.write_all(head.as_bytes())?;
    stream.write_all(content.as_bytes())
}
