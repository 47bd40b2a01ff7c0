//! Limits how many requests are sent to an endpoint, and when.
//!
//! [`Gate`] makes all decisions and takes the time as an argument, so that tests need no clock. This module makes threads
//! wait for its decisions.

mod advertised;
mod bucket;
mod gate;
mod pace;

pub(crate) use advertised::Advertised;
pub(crate) use gate::{Outcome, Rules, Turn};

use gate::{Gate, Ticket};
use std::{
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

/// How often a waiting thread checks whether the run was stopped.
const LOOK_UP: Duration = Duration::from_millis(100);

/// Lets threads send requests to one endpoint, one after the other.
pub(crate) struct Limiter {
    gate: Mutex<Gate>,
    /// Signalled when a request has ended.
    back: Condvar,
    /// Locked by the thread that is next. The others wait for this lock, so that not all of them wake up each time.
    next: Mutex<()>,
}

/// Permission to have one request in flight.
pub(crate) struct Permit<'a> {
    limiter: &'a Limiter,
    ticket: Ticket,
    outcome: Option<Outcome>,
}

impl Limiter {
    /// A limiter with these rules.
    pub(crate) fn new(rules: Rules) -> Self {
        Self { gate: Mutex::new(Gate::new(rules, Instant::now())), back: Condvar::new(), next: Mutex::new(()) }
    }

    /// Waits until a request of about `tokens` tokens may be sent; `None` if `stopped` returns true first.
    pub(crate) fn enter(&self, tokens: u64, stopped: impl Fn() -> bool) -> Option<Permit<'_>> {
        let _first_in_line = self.next.lock().unwrap_or_else(PoisonError::into_inner);
        let mut gate = self.gate();
        loop {
            if stopped() {
                return None;
            }
            let now = Instant::now();
            let wait = match gate.turn(now) {
                Turn::Now => {
                    let ticket = gate.leave(now, tokens);
                    return Some(Permit { limiter: self, ticket, outcome: None });
                }
                Turn::In(wait) => wait.min(LOOK_UP),
                Turn::WhenOneIsBack => LOOK_UP,
            };
            gate = self.back.wait_timeout(gate, wait).unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    fn gate(&self) -> MutexGuard<'_, Gate> {
        self.gate.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Permit<'_> {
    /// Notes how the request ended, and wakes the next thread.
    pub(crate) fn done(mut self, outcome: Outcome) {
        self.outcome = Some(outcome);
    }

    /// How long the request has been in flight.
    pub(crate) fn latency(&self) -> Duration {
        self.ticket.left_at.elapsed()
    }

    /// Notes that the request is sent only now: the wait before must not count as the service's latency.
    pub(crate) fn leaves(&mut self) {
        self.ticket.left_at = Instant::now();
    }

    /// Takes over the limits that the service gives.
    pub(crate) fn learn(&self, advertised: Advertised) {
        self.limiter.gate().learn(advertised, Instant::now());
    }
}

impl Drop for Permit<'_> {
    fn drop(&mut self) {
        let outcome = self.outcome.take().unwrap_or(Outcome::Failed);
        self.limiter.gate().back(self.ticket, Instant::now(), outcome);
        self.limiter.back.notify_one();
    }
}

#[cfg(test)]
mod tests;
