//! Decides when a request may be sent. It has no clock: every function takes the time as an argument.
//!
//! The number of requests in flight follows the rule of TCP (additive increase, multiplicative decrease): it grows
//! slowly while requests are answered, and shrinks by a factor when the service refuses or is slow. On top of it there
//! are the rates that the user or the service sets ([`RateBucket`]), and a rate learned from refusals
//! ([`SendingPace`]).

use super::{advertised::AdvertisedLimits, bucket::RateBucket, pace::SendingPace};
use crate::{RequestConcurrency, faults::ServiceLoad};
use std::time::{Duration, Instant};

/// The initial value of an adaptive limit, requests in flight.
const INITIAL_ADAPTIVE_LIMIT: f64 = 8.0;

/// The factor that an adaptive limit is multiplied by when the service is overloaded.
const SHRINK_FACTOR: f64 = 0.7;

/// A limit shrinks at most once in this time, or in the usual latency if that is longer.
const MIN_SHRINK_INTERVAL: Duration = Duration::from_millis(100);

/// If the share of refusals, or of answers that came too late, is below this, they count as chance and not as a limit:
/// a refusal then delays its own request and no other. Services in trouble refuse at random; without this rule each
/// random refusal would stop all requests for as long as it asks.
const CHANCE_SHARE: f64 = 0.125;

/// About how many requests a [`RecentShare`] remembers.
const SHARE_MEMORY_REQUESTS: f64 = 64.0;

/// The limits that a user sets.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LimiterRules {
    pub(crate) concurrency: RequestConcurrency,
    pub(crate) requests_per_minute: Option<f64>,
    pub(crate) tokens_per_minute: Option<f64>,
}

/// When a request may be sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum GateTurn {
    /// Now.
    Now,
    /// Not before this time has passed.
    In(Duration),
    /// Not before another request has ended.
    WhenOneIsBack,
}

/// How a request ended, as far as this matters for the limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RequestOutcome {
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
        load: ServiceLoad,
        /// How long the service asks the program to wait.
        after: Option<Duration>,
    },
}

/// A request in flight.
#[derive(Debug, Clone, Copy)]
pub(super) struct GateTicket {
    /// When the request was sent.
    pub(super) sent_at: Instant,
    /// The same moment by the pace's clock, seconds.
    sent_s: f64,
    /// About how many tokens it has.
    tokens: u64,
}

/// One endpoint's limits, and its requests in flight.
#[derive(Debug)]
pub(super) struct RequestGate {
    rules: LimiterRules,
    /// How many requests in flight the service can take; a fraction, because it grows by less than one at a time. If
    /// the user fixed the number, this value only spaces requests out after a refusal.
    limit: f64,
    /// How many requests are in flight.
    in_flight: usize,
    /// The end of the pause that the service asked for.
    paused_until: Option<Instant>,
    /// The usual time until an answer: a mean in which older answers count less and less.
    latency: Duration,
    /// When the limit last shrank.
    shrunk_at: Option<Instant>,
    /// Whether the service ever refused a request as too much.
    refused: bool,
    /// The shares of requests that were refused as too much, and that were not answered in time.
    over: RecentShare,
    slow: RecentShare,
    /// When a request last had to wait for another one to end.
    crowded_at: Option<Instant>,
    /// The rates of requests and tokens that the user or the service sets.
    requests: Option<RateBucket>,
    tokens: Option<RateBucket>,
    pace: SendingPace,
}

impl RequestGate {
    pub(super) fn new(rules: LimiterRules, now: Instant) -> Self {
        let bucket = |rate: Option<f64>| rate.map(|rate| RateBucket::per_minute(rate, now));
        let limit = match rules.concurrency {
            RequestConcurrency::Fixed(most) => most as f64,
            RequestConcurrency::Adaptive { most } => INITIAL_ADAPTIVE_LIMIT.min(most as f64),
        };
        Self {
            limit: limit.max(1.0),
            in_flight: 0,
            paused_until: None,
            latency: Duration::ZERO,
            shrunk_at: None,
            refused: false,
            over: RecentShare::default(),
            slow: RecentShare::default(),
            crowded_at: None,
            requests: bucket(rules.requests_per_minute),
            tokens: bucket(rules.tokens_per_minute),
            pace: SendingPace::new(now),
            rules,
        }
    }

    /// Whether a request may be sent now, and if not, when to ask again.
    pub(super) fn next_turn(&mut self, now: Instant) -> GateTurn {
        let pause = self.paused_until.map_or(Duration::ZERO, |until| until.saturating_duration_since(now));
        self.pace.advance_clock(now, !pause.is_zero());
        if !pause.is_zero() {
            return GateTurn::In(pause);
        }
        let max_in_flight = match self.rules.concurrency {
            RequestConcurrency::Fixed(max_in_flight) => max_in_flight as f64,
            RequestConcurrency::Adaptive { .. } => self.limit,
        };
        if self.in_flight as f64 + 1.0 > max_in_flight + 1e-9 {
            self.crowded_at = Some(now);
            return GateTurn::WhenOneIsBack;
        }
        let requests = self.requests.as_mut().map_or(Duration::ZERO, |bucket| bucket.wait_for(1.0, now));
        let tokens = self.tokens.as_mut().map_or(Duration::ZERO, |bucket| bucket.wait_for(1.0, now));
        match requests.max(tokens).max(self.pace.wait_time(now)) {
            Duration::ZERO => GateTurn::Now,
            wait => GateTurn::In(wait),
        }
    }

    /// Notes that a request of about `tokens` tokens is sent.
    pub(super) fn note_sent(&mut self, now: Instant, tokens: u64) -> GateTicket {
        self.in_flight += 1;
        // A service may refuse requests that arrive together, and accept them one by one.
        let spacing = self.refused.then(|| self.latency.div_f64(self.limit));
        let left_s = self.pace.note_sent(now, spacing);
        if let Some(bucket) = &mut self.requests {
            bucket.take_amount(1.0);
        }
        if let Some(bucket) = &mut self.tokens {
            bucket.take_amount(tokens as f64);
        }
        GateTicket { sent_at: now, sent_s: left_s, tokens }
    }

    /// Notes that a request has ended.
    pub(super) fn note_ended(&mut self, ticket: GateTicket, now: Instant, outcome: RequestOutcome) {
        self.in_flight = self.in_flight.saturating_sub(1);
        let paused = self.paused_until.is_some_and(|until| until > now);
        self.pace.advance_clock(now, paused);
        let over = self.over.count_request(matches!(outcome, RequestOutcome::Burdened { load: ServiceLoad::Over, .. }));
        let slow = self.slow.count_request(matches!(outcome, RequestOutcome::Burdened { load: ServiceLoad::Slow, .. }));
        match outcome {
            RequestOutcome::Answered { tokens: used } => {
                self.pace.note_accepted(ticket.sent_s);
                self.note_answer(ticket.sent_at, now);
                if let Some(bucket) = &mut self.tokens {
                    bucket.take_amount(used as f64 - ticket.tokens as f64);
                }
            }
            RequestOutcome::Failed => self.pace.note_accepted(ticket.sent_s),
            RequestOutcome::Burdened { load: ServiceLoad::Slow, .. } if slow < CHANCE_SHARE => {}
            RequestOutcome::Burdened { load: ServiceLoad::Over, .. } if over < CHANCE_SHARE => {}
            RequestOutcome::Burdened { load, after } => self.note_burden(ticket.sent_at, now, load, after),
        }
    }

    /// Learns from an answer: updates the latency, and raises the limit if it was reached.
    fn note_answer(&mut self, left_at: Instant, now: Instant) {
        let latency = now.saturating_duration_since(left_at);
        self.latency = if self.latency.is_zero() { latency } else { (7 * self.latency + latency) / 8 };
        // If the limit was not reached, it is not known whether the service can take more.
        if self.crowded_at.is_some_and(|crowded_at| crowded_at >= left_at) {
            // Until the first refusal the limit grows quickly, then by about one for each round of requests.
            let step = if self.shrunk_at.is_none() { 0.25 } else { 1.0 / self.limit };
            self.limit = (self.limit + step).min(self.rules.concurrency.max_in_flight() as f64);
        }
    }

    /// Learns from a refusal or an answer that came too late: lowers the limit, and pauses if the service asks for it.
    fn note_burden(&mut self, left_at: Instant, now: Instant, load: ServiceLoad, after: Option<Duration>) {
        // Refusals of requests that were in flight together count as one.
        let window = self.latency.max(MIN_SHRINK_INTERVAL);
        let is_first = self.shrunk_at.is_none_or(|shrunk_at| left_at >= shrunk_at && now >= shrunk_at + window);
        // The cases so far are forgotten, so that each refusal changes the limits only once.
        if load == ServiceLoad::Slow {
            self.slow.forget_cases();
        }
        if load == ServiceLoad::Over {
            self.over.forget_cases();
            self.refused = true;
            self.pace.note_refusal(is_first);
            if let Some(until) = after.and_then(|after| now.checked_add(after)) {
                self.paused_until = Some(self.paused_until.map_or(until, |paused| paused.max(until)));
            }
        }
        if is_first {
            self.limit = (self.limit * SHRINK_FACTOR).max(1.0);
            self.shrunk_at = Some(now);
        }
    }

    /// Takes the service's limits, where they are lower than the user's.
    pub(super) fn adopt_limits(&mut self, advertised: AdvertisedLimits, now: Instant) {
        let smaller = |user: Option<f64>, service: f64| user.map_or(service, |user| user.min(service));
        if let Some(rate) = advertised.requests_per_minute {
            set_bucket_rate(&mut self.requests, smaller(self.rules.requests_per_minute, rate), now);
        }
        if let Some(rate) = advertised.tokens_per_minute {
            set_bucket_rate(&mut self.tokens, smaller(self.rules.tokens_per_minute, rate), now);
        }
    }
}

/// The share of some case, such as a refusal, among the latest requests. Older requests count less and less.
#[derive(Debug, Default)]
pub(super) struct RecentShare {
    /// The weights of the requests that are such a case, and of all requests.
    case_weight: f64,
    total_weight: f64,
}

impl RecentShare {
    /// Counts a request, and returns the new share.
    pub(super) fn count_request(&mut self, met: bool) -> f64 {
        let kept = 1.0 - 1.0 / SHARE_MEMORY_REQUESTS;
        self.case_weight = self.case_weight * kept + f64::from(u8::from(met));
        self.total_weight = self.total_weight * kept + 1.0;
        self.case_weight / self.total_weight
    }

    /// Forgets the cases so far.
    pub(super) fn forget_cases(&mut self) {
        self.case_weight = 0.0;
    }
}

#[cfg(test)]
impl RequestGate {
    pub(super) fn limit(&self) -> f64 {
        self.limit
    }
}

/// Changes the rate of a bucket, which is made if there is none.
fn set_bucket_rate(bucket: &mut Option<RateBucket>, per_minute: f64, now: Instant) {
    match bucket {
        Some(bucket) => bucket.set_per_minute(per_minute, now),
        None => *bucket = Some(RateBucket::per_minute(per_minute, now)),
    }
}
