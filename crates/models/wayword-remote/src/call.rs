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
    first_calls::{CallKind, FirstCallTurn},
    limiter::{AdvertisedLimits, RequestOutcome},
    stream,
    transport::HttpResponse,
};
use serde_json::Value;
use std::{
    thread,
    time::{Duration, Instant, SystemTime},
};
use wayword_ledger::{CallAnswer, CallAttempts, LedgerError, LedgerRun, RequestRefusedError};

/// How often a thread that waits for its next attempt checks whether the run was stopped.
const STOP_CHECK_INTERVAL: Duration = Duration::from_millis(100);

/// How many times the program asks again after a complete answer that is of no use, because it may have been paid for.
const MAX_UNREADABLE_ANSWER_RETRIES: u32 = 1;

/// How much a page of HTML in place of an answer counts among the faults before any answer. No model writes one.
const PAGE_WEIGHT: u32 = 2;

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
    /// What it has in common with other calls.
    pub(crate) kind: &'a CallKind,
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
        let Some(turn) = self.endpoint.first_calls.wait_for_turn(self.kind, || self.is_ended()) else {
            self.check_open()?;
            return Err(CallError::Refused(RequestRefusedError::Stopped));
        };
        let mut unreadable_answers = 0;
        let mut attempt = 0;
        loop {
            attempt += 1;
            self.check_open()?;
            attempts.begin_request(most_usd).map_err(CallError::Refused)?;
            let fault = match self.send_once(body.as_bytes()) {
                AttemptOutcome::Heard(reply, latency) => match check_reply(&reply, self.endpoint) {
                    Ok(()) => {
                        self.endpoint.note_answer();
                        turn.note_answer();
                        self.note_cut_prompt(&reply);
                        let text = reply.answer();
                        let text = secret.map_or(text.clone(), |secret| secret.scrub_key(text.clone()));
                        return Ok(self.ledger_answer(&reply, text, latency, attempt));
                    }
                    Err(fault) => fault,
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
            let next = self.record_fault(fault, &turn, attempts)?;
            unreadable_answers += u32::from(matches!(next, NextAttempt::OnceMore { .. }));
            if attempt >= self.attempts || unreadable_answers > MAX_UNREADABLE_ANSWER_RETRIES {
                return Err(give_up(next, attempt, &turn));
            }
            self.wait_between_attempts(self.wait_before(&next, attempt));
        }
    }

    /// How long to wait before the next attempt. Even if the service asks for short waits, the waits become longer and longer.
    fn wait_before(&self, next: &NextAttempt, attempt: u32) -> Duration {
        let (requested, load) = match next {
            NextAttempt::Again(retry) => (retry.after, retry.load),
            NextAttempt::OnceMore { .. } => (None, ServiceLoad::Unknown),
        };
        let requested = requested.map_or(Duration::ZERO, |requested| wait_after(requested, self.key, attempt));
        requested.max(backoff_wait(self.key, attempt, load))
    }

    /// Records a fault in the ledger. Returns the next attempt, if one makes sense. Stops the run where every call would fail alike.
    fn record_fault(
        &self,
        fault: RemoteFault,
        turn: &FirstCallTurn<'_>,
        attempts: &mut CallAttempts<'_>,
    ) -> Result<NextAttempt, CallError> {
        let provider = &self.endpoint.provider.name;
        let maybe_paid = match &fault {
            RemoteFault::Retry(RetryFault { maybe_paid, .. }) | RemoteFault::Final { maybe_paid, .. } => *maybe_paid,
            RemoteFault::Unreadable { .. } => true,
            RemoteFault::Stop { .. } => false,
        };
        attempts.mark_failed(fault.reason(), maybe_paid);
        match fault {
            RemoteFault::Retry(retry) => Ok(NextAttempt::Again(retry)),
            RemoteFault::Unreadable { reason, hint, is_page } => {
                if turn.note_fault(if is_page { PAGE_WEIGHT } else { 1 }) {
                    return Err(
                        self.close_endpoint(format!("{provider} gave no answer that can be read: {reason}"), hint)
                    );
                }
                Ok(NextAttempt::OnceMore { reason, hint })
            }
            RemoteFault::Final { reason, hint, is_refusal, .. } => {
                if is_refusal && turn.note_fault(1) {
                    return Err(self.close_endpoint(format!("{provider} refused every call so far: {reason}"), hint));
                }
                Err(CallError::Failed(with_hint(&reason, hint.as_deref())))
            }
            RemoteFault::Stop { reason, hint } => Err(self.close_endpoint(reason, Some(hint))),
        }
    }

    /// Stops all further requests to the service.
    fn close_endpoint(&self, reason: String, hint: Option<String>) -> CallError {
        let hint = hint.unwrap_or_else(|| "read what the service says, and try it with `wayword doctor`".to_owned());
        let closed = ClosedEndpoint { reason, hint };
        self.endpoint.close_with(closed.clone());
        CallError::Closed(closed)
    }

    /// Whether nothing is sent any more.
    fn is_ended(&self) -> bool {
        self.run.is_stopped() || self.endpoint.closed_reason().is_some()
    }

    /// Fails if the service answers no calls any more.
    fn check_open(&self) -> Result<(), CallError> {
        self.endpoint.closed_reason().map_or(Ok(()), |closed| Err(CallError::Closed(closed.clone())))
    }

    /// Waits, unless the run is stopped meanwhile.
    fn wait_between_attempts(&self, wait: Duration) {
        let until = Instant::now() + wait;
        while !self.is_ended() {
            match until.saturating_duration_since(Instant::now()) {
                Duration::ZERO => return,
                remaining => thread::sleep(remaining.min(STOP_CHECK_INTERVAL)),
            }
        }
    }

    /// One attempt: waits for the limiter, sends the request, and reads the response.
    fn send_once(&self, body: &[u8]) -> AttemptOutcome {
        let endpoint = self.endpoint;
        let stopped = || self.is_ended();
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
        let context = endpoint.fault_context();
        let text = faults::body_text(&received.headers, body);
        let value = text.and_then(|text| serde_json::from_str(&text).ok().or_else(|| stream::joined_stream(&text)));
        let Some(value) = value.filter(|value: &Value| !value.is_null()) else {
            return Err(faults::fault_of_unreadable_body(&received.headers, body, context));
        };
        if value.get("error").is_some_and(|error| !error.is_null()) {
            // A stream may report an error among its events.
            return Err(fault(value.to_string().as_bytes()));
        }
        endpoint.provider.dialect.read_reply(&value).map_err(|missing| match faults::reports_error(&value) {
            true => fault(body),
            false => faults::fault_of_other_json(missing.0, body, context),
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

/// The attempt that follows a fault.
enum NextAttempt {
    /// As often as the settings allow.
    Again(RetryFault),
    /// Once more at most, because a complete answer may have been paid for.
    OnceMore { reason: String, hint: Option<String> },
}

/// The error of a call after its last attempt.
fn give_up(next: NextAttempt, attempt: u32, turn: &FirstCallTurn<'_>) -> CallError {
    let times = if attempt == 1 { "1 attempt".to_owned() } else { format!("{attempt} attempts") };
    match next {
        NextAttempt::Again(retry) => {
            turn.note_loss();
            CallError::Lost(format!("{} ({times})", retry.reason))
        }
        // A service that answers is there, so the call is not lost.
        NextAttempt::OnceMore { reason, hint } => {
            CallError::Failed(with_hint(&format!("{reason} ({times})"), hint.as_deref()))
        }
    }
}

/// A reason with what to do about it, on one line.
fn with_hint(reason: &str, hint: Option<&str>) -> String {
    hint.map_or_else(|| reason.to_owned(), |hint| format!("{reason}; {hint}"))
}

/// Checks that a reply is an answer: not empty, not refused, not blocked.
fn check_reply(reply: &DialectReply, endpoint: &ProviderEndpoint) -> Result<(), RemoteFault> {
    let provider = &endpoint.provider;
    let final_fault = |reason: String| RemoteFault::Final { reason, hint: None, is_refusal: false, maybe_paid: true };
    let once_more = |reason: String| RemoteFault::Unreadable { reason, hint: None, is_page: false };
    match &reply.end {
        ReplyEnd::Filtered(why) => Err(final_fault(format!(
            "the service's filter blocked the answer ({})",
            endpoint.fault_context().safe_text(why)
        ))),
        // A refusal is an answer: the one who asked asks again in other words, or does without.
        ReplyEnd::Refused(_) => Ok(()),
        ReplyEnd::Stop | ReplyEnd::Length | ReplyEnd::Thought if !reply.text.is_empty() => Ok(()),
        ReplyEnd::Thought => Err(once_more(format!(
            "the answer is empty, and all text stands in the field for thoughts: set {} under [providers.{}], or start the server without its reasoning parser",
            provider.dialect.without_thinking(),
            provider.name
        ))),
        ReplyEnd::Stop => Err(once_more("empty answer".to_owned())),
        ReplyEnd::Length => Err(final_fault(format!(
            "the model spent all its tokens on thinking and gave no answer: set {} under [providers.{}]",
            provider.dialect.without_thinking(),
            provider.name
        ))),
    }
}
