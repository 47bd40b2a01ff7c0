//! Limits how many requests are sent to an endpoint, and when.
//!
//! [`RequestGate`] makes all decisions and takes the time as an argument, so that tests need no clock. This module
//! makes threads wait for the decisions.

mod advertised;
mod bucket;
mod gate;
mod pace;

pub(crate) use advertised::AdvertisedLimits;
pub(crate) use gate::{GateTurn, LimiterRules, RequestOutcome};

use gate::{GateTicket, RequestGate};
use std::{
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

/// How often a waiting thread checks whether the run was stopped.
const STOP_CHECK_INTERVAL: Duration = Duration::from_millis(100);

/// Lets threads send requests to one endpoint, one after the other.
pub(crate) struct EndpointLimiter {
    gate: Mutex<RequestGate>,
    /// Signalled when a request has ended.
    request_ended: Condvar,
    /// Locked by the thread that is next. The others wait for this lock, so that not all of them wake up each time.
    turn: Mutex<()>,
}

/// Permission to have one request in flight.
pub(crate) struct RequestPermit<'a> {
    limiter: &'a EndpointLimiter,
    ticket: GateTicket,
    /// How the request ended. A permit that is dropped without it counts as failed.
    outcome: Option<RequestOutcome>,
}

impl EndpointLimiter {
    /// A limiter with these rules.
    pub(crate) fn new(rules: LimiterRules) -> Self {
        Self {
            gate: Mutex::new(RequestGate::new(rules, Instant::now())),
            request_ended: Condvar::new(),
            turn: Mutex::new(()),
        }
    }

    /// Waits until a request of about `tokens` tokens may be sent; `None` if `stopped` returns true first.
    pub(crate) fn wait_for_permit(&self, tokens: u64, stopped: impl Fn() -> bool) -> Option<RequestPermit<'_>> {
        let _first_in_line = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        let mut gate = self.lock_gate();
        loop {
            if stopped() {
                return None;
            }
            let now = Instant::now();
            let wait = match gate.next_turn(now) {
                GateTurn::Now => {
                    let ticket = gate.note_sent(now, tokens);
                    return Some(RequestPermit { limiter: self, ticket, outcome: None });
                }
                GateTurn::In(wait) => wait.min(STOP_CHECK_INTERVAL),
                GateTurn::WhenOneIsBack => STOP_CHECK_INTERVAL,
            };
            gate = self.request_ended.wait_timeout(gate, wait).unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    fn lock_gate(&self) -> MutexGuard<'_, RequestGate> {
        self.gate.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl RequestPermit<'_> {
    /// Notes how the request ended, and wakes the next thread.
    pub(crate) fn end_with(mut self, outcome: RequestOutcome) {
        self.outcome = Some(outcome);
    }

    /// How long the request has been in flight.
    pub(crate) fn latency(&self) -> Duration {
        self.ticket.sent_at.elapsed()
    }

    /// Notes that the request is sent only now: the wait before must not count as the service's latency.
    pub(crate) fn note_late_start(&mut self) {
        self.ticket.sent_at = Instant::now();
    }

    /// Takes over the limits that the service gives.
    pub(crate) fn adopt_limits(&self, advertised: AdvertisedLimits) {
        self.limiter.lock_gate().adopt_limits(advertised, Instant::now());
    }
}

impl Drop for RequestPermit<'_> {
    fn drop(&mut self) {
        let outcome = self.outcome.take().unwrap_or(RequestOutcome::Failed);
        self.limiter.lock_gate().note_ended(self.ticket, Instant::now(), outcome);
        self.limiter.request_ended.notify_one();
    }
}

#[cfg(test)]
mod tests;
