//! Makes one call: repeats a request until it is answered, or until another attempt makes no sense.
//!
//! Each attempt waits for the limiter, sends the request, and reads the response. A fault is classified by
//! [`faults`](crate::faults); the ledger records every attempt, because a failed one may cost money too.

use crate::{
    ModelPrice,
    backoff::{backoff_wait, wait_after},
    dialect::{DialectReply, ReplyEnd, WireRequest},
    endpoint::{ClosedEndpoint, ProviderEndpoint},
    faults::{self, RemoteFault, RetryFault, ServiceLoad},
    limiter::{AdvertisedLimits, RequestOutcome},
    stream,
    transport::HttpResponse,
};
use std::{
    thread,
    time::{Duration, Instant, SystemTime},
};
use wayword_ledger::{CallAnswer, CallAttempts, LedgerError, LedgerRun, RequestRefusedError};

/// How often a thread that waits for its next attempt checks whether the run was stopped.
const STOP_CHECK_INTERVAL: Duration = Duration::from_millis(100);

/// How many times the program asks again after an empty answer.
const MAX_EMPTY_ANSWER_RETRIES: u32 = 1;

/// More tokens than any model takes or gives at once. A service that reports more is wrong, and the program estimates
/// the tokens instead. If it believed the service, all money would count as spent, and the limit on tokens would delay
/// every request for years.
const MAX_PLAUSIBLE_TOKENS: u64 = 20_000_000;

/// A call that is ready to be sent.
pub(crate) struct PreparedCall<'a> {
    pub(crate) endpoint: &'a ProviderEndpoint,
    pub(crate) run: &'a LedgerRun,
    /// The ledger's key of the call. The waits between attempts are drawn from it too.
    pub(crate) key: &'a str,
    /// The request as it is sent.
    pub(crate) wire: &'a WireRequest,
    pub(crate) price: Option<&'a ModelPrice>,
    /// The size of the request, from which its tokens are estimated.
    pub(crate) size: RequestSize,
    /// Most attempts of this call.
    pub(crate) attempts: u32,
}

/// The size of a request.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RequestSize {
    /// Characters of the messages.
    pub(crate) chars: u64,
    /// Bytes of the characters that are not ASCII.
    pub(crate) other_bytes: u64,
    /// How many pictures it has.
    pub(crate) pictures: u64,
    /// The most tokens of the reply.
    pub(crate) max_tokens: u64,
}

/// Why a call was not answered.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CallError {
    /// This call failed.
    #[error("{0}")]
    Failed(String),
    /// The service did not answer in any attempt.
    #[error("{0}")]
    Lost(String),
    /// The service answers no calls any more.
    #[error("{}", .0.reason)]
    Closed(ClosedEndpoint),
    /// The ledger refuses the request.
    #[error(transparent)]
    Refused(RequestRefusedError),
}

impl CallError {
    /// The kind of error, in one word.
    pub(crate) fn kind_name(&self) -> &'static str {
        match self {
            Self::Failed(_) => "failed",
            Self::Lost(_) => "lost",
            Self::Closed(_) => "closed",
            Self::Refused(_) => "refused",
        }
    }
}

/// The result of one attempt.
enum AttemptOutcome {
    /// The service replied, after this time. The reply may still be no answer.
    Heard(DialectReply, Duration),
    /// The service did not reply, or not with what its API promises.
    Fault(RemoteFault),
    /// The run was stopped, or the endpoint closed, before anything was sent.
    NotSent,
    /// The ledger, which limits the rate of all workers together, could not be used. No request was sent.
    RateLimitUnavailable(LedgerError),
}

impl RequestSize {
    /// An upper bound of the request's tokens, for any tokenizer in use and for large pictures. Words have more than
    /// two characters each; in a script that a tokenizer does not know, each byte is a token. 16 more are for
    /// what a service adds around the messages.
    pub(crate) fn max_tokens_in(self, tokens_per_picture: u64) -> u64 {
        (self.chars / 2 + self.other_bytes + 16).saturating_add(tokens_per_picture.saturating_mul(self.pictures))
    }

    /// The context that the request and its reply need, tokens: three characters a token, and what models with many
    /// tokens a picture take for pictures of this length, pixels.
    pub(crate) fn context_tokens(self, picture_px: u32) -> u64 {
        // Qwen's models: a token for 28 by 28 pixels of a picture of 4 by 3. LLaVA's: always 576.
        let per_picture = (u64::from(picture_px).pow(2) * 3 / 4 / (28 * 28)).max(576);
        self.chars / 3 + self.other_bytes + per_picture * self.pictures + self.max_tokens
    }

    /// The least tokens that a request of this size takes if nothing is cut off.
    fn least_tokens_in(self) -> u64 {
        self.chars / 4 + 256 * self.pictures
    }

    /// An estimate of the request's tokens: four characters a token, and 800 tokens a picture.
    fn tokens_in(self) -> u64 {
        self.chars / 4 + 800 * self.pictures
    }
}

impl PreparedCall<'_> {
    /// Makes the call.
    ///
    /// # Errors
    /// When it was not answered. The ledger has every attempt with its reason.
    pub(crate) fn make_call(&self, attempts: &mut CallAttempts<'_>) -> Result<CallAnswer, CallError> {
        let secret = self.endpoint.find_secret().map_err(CallError::Closed)?;
        let body = self.wire.body.to_string();
        let most_usd = self
            .price
            .map(|price| price.cost_usd(self.size.max_tokens_in(price.tokens_per_picture), self.size.max_tokens));
        let mut empty_answers = 0;
        let mut attempt = 0;
        loop {
            attempt += 1;
            self.check_open()?;
            attempts.begin_request(most_usd).map_err(CallError::Refused)?;
            let fault = match self.send_once(body.as_bytes()) {
                AttemptOutcome::Heard(reply, latency) => match check_reply(&reply, self.endpoint) {
                    Ok(()) => {
                        self.endpoint.note_answer();
                        self.note_cut_prompt(&reply);
                        let text = reply.answer();
                        let text = secret.map_or(text.clone(), |secret| secret.scrub_key(text.clone()));
                        return Ok(self.ledger_answer(&reply, text, latency, attempt));
                    }
                    Err(fault) => {
                        // Of the faults of a reply, only an empty answer is worth another try.
                        empty_answers += u32::from(matches!(fault, RemoteFault::Retry(_)));
                        fault
                    }
                },
                AttemptOutcome::Fault(fault) => fault,
                AttemptOutcome::NotSent => {
                    attempts.mark_cancelled();
                    self.check_open()?;
                    return Err(CallError::Refused(RequestRefusedError::Stopped));
                }
                AttemptOutcome::RateLimitUnavailable(error) => {
                    attempts.mark_cancelled();
                    return Err(CallError::Refused(error.into()));
                }
            };
            let retry = self.record_fault(fault, attempts)?;
            if attempt >= self.attempts || empty_answers > MAX_EMPTY_ANSWER_RETRIES {
                let times = if attempt == 1 { "1 attempt".to_owned() } else { format!("{attempt} attempts") };
                let reason = format!("{} ({times})", retry.reason);
                // A service that gives empty answers is there, so the call is not lost.
                return Err(if empty_answers > MAX_EMPTY_ANSWER_RETRIES {
                    CallError::Failed(reason)
                } else {
                    CallError::Lost(reason)
                });
            }
            // Even if the service asks for short waits, the waits become longer and longer.
            let requested = retry.after.map_or(Duration::ZERO, |requested| wait_after(requested, self.key, attempt));
            self.wait_between_attempts(requested.max(backoff_wait(self.key, attempt, retry.load)));
        }
    }

    /// Records a fault in the ledger. Returns it if another attempt makes sense.
    fn record_fault(&self, fault: RemoteFault, attempts: &mut CallAttempts<'_>) -> Result<RetryFault, CallError> {
        match fault {
            RemoteFault::Retry(retry) => {
                attempts.mark_failed(&retry.reason, retry.maybe_paid);
                Ok(retry)
            }
            RemoteFault::Final { reason, maybe_paid } => {
                attempts.mark_failed(&reason, maybe_paid);
                Err(CallError::Failed(reason))
            }
            RemoteFault::Stop { reason, hint } => {
                attempts.mark_failed(&reason, false);
                let closed = ClosedEndpoint { reason, hint };
                self.endpoint.close_with(closed.clone());
                Err(CallError::Closed(closed))
            }
        }
    }

    /// Fails if the service answers no calls any more.
    fn check_open(&self) -> Result<(), CallError> {
        self.endpoint.closed_reason().map_or(Ok(()), |closed| Err(CallError::Closed(closed.clone())))
    }

    /// Waits, unless the run is stopped meanwhile.
    fn wait_between_attempts(&self, wait: Duration) {
        let until = Instant::now() + wait;
        while !self.run.is_stopped() && self.endpoint.closed_reason().is_none() {
            match until.saturating_duration_since(Instant::now()) {
                Duration::ZERO => return,
                remaining => thread::sleep(remaining.min(STOP_CHECK_INTERVAL)),
            }
        }
    }

    /// One attempt: waits for the limiter, sends the request, and reads the response.
    fn send_once(&self, body: &[u8]) -> AttemptOutcome {
        let endpoint = self.endpoint;
        let stopped = || self.run.is_stopped() || endpoint.closed_reason().is_some();
        let tokens = self.size.tokens_in() + self.size.max_tokens;
        let Some(mut permit) = endpoint.limiter.wait_for_permit(tokens, stopped) else {
            return AttemptOutcome::NotSent;
        };
        if self.run.shares_rates() {
            let (name, rates) = endpoint.shared_rates();
            match self.run.wait_turn(&name, rates, tokens, stopped) {
                // It is our turn. The wait for it does not count as latency.
                Ok(true) => permit.note_late_start(),
                Ok(false) => return AttemptOutcome::NotSent,
                Err(error) => return AttemptOutcome::RateLimitUnavailable(error),
            }
        }
        let received = endpoint.post_request(self.wire, body);
        let latency = permit.latency();
        let reply = match received {
            Ok(received) => {
                permit.adopt_limits(AdvertisedLimits::from_headers(
                    &received.headers,
                    endpoint.provider.advertises_requests_per_day,
                ));
                self.read_response(&received)
            }
            Err(error) => Err(faults::fault_from_transport(
                &error,
                None,
                endpoint.provider.base_url.as_str(),
                endpoint.fault_context(),
            )),
        };
        permit.end_with(match &reply {
            Ok(reply) => RequestOutcome::Answered { tokens: self.count_tokens(reply).0 + self.count_tokens(reply).1 },
            Err(RemoteFault::Retry(RetryFault {
                load: load @ (ServiceLoad::Slow | ServiceLoad::Over), after, ..
            })) => RequestOutcome::Burdened { load: *load, after: *after },
            Err(_) => RequestOutcome::Failed,
        });
        reply.map_or_else(AttemptOutcome::Fault, |reply| AttemptOutcome::Heard(reply, latency))
    }

    /// Reads a response: a reply, or the fault that its status or its body reports.
    fn read_response(&self, received: &HttpResponse) -> Result<DialectReply, RemoteFault> {
        let (endpoint, status) = (self.endpoint, received.status);
        let fault = |body: &[u8]| {
            faults::fault_from_response(status, &received.headers, body, SystemTime::now(), endpoint.fault_context())
        };
        let body = match &received.body {
            Ok(body) => body,
            // The status is enough, even if the body was lost.
            Err(_) if !(200..300).contains(&status) => return Err(fault(&[])),
            Err(error) => {
                return Err(faults::fault_from_transport(
                    error,
                    Some(status),
                    endpoint.provider.base_url.as_str(),
                    endpoint.fault_context(),
                ));
            }
        };
        if !(200..300).contains(&status) {
            return Err(fault(body));
        }
        let value: serde_json::Value = match serde_json::from_slice(body) {
            Ok(value) => value,
            Err(_) => stream::joined_stream(body).ok_or_else(|| {
                let is_wrong_address = faults::is_html(body) && endpoint.note_page();
                faults::fault_of_odd_body(body, is_wrong_address, endpoint.fault_context())
            })?,
        };
        if value.get("error").is_some_and(|error| !error.is_null()) {
            return Err(fault(body));
        }
        endpoint.provider.dialect.read_reply(&value).map_err(|missing| match faults::reports_error(&value) {
            true => fault(body),
            false => RemoteFault::retry_without_wait(format!("the answer has no {}", missing.0), true),
        })
    }

    /// Notes for the user that a service read much less than was sent.
    fn note_cut_prompt(&self, reply: &DialectReply) {
        let sent = self.size.least_tokens_in();
        let Some(read) = reply.tokens_in.filter(|read| *read > 0 && *read < sent / 2) else { return };
        let provider = &self.endpoint.provider;
        self.endpoint.note(format!(
            "{} read {read} tokens of a prompt of about {sent}: it may cut prompts; {} under [providers.{}]",
            provider.name,
            provider.dialect.longer_context(),
            provider.name
        ));
    }

    /// Tokens in and out. Estimated where the service reports no number, or an impossible one.
    fn count_tokens(&self, reply: &DialectReply) -> (u64, u64) {
        let plausible = |tokens: Option<u64>| tokens.filter(|tokens| *tokens <= MAX_PLAUSIBLE_TOKENS);
        let tokens_out = || reply.text.chars().count() as u64 / 4;
        (
            plausible(reply.tokens_in).unwrap_or_else(|| self.size.tokens_in()),
            plausible(reply.tokens_out).unwrap_or_else(tokens_out),
        )
    }

    /// A new answer for the ledger.
    fn ledger_answer(&self, reply: &DialectReply, text: String, latency: Duration, attempts: u32) -> CallAnswer {
        let (tokens_in, tokens_out) = self.count_tokens(reply);
        CallAnswer {
            text,
            finish: if reply.end == ReplyEnd::Length { "length" } else { "stop" }.to_owned(),
            tokens_in,
            tokens_out,
            usd: self.price.map(|price| price.cost_usd(tokens_in, tokens_out)),
            latency_ms: u64::try_from(latency.as_millis()).unwrap_or(u64::MAX),
            attempts,
        }
    }
}

/// Checks that a reply is an answer: not empty, not refused, not blocked.
fn check_reply(reply: &DialectReply, endpoint: &ProviderEndpoint) -> Result<(), RemoteFault> {
    let final_fault = |reason: String| RemoteFault::Final { reason, maybe_paid: true };
    match &reply.end {
        ReplyEnd::Filtered(why) => Err(final_fault(format!(
            "the service's filter blocked the answer ({})",
            endpoint.fault_context().safe_text(why)
        ))),
        // A refusal is an answer: the one who asked asks again in other words, or does without.
        ReplyEnd::Refused(_) => Ok(()),
        ReplyEnd::Stop | ReplyEnd::Length | ReplyEnd::Thought if !reply.text.is_empty() => Ok(()),
        ReplyEnd::Thought => Err(RemoteFault::retry_without_wait(
            format!(
                "the answer is empty, and all text stands in the field for thoughts: set {} under [providers.{}], or start the server without its reasoning parser",
                endpoint.provider.dialect.without_thinking(),
                endpoint.provider.name
            ),
            true,
        )),
        ReplyEnd::Stop => Err(RemoteFault::retry_without_wait("empty answer", true)),
        ReplyEnd::Length => Err(final_fault(format!(
            "the model spent all its tokens on thinking and gave no answer: set {} under [providers.{}]",
            endpoint.provider.dialect.without_thinking(),
            endpoint.provider.name
        ))),
    }
}
