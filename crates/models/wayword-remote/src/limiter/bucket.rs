//! A token bucket: it fills at a steady rate, and each request takes its amount out. Limits requests or tokens per
//! minute.

use std::time::{Duration, Instant};

/// A bucket's capacity, in seconds of its rate: this much may be sent at once after a pause.
const BURST_S: f64 = 2.0;

/// Allows a fixed amount per second, with a small burst. Its level may go below 0, so that a request larger than the
/// bucket can be sent too. Later requests then wait until the bucket has filled again.
#[derive(Debug, Clone)]
pub(super) struct RateBucket {
    /// The rate at which the bucket fills, requests or tokens per second.
    per_s: f64,
    /// How much may be sent now, requests or tokens.
    level: f64,
    /// When the level was last brought up to date.
    filled_at: Instant,
}

impl RateBucket {
    /// A full bucket.
    pub(super) fn per_minute(amount: f64, now: Instant) -> Self {
        let per_s = amount / 60.0;
        Self { per_s, level: bucket_capacity(per_s), filled_at: now }
    }

    /// Changes the rate, and keeps the level.
    pub(super) fn set_per_minute(&mut self, amount: f64, now: Instant) {
        self.fill_until(now);
        self.per_s = amount / 60.0;
        self.level = self.level.min(bucket_capacity(self.per_s));
    }

    /// How long until something of `amount` may be sent, at most an hour.
    pub(super) fn wait_for(&mut self, amount: f64, now: Instant) -> Duration {
        self.fill_until(now);
        let missing = amount.min(bucket_capacity(self.per_s)) - self.level;
        if missing <= 1e-9 { Duration::ZERO } else { Duration::from_secs_f64((missing / self.per_s).min(3600.0)) }
    }

    /// Takes an amount out, or puts one back.
    pub(super) fn take_amount(&mut self, amount: f64) {
        self.level = (self.level - amount).min(bucket_capacity(self.per_s));
    }

    /// Brings the level up to date.
    fn fill_until(&mut self, now: Instant) {
        let passed_s = now.saturating_duration_since(self.filled_at).as_secs_f64();
        self.level = (self.level + passed_s * self.per_s).min(bucket_capacity(self.per_s));
        self.filled_at = self.filled_at.max(now);
    }
}

/// The capacity of a bucket with this rate: at least one request.
fn bucket_capacity(per_s: f64) -> f64 {
    (per_s * BURST_S).max(1.0)
}
