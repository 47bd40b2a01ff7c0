//! Bytes as text: hashes in names, provenance and messages.

use std::fmt::Write;

/// Bytes as hexadecimal digits, two for each.
#[must_use]
pub fn hex_text(bytes: impl AsRef<[u8]>) -> String {
    let bytes = bytes.as_ref();
    let mut text = String::with_capacity(bytes.len() * 2);
    for byte in bytes {
        // Writing to a text cannot fail.
        let _ = write!(text, "{byte:02x}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hex_text_gives_two_digits_for_each_byte() {
        assert_eq!(hex_text([0, 10, 255]), "000aff");
        assert_eq!(hex_text([]), "");
    }
}
