//! Checksums, which show whether an answer is the one that was written.

use crate::{CallAnswer, CallKey};
use serde_json::json;
use sha2::{Digest, Sha256};

/// The checksum of an answer in the ledger, in hexadecimal digits. It covers the whole answer and the call's key, so
/// that the answer of another call fails too.
pub(crate) fn answer_checksum(key: &CallKey, answer: &CallAnswer) -> String {
    let CallAnswer { text, finish, tokens_in, tokens_out, usd, latency_ms, attempts } = answer;
    // The database stores integers up to `i64::MAX`, and does not distinguish -0.0 from 0.0.
    let count = |count: &u64| (*count).min(i64::MAX.cast_unsigned());
    let counts = [count(tokens_in), count(tokens_out), count(latency_ms)];
    let usd = usd.map(|usd| (usd + 0.0).to_bits());
    let all = json!([key.as_str(), text, finish, counts, usd, attempts]).to_string();
    sha256_text(all)
}

/// The SHA-256 of bytes, in hexadecimal digits.
pub(crate) fn sha256_text(bytes: impl AsRef<[u8]>) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
