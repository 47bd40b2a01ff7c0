//! A bucket that fills at a steady rate.

use std::time::{Duration, Instant};

/// How much of its rate a bucket holds, seconds: what may leave at once after a pause.
const HOLDS_S: f64 = 2.0;

/// So much per second, and a little at once. It may go below nothing, so that a request larger than the bucket leaves too, and
/// is paid back after.
#[derive(Debug, Clone)]
pub(super) struct Bucket {
    per_s: f64,
    level: f64,
    filled_at: Instant,
}

impl Bucket {
    /// A full one.
    pub(super) fn per_minute(amount: f64, now: Instant) -> Self {
        let per_s = amount / 60.0;
        Self { per_s, level: holds(per_s), filled_at: now }
    }

    /// Changes the rate, and keeps what is in it.
    pub(super) fn set_per_minute(&mut self, amount: f64, now: Instant) {
        self.fill(now);
        self.per_s = amount / 60.0;
        self.level = self.level.min(holds(self.per_s));
    }

    /// How long until something of `amount` may leave.
    pub(super) fn wait(&mut self, amount: f64, now: Instant) -> Duration {
        self.fill(now);
        let lacks = amount.min(holds(self.per_s)) - self.level;
        if lacks <= 1e-9 { Duration::ZERO } else { Duration::from_secs_f64((lacks / self.per_s).min(3600.0)) }
    }

    /// Takes an amount out, or puts one back.
    pub(super) fn take(&mut self, amount: f64) {
        self.level = (self.level - amount).min(holds(self.per_s));
    }

    fn fill(&mut self, now: Instant) {
        let passed_s = now.saturating_duration_since(self.filled_at).as_secs_f64();
        self.level = (self.level + passed_s * self.per_s).min(holds(self.per_s));
        self.filled_at = self.filled_at.max(now);
    }
}

/// At least one request.
fn holds(per_s: f64) -> f64 {
    (per_s * HOLDS_S).max(1.0)
}
