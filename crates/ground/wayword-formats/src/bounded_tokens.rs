//! A reader between a JSON file and its parser. It stops the parser at a text or number that is too long. Without it,
//! `serde_json` would take up to three times the memory of a long text before returning it.

use crate::limits;
use std::io::{self, Read};

/// Passes JSON on, and fails where a text or number in it is longer than [`limits::MAX_TOKEN_BYTES`].
pub(crate) struct BoundedTokenReader<R> {
    inner: R,
    /// Bytes of the text or number that is being read.
    length: usize,
    /// Whether the next byte is within quotes.
    in_text: bool,
    /// Whether the byte before was a backslash, so that a quote does not end the text.
    is_escaped: bool,
    /// Whether a text or number was too long: the next read fails.
    is_over: bool,
}

impl<R> BoundedTokenReader<R> {
    pub(crate) fn new(inner: R) -> Self {
        Self { inner, length: 0, in_text: false, is_escaped: false, is_over: false }
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
        if self.is_over {
            return Err(io::Error::other("a text or number in it is longer than 1 MiB"));
        }
        let count = self.inner.read(buffer)?;
        for (at, byte) in buffer.iter().take(count).enumerate() {
            if !self.accept_byte(*byte) {
                self.is_over = true;
                // The bytes before are passed on, so that the error can name the item.
                return if at == 0 { self.read(buffer) } else { Ok(at) };
            }
        }
        Ok(count)
    }
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
}
