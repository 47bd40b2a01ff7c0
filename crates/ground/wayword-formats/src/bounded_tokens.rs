//! A reader between a JSON file and its parser. It stops the parser at a text or number that is too long. Without it,
//! `serde_json` would take up to three times the memory of a long text before returning it. It also stops at NaN and
//! Infinity, which Python's json writes and JSON does not have, so that an error can name them.

use crate::limits;
use std::io::{self, Read};

/// Why reading stops at a long text or number.
pub(crate) const TOO_LONG: &str = "a text or number in it is longer than 1 MiB";
/// Why reading stops at NaN or Infinity.
pub(crate) const NOT_A_NUMBER: &str = "it holds NaN or Infinity, which Python's json writes, but JSON does not have";

/// Passes JSON on, and fails where a text or number in it is longer than [`limits::MAX_TOKEN_BYTES`], or is NaN or
/// Infinity.
pub(crate) struct BoundedTokenReader<R> {
    inner: R,
    /// Bytes of the text or number that is being read.
    length: usize,
    /// Whether the next byte is within quotes.
    in_text: bool,
    /// Whether the byte before was a backslash, so that a quote does not end the text.
    is_escaped: bool,
    /// Why the next read fails.
    fault: Option<&'static str>,
}

impl<R> BoundedTokenReader<R> {
    pub(crate) fn new(inner: R) -> Self {
        Self { inner, length: 0, in_text: false, is_escaped: false, fault: None }
    }

    /// Takes in a byte. Returns whether the text or number that it belongs to is still short enough.
    fn accept_byte(&mut self, byte: u8) -> bool {
        self.length += 1;
        match byte {
            _ if self.is_escaped => self.is_escaped = false,
            b'\\' if self.in_text => self.is_escaped = true,
            b'"' => (self.in_text, self.length) = (!self.in_text, 0),
            b' ' | b'\n' | b'\r' | b'\t' | b',' | b':' | b'[' | b']' | b'{' | b'}' if !self.in_text => self.length = 0,
            _ => {}
        }
        self.length <= limits::MAX_TOKEN_BYTES
    }
}

impl<R: Read> Read for BoundedTokenReader<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if let Some(fault) = self.fault {
            return Err(io::Error::other(fault));
        }
        let count = self.inner.read(buffer)?;
        let read = buffer.get(..count).unwrap_or_default();
        for (at, byte) in read.iter().enumerate() {
            let is_number = self.in_text || !begins_not_a_number(read.get(at..).unwrap_or_default());
            if !is_number || !self.accept_byte(*byte) {
                self.fault = Some(if is_number { TOO_LONG } else { NOT_A_NUMBER });
                // The bytes before are passed on, so that the error can name the item.
                return if at == 0 { self.read(buffer) } else { Ok(at) };
            }
        }
        Ok(count)
    }
}

/// Whether these bytes, outside of a text, begin with NaN or Infinity, as far as they reach.
fn begins_not_a_number(bytes: &[u8]) -> bool {
    let begins = |word: &[u8]| bytes.iter().zip(word).all(|(byte, letter)| byte == letter);
    matches!(bytes.first(), Some(b'N' | b'I')) && (begins(b"NaN") || begins(b"Infinity"))
}

/// Whether JSON holds NaN or Infinity outside of its texts.
pub(crate) fn has_not_a_number(json: &[u8]) -> bool {
    let mut rest = Vec::new();
    let read = BoundedTokenReader::new(json).read_to_end(&mut rest);
    read.is_err_and(|error| error.to_string() == NOT_A_NUMBER)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many bytes come through.
    fn read(text: &str) -> Result<usize, String> {
        let mut read = Vec::new();
        let all = io::BufReader::with_capacity(1000, BoundedTokenReader::new(text.as_bytes())).read_to_end(&mut read);
        all.map_err(|error| format!("{error} after {}", read.len()))
    }

    #[test]
    fn the_longest_text_or_number_comes_through_and_no_longer_one() {
        let text = |bytes: usize| format!("[1, \"a\\\"\", \"{}\", 2.5]", "x".repeat(bytes));
        let most = limits::MAX_TOKEN_BYTES;
        assert_eq!(read(&text(most)), Ok(text(most).len()));
        assert!(read(&text(most + 1)).unwrap_err().contains("longer than 1 MiB after 10485"));
        assert!(read(&"1".repeat(most + 1)).unwrap_err().contains("longer than 1 MiB"));
    }

    #[test]
    fn many_short_texts_are_no_long_one() {
        let many = format!("[{}]", vec!["\"\\\\\", {\"a\": -1.5e3}"; 100_000].join(","));
        assert_eq!(read(&many), Ok(many.len()));
    }

    #[test]
    fn nan_and_infinity_are_found_outside_of_texts_alone() {
        for (json, is_found) in [
            ("[1, NaN]", true),
            ("{\"heading\": -Infinity}", true),
            ("Infinity", true),
            ("[\"NaN\", \"a \\\" Infinity\"]", false),
            ("[null, true, 1.5e3]", false),
            ("[No, In]", false),
        ] {
            assert_eq!(has_not_a_number(json.as_bytes()), is_found, "{json}");
        }
    }
}
