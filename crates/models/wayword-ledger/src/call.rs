//! Calls of models, their keys and their answers.
//!
//! A key is a hash over everything that could change the answer. So equal calls have equal keys, and an answer is found again by its key.

use crate::checksum::sha256_text;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fmt;

/// Everything that could change a call's answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelCall {
    /// `provider/model`.
    pub model: String,
    /// The address of the service; for a model in process, where its weights come from.
    pub base_url: String,
    /// Messages, with hashes in place of pictures, and parameters.
    pub request: Value,
    /// A number that differs between equal calls, so that each gets an answer of its own.
    pub replicate: u32,
}

/// The key of a call: the SHA-256 of its canonical JSON, in hexadecimal digits.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct CallKey(String);

/// The answer of a call, and what it cost.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CallAnswer {
    /// The text of the answer.
    pub text: String,
    /// Why the answer ended, in the caller's words, as `stop` or `length`.
    pub finish: String,
    /// Tokens of the request.
    pub tokens_in: u64,
    /// Tokens of the answer.
    pub tokens_out: u64,
    /// US dollars; `None` where the price is not known.
    pub usd: Option<f64>,
    /// Milliseconds from sending the last attempt to its last byte.
    pub latency_ms: u64,
    /// How many requests were sent until one was answered.
    pub attempts: u32,
}

/// A call with its answer: a line of an export or a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LedgerEntry {
    /// The call's key.
    pub key: CallKey,
    /// The call.
    pub call: ModelCall,
    /// Its answer.
    pub answer: CallAnswer,
    /// When it was answered, seconds since 1970.
    pub at_unix_s: i64,
    /// The run that made the call.
    pub run: String,
}

impl ModelCall {
    /// The call's key. Equal calls have equal keys, for any order of the request's fields.
    #[must_use]
    pub fn key(&self) -> CallKey {
        let mut canonical = String::new();
        let parts = [
            Value::from(self.model.as_str()),
            Value::from(self.base_url.as_str()),
            self.request.clone(),
            Value::from(self.replicate),
        ];
        write_canonical(&Value::Array(parts.into()), &mut canonical);
        CallKey(sha256_text(canonical))
    }
}

/// Writes JSON without spaces, with the fields of objects sorted by name.
fn write_canonical(value: &Value, out: &mut String) {
    match value {
        Value::Array(items) => {
            for (at, item) in items.iter().enumerate() {
                out.push(if at == 0 { '[' } else { ',' });
                write_canonical(item, out);
            }
            out.push_str(if items.is_empty() { "[]" } else { "]" });
        }
        Value::Object(fields) => {
            let mut fields: Vec<_> = fields.iter().collect();
            fields.sort_by_key(|(name, _)| *name);
            for (at, (name, item)) in fields.iter().enumerate() {
                out.push(if at == 0 { '{' } else { ',' });
                out.push_str(&Value::from(name.as_str()).to_string());
                out.push(':');
                write_canonical(item, out);
            }
            out.push_str(if fields.is_empty() { "{}" } else { "}" });
        }
        plain => out.push_str(&plain.to_string()),
    }
}

impl CallKey {
    /// The hexadecimal digits.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// A key as the store has it.
    pub(crate) fn from_stored(digits: String) -> Self {
        Self(digits)
    }
}

impl fmt::Display for CallKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::json;

    fn call(request: Value) -> ModelCall {
        ModelCall { model: "p/m".into(), base_url: "http://127.0.0.1".into(), request, replicate: 0 }
    }

    #[test]
    fn key_ignores_the_order_of_fields_and_depends_on_all_else() {
        let one = call(json!({"a": [1, {"x": null, "y": "é\n"}], "b": {}, "c": []}));
        assert_eq!(one.key(), call(json!({"c": [], "b": {}, "a": [1, {"y": "é\n", "x": null}]})).key());
        assert_eq!(one.key().as_str().len(), 64);
        let others = [
            call(json!({"a": [1, {"x": null, "y": "é"}], "b": {}, "c": []})),
            call(json!({"a": [{"x": null, "y": "é\n"}, 1], "b": {}, "c": []})),
            ModelCall { model: "p/n".into(), ..one.clone() },
            ModelCall { base_url: "http://127.0.0.2".into(), ..one.clone() },
            ModelCall { replicate: 1, ..one.clone() },
        ];
        for other in others {
            assert_ne!(one.key(), other.key(), "{other:?}");
        }
    }

    proptest! {
        #[test]
        fn different_texts_have_different_names(a in ".{0,20}", b in ".{0,20}") {
            let (one, other) = (call(json!({"text": a})), call(json!({"text": b})));
            prop_assert_eq!(one.key() == other.key(), a == b);
        }
    }
}
