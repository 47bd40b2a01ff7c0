//! Names what came in place of an answer: a page of HTML, a stream, compressed bytes, cut JSON, and so on.

use super::{FaultContext, RemoteFault, error_body::one_line};
use std::borrow::Cow;
use ureq::http::{HeaderMap, header};

/// Most characters of a body that a message quotes.
const MAX_QUOTED_CHARS: usize = 80;
/// How many bytes of a page are searched for its title.
const MAX_TITLE_SEARCH_BYTES: usize = 4096;

/// The text of a body: UTF-8 or UTF-16 with or without a byte order mark, or Latin-1 where the headers say so. `None` for anything
/// else, which is no text or would be read wrongly.
pub(crate) fn body_text<'a>(headers: &HeaderMap, body: &'a [u8]) -> Option<Cow<'a, str>> {
    let utf_16 = |bytes: &[u8], unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]])).collect();
        bytes.len().is_multiple_of(2).then(|| String::from_utf16(&units).ok()).flatten().map(Cow::Owned)
    };
    match body {
        [0xef, 0xbb, 0xbf, rest @ ..] => return std::str::from_utf8(rest).ok().map(Cow::Borrowed),
        [0xff, 0xfe, rest @ ..] => return utf_16(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => return utf_16(rest, u16::from_be_bytes),
        // The first character of JSON is ASCII.
        [0, second, ..] if *second != 0 => return utf_16(body, u16::from_be_bytes),
        [first, 0, ..] if *first != 0 => return utf_16(body, u16::from_le_bytes),
        _ => {}
    }
    match std::str::from_utf8(body) {
        Ok(text) => Some(Cow::Borrowed(text)),
        Err(_) if declares_latin_1(headers) => Some(Cow::Owned(body.iter().map(|byte| char::from(*byte)).collect())),
        Err(_) => None,
    }
}

/// Whether the headers declare a text of one byte a character.
fn declares_latin_1(headers: &HeaderMap) -> bool {
    let kind = headers.get(header::CONTENT_TYPE).and_then(|kind| kind.to_str().ok()).unwrap_or_default();
    let kind = kind.to_ascii_lowercase();
    ["iso-8859-1", "latin1", "windows-1252", "us-ascii"].iter().any(|charset| kind.contains(charset))
}

/// Whether a body is a page of HTML, or of another language with tags.
pub(crate) fn is_html(body: &[u8]) -> bool {
    let begin = body.strip_prefix(b"\xef\xbb\xbf").unwrap_or(body);
    begin.trim_ascii_start().starts_with(b"<")
}

/// The fault of a complete body under a status of success that is neither JSON nor a stream that can be joined.
pub(crate) fn fault_of_unreadable_body(headers: &HeaderMap, body: &[u8], context: FaultContext<'_>) -> RemoteFault {
    let (what, hint) = if is_html(body) {
        let hint = format!(
            "{}; a page for signing in means that a proxy stands before it, and a page about a challenge that a firewall does",
            context.address_hint()
        );
        (format!("a page of HTML{}", page_title(body, context)), Some(hint))
    } else if let Some(kind) = compression(headers, body) {
        let hint = "switch the compression of answers off in the service, or in the proxy before it";
        (format!("compressed ({kind}), which nobody asked for"), Some(hint.to_owned()))
    } else {
        name_of_text(headers, body, context)
    };
    RemoteFault::Unreadable { reason: format!("the answer is {what}"), hint, is_page: is_html(body) }
}

/// The fault of JSON under a status of success that has no answer where the API has it.
pub(crate) fn fault_of_other_json(missing: &str, body: &[u8], context: FaultContext<'_>) -> RemoteFault {
    RemoteFault::Unreadable {
        reason: format!("the answer has no {missing}{}", quoted_beginning(&String::from_utf8_lossy(body), context)),
        hint: Some(context.dialect_hint()),
        is_page: false,
    }
}

/// What a body is that is neither a page nor compressed, and what to do.
fn name_of_text(headers: &HeaderMap, body: &[u8], context: FaultContext<'_>) -> (String, Option<String>) {
    let Some(text) = body_text(headers, body) else {
        let lossy = String::from_utf8_lossy(body);
        let hint = "the service has to send JSON in UTF-8".to_owned();
        return (format!("in no charset that is read{}", quoted_beginning(&lossy, context)), Some(hint));
    };
    let begin = text.trim_start();
    let quoted = quoted_beginning(begin, context);
    if begin.is_empty() {
        return ("empty".to_owned(), None);
    }
    if ["data:", "event:", "id:", "retry:", ": "].iter().any(|mark| begin.starts_with(mark)) {
        let is_whole = ["[DONE]", "message_stop", "response.completed"].iter().any(|mark| text.contains(mark));
        let hint = format!(
            "switch streaming off in the service, or set extra = {{ stream = false }} under [providers.{}]",
            context.provider
        );
        return if is_whole {
            (format!("a stream in a form that is not read{quoted}"), Some(hint))
        } else {
            (format!("a stream that breaks off before its end{quoted}"), Some(hint))
        };
    }
    match serde_json::from_str::<serde_json::Value>(begin) {
        Ok(_) => (format!("JSON without an answer{quoted}"), Some(context.dialect_hint())),
        Err(_) if !begin.starts_with(['{', '[', '"']) => {
            (format!("a text that is not JSON{quoted}"), Some(context.address_hint()))
        }
        Err(error) if error.is_eof() => (format!("JSON that breaks off after {} bytes{quoted}", body.len()), None),
        Err(_) => (format!("JSON with an error in it{quoted}"), None),
    }
}

/// How a body is compressed, by its first bytes or, where it has no mark of its own, by its headers.
fn compression(headers: &HeaderMap, body: &[u8]) -> Option<&'static str> {
    match body {
        [0x1f, 0x8b, ..] => return Some("gzip"),
        [0x28, 0xb5, 0x2f, 0xfd, ..] => return Some("zstd"),
        [0x78, 0x01 | 0x5e | 0x9c | 0xda, ..] => return Some("deflate"),
        _ => {}
    }
    let encoding = headers.get(header::CONTENT_ENCODING)?.to_str().ok()?.to_ascii_lowercase();
    ["gzip", "deflate", "br", "zstd"].into_iter().find(|known| encoding.contains(known))
}

/// The title of a page, in a form that can stand behind its name; nothing if it has none.
fn page_title(body: &[u8], context: FaultContext<'_>) -> String {
    let page = String::from_utf8_lossy(&body[..body.len().min(MAX_TITLE_SEARCH_BYTES)]);
    // In ASCII, lower case has the same length.
    let lower = page.to_ascii_lowercase();
    let title = || {
        let from = lower.find("<title")?;
        let from = from + lower[from..].find('>')? + 1;
        Some(&page[from..from + lower[from..].find('<')?])
    };
    match title().map(str::trim).filter(|title| !title.is_empty()) {
        Some(title) => format!(" with the title {}", quoted(title, context)),
        None => String::new(),
    }
}

/// The first words of a body, in a form that can stand behind its name; nothing if it has none.
fn quoted_beginning(text: &str, context: FaultContext<'_>) -> String {
    match text.trim() {
        "" => String::new(),
        text => format!(", which begins {}", quoted(text, context)),
    }
}

/// A text in quotes: short, on one line, with all signs escaped that move a cursor or turn a line, and without the key.
fn quoted(text: &str, context: FaultContext<'_>) -> String {
    // Longer than what is quoted by more than a key is long, so that no part of a key is left at the cut.
    let long: String = text.chars().take(20 * MAX_QUOTED_CHARS).collect();
    let clean = context.secret.map_or(long.clone(), |secret| secret.scrub_key(long));
    let line = one_line(&format!(" {}", clean.replace('<', "‹")));
    let line = line.replace('‹', "<");
    let short: String = line.chars().take(MAX_QUOTED_CHARS).collect();
    let more = if short.len() < line.len() { "…" } else { "" };
    format!("{short:?}{more}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::secret::ServiceSecret;
    use ureq::http::HeaderValue;

    fn who(secret: Option<&ServiceSecret>) -> FaultContext<'_> {
        FaultContext { provider: "lab", key_env: None, secret, version_path: "/v1", has_answered: false }
    }

    fn told(content_type: &'static str, encoding: Option<&'static str>, body: &[u8]) -> (String, String) {
        let mut headers = HeaderMap::from_iter([(header::CONTENT_TYPE, HeaderValue::from_static(content_type))]);
        headers.extend(encoding.map(|name| (header::CONTENT_ENCODING, HeaderValue::from_static(name))));
        match fault_of_unreadable_body(&headers, body, who(None)) {
            RemoteFault::Unreadable { reason, hint, .. } => (reason, hint.unwrap_or_default()),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn what_came_is_named_with_its_first_words_and_what_to_do() {
        let plain = "application/json";
        for (body, what, to_do) in [
            (
                &b"<!DOCTYPE html><html><head><title>Sign in\n to Lab</title>"[..],
                "a page of HTML with the title \"Sign in to Lab\"",
                "/v1",
            ),
            (b"\n<html><body>", "a page of HTML", "proxy"),
            (b"\x1f\x8b\x08\x00abc", "compressed (gzip)", "compression"),
            (b"\x78\x9cabc", "compressed (deflate)", "compression"),
            (b"data: {\"choices\":[]}\n\n", "a stream that breaks off", "stream = false"),
            (b"event: x\ndata: {\"type\":\"message_stop\"}\n", "a stream in a form that is not read", "streaming off"),
            (b"{\"choices\":", "JSON that breaks off after 11 bytes, which begins \"{\\\"choices\\\":\"", ""),
            (b"{\"choices\": oops}", "JSON with an error in it", ""),
            (b"Hello there", "a text that is not JSON, which begins \"Hello there\"", "/v1"),
            (b" \n", "the answer is empty", ""),
            (b"{\"a\":\"caf\xe9\"}", "in no charset that is read", "UTF-8"),
        ] {
            let (reason, hint) = told(plain, None, body);
            assert!(reason.contains(what) && hint.contains(to_do), "{reason} / {hint}");
        }
        assert!(told(plain, Some("br"), b"\x0b\x02\x80abc").0.contains("compressed (br)"));
    }

    #[test]
    fn a_quote_is_short_escaped_and_without_any_part_of_a_key() {
        let (reason, _) = told("text/plain", None, "a\u{1b}[31m\u{202e}b\0 <script>".as_bytes());
        assert!(reason.ends_with("begins \"a [31m\\u{202e}b <script>\""), "{reason}");
        let secret = ServiceSecret::new("sk-0123456789abcdef").unwrap();
        for before in 0..120 {
            let body = format!("{} sk-0123456789abcdef {}", "x".repeat(before), "y".repeat(5000));
            let fault = fault_of_unreadable_body(&HeaderMap::new(), body.as_bytes(), who(Some(&secret)));
            assert!(!fault.reason().contains("0123") && fault.reason().chars().count() < 200, "{}", fault.reason());
        }
    }

    #[test]
    fn texts_in_other_charsets_are_read_where_they_are_known() {
        let json = "{\"text\":\"café\"}";
        let utf_16: Vec<u8> = json.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let with_mark = |mark: &[u8], rest: &[u8]| [mark, rest].concat();
        let big_endian: Vec<u8> = json.encode_utf16().flat_map(u16::to_be_bytes).collect();
        for body in [
            json.as_bytes().to_vec(),
            with_mark(b"\xef\xbb\xbf", json.as_bytes()),
            with_mark(b"\xff\xfe", &utf_16),
            with_mark(b"\xfe\xff", &big_endian),
            utf_16,
            big_endian,
        ] {
            assert_eq!(body_text(&HeaderMap::new(), &body).as_deref(), Some(json), "{body:?}");
        }
        let latin = b"{\"text\":\"caf\xe9\"}";
        assert_eq!(body_text(&HeaderMap::new(), latin), None);
        let said = HeaderValue::from_static("application/json; charset=ISO-8859-1");
        assert_eq!(body_text(&HeaderMap::from_iter([(header::CONTENT_TYPE, said)]), latin).as_deref(), Some(json));
    }
}
