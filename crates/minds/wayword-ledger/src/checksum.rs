//! Whether an answer is the one that was written.

use crate::{Answer, Key};
use serde_json::json;
use sha2::{Digest, Sha256};

/// The checksum that an answer carries in the ledger, in hexadecimal digits: over all of it and the name of its call, so that an
/// answer of another call does not pass either.
pub(crate) fn of(key: &Key, answer: &Answer) -> String {
    let Answer { text, finish, tokens_in, tokens_out, usd, latency_ms, attempts } = answer;
    // The database holds whole numbers up to this one, and one kind of nothing.
    let count = |count: &u64| (*count).min(i64::MAX.cast_unsigned());
    let counts = [count(tokens_in), count(tokens_out), count(latency_ms)];
    let usd = usd.map(|usd| (usd + 0.0).to_bits());
    let all = json!([key.as_str(), text, finish, counts, usd, attempts]).to_string();
    Sha256::digest(all).iter().map(|byte| format!("{byte:02x}")).collect()
}
