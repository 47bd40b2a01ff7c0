//! What a fault means: try again, give this call up, or stop the run.

mod delay;
mod said;
mod times;

use crate::{secret::Secret, transport::LARGEST_BODY};
use said::Said;
pub(crate) use said::short;
use std::{
    io::ErrorKind,
    time::{Duration, SystemTime},
};
use ureq::{Timeout, http::HeaderMap};

/// A service that asks for a longer wait than this is not waited for.
const LONGEST_WAIT: Duration = Duration::from_secs(600);

/// What to do about a request that brought no answer.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Fault {
    /// Another attempt makes sense.
    Retry(Retry),
    /// This call comes to nothing; others may do better.
    Final {
        /// What happened.
        reason: String,
        /// Whether it may cost money all the same.
        maybe_paid: bool,
    },
    /// Every further call would come to nothing.
    Stop {
        /// What happened.
        reason: String,
        /// What to do.
        hint: String,
    },
}

/// An attempt that may be repeated.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Retry {
    /// What happened.
    pub(crate) reason: String,
    /// How long the service asks to be left alone.
    pub(crate) after: Option<Duration>,
    /// Whether it has too much to do, or more than it allows.
    pub(crate) load: Load,
    /// Whether it may cost money all the same.
    pub(crate) maybe_paid: bool,
}

/// What a fault tells about the service's load.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Load {
    /// Nothing: it happens at any load.
    Unknown,
    /// It did not answer in time.
    Slow,
    /// It said that this is too much.
    Over,
}

/// Who is talked to, for reasons and hints.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Who<'a> {
    pub(crate) provider: &'a str,
    pub(crate) key_env: Option<&'a str>,
    pub(crate) secret: Option<&'a Secret>,
}

impl Fault {
    /// A fault that another attempt may not meet.
    pub(crate) fn again(reason: impl Into<String>, maybe_paid: bool) -> Self {
        Self::Retry(Retry { reason: reason.into(), after: None, load: Load::Unknown, maybe_paid })
    }

    /// What happened.
    pub(crate) fn reason(&self) -> &str {
        match self {
            Self::Retry(Retry { reason, .. }) | Self::Final { reason, .. } | Self::Stop { reason, .. } => reason,
        }
    }
}

/// Whether a body of JSON that is no answer tells of an error.
pub(crate) fn error_inside(body: &serde_json::Value) -> bool {
    Said::of_json(body).is_error()
}

/// The fault of a response whose status or body is no answer's. `now` is what dates in headers are held against.
pub(crate) fn of_response(status: u16, headers: &HeaderMap, body: &[u8], now: SystemTime, who: Who<'_>) -> Fault {
    let said = Said::read(body);
    // Some services send an error under status 200, with the status inside.
    let status = if (200..300).contains(&status) { said.status.unwrap_or(status) } else { status };
    let message = who.told(&said.message);
    let reason = match message.as_str() {
        "" => format!("status {status}"),
        message => format!("status {status}: {message}"),
    };
    if let Some(hint) = stops(status, &said, who) {
        return Fault::Stop { reason: format!("{} says {reason}", who.provider), hint };
    }
    match status {
        429 | 529 => overloaded(reason, delay::asked(headers, &said, now), who),
        503 => match delay::asked(headers, &said, now) {
            Some(after) => overloaded(reason, Some(after), who),
            None => Fault::again(reason, false),
        },
        408 | 409 | 425 | 500..=599 => Fault::again(reason, false),
        // An error under a status of success that names no status: the request may have been worked on.
        200..=299 if said.overloaded() => overloaded(reason, None, who),
        200..=299 => Fault::again(reason, true),
        400 | 422 => Fault::Final { reason: reason + unsupported(&message), maybe_paid: false },
        _ => Fault::Final { reason, maybe_paid: false },
    }
}

fn overloaded(reason: String, after: Option<Duration>, who: Who<'_>) -> Fault {
    match after {
        Some(after) if after > LONGEST_WAIT => Fault::Stop {
            reason: format!("{} asks to wait {} minutes: {reason}", who.provider, after.as_secs() / 60),
            hint: "go on later with the same command: what was answered is kept".to_owned(),
        },
        after => Fault::Retry(Retry { reason, after, load: Load::Over, maybe_paid: false }),
    }
}

/// Whether nothing more can be asked for; if so, what to do.
fn stops(status: u16, said: &Said, who: Who<'_>) -> Option<String> {
    if said.out_of_money() || status == 402 {
        return Some(format!(
            "pay for more at {}, or wait until its quota is renewed; then go on with the same command",
            who.provider
        ));
    }
    if said.day_is_over() {
        return Some(
            "the day's quota is used up: go on tomorrow with the same command, or name another model".to_owned(),
        );
    }
    match status {
        // Moderation of one request comes with the same status as a key without rights.
        403 if said.moderated() => None,
        401 | 403 => Some(who.key_hint()),
        400 if said.bad_key() => Some(who.key_hint()),
        300..=399 => Some(format!(
            "redirects are not followed, because they would carry the key along: give base_url under [providers.{}] where it leads",
            who.provider
        )),
        _ => None,
    }
}

/// What to do when a service does not know a field that is usually sent.
fn unsupported(message: &str) -> &'static str {
    let message = message.to_ascii_lowercase();
    if !["unsupported", "not support", "unrecognized", "unknown", "extra inputs"]
        .iter()
        .any(|word| message.contains(word))
    {
        ""
    } else if message.contains("max_completion_tokens") || message.contains("max_tokens") {
        " (set max_tokens_field under the provider's settings)"
    } else if message.contains("temperature") {
        " (set omit = [\"temperature\"] under the provider's settings)"
    } else if message.contains("seed") {
        " (set omit = [\"seed\"] under the provider's settings)"
    } else {
        ""
    }
}

/// The fault of a request that no whole response came back for. `answered` is the status, where that came.
pub(crate) fn of_transport(error: &ureq::Error, answered: Option<u16>, url: &str, who: Who<'_>) -> Fault {
    use ureq::Error as E;
    let refused = |error: &std::io::Error| error.kind() == ErrorKind::ConnectionRefused;
    let retry = |reason: String, load, maybe_paid| Fault::Retry(Retry { reason, after: None, load, maybe_paid });
    match error {
        E::Io(error) if refused(error) => retry(format!("nothing answers at {url}"), Load::Unknown, false),
        E::HostNotFound => retry(format!("the host of {url} is not found"), Load::Unknown, false),
        E::Timeout(Timeout::Connect | Timeout::Resolve) => {
            retry(format!("no connection to {url} within 10 seconds"), Load::Slow, false)
        }
        E::Timeout(_) => retry("no whole answer in time".to_owned(), Load::Slow, true),
        E::BodyExceedsLimit(_) => {
            Fault::Final { reason: format!("the answer is longer than {} MiB", LARGEST_BODY >> 20), maybe_paid: true }
        }
        E::Io(_) | E::Protocol(_) | E::ConnectionFailed | E::BodyStalled => {
            let where_ = if answered.is_some() { "in mid-answer" } else { "before an answer" };
            retry(format!("the connection broke {where_}: {}", who.told(&error.to_string())), Load::Unknown, true)
        }
        E::LargeResponseHeader(..) => retry("the answer's headers are too large".to_owned(), Load::Unknown, true),
        E::Rustls(_) | E::Tls(_) | E::Pem(_) | E::TlsRequired | E::ConnectProxyFailed(_) | E::InvalidProxyUrl => {
            retry(format!("no secure connection to {url}: {}", who.told(&error.to_string())), Load::Unknown, false)
        }
        // What is left is a request that cannot even be made; its words could hold what was to be sent.
        _ => Fault::Final { reason: "the request could not be made".to_owned(), maybe_paid: false },
    }
}

impl Who<'_> {
    /// A service's words, short and without the key. The key goes first: of one that is cut, a part would stay.
    pub(crate) fn told(&self, words: &str) -> String {
        match self.secret {
            Some(secret) => short(&secret.scrub(words.to_owned())),
            None => short(words),
        }
    }

    fn key_hint(&self) -> String {
        match self.key_env {
            Some(variable) => {
                format!("check the key in {variable} and what it may do, then go on with the same command")
            }
            None => format!("it wants a key: give --key-env VARIABLE, or key_env under [providers.{}]", self.provider),
        }
    }
}

#[cfg(test)]
mod tests;
