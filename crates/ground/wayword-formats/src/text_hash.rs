//! The hash of a text in its record, by which a reader sees that somebody has changed the text since.

use serde_json::{Map as JsonMap, Value};
use sha2::{Digest, Sha256};
use wayword_core::hex_text;

/// The field of a record that has the hash of its text.
pub(crate) const HASH_FIELD: &str = "text_hash";
/// Digits of the hash: 64 bits. It tells of changes, and is no protection against forgery.
const HASH_DIGITS: usize = 16;

/// The hash of a text: the first 16 digits of its SHA-256.
#[must_use]
pub fn hash_of_text(text: &str) -> String {
    let mut digits = hex_text(Sha256::digest(text));
    digits.truncate(HASH_DIGITS);
    digits
}

/// Adds the hash of a text to the additional fields of its record.
pub fn add_text_hash(extra: &mut JsonMap<String, Value>, text: &str) {
    extra.insert(HASH_FIELD.to_owned(), hash_of_text(text).into());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hash_has_the_first_digits_of_sha_256() {
        assert_eq!(hash_of_text("abc"), "ba7816bf8f01cfea");
        let mut extra = JsonMap::new();
        add_text_hash(&mut extra, "abc");
        assert_eq!(extra["text_hash"], "ba7816bf8f01cfea");
    }
}
