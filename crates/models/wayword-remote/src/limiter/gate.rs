//! Decides when a request may be sent. It has no clock: every function takes the time as an argument.
//!
//! The number of requests in flight follows the rule of TCP (additive increase, multiplicative decrease): it grows slowly
//! while requests are answered, and shrinks by a factor when the service refuses or is slow. On top of it there are the
//! rates that the user or the service sets ([`Bucket`]), and a rate learned from refusals ([`Pace`]).

use super::{advertised::Advertised, bucket::Bucket, pace::Pace};
use crate::{Concurrency, faults::Load};
use std::time::{Duration, Instant};

/// The initial value of an adaptive limit.
const START: f64 = 8.0;

/// The factor that an adaptive limit is multiplied by when the service is overloaded.
const SHRINK: f64 = 0.7;

/// A limit shrinks at most once in this time, or in the usual latency if that is longer.
const SHORTEST_WINDOW: Duration = Duration::from_millis(100);

/// If the share of refusals, or of answers that came too late, is below this, they count as chance and not as a limit:
/// a refusal then delays its own request and no other. Services in trouble refuse at random; without this rule each
/// random refusal would stop all requests for as long as it asks.
const CHANCE: f64 = 0.125;

/// About how many requests a [`Share`] remembers.
const REMEMBERED: f64 = 64.0;

/// The limits that a user sets.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rules {
    pub(crate) concurrency: Concurrency,
    pub(crate) requests_per_minute: Option<f64>,
    pub(crate) tokens_per_minute: Option<f64>,
}

/// When a request may be sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Turn {
    /// Now.
    Now,
    /// Not before this time has passed.
    In(Duration),
    /// Not before another request has ended.
    WhenOneIsBack,
}

/// How a request ended, as far as this matters for the limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// It was answered.
    Answered {
        /// Tokens in and out.
        tokens: u64,
    },
    /// It failed for a reason that has no connection with the service's load.
    Failed,
    /// It took too long, or the service refused it as too much.
    Burdened {
        /// Which of the two.
        load: Load,
        /// How long the service asks the program to wait.
        after: Option<Duration>,
    },
}

/// A request in flight.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ticket {
    pub(super) left_at: Instant,
    /// The same moment by the pace's clock, seconds.
    left_s: f64,
    /// About how many tokens it has.
    tokens: u64,
}

/// One endpoint's limits, and its requests in flight.
#[derive(Debug)]
pub(super) struct Gate {
    rules: Rules,
    /// How many requests in flight the service can take; a fraction, because it grows by less than one at a time. If
    /// the user fixed the number, this value only spaces requests out after a refusal.
    limit: f64,
    out: usize,
    paused_until: Option<Instant>,
    latency: Duration,
    shrunk_at: Option<Instant>,
    /// Whether the service ever refused a request as too much.
    refused: bool,
    /// The shares of requests that were refused as too much, and that were not answered in time.
    over: Share,
    slow: Share,
    /// When a request last had to wait for another one to end.
    crowded_at: Option<Instant>,
    requests: Option<Bucket>,
    tokens: Option<Bucket>,
    pace: Pace,
}

impl Gate {
    pub(super) fn new(rules: Rules, now: Instant) -> Self {
        let bucket = |rate: Option<f64>| rate.map(|rate| Bucket::per_minute(rate, now));
        let limit = match rules.concurrency {
            Concurrency::Fixed(most) => most as f64,
            Concurrency::Adaptive { most } => START.min(most as f64),
        };
        Self {
            limit: limit.max(1.0),
            out: 0,
            paused_until: None,
            latency: Duration::ZERO,
            shrunk_at: None,
            refused: false,
            over: Share::default(),
            slow: Share::default(),
            crowded_at: None,
            requests: bucket(rules.requests_per_minute),
            tokens: bucket(rules.tokens_per_minute),
            pace: Pace::new(now),
            rules,
        }
    }

    /// Whether a request may be sent now, and if not, when to ask again.
    pub(super) fn turn(&mut self, now: Instant) -> Turn {
        let pause = self.paused_until.map_or(Duration::ZERO, |until| until.saturating_duration_since(now));
        self.pace.advance(now, !pause.is_zero());
        if !pause.is_zero() {
            return Turn::In(pause);
        }
        let most = match self.rules.concurrency {
            Concurrency::Fixed(most) => most as f64,
            Concurrency::Adaptive { .. } => self.limit,
        };
        if self.out as f64 + 1.0 > most + 1e-9 {
            self.crowded_at = Some(now);
            return Turn::WhenOneIsBack;
        }
        let requests = self.requests.as_mut().map_or(Duration::ZERO, |bucket| bucket.wait(1.0, now));
        let tokens = self.tokens.as_mut().map_or(Duration::ZERO, |bucket| bucket.wait(1.0, now));
        match requests.max(tokens).max(self.pace.wait(now)) {
            Duration::ZERO => Turn::Now,
            wait => Turn::In(wait),
        }
    }

    /// Notes that a request of about `tokens` tokens is sent.
    pub(super) fn leave(&mut self, now: Instant, tokens: u64) -> Ticket {
        self.out += 1;
        // A service may refuse requests that arrive together, and accept them one by one.
        let spacing = self.refused.then(|| self.latency.div_f64(self.limit));
        let left_s = self.pace.leave(now, spacing);
        if let Some(bucket) = &mut self.requests {
            bucket.take(1.0);
        }
        if let Some(bucket) = &mut self.tokens {
            bucket.take(tokens as f64);
        }
        Ticket { left_at: now, left_s, tokens }
    }

    /// Notes that a request has ended.
    pub(super) fn back(&mut self, ticket: Ticket, now: Instant, outcome: Outcome) {
        self.out = self.out.saturating_sub(1);
        let paused = self.paused_until.is_some_and(|until| until > now);
        self.pace.advance(now, paused);
        let over = self.over.count(matches!(outcome, Outcome::Burdened { load: Load::Over, .. }));
        let slow = self.slow.count(matches!(outcome, Outcome::Burdened { load: Load::Slow, .. }));
        match outcome {
            Outcome::Answered { tokens: used } => {
                self.pace.let_in(ticket.left_s);
                self.answered(ticket.left_at, now);
                if let Some(bucket) = &mut self.tokens {
                    bucket.take(used as f64 - ticket.tokens as f64);
                }
            }
            Outcome::Failed => self.pace.let_in(ticket.left_s),
            Outcome::Burdened { load: Load::Slow, .. } if slow < CHANCE => {}
            Outcome::Burdened { load: Load::Over, .. } if over < CHANCE => {}
            Outcome::Burdened { load, after } => self.burdened(ticket.left_at, now, load, after),
        }
    }

    fn answered(&mut self, left_at: Instant, now: Instant) {
        let latency = now.saturating_duration_since(left_at);
        self.latency = if self.latency.is_zero() { latency } else { (7 * self.latency + latency) / 8 };
        // If the limit was not reached, it is not known whether the service can take more.
        if self.crowded_at.is_some_and(|crowded_at| crowded_at >= left_at) {
            let step = if self.shrunk_at.is_none() { 0.25 } else { 1.0 / self.limit };
            self.limit = (self.limit + step).min(self.rules.concurrency.most() as f64);
        }
    }

    fn burdened(&mut self, left_at: Instant, now: Instant, load: Load, after: Option<Duration>) {
        // Refusals of requests that were in flight together count as one.
        let window = self.latency.max(SHORTEST_WINDOW);
        let first = self.shrunk_at.is_none_or(|shrunk_at| left_at >= shrunk_at && now >= shrunk_at + window);
        // Each refusal changes the limits only once.
        if load == Load::Slow {
            self.slow.settle();
        }
        if load == Load::Over {
            self.over.settle();
            self.refused = true;
            self.pace.refused(first);
            if let Some(until) = after.and_then(|after| now.checked_add(after)) {
                self.paused_until = Some(self.paused_until.map_or(until, |paused| paused.max(until)));
            }
        }
        if first {
            self.limit = (self.limit * SHRINK).max(1.0);
            self.shrunk_at = Some(now);
        }
    }

    /// Takes the service's limits, where they are lower than the user's.
    pub(super) fn learn(&mut self, advertised: Advertised, now: Instant) {
        let smaller = |own: Option<f64>, told: f64| own.map_or(told, |own| own.min(told));
        if let Some(told) = advertised.requests_per_minute {
            set(&mut self.requests, smaller(self.rules.requests_per_minute, told), now);
        }
        if let Some(told) = advertised.tokens_per_minute {
            set(&mut self.tokens, smaller(self.rules.tokens_per_minute, told), now);
        }
    }
}

/// A share among the latest requests, in which older ones count less and less.
#[derive(Debug, Default)]
pub(super) struct Share {
    met: f64,
    all: f64,
}

impl Share {
    /// Counts a request, and returns the new share.
    pub(super) fn count(&mut self, met: bool) -> f64 {
        let kept = 1.0 - 1.0 / REMEMBERED;
        self.met = self.met * kept + f64::from(u8::from(met));
        self.all = self.all * kept + 1.0;
        self.met / self.all
    }

    /// Forgets the cases so far.
    pub(super) fn settle(&mut self) {
        self.met = 0.0;
    }
}

#[cfg(test)]
impl Gate {
    pub(super) fn limit(&self) -> f64 {
        self.limit
    }
}

fn set(bucket: &mut Option<Bucket>, per_minute: f64, now: Instant) {
    match bucket {
        Some(bucket) => bucket.set_per_minute(per_minute, now),
        None => *bucket = Some(Bucket::per_minute(per_minute, now)),
    }
}
