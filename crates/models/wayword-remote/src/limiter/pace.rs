//! Learns the rate limit of a service that refuses requests above it and does not advertise it.
//!
//! At a refusal, the rate of the requests that were accepted lately is close to the limit. The pace is set a little
//! below it, grows again carefully, and stays near the limit once two refusals came at about the same rate.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

/// The rate of accepted requests is measured over this time, seconds.
const LOOK_BACK_S: f64 = 3.0;

/// Fewest accepted requests from which a rate is measured.
const MIN_MEASURED_REQUESTS: usize = 16;

/// Most accepted requests that are remembered. The oldest is forgotten.
const MAX_REMEMBERED_REQUESTS: usize = 4096;

/// Shortest time over which a rate is measured, seconds. A shorter time may show only a burst that the service accepts.
const MIN_MEASURED_SPAN_S: f64 = 0.8;

/// After a refusal, the pace is this share of the accepted rate.
const CAUTION_SHARE: f64 = 0.98;

/// If a refusal follows another one within this time, the pace is still far too high, seconds.
const SOON_AFTER_REFUSAL_S: f64 = 3.0;

/// A pace that was refused only once grows by this share of itself per second, by twice the share one second after the
/// refusal, by three times the share after two seconds, and so on, until it is refused at about the same rate again.
const SEARCH_PER_S: f64 = 0.03;

/// A pace that was refused twice at about the same rate quickly approaches this share of the refused pace.
const NEAR_SHARE: f64 = 0.98;

/// Above [`NEAR_SHARE`] of the refused pace, the pace grows by this share per second at first, and twice as fast after
/// each [`CALM_S`] without a refusal, so that it notices when the service allows more again.
const PROBE_PER_S: f64 = 0.001;

/// The time without a refusal after which the growth by [`PROBE_PER_S`] doubles, seconds.
const CALM_S: f64 = 10.0;

/// A pace above this many times the accepted rate did not limit the requests, so it was never tried.
const TRIED_RATE_FACTOR: f64 = 2.0;

/// The highest pace, requests per second.
const MAX_PACE_PER_S: f64 = 1e5;

/// A learned pace.
#[derive(Debug)]
pub(super) struct SendingPace {
    /// When the accepted requests were sent, by a clock that stops in pauses, seconds.
    accepted_s: VecDeque<f64>,
    /// The time by the clock that stops in pauses, seconds.
    active_s: f64,
    /// When that clock was last advanced.
    advanced_at: Instant,
    learned: Option<LearnedRate>,
    /// When the next request may be sent, if they are spaced out.
    next: Option<Instant>,
}

/// The pace that follows from the refusals so far.
#[derive(Debug)]
struct LearnedRate {
    /// The pace, requests per second.
    per_s: f64,
    /// The pace that was refused.
    refused_per_s: f64,
    /// When that was, by the clock that stops in pauses, seconds.
    refused_s: f64,
    /// Whether it was refused at about the same rate before.
    confirmed: bool,
}

impl SendingPace {
    pub(super) fn new(now: Instant) -> Self {
        Self { accepted_s: VecDeque::new(), active_s: 0.0, advanced_at: now, learned: None, next: None }
    }

    /// Advances the clock that stops in pauses, and increases the learned pace.
    pub(super) fn advance_clock(&mut self, now: Instant, paused: bool) {
        let passed_s = now.saturating_duration_since(self.advanced_at).as_secs_f64();
        self.advanced_at = self.advanced_at.max(now);
        if paused {
            return;
        }
        // Time without requests shows nothing about the service, so a gap counts as one second at most.
        let passed_s = passed_s.min(1.0);
        self.active_s += passed_s;
        if let Some(learned) = &mut self.learned {
            learned.grow_rate(passed_s, self.active_s);
            learned.per_s = learned.per_s.min(MAX_PACE_PER_S);
        }
    }

    /// How long until the next request may be sent.
    pub(super) fn wait_time(&self, now: Instant) -> Duration {
        self.next.map_or(Duration::ZERO, |next| next.saturating_duration_since(now))
    }

    /// Notes that a request is sent. If no pace is learned, the next one is `spacing` later. Returns the time by the
    /// clock that stops in pauses, seconds.
    pub(super) fn note_sent(&mut self, now: Instant, spacing: Option<Duration>) -> f64 {
        let learned = self.learned.as_ref().map(|learned| Duration::from_secs_f64(1.0 / learned.per_s));
        self.next = learned.or(spacing).map(|interval| {
            // If a thread wakes up a little late, the pace does not drop.
            let slack = interval / 4 + Duration::from_millis(1);
            let earliest = now.checked_sub(slack).unwrap_or(now);
            self.next.map_or(earliest, |next| next.max(earliest)) + interval
        });
        self.active_s
    }

    /// Notes that the service accepted a request that was sent at `left_s`, whatever its result.
    pub(super) fn note_accepted(&mut self, left_s: f64) {
        if self.accepted_s.len() >= MAX_REMEMBERED_REQUESTS {
            self.accepted_s.pop_front();
        }
        self.accepted_s.push_back(left_s);
    }

    /// Notes that a request was refused as too much. `first` is false if another request in flight at the same time was
    /// refused before.
    pub(super) fn note_refusal(&mut self, first: bool) {
        let let_in_per_s = if first { self.accepted_per_s() } else { None };
        let Some(let_in_per_s) = let_in_per_s else { return };
        let careful = let_in_per_s * CAUTION_SHARE;
        // A pace far above the rate of requests was never tried, so it is no evidence of the limit.
        let old = self.learned.as_ref().filter(|old| old.per_s < let_in_per_s * TRIED_RATE_FACTOR);
        let (per_s, refused_per_s, confirmed) = match old {
            None => (careful, let_in_per_s, false),
            Some(old) => {
                // The last refusal was a moment ago, so the pace is still far too high.
                let is_soon = self.active_s - old.refused_s < SOON_AFTER_REFUSAL_S;
                // The pace is near the one that was refused last.
                let is_close = (0.87..1.15).contains(&(old.per_s / old.refused_per_s));
                // A single refusal among many accepted requests is not a new limit, so the step down is bounded.
                let lowest = old.per_s * if is_soon || !old.confirmed { 0.6 } else { 0.8 };
                // The limit lies between the accepted and the refused rate. Right after a refusal, the accepted rate is
                // lower than it could be.
                let refused_per_s =
                    if is_close && !is_soon { let_in_per_s.clamp(old.per_s * 0.85, old.per_s) } else { old.per_s };
                (careful.clamp(lowest, old.per_s * 0.98), refused_per_s, is_close)
            }
        };
        let refused_s = self.active_s;
        self.learned =
            Some(LearnedRate { per_s: per_s.clamp(0.05, MAX_PACE_PER_S), refused_per_s, refused_s, confirmed });
    }

    /// The rate of the requests that were accepted lately, if there were enough.
    fn accepted_per_s(&self) -> Option<f64> {
        let mut sent: Vec<f64> = self.accepted_s.iter().copied().collect();
        sent.sort_by(f64::total_cmp);
        let newest = *sent.last()?;
        let recent = sent.iter().rev().take_while(|&&at| at >= newest - LOOK_BACK_S).count();
        // For a slow service, a longer time is used, so that there are enough requests.
        let count = recent.max(sent.len().min(MIN_MEASURED_REQUESTS));
        let span_s = newest - sent[sent.len() - count];
        (count >= MIN_MEASURED_REQUESTS && span_s >= MIN_MEASURED_SPAN_S).then(|| (count - 1) as f64 / span_s)
    }
}

impl LearnedRate {
    /// Lets the pace grow during `passed_s` seconds, up to the time `active_s`.
    fn grow_rate(&mut self, passed_s: f64, active_s: f64) {
        if !self.confirmed {
            let since_s = active_s - self.refused_s;
            self.per_s *= 1.0 + SEARCH_PER_S * (1.0 + since_s) * passed_s;
            return;
        }
        let near = self.refused_per_s * NEAR_SHARE;
        if self.per_s < near {
            self.per_s += (near - self.per_s) * (passed_s * 0.5).min(1.0);
        }
        if self.per_s >= near * 0.99 {
            let doublings = ((active_s - self.refused_s) / CALM_S).clamp(0.0, 6.0);
            self.per_s *= 1.0 + PROBE_PER_S * doublings.floor().exp2() * passed_s;
        }
    }
}
