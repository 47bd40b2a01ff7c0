//! A run's use of the ledger. [`LedgerRun::answer_once`] answers a call from the ledger, or makes it, at most once over all threads
//! and programs.

use crate::{
    CallAnswer, CallContext, CallKey, LedgerEntry, LedgerError, ModelCall, RequestRefusedError, RunLimits, RunStopper,
    budget::{RunBudget, SpentBudget, valid_amount},
    claim::{ABANDONED_CLAIM_TIMEOUT, CallClaim, ClaimOutcome},
    ledger::{Ledger, now_unix_s},
    rate::{ProviderRates, wait_until},
    span::CallSpan,
    spending::LedgerFilter,
    store::{PendingRequest, RequestEnd, SentRequest},
};
use std::{
    io::Write,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
    time::Instant,
};

/// How many turns in a row a request may miss, because the database answered after the turn was over. If it misses more, the
/// database is too slow for a common rate.
const MAX_MISSED_TURNS: usize = 100;

/// A run's use of a ledger: its limits, its spending, and whether it was stopped. Clones share one run.
#[derive(Debug, Clone)]
pub struct LedgerRun {
    ledger: Ledger,
    state: Arc<RunState>,
}

#[derive(Debug)]
struct RunState {
    id: String,
    limits: RunLimits,
    /// Checks the limits in this process. It has none if the store checks them, for all processes of the run together.
    budget: RunBudget,
    stopper: RunStopper,
    totals: Mutex<RunTotals>,
}

/// The requests and the spending of a run in this process.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct RunTotals {
    /// Requests that were sent.
    pub calls: u64,
    /// Calls that the ledger answered.
    pub hits: u64,
    /// Calls that were answered by a request.
    pub answered: u64,
    /// Requests that brought no answer.
    pub failed: u64,
    /// Failed requests that may have been paid for.
    pub lost: u64,
    /// Tokens of the requests that were answered.
    pub tokens_in: u64,
    /// Tokens of the answers.
    pub tokens_out: u64,
    /// What the answers cost, US dollars, where the price is known.
    pub usd: f64,
    /// What the lost requests may have cost at most, US dollars.
    pub maybe_usd: f64,
}

/// The attempts to get an answer to one call. Each attempt is a request, which has to be announced with
/// [`CallAttempts::begin_request`] before it is sent.
pub struct CallAttempts<'a> {
    run: &'a LedgerRun,
    key: &'a CallKey,
    span: &'a CallSpan,
    /// The request in flight.
    open: Option<SentRequest>,
    /// How many requests were sent.
    sent: u32,
    /// The kind of failure that the span reports if the call fails.
    failure: &'static str,
}

/// A call was not answered.
#[derive(Debug, thiserror::Error)]
pub enum OnceError<E> {
    /// The call failed.
    #[error(transparent)]
    Call(E),
    /// The call may not be made.
    #[error(transparent)]
    Refused(RequestRefusedError),
    /// The call is not in the recording from which all answers have to come.
    #[error("{}: this file of recorded calls has no call to {model} with these words: {words:?}\nhint: record the calls again with --record, with the same settings", recording.display())]
    NotRecorded {
        /// The recording.
        recording: PathBuf,
        /// The model of the missing call.
        model: String,
        /// The beginning of the call's last message.
        words: String,
    },
    /// The ledger could not be read or written.
    #[error(transparent)]
    Ledger(#[from] LedgerError),
}

impl Ledger {
    /// Starts or continues a run by its name. The spending of its earlier processes counts towards the limits.
    ///
    /// # Errors
    /// When the ledger cannot be read.
    pub fn start_run(&self, id: &str, limits: RunLimits) -> Result<LedgerRun, LedgerError> {
        let (process_limits, spent) = match self.store().keeps_budget() {
            true => (RunLimits::default(), SpentBudget::default()),
            false => (limits, self.store().spent_budget(id)?),
        };
        let state = RunState {
            id: id.to_owned(),
            limits,
            budget: RunBudget::new(process_limits, spent),
            stopper: RunStopper::default(),
            totals: Mutex::default(),
        };
        Ok(LedgerRun { ledger: self.clone(), state: Arc::new(state) })
    }
}

impl LedgerRun {
    /// The answer of a call. If the ledger has it, returns that. If another thread or program is making the call, waits
    /// for it. Otherwise `send` makes the call, and its answer is on disk before it is returned. If another program was
    /// faster after all, returns that program's answer, so that every caller gets the same one.
    ///
    /// # Errors
    /// When `send` fails, a limit would be exceeded, the run is stopped while it waits, the answer was changed after it
    /// was written, or the ledger cannot be used.
    pub fn answer_once<E>(
        &self,
        call: &ModelCall,
        send: impl FnOnce(&mut CallAttempts<'_>) -> Result<CallAnswer, E>,
    ) -> Result<CallAnswer, OnceError<E>> {
        let span = CallSpan::begin_call(call);
        let outcome = self.answer_within_span(&span, call, send);
        match &outcome {
            Ok(answer) => CallContext::count_answer(answer),
            Err(OnceError::Call(_)) => {}
            Err(OnceError::Refused(_)) => span.record_error("refused"),
            Err(OnceError::NotRecorded { .. }) => span.record_error("not_recorded"),
            Err(OnceError::Ledger(_)) => span.record_error("ledger"),
        }
        outcome
    }

    /// Does the work of [`LedgerRun::answer_once`] and reports to its span. The loop begins anew after each wait for another thread or
    /// program, and normally finds the answer then.
    fn answer_within_span<E>(
        &self,
        span: &CallSpan,
        call: &ModelCall,
        send: impl FnOnce(&mut CallAttempts<'_>) -> Result<CallAnswer, E>,
    ) -> Result<CallAnswer, OnceError<E>> {
        let key = call.key();
        loop {
            if let Some(answer) = self.stored_answer(&key, span)? {
                return Ok(answer);
            }
            let Some(_flight) = self.ledger.flights().take_off(&key) else { continue };
            // Another thread may have finished the call between the first look and taking the flight.
            if let Some(answer) = self.stored_answer(&key, span)? {
                return Ok(answer);
            }
            if let Some(recording) = self.ledger.recording() {
                return Err(not_recorded_error(recording, call));
            }
            let mut claim = match CallClaim::take_claim(self.ledger.store(), &key, ABANDONED_CLAIM_TIMEOUT, || {
                self.is_stopped()
            })? {
                ClaimOutcome::Ours(claim) => claim,
                ClaimOutcome::Answered => continue,
                ClaimOutcome::Stopped => return Err(OnceError::Refused(RequestRefusedError::Stopped)),
            };
            let mut attempts = CallAttempts { run: self, key: &key, span, open: None, sent: 0, failure: "failed" };
            return match send(&mut attempts) {
                Ok(answer) => {
                    let stored = attempts.store_answer(call, answer)?;
                    claim.mark_fulfilled();
                    Ok(stored)
                }
                Err(error) => {
                    attempts.mark_failed("given up", true);
                    attempts.record_failure();
                    Err(OnceError::Call(error))
                }
            };
        }
    }

    /// The answer that the ledger already has.
    fn stored_answer(&self, key: &CallKey, span: &CallSpan) -> Result<Option<CallAnswer>, LedgerError> {
        let answer = self.ledger.store().find_answer(key, &self.state.id)?;
        if answer.is_some() {
            span.record_ledger_hit();
            self.update_totals(|totals| totals.hits += 1);
        }
        Ok(answer)
    }

    /// Stops the run: it sends no more requests. Requests in flight are finished and kept.
    pub fn stop(&self) {
        self.state.stopper.stop();
    }

    /// Whether [`LedgerRun::stop`] was called.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.state.stopper.is_stopped()
    }

    /// A handle that stops the run and does not keep the ledger open.
    #[must_use]
    pub fn stopper(&self) -> RunStopper {
        self.state.stopper.clone()
    }

    /// The requests and the spending of the run in this process.
    #[must_use]
    pub fn totals(&self) -> RunTotals {
        *self.state.totals.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes every call that this run has used to `out`, as [`Ledger::export_calls`] does. Returns how many.
    ///
    /// # Errors
    /// When the ledger cannot be read or the file cannot be written.
    pub fn record_calls(&self, place: &Path, out: impl Write) -> Result<usize, LedgerError> {
        let filter = LedgerFilter { run: Some(self.state.id.clone()), ..LedgerFilter::default() };
        self.ledger.export_calls(&filter, place, out)
    }

    /// Whether the ledger keeps rates for all programs together, see [`LedgerRun::wait_turn`].
    #[must_use]
    pub fn shares_rates(&self) -> bool {
        self.ledger.store().shares_rates()
    }

    /// Waits until a request of about so many tokens may be sent to a provider, if the ledger keeps rates for all
    /// programs together; otherwise returns at once. Returns false if `stopped` became true first.
    ///
    /// Requests leave in the order in which they asked. In any second, at most a tenth more than the rate leave, or one more where a
    /// tenth is less than one. A request that comes too late for its turn gives it up and takes another.
    ///
    /// # Errors
    /// When the ledger cannot be used, or answers too slowly.
    pub fn wait_turn(
        &self,
        provider: &str,
        rates: ProviderRates,
        tokens: u64,
        stopped: impl Fn() -> bool,
    ) -> Result<bool, LedgerError> {
        let store = self.ledger.store();
        for _ in 0..MAX_MISSED_TURNS {
            if stopped() {
                return Ok(false);
            }
            let Some(slot) = store.next_slot(provider, rates, tokens)? else { return Ok(true) };
            if !wait_until(slot.from, &stopped) {
                return Ok(false);
            }
            if Instant::now() <= slot.until {
                return Ok(true);
            }
        }
        Err(LedgerError::Slow { place: store.ledger_location() })
    }

    fn update_totals(&self, change: impl FnOnce(&mut RunTotals)) {
        change(&mut self.state.totals.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

impl CallAttempts<'_> {
    /// Call this before each request, with the most that the request may cost, US dollars. When it returns, the ledger
    /// has the request on disk.
    ///
    /// # Errors
    /// When the request may not be sent: the run was stopped, a limit would be exceeded, or the ledger cannot be
    /// written.
    pub fn begin_request(&mut self, most_usd: Option<f64>) -> Result<(), RequestRefusedError> {
        // If the caller did not report how the request before ended, it may have been paid for.
        self.mark_failed("followed by another", true);
        self.reserve_request(most_usd).inspect_err(|_| self.failure = "refused")
    }

    /// Reserves the money of a request, and writes the request down.
    fn reserve_request(&mut self, most_usd: Option<f64>) -> Result<(), RequestRefusedError> {
        if self.run.is_stopped() {
            return Err(RequestRefusedError::Stopped);
        }
        let most_usd = valid_amount(most_usd);
        self.run.state.budget.reserve_money(most_usd)?;
        match self.write_request_down(most_usd) {
            Ok(number) => {
                self.open = Some(SentRequest { number, most_usd });
                self.sent += 1;
                self.run.update_totals(|totals| totals.calls += 1);
                Ok(())
            }
            Err(refused) => {
                self.run.state.budget.cancel_reservation(most_usd);
                Err(refused)
            }
        }
    }

    /// Writes a request down in the ledger, and returns its number there.
    fn write_request_down(&self, most_usd: Option<f64>) -> Result<i64, RequestRefusedError> {
        let RunState { id, limits, .. } = &*self.run.state;
        let request = PendingRequest { run: id, key: self.key, most_usd, at_unix_s: now_unix_s(), limits: *limits };
        self.run.ledger.store().write_request(&request)
    }

    /// Reports that the request was not sent after all.
    pub fn mark_cancelled(&mut self) {
        let Some(sent) = self.open.take() else { return };
        self.sent = self.sent.saturating_sub(1);
        self.run.state.budget.cancel_reservation(sent.most_usd);
        self.run.update_totals(|totals| totals.calls -= 1);
        self.run.ledger.store().write_end(&sent, RequestEnd::Cancelled, "");
    }

    /// Reports that the request brought no answer. If it may have been paid for, its upper bound counts as spent.
    pub fn mark_failed(&mut self, reason: &str, maybe_paid: bool) {
        let Some(sent) = self.open.take() else { return };
        let lost_usd = if maybe_paid { sent.most_usd.unwrap_or(0.0) } else { 0.0 };
        self.run.state.budget.settle_reservation(sent.most_usd, lost_usd);
        self.run.update_totals(|totals| {
            totals.failed += 1;
            totals.lost += u64::from(maybe_paid);
            totals.maybe_usd += lost_usd;
        });
        self.run.ledger.store().write_end(
            &sent,
            if maybe_paid { RequestEnd::Lost } else { RequestEnd::Failed },
            reason,
        );
    }

    /// Sets the kind of failure that the call's span reports if the call fails: one word, without any text from a service.
    pub fn set_failure_kind(&mut self, kind: &'static str) {
        self.failure = kind;
    }

    /// Records in the span that the call has failed.
    fn record_failure(&self) {
        self.span.record_attempts(self.sent);
        self.span.record_error(self.failure);
    }

    /// Stores an answer. Returns the one that is kept: an answer that another program stored first, or this one.
    fn store_answer(&mut self, call: &ModelCall, answer: CallAnswer) -> Result<CallAnswer, LedgerError> {
        let open = self.open.take();
        let most_usd = open.and_then(|sent| sent.most_usd);
        let answer = CallAnswer { usd: valid_amount(answer.usd), ..answer };
        self.run.state.budget.settle_reservation(most_usd, answer.usd.or(most_usd).unwrap_or(0.0));
        let row = LedgerEntry {
            key: self.key.clone(),
            call: call.clone(),
            answer: answer.clone(),
            at_unix_s: now_unix_s(),
            run: self.run.state.id.clone(),
        };
        let store = self.run.ledger.store();
        let is_first = store.write_answer(open.as_ref(), row)?;
        self.span.record_attempts(self.sent);
        self.span.record_answer(&answer);
        self.run.update_totals(|totals| {
            totals.answered += 1;
            totals.tokens_in = totals.tokens_in.saturating_add(answer.tokens_in);
            totals.tokens_out = totals.tokens_out.saturating_add(answer.tokens_out);
            totals.usd += answer.usd.unwrap_or(0.0);
        });
        let earlier = if is_first { None } else { store.find_answer(self.key, &self.run.state.id)? };
        Ok(earlier.unwrap_or(answer))
    }
}

/// How many characters of a request an error quotes. The rest is cut off.
const QUOTED_CHARS: usize = 200;

/// The error of a replay that needs a call which the recording does not have.
fn not_recorded_error<E>(recording: &Path, call: &ModelCall) -> OnceError<E> {
    let words = call.request.get("messages").and_then(|messages| messages.as_array()?.last()?.get("text")?.as_str());
    OnceError::NotRecorded {
        recording: recording.to_owned(),
        model: call.model.clone(),
        words: words.unwrap_or_default().chars().take(QUOTED_CHARS).collect(),
    }
}
