//! Classifies a fault of a service by the reaction to it: try again, ask once more, give up this call, or stop the run.
//!
//! The status alone is not enough. A 429, for example, may mean "slow down" (try again) or "your account is empty"
//! (stop), and a 200 may carry an error in its body. So the body's codes and words are read first
//! ([`ServiceErrorBody`]).

mod connection;
mod delay;
mod error_body;
mod hints;
mod times;
mod unreadable;

use crate::secret::ServiceSecret;
pub(crate) use connection::{ends_in_handshake, fault_from_transport};
use error_body::ServiceErrorBody;
pub(crate) use error_body::one_line;
use std::time::{Duration, SystemTime};
pub(crate) use unreadable::{body_text, fault_of_other_json, fault_of_unreadable_body, is_html};
use ureq::http::HeaderMap;

/// Longest wait that a service may ask for. If a service asks for a longer one, the run stops.
const MAX_REQUESTED_WAIT: Duration = Duration::from_secs(600);

/// The reaction to a request without an answer.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum RemoteFault {
    /// Another attempt makes sense.
    Retry(RetryFault),
    /// A complete answer came that cannot be read. It may be paid for, so the program asks only once more.
    Unreadable {
        /// What came, for people.
        reason: String,
        /// How the user can fix it, if that is known.
        hint: Option<String>,
        /// Whether it was a page of HTML, which no model writes.
        is_page: bool,
    },
    /// This call fails. Other calls may succeed.
    Final {
        /// The cause, for people.
        reason: String,
        /// How the user can fix it, if that is known.
        hint: Option<String>,
        /// Whether the service refused the request as it is, so that others like it are refused too.
        is_refusal: bool,
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
    /// What the base URL of its API ends in, as in "/v1"; empty where it has no path.
    pub(crate) version_path: &'static str,
    /// Whether the service answered a call of this run, so that its address is right.
    pub(crate) has_answered: bool,
}

impl RemoteFault {
    /// A fault after which another attempt may succeed.
    pub(crate) fn retry_without_wait(reason: impl Into<String>, maybe_paid: bool) -> Self {
        Self::Retry(RetryFault { reason: reason.into(), after: None, load: ServiceLoad::Unknown, maybe_paid })
    }

    /// The cause, for people.
    pub(crate) fn reason(&self) -> &str {
        match self {
            Self::Retry(RetryFault { reason, .. })
            | Self::Unreadable { reason, .. }
            | Self::Final { reason, .. }
            | Self::Stop { reason, .. } => reason,
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
    if let Some(hint) = hints::stop_hint(status, body, &service_error, context) {
        return RemoteFault::Stop { reason: format!("{} says {reason}", context.provider), hint };
    }
    match status {
        429 | 529 => overload_fault(reason, delay::requested_wait(headers, &service_error, now), context),
        503 => match delay::requested_wait(headers, &service_error, now) {
            Some(after) => overload_fault(reason, Some(after), context),
            None => RemoteFault::retry_without_wait(reason, false),
        },
        408 | 409 | 425 | 500 | 502..=599 => RemoteFault::retry_without_wait(reason, false),
        // An error with a success status, and no status in the body: the service may have worked on the request.
        200..=299 if service_error.is_overloaded() => overload_fault(reason, None, context),
        200..=299 => RemoteFault::Unreadable { reason, hint: None, is_page: false },
        _ => RemoteFault::Final {
            reason,
            hint: hints::call_hint(status, &service_error, context),
            is_refusal: !service_error.is_moderated(),
            maybe_paid: false,
        },
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

impl FaultContext<'_> {
    /// A service's message, short and without the key. The key is removed before the text is cut, because the cut could
    /// leave a part of the key.
    pub(crate) fn safe_text(&self, words: &str) -> String {
        match self.secret {
            Some(secret) => one_line(&secret.scrub_key(words.to_owned())),
            None => one_line(words),
        }
    }
}

#[cfg(test)]
mod tests;
