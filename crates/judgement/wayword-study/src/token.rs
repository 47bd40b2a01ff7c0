//! Random names that cannot be guessed, for links, sessions and slots, and the hashes under which the database stores them.

use base64::{Engine as _, engine::general_purpose::URL_SAFE_NO_PAD};
use sha2::{Digest, Sha256};

/// Bytes of a token: 128 bits.
const TOKEN_BYTES: usize = 16;

/// Makes a token for a link or cookie. It is random and does not come from the study's seed, because a seed could be guessed.
///
/// # Errors
/// When the system has no randomness.
pub(crate) fn random_token() -> Result<String, getrandom::Error> {
    let mut bytes = [0; TOKEN_BYTES];
    getrandom::fill(&mut bytes)?;
    Ok(URL_SAFE_NO_PAD.encode(bytes))
}

/// Whether a text has the form of a token.
pub(crate) fn is_token(text: &str) -> bool {
    // Base64 without padding writes the 16 bytes as 22 characters.
    text.len() == 22 && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_'))
}

/// The hash that the database stores in place of a token, so that a reader of the database cannot use it to log in. Each part is
/// preceded by its length, so that `["ab", "c"]` and `["a", "bc"]` differ.
pub(crate) fn hash_parts(parts: &[&str]) -> [u8; 32] {
    let mut hash = Sha256::new();
    for part in parts {
        hash.update((part.len() as u64).to_le_bytes());
        hash.update(part.as_bytes());
    }
    hash.finalize().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_differ_and_are_known_by_their_form() {
        let (a, b) = (random_token().unwrap(), random_token().unwrap());
        assert!(a != b && is_token(&a) && is_token(&b));
        assert!(!is_token("") && !is_token(&format!("{}!", &a[1..])) && !is_token(&a[1..]));
    }

    #[test]
    fn a_hash_keeps_its_parts_apart() {
        assert_ne!(hash_parts(&["ab", "c"]), hash_parts(&["a", "bc"]));
    }
}
