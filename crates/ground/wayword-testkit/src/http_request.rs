//! Reads a request over HTTP whole. A server that answers and closes before it has read everything resets the connection, and
//! its client may lose the answer.

use std::io::BufRead;

/// The head and the body of the next request, or none where the connection ends first. The length of the body is that of the
/// head's `Content-Length`; without one there is no body.
pub fn read_http_request(reader: &mut impl BufRead) -> Option<(String, Vec<u8>)> {
    let (mut head, mut length) = (String::new(), 0);
    loop {
        let mut line = String::new();
        if reader.read_line(&mut line).ok()? == 0 {
            return None;
        }
        if let Some(value) = line.to_ascii_lowercase().strip_prefix("content-length:") {
            length = value.trim().parse().ok()?;
        }
        head.push_str(&line);
        if line == "\r\n" {
            break;
        }
    }
    let mut body = vec![0; length];
    reader.read_exact(&mut body).ok()?;
    Some((head, body))
}
