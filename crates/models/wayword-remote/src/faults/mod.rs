//! Classifies a fault of a service into one of three reactions: try again, give up this call, or stop the run.
//!
//! The status alone is not enough. A 429, for example, may mean "slow down" (try again) or "your account is empty"
//! (stop), and a 200 may carry an error in its body. So the body's codes and words are read first
//! ([`ServiceErrorBody`]).

mod delay;
mod error_body;
mod times;

use crate::{secret::ServiceSecret, transport::MAX_BODY_BYTES};
use error_body::ServiceErrorBody;
pub(crate) use error_body::one_line;
use std::{
    io::ErrorKind,
    time::{Duration, SystemTime},
};
use ureq::{Timeout, http::HeaderMap};

/// Longest wait that a service may ask for. If a service asks for a longer one, the run stops.
const MAX_REQUESTED_WAIT: Duration = Duration::from_secs(600);

/// The reaction to a request without an answer.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum RemoteFault {
    /// Another attempt makes sense.
    Retry(RetryFault),
    /// This call fails. Other calls may succeed.
    Final {
        /// The cause, for people.
        reason: String,
        /// Whether the request may cost money nevertheless.
        maybe_paid: bool,
    },
    /// Every further call would fail.
    Stop {
        /// The cause, for people.
        reason: String,
        /// How the user can fix it.
        hint: String,
    },
}

/// An attempt that may be repeated.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RetryFault {
    /// The cause, for people.
    pub(crate) reason: String,
    /// How long the service asks the program to wait.
    pub(crate) after: Option<Duration>,
    /// How loaded the service is, as far as the fault shows it.
    pub(crate) load: ServiceLoad,
    /// Whether the request may cost money nevertheless.
    pub(crate) maybe_paid: bool,
}

/// How loaded a service is, as far as a fault shows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ServiceLoad {
    /// Unknown: the fault happens at any load.
    Unknown,
    /// The service did not answer in time.
    Slow,
    /// The service reported too many requests or tokens.
    Over,
}

/// The details of a provider that reasons and hints need.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FaultContext<'a> {
    /// The name of the provider.
    pub(crate) provider: &'a str,
    /// The environment variable with the key.
    pub(crate) key_env: Option<&'a str>,
    /// The key, which is removed from every text of the service.
    pub(crate) secret: Option<&'a ServiceSecret>,
}

impl RemoteFault {
    /// A fault after which another attempt may succeed.
    pub(crate) fn retry_without_wait(reason: impl Into<String>, maybe_paid: bool) -> Self {
        Self::Retry(RetryFault { reason: reason.into(), after: None, load: ServiceLoad::Unknown, maybe_paid })
    }

    /// The cause, for people.
    pub(crate) fn reason(&self) -> &str {
        match self {
            Self::Retry(RetryFault { reason, .. }) | Self::Final { reason, .. } | Self::Stop { reason, .. } => reason,
        }
    }
}

/// Whether a JSON body that is not an answer reports an error.
pub(crate) fn reports_error(body: &serde_json::Value) -> bool {
    ServiceErrorBody::from_json(body).is_error()
}

/// The fault of a response that is not an answer, by its status or its body. Dates in headers are compared with `now`.
pub(crate) fn fault_from_response(
    status: u16,
    headers: &HeaderMap,
    body: &[u8],
    now: SystemTime,
    context: FaultContext<'_>,
) -> RemoteFault {
    let service_error = ServiceErrorBody::from_body(body);
    // Some services send an error with status 200, and the real status in the body.
    let status = if (200..300).contains(&status) { service_error.status.unwrap_or(status) } else { status };
    let message = context.safe_text(&service_error.message);
    let reason = match message.as_str() {
        "" => format!("status {status}"),
        message => format!("status {status}: {message}"),
    };
    if let Some(hint) = stop_hint(status, &service_error, context) {
        return RemoteFault::Stop { reason: format!("{} says {reason}", context.provider), hint };
    }
    if let Some(setting) = wrong_setting(status, &message, context) {
        return RemoteFault::Stop { reason: format!("{} says {reason}", context.provider), hint: setting };
    }
    match status {
        429 | 529 => overload_fault(reason, delay::requested_wait(headers, &service_error, now), context),
        503 => match delay::requested_wait(headers, &service_error, now) {
            Some(after) => overload_fault(reason, Some(after), context),
            None => RemoteFault::retry_without_wait(reason, false),
        },
        408 | 409 | 425 | 500..=599 => RemoteFault::retry_without_wait(reason, false),
        // An error with a success status, and no status in the body: the service may have worked on the request.
        200..=299 if service_error.is_overloaded() => overload_fault(reason, None, context),
        200..=299 => RemoteFault::retry_without_wait(reason, true),
        _ => RemoteFault::Final { reason, maybe_paid: false },
    }
}

/// The fault of an overloaded service, which may ask for a wait.
fn overload_fault(reason: String, after: Option<Duration>, context: FaultContext<'_>) -> RemoteFault {
    match after {
        Some(after) if after > MAX_REQUESTED_WAIT => RemoteFault::Stop {
            reason: format!("{} asks to wait {} minutes: {reason}", context.provider, after.as_secs() / 60),
            hint: "all answers are kept: to continue, run the same command later".to_owned(),
        },
        after => RemoteFault::Retry(RetryFault { reason, after, load: ServiceLoad::Over, maybe_paid: false }),
    }
}

/// A hint for the user, if the service will answer no further request.
fn stop_hint(status: u16, service_error: &ServiceErrorBody, context: FaultContext<'_>) -> Option<String> {
    if service_error.is_out_of_money() || status == 402 {
        return Some(format!(
            "pay for more at {}, or wait until its quota is renewed; then run the same command to continue",
            context.provider
        ));
    }
    if service_error.is_daily_quota_used_up() {
        return Some(
            "today's quota is used up: run the same command tomorrow to continue, or choose another model".to_owned(),
        );
    }
    match status {
        // The moderation of one request has the same status as a key without permission.
        403 if service_error.is_moderated() => None,
        401 | 403 => Some(context.key_hint()),
        400 if service_error.has_bad_key() => Some(context.key_hint()),
        300..=399 => Some(format!(
            "redirects are not followed, because the key would be sent along: set base_url under [providers.{}] to the address that the redirect leads to",
            context.provider
        )),
        _ => None,
    }
}

/// The setting to change, if a service refuses what every request of this run has; `None` for other faults.
fn wrong_setting(status: u16, message: &str, context: FaultContext<'_>) -> Option<String> {
    let message = message.to_ascii_lowercase();
    let says = |words: &[&str]| words.iter().any(|word| message.contains(word));
    let at = format!("under [providers.{}]", context.provider);
    if says(&["unexpected endpoint"]) {
        return Some(format!("set base_url {at} to the address of its API, mostly one that ends in /v1"));
    }
    let names_model = says(&["model"]) && says(&["not found", "does not exist", "no such model", "not exist"]);
    if matches!(status, 400 | 404 | 422) && names_model {
        return Some("check the name of the model: `wayword doctor` lists those that the service offers".to_owned());
    }
    let refuses = says(&[
        "unsupported",
        "not support",
        "unrecognized",
        "unknown",
        "extra inputs",
        "unavailable",
        "not permitted",
        "requires --",
        "must be 'json_schema'",
        "only 1 is allowed",
    ]);
    // llama.cpp reports a model that does not see with status 500.
    let names_pictures = says(&["image_url", "image input", "mmproj", "vision", "multimodal"]);
    if refuses && names_pictures && matches!(status, 400 | 404 | 415 | 422 | 500) {
        return Some("the model does not see: name one that does in the roles that are shown pictures".to_owned());
    }
    if !refuses || !matches!(status, 400 | 404 | 422) {
        return None;
    }
    let setting = if says(&["max_completion_tokens", "max_tokens"]) {
        "max_tokens_field = \"max_completion_tokens\""
    } else if says(&["temperature"]) {
        "omit = [\"temperature\"]"
    } else if says(&["seed"]) {
        "omit = [\"seed\"]"
    } else if says(&["response_format", "json_schema", "responseschema", "format"]) {
        "json = \"prompt\""
    } else if says(&["tool"]) {
        "tools = false"
    } else if says(&["think"]) {
        "extra = { think = false }, or leave think out,"
    } else {
        return None;
    };
    Some(format!("set {setting} {at}"))
}

/// The beginning of a body, lower case.
fn begin_of_body(body: &[u8]) -> String {
    String::from_utf8_lossy(&body[..body.len().min(200)]).trim_start().to_ascii_lowercase()
}

/// Whether a body is a page of HTML.
pub(crate) fn is_html(body: &[u8]) -> bool {
    let begin = begin_of_body(body);
    begin.starts_with("<!doctype") || begin.starts_with("<html")
}

/// The fault of a body that is neither JSON nor a whole stream, under a status of success. `is_wrong_address`: pages of HTML came before
/// any answer.
pub(crate) fn fault_of_odd_body(body: &[u8], is_wrong_address: bool, context: FaultContext<'_>) -> RemoteFault {
    let begin = begin_of_body(body);
    if is_wrong_address {
        return RemoteFault::Stop {
            reason: format!("{} answers with a page of HTML in place of JSON", context.provider),
            hint: format!(
                "set base_url under [providers.{}] to the address of its API, mostly one that ends in /v1; a page for signing in means that a proxy stands before it",
                context.provider
            ),
        };
    }
    let is_stream = ["data:", "event:", ": "].iter().any(|mark| begin.starts_with(mark));
    let reason = if is_stream { "the stream breaks off before its end" } else { "the answer is not complete JSON" };
    RemoteFault::retry_without_wait(reason, true)
}

/// The fault of a request without a complete response. `answered` is the status, if one came.
pub(crate) fn fault_from_transport(
    error: &ureq::Error,
    answered: Option<u16>,
    url: &str,
    context: FaultContext<'_>,
) -> RemoteFault {
    use ureq::Error as E;
    let refused = |error: &std::io::Error| error.kind() == ErrorKind::ConnectionRefused;
    let retry =
        |reason: String, load, maybe_paid| RemoteFault::Retry(RetryFault { reason, after: None, load, maybe_paid });
    match error {
        E::Io(error) if refused(error) => retry(format!("nothing answers at {url}"), ServiceLoad::Unknown, false),
        E::HostNotFound => retry(format!("the host of {url} is not found"), ServiceLoad::Unknown, false),
        E::Timeout(Timeout::Connect | Timeout::Resolve) => {
            retry(format!("no connection to {url} within 10 seconds"), ServiceLoad::Slow, false)
        }
        E::Timeout(_) => {
            retry("no complete answer in time; give it more time with --timeout-s".to_owned(), ServiceLoad::Slow, true)
        }
        E::BodyExceedsLimit(_) => RemoteFault::Final {
            reason: format!("the answer is longer than {} MiB", MAX_BODY_BYTES >> 20),
            maybe_paid: true,
        },
        E::Io(_) | E::Protocol(_) | E::ConnectionFailed | E::BodyStalled => {
            let where_ = if answered.is_some() { "in mid-answer" } else { "before an answer" };
            retry(
                format!("the connection broke {where_}: {}", context.safe_text(&error.to_string())),
                ServiceLoad::Unknown,
                true,
            )
        }
        E::LargeResponseHeader(..) => {
            retry("the answer's headers are too large".to_owned(), ServiceLoad::Unknown, true)
        }
        E::Rustls(_) | E::Tls(_) | E::Pem(_) | E::TlsRequired | E::ConnectProxyFailed(_) | E::InvalidProxyUrl => retry(
            format!("no secure connection to {url}: {}", context.safe_text(&error.to_string())),
            ServiceLoad::Unknown,
            false,
        ),
        // All other errors: the request could not be made. The error's text is left out, because it could contain the
        // request.
        _ => RemoteFault::Final { reason: "the request could not be made".to_owned(), maybe_paid: false },
    }
}

impl FaultContext<'_> {
    /// A service's message, short and without the key. The key is removed before the text is cut, because the cut could
    /// leave a part of the key.
    pub(crate) fn safe_text(&self, words: &str) -> String {
        match self.secret {
            Some(secret) => one_line(&secret.scrub_key(words.to_owned())),
            None => one_line(words),
        }
    }

    /// The hint for a key that the service refuses or lacks.
    fn key_hint(&self) -> String {
        match self.key_env {
            Some(variable) => {
                format!("check the key in {variable} and its permissions, then run the same command to continue")
            }
            None => {
                format!("it needs a key: give --key-env VARIABLE, or set key_env under [providers.{}]", self.provider)
            }
        }
    }
}

#[cfg(test)]
mod tests;
