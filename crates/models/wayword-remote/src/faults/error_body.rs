//! Reads the error that a service reports in the body of a response.
//!
//! Every service has its own JSON: `{"error": {"message": ..., "code": ...}}`, `{"error": "..."}`, `{"detail": ...}`
//! and others. This file reads all of them into one struct with the message and the codes.

use serde_json::Value;
use std::time::Duration;

/// Most characters of a service's message that an error of this program repeats. The rest is cut off.
const MAX_MESSAGE_CHARS: usize = 300;

/// Most characters of a message in which phrases are searched for.
const MAX_SEARCHED_CHARS: usize = 4000;

/// The content of an error's body.
#[derive(Debug, Default)]
pub(super) struct ServiceErrorBody {
    /// The message as the service wrote it: of any length, and possibly with the key in it.
    pub(super) message: String,
    /// Every code, type, status and quota name in the body, in lower case.
    marks: Vec<String>,
    /// A status inside the body.
    pub(super) status: Option<u16>,
    /// How long Gemini asks the program to wait (`RetryInfo`).
    pub(super) retry_delay: Option<Duration>,
}

impl ServiceErrorBody {
    /// Reads an error's body.
    pub(super) fn from_body(body: &[u8]) -> Self {
        match serde_json::from_slice::<Value>(body) {
            Ok(value) => Self::from_json(&value),
            Err(_) => Self { message: String::from_utf8_lossy(body).into_owned(), ..Self::default() },
        }
    }

    /// Reads an error's body that is JSON.
    pub(super) fn from_json(value: &Value) -> Self {
        // Some of Gemini's endpoints put the error into a list.
        let value = value.get(0).unwrap_or(value);
        // If its own provider fails, OpenRouter puts the error into the choice.
        let choice = value.get("choices").and_then(|choices| choices.get(0)?.get("error"));
        let error = value.get("error").filter(|error| !error.is_null()).or(choice).unwrap_or(value);
        let text = |value: &Value, field: &str| value.get(field).and_then(Value::as_str).map(str::to_owned);
        let message = error.as_str().map(str::to_owned).or_else(|| text(error, "message"));
        let message = message.or_else(|| text(value, "message")).or_else(|| value.get("detail").map(plain_text));
        let mut parsed = Self { message: message.unwrap_or_default(), ..Self::default() };
        for field in ["code", "type", "status"] {
            parsed.marks.extend(text(error, field).map(|mark| mark.to_ascii_lowercase()));
        }
        let code = error.get("code").and_then(|code| code.as_u64().or_else(|| code.as_str()?.parse().ok()));
        parsed.status = code.and_then(|code| u16::try_from(code).ok()).filter(|code| (300..600).contains(code));
        let details = error.get("details").and_then(Value::as_array);
        // More than 16 details or violations are ignored, because the body comes from outside.
        details.into_iter().flatten().take(16).for_each(|detail| parsed.add_detail(detail));
        parsed
    }

    /// Reads one of the details that Gemini adds to an error.
    fn add_detail(&mut self, detail: &Value) {
        self.marks.extend(detail.get("reason").and_then(Value::as_str).map(str::to_ascii_lowercase));
        let delay = detail.get("retryDelay").and_then(Value::as_str);
        self.retry_delay = self.retry_delay.or_else(|| super::times::parse_duration(delay?));
        let violations = detail.get("violations").and_then(Value::as_array);
        let quotas =
            violations.into_iter().flatten().take(16).filter_map(|violation| violation.get("quotaId")?.as_str());
        self.marks.extend(quotas.map(str::to_ascii_lowercase));
    }

    /// Whether the body reports an error.
    pub(super) fn is_error(&self) -> bool {
        !self.message.is_empty() || self.status.is_some()
    }

    /// Whether the account is empty or its limit is reached, so that waiting does not help.
    pub(super) fn is_out_of_money(&self) -> bool {
        self.has_mark(&["insufficient_quota", "billing_hard_limit_reached", "billing_not_active", "billing_error"])
            || self.mentions_any(&["credit balance is too low", "insufficient balance", "insufficient credits"])
            || self.mentions_any(&["used all available credits", "billing hard limit"])
    }

    /// Whether a quota per day is used up.
    pub(super) fn is_daily_quota_used_up(&self) -> bool {
        self.marks.iter().any(|mark| mark.contains("perday")) || self.mentions_any(&["free-models-per-day"])
    }

    /// Whether the key is invalid, although the status is not 401.
    pub(super) fn has_bad_key(&self) -> bool {
        self.has_mark(&["api_key_invalid", "invalid_api_key"])
            || self.mentions_any(&["api key not valid", "api key expired"])
    }

    /// Whether the request is longer than what the model reads at once.
    pub(super) fn is_too_long(&self) -> bool {
        self.has_mark(&["context_length_exceeded", "exceed_context_size_error"])
            || self.mentions_any(&["context length", "context size", "context window", "context the overflows"])
            || self.mentions_any(&["prompt is too long", "too many tokens", "exceeds the maximum number of tokens"])
    }

    /// Whether moderation refused this one request.
    pub(super) fn is_moderated(&self) -> bool {
        self.mentions_any(&["moderation", "flagged"])
    }

    /// Whether the service is overloaded.
    pub(super) fn is_overloaded(&self) -> bool {
        self.has_mark(&[
            "overloaded_error",
            "rate_limit_error",
            "rate_limit_exceeded",
            "resource_exhausted",
            "unavailable",
        ])
    }

    /// Whether the body has one of these codes.
    fn has_mark(&self, marks: &[&str]) -> bool {
        self.marks.iter().any(|mark| marks.contains(&mark.as_str()))
    }

    /// Whether the message contains one of these phrases, in any case.
    pub(super) fn mentions_any(&self, phrases: &[&str]) -> bool {
        let message: String = self.message.chars().take(MAX_SEARCHED_CHARS).collect::<String>().to_ascii_lowercase();
        phrases.iter().any(|phrase| message.contains(phrase))
    }
}

fn plain_text(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// A text on one line, without control characters, and cut if it is long. A page of HTML is left out.
pub(crate) fn one_line(text: &str) -> String {
    let text = text.trim_start();
    if text.starts_with('<') {
        return "(a page of HTML)".to_owned();
    }
    let clean = text.chars().map(|c| if c.is_whitespace() || c.is_control() { ' ' } else { c });
    let words: String = clean.take(4 * MAX_MESSAGE_CHARS).collect();
    let line = words.split(' ').filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" ");
    match line.char_indices().nth(MAX_MESSAGE_CHARS) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn read_finds_the_message_in_every_form() {
        let forms = [
            r#"{"error":{"message":"too bad","type":"x","code":null}}"#,
            r#"{"type":"error","error":{"type":"overloaded_error","message":"too bad"}}"#,
            r#"[{"error":{"code":400,"message":"too bad","status":"INVALID_ARGUMENT"}}]"#,
            r#"{"error":"too bad"}"#,
            r#"{"object":"error","message":"too bad","code":40001}"#,
            r#"{"detail":"too bad"}"#,
            r#"{"choices":[{"error":{"code":502,"message":"too bad"}}]}"#,
            "too\n\tbad\u{0}",
        ];
        for form in forms {
            assert_eq!(one_line(&ServiceErrorBody::from_body(form.as_bytes()).message), "too bad", "{form}");
        }
        assert_eq!(one_line("<html><body>502"), "(a page of HTML)");
    }

    proptest! {
        #[test]
        fn short_bounds_every_text(text in ".{0,3000}", bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            prop_assert!(one_line(&text).chars().count() <= MAX_MESSAGE_CHARS + 1);
            prop_assert!(!one_line(&text).chars().any(char::is_control));
            ServiceErrorBody::from_body(&bytes);
        }
    }
}
