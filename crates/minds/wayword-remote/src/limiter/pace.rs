//! A rate that is learned from a service which refuses what is too much, and never says how much that is.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

/// What was let in is looked back on for so long, seconds.
const LOOK_BACK_S: f64 = 3.0;

/// Fewer than these tell no rate.
const FEWEST: usize = 16;

/// Most that are remembered.
const REMEMBERED: usize = 4096;

/// A rate over a shorter time than this tells nothing, seconds: it may be what a service lets in at once.
const LONG_ENOUGH_S: f64 = 0.8;

/// After a refusal, the pace is so much of the rate that was let in.
const CAUTION: f64 = 0.98;

/// A refusal that follows another one so soon tells that the pace is still far too high, seconds.
const SOON_S: f64 = 3.0;

/// A pace that was refused only once grows by this share of it per second, and by as much more with each second since, until
/// it is refused at about the same rate again.
const SEARCH_PER_S: f64 = 0.03;

/// After that, the pace that was refused is approached quickly up to this share of it.
const NEAR: f64 = 0.98;

/// Beyond that it grows by this share per second at first, and twice as fast after each [`CALM_S`] without a refusal, so that
/// a service that allows more again is found out.
const PROBE_PER_S: f64 = 0.001;

/// See [`PROBE_PER_S`], seconds.
const CALM_S: f64 = 10.0;

/// A pace beyond so many times what was let in was not what held requests back.
const TRIED: f64 = 2.0;

/// No service is asked more often than this, per second.
const FASTEST_PER_S: f64 = 1e5;

/// A learned pace.
#[derive(Debug)]
pub(super) struct Pace {
    /// When requests left that were let in, by a clock that stands still in pauses, seconds.
    let_in: VecDeque<f64>,
    active_s: f64,
    seen_at: Instant,
    learned: Option<Learned>,
    /// When the next request may leave, where they leave one by one.
    next: Option<Instant>,
}

#[derive(Debug)]
struct Learned {
    per_s: f64,
    /// The pace that was refused.
    refused_per_s: f64,
    /// When that was, by the clock that stands still.
    refused_s: f64,
    /// Whether it was refused at about the same rate before.
    confirmed: bool,
}

impl Pace {
    pub(super) fn new(now: Instant) -> Self {
        Self { let_in: VecDeque::new(), active_s: 0.0, seen_at: now, learned: None, next: None }
    }

    /// Moves the clock that stands still in pauses, and lets the pace grow meanwhile.
    pub(super) fn advance(&mut self, now: Instant, paused: bool) {
        let passed_s = now.saturating_duration_since(self.seen_at).as_secs_f64();
        self.seen_at = self.seen_at.max(now);
        if paused {
            return;
        }
        // A gap in which nobody asked says nothing about the service.
        let passed_s = passed_s.min(1.0);
        self.active_s += passed_s;
        if let Some(learned) = &mut self.learned {
            learned.grow(passed_s, self.active_s);
            learned.per_s = learned.per_s.min(FASTEST_PER_S);
        }
    }

    /// How long until the next request may leave.
    pub(super) fn wait(&self, now: Instant) -> Duration {
        self.next.map_or(Duration::ZERO, |next| next.saturating_duration_since(now))
    }

    /// A request leaves; where no pace is learned, so long before the next. Returns when, by the clock that stands still.
    pub(super) fn leave(&mut self, now: Instant, spacing: Option<Duration>) -> f64 {
        let learned = self.learned.as_ref().map(|learned| Duration::from_secs_f64(1.0 / learned.per_s));
        self.next = learned.or(spacing).map(|interval| {
            // A thread that wakes a little late takes nothing from the pace.
            let slack = interval / 4 + Duration::from_millis(1);
            let earliest = now.checked_sub(slack).unwrap_or(now);
            self.next.map_or(earliest, |next| next.max(earliest)) + interval
        });
        self.active_s
    }

    /// A request that left at `left_s` came back and had been let in, whatever became of it.
    pub(super) fn let_in(&mut self, left_s: f64) {
        if self.let_in.len() >= REMEMBERED {
            self.let_in.pop_front();
        }
        self.let_in.push_back(left_s);
    }

    /// A request was refused as too much. `first` unless another one that was out at the same time has told it.
    pub(super) fn refused(&mut self, first: bool) {
        let let_in_per_s = if first { self.let_in_per_s() } else { None };
        let Some(let_in_per_s) = let_in_per_s else { return };
        let careful = let_in_per_s * CAUTION;
        // A pace that grew far beyond what was asked was never tried, and tells nothing.
        let old = self.learned.as_ref().filter(|old| old.per_s < let_in_per_s * TRIED);
        let (per_s, refused_per_s, confirmed) = match old {
            None => (careful, let_in_per_s, false),
            Some(old) => {
                let soon = self.active_s - old.refused_s < SOON_S;
                let close = (0.87..1.15).contains(&(old.per_s / old.refused_per_s));
                // A single refusal among many that were let in is not a new limit, so the step down is bounded.
                let least = old.per_s * if soon || !old.confirmed { 0.6 } else { 0.8 };
                // The limit lies between what was let in and what was refused; right after a refusal, what was let in is less
                // than could be.
                let refused_per_s =
                    if close && !soon { let_in_per_s.clamp(old.per_s * 0.85, old.per_s) } else { old.per_s };
                (careful.clamp(least, old.per_s * 0.98), refused_per_s, close)
            }
        };
        let refused_s = self.active_s;
        self.learned = Some(Learned { per_s: per_s.clamp(0.05, FASTEST_PER_S), refused_per_s, refused_s, confirmed });
    }

    /// The rate of what was let in lately, where there was enough of it.
    fn let_in_per_s(&self) -> Option<f64> {
        let mut left: Vec<f64> = self.let_in.iter().copied().collect();
        left.sort_by(f64::total_cmp);
        let newest = *left.last()?;
        let recent = left.iter().rev().take_while(|&&at| at >= newest - LOOK_BACK_S).count();
        // A slow service is looked back on for longer, to a few requests.
        let count = recent.max(left.len().min(FEWEST));
        let span_s = newest - left[left.len() - count];
        (count >= FEWEST && span_s >= LONG_ENOUGH_S).then(|| (count - 1) as f64 / span_s)
    }
}

impl Learned {
    fn grow(&mut self, passed_s: f64, active_s: f64) {
        if !self.confirmed {
            let since_s = active_s - self.refused_s;
            self.per_s *= 1.0 + SEARCH_PER_S * (1.0 + since_s) * passed_s;
            return;
        }
        let near = self.refused_per_s * NEAR;
        if self.per_s < near {
            self.per_s += (near - self.per_s) * (passed_s * 0.5).min(1.0);
        }
        if self.per_s >= near * 0.99 {
            let calm = ((active_s - self.refused_s) / CALM_S).clamp(0.0, 6.0);
            self.per_s *= 1.0 + PROBE_PER_S * calm.floor().exp2() * passed_s;
        }
    }
}
