//! Makes one call: repeats a request until it is answered, or until another attempt makes no sense.
//!
//! Each attempt waits for the limiter, sends the request, and reads the response. A fault is classified by
//! [`faults`](crate::faults); the ledger records every attempt, because a failed one may cost money too.

use crate::{
    Price,
    backoff::{after, backoff},
    dialect::{End, Heard, Wire},
    endpoint::{Closed, Endpoint},
    faults::{self, Fault, Load, Retry},
    limiter::{Advertised, Outcome},
    transport::Received,
};
use std::{
    thread,
    time::{Duration, Instant, SystemTime},
};
use wayword_ledger::{Answer, Attempts, LedgerError, Refused, Run};

/// How often a thread that waits for its next attempt checks whether the run was stopped.
const LOOK_UP: Duration = Duration::from_millis(100);

/// How many times the program asks again after an empty answer.
const EMPTY_AGAIN: u32 = 1;

/// More tokens than any model takes or gives at once. A larger count is an error of the service. If the program
/// believed it, all money would count as spent, and the limit on tokens would delay every request for years.
const MOST_TOKENS: u64 = 20_000_000;

/// A call that is ready to be sent.
pub(crate) struct Sending<'a> {
    pub(crate) endpoint: &'a Endpoint,
    pub(crate) run: &'a Run,
    /// The ledger's key of the call, which seeds the waits.
    pub(crate) key: &'a str,
    pub(crate) wire: &'a Wire,
    pub(crate) price: Option<&'a Price>,
    /// The size of the request, from which its tokens are estimated.
    pub(crate) size: Size,
    /// Most attempts.
    pub(crate) attempts: u32,
}

/// The size of a request.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Size {
    /// Characters of the messages.
    pub(crate) chars: u64,
    /// Bytes of the characters that are not ASCII.
    pub(crate) other_bytes: u64,
    pub(crate) pictures: u64,
    pub(crate) max_tokens: u64,
}

/// Why a call was not answered.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Unanswered {
    /// This call failed.
    #[error("{0}")]
    Failed(String),
    /// The service did not answer in any attempt.
    #[error("{0}")]
    Lost(String),
    /// The service answers no calls any more.
    #[error("{}", .0.reason)]
    Closed(Closed),
    /// The ledger refuses the request.
    #[error(transparent)]
    Refused(Refused),
}

impl Unanswered {
    /// Its kind, in one word.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Self::Failed(_) => "failed",
            Self::Lost(_) => "lost",
            Self::Closed(_) => "closed",
            Self::Refused(_) => "refused",
        }
    }
}

/// The result of one attempt.
enum Attempt {
    Heard(Heard, Duration),
    Fault(Fault),
    /// The run was stopped, or the endpoint closed, before anything was sent.
    NotSent,
    /// The ledger, which limits the rate of all workers together, could not be used. No request was sent.
    NoTurn(LedgerError),
}

impl Size {
    /// An upper bound of the request's tokens, for any tokenizer in use and for large pictures. Words have more than
    /// two characters each; in a script that a tokenizer does not know, each byte is a token.
    pub(crate) fn most_tokens_in(self, tokens_per_picture: u64) -> u64 {
        (self.chars / 2 + self.other_bytes + 16).saturating_add(tokens_per_picture.saturating_mul(self.pictures))
    }

    /// An estimate of the request's tokens.
    fn tokens_in(self) -> u64 {
        self.chars / 4 + 800 * self.pictures
    }
}

impl Sending<'_> {
    /// Makes the call.
    ///
    /// # Errors
    /// When it was not answered. The ledger has every attempt with its reason.
    pub(crate) fn make(&self, attempts: &mut Attempts<'_>) -> Result<Answer, Unanswered> {
        let secret = self.endpoint.secret().map_err(Unanswered::Closed)?;
        let body = self.wire.body.to_string();
        let most_usd =
            self.price.map(|price| price.usd(self.size.most_tokens_in(price.tokens_per_picture), self.size.max_tokens));
        let mut empty = 0;
        let mut attempt = 0;
        loop {
            attempt += 1;
            self.open()?;
            attempts.begin(most_usd).map_err(Unanswered::Refused)?;
            let fault = match self.attempt(body.as_bytes()) {
                Attempt::Heard(heard, latency) => match judge(&heard, self.endpoint) {
                    Ok(()) => {
                        let text = secret.map_or(heard.text.clone(), |secret| secret.scrub(heard.text.clone()));
                        return Ok(self.answer(&heard, text, latency, attempt));
                    }
                    Err(fault) => {
                        empty += u32::from(matches!(fault, Fault::Retry(_)));
                        fault
                    }
                },
                Attempt::Fault(fault) => fault,
                Attempt::NotSent => {
                    attempts.cancelled();
                    self.open()?;
                    return Err(Unanswered::Refused(Refused::Stopped));
                }
                Attempt::NoTurn(error) => {
                    attempts.cancelled();
                    return Err(Unanswered::Refused(error.into()));
                }
            };
            let retry = self.give_up_or(fault, attempts)?;
            if attempt >= self.attempts || empty > EMPTY_AGAIN {
                let times = if attempt == 1 { "1 attempt".to_owned() } else { format!("{attempt} attempts") };
                let reason = format!("{} ({times})", retry.reason);
                // A service that gives empty answers is there, so the call is not lost.
                return Err(if empty > EMPTY_AGAIN { Unanswered::Failed(reason) } else { Unanswered::Lost(reason) });
            }
            // Even if the service asks for short waits, the waits become longer and longer.
            let asked = retry.after.map_or(Duration::ZERO, |asked| after(asked, self.key, attempt));
            self.rest(asked.max(backoff(self.key, attempt)));
        }
    }

    /// Records a fault in the ledger. Returns it if another attempt makes sense.
    fn give_up_or(&self, fault: Fault, attempts: &mut Attempts<'_>) -> Result<Retry, Unanswered> {
        match fault {
            Fault::Retry(retry) => {
                attempts.failed(&retry.reason, retry.maybe_paid);
                Ok(retry)
            }
            Fault::Final { reason, maybe_paid } => {
                attempts.failed(&reason, maybe_paid);
                Err(Unanswered::Failed(reason))
            }
            Fault::Stop { reason, hint } => {
                attempts.failed(&reason, false);
                let closed = Closed { reason, hint };
                self.endpoint.close(closed.clone());
                Err(Unanswered::Closed(closed))
            }
        }
    }

    fn open(&self) -> Result<(), Unanswered> {
        self.endpoint.closed().map_or(Ok(()), |closed| Err(Unanswered::Closed(closed.clone())))
    }

    /// Waits, unless the run is stopped meanwhile.
    fn rest(&self, wait: Duration) {
        let until = Instant::now() + wait;
        while !self.run.is_stopped() && self.endpoint.closed().is_none() {
            match until.saturating_duration_since(Instant::now()) {
                Duration::ZERO => return,
                left => thread::sleep(left.min(LOOK_UP)),
            }
        }
    }

    fn attempt(&self, body: &[u8]) -> Attempt {
        let endpoint = self.endpoint;
        let stopped = || self.run.is_stopped() || endpoint.closed().is_some();
        let tokens = self.size.tokens_in() + self.size.max_tokens;
        let Some(mut permit) = endpoint.limiter.enter(tokens, stopped) else { return Attempt::NotSent };
        if self.run.shares_rates() {
            let (name, rates) = endpoint.rates();
            match self.run.wait_turn(&name, rates, tokens, stopped) {
                Ok(true) => permit.leaves(),
                Ok(false) => return Attempt::NotSent,
                Err(error) => return Attempt::NoTurn(error),
            }
        }
        let received = endpoint.post(self.wire, body);
        let latency = permit.latency();
        let heard = match received {
            Ok(received) => {
                permit.learn(Advertised::read(&received.headers, endpoint.provider.advertises_requests_per_day));
                self.hear(&received)
            }
            Err(error) => Err(faults::of_transport(&error, None, endpoint.provider.base_url.as_str(), endpoint.who())),
        };
        permit.done(match &heard {
            Ok(heard) => Outcome::Answered { tokens: self.tokens(heard).0 + self.tokens(heard).1 },
            Err(Fault::Retry(Retry { load: load @ (Load::Slow | Load::Over), after, .. })) => {
                Outcome::Burdened { load: *load, after: *after }
            }
            Err(_) => Outcome::Failed,
        });
        heard.map_or_else(Attempt::Fault, |heard| Attempt::Heard(heard, latency))
    }

    /// Reads a response.
    fn hear(&self, received: &Received) -> Result<Heard, Fault> {
        let (endpoint, status) = (self.endpoint, received.status);
        let fault =
            |body: &[u8]| faults::of_response(status, &received.headers, body, SystemTime::now(), endpoint.who());
        let body = match &received.body {
            Ok(body) => body,
            // The status is enough, even if the body was lost.
            Err(_) if !(200..300).contains(&status) => return Err(fault(&[])),
            Err(error) => {
                return Err(faults::of_transport(
                    error,
                    Some(status),
                    endpoint.provider.base_url.as_str(),
                    endpoint.who(),
                ));
            }
        };
        if !(200..300).contains(&status) {
            return Err(fault(body));
        }
        let value: serde_json::Value =
            serde_json::from_slice(body).map_err(|_| Fault::again("the answer is not complete JSON", true))?;
        if value.get("error").is_some_and(|error| !error.is_null()) {
            return Err(fault(body));
        }
        endpoint.provider.dialect.heard(&value).map_err(|missing| match faults::error_inside(&value) {
            true => fault(body),
            false => Fault::again(format!("the answer has no {}", missing.0), true),
        })
    }

    /// Tokens in and out. Estimated where the service reports no number, or an impossible one.
    fn tokens(&self, heard: &Heard) -> (u64, u64) {
        let told = |tokens: Option<u64>| tokens.filter(|tokens| *tokens <= MOST_TOKENS);
        let tokens_out = || heard.text.chars().count() as u64 / 4;
        (
            told(heard.tokens_in).unwrap_or_else(|| self.size.tokens_in()),
            told(heard.tokens_out).unwrap_or_else(tokens_out),
        )
    }

    fn answer(&self, heard: &Heard, text: String, latency: Duration, attempts: u32) -> Answer {
        let (tokens_in, tokens_out) = self.tokens(heard);
        Answer {
            text,
            finish: if heard.end == End::Length { "length" } else { "stop" }.to_owned(),
            tokens_in,
            tokens_out,
            usd: self.price.map(|price| price.usd(tokens_in, tokens_out)),
            latency_ms: u64::try_from(latency.as_millis()).unwrap_or(u64::MAX),
            attempts,
        }
    }
}

/// Whether a reply is an answer.
fn judge(heard: &Heard, endpoint: &Endpoint) -> Result<(), Fault> {
    let lost = |reason: String| Fault::Final { reason, maybe_paid: true };
    match &heard.end {
        End::Filtered(why) => {
            Err(lost(format!("the service's filter blocked the answer ({})", endpoint.who().told(why))))
        }
        End::Refused(why) => Err(lost(format!("the model refused: {}", endpoint.who().told(why)))),
        End::Stop | End::Length if !heard.text.is_empty() => Ok(()),
        End::Stop => Err(Fault::again("empty answer", true)),
        End::Length => Err(lost(format!(
            "the model spent all its tokens on thinking and gave no answer: set {} under [providers.{}]",
            endpoint.provider.dialect.without_thinking(),
            endpoint.provider.name
        ))),
    }
}
