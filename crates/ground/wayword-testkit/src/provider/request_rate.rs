//! The rate limit of the provider: a token bucket.

use super::RetryAfter;
use std::time::{Duration, Instant};

/// A token bucket. Requests above the rate are refused with 429 and do not count against it.
#[derive(Debug, Clone, Copy)]
pub struct ProviderRequestRate {
    /// How fast the bucket fills.
    pub requests_per_s: f64,
    /// How many requests a full bucket holds; it is full at the start.
    pub burst: u32,
    /// The form in which a refusal announces when the next request is allowed.
    pub retry_after: RetryAfter,
}

/// The bucket in use.
#[derive(Debug)]
pub(super) struct ProviderTokenBucket {
    rate: ProviderRequestRate,
    /// Requests in the bucket at the moment `at`.
    left: f64,
    at: Instant,
}

impl ProviderTokenBucket {
    /// A full bucket.
    pub(super) fn full(rate: ProviderRequestRate, now: Instant) -> Self {
        Self { rate, left: f64::from(rate.burst), at: now }
    }

    /// Takes one request out of the bucket; `Err` with the form and the wait where it is empty.
    pub(super) fn take_request(&mut self, now: Instant) -> Result<(), (RetryAfter, Duration)> {
        let filled = now.saturating_duration_since(self.at).as_secs_f64() * self.rate.requests_per_s;
        self.left = (self.left + filled).min(f64::from(self.rate.burst));
        self.at = self.at.max(now);
        if self.left >= 1.0 {
            self.left -= 1.0;
            return Ok(());
        }
        let wait_s = (1.0 - self.left) / self.rate.requests_per_s.max(1e-6);
        Err((self.rate.retry_after, Duration::from_secs_f64(wait_s)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refused_requests_do_not_drain_the_bucket() {
        let start = Instant::now();
        let rate = ProviderRequestRate { requests_per_s: 10.0, burst: 3, retry_after: RetryAfter::Seconds };
        let mut bucket = ProviderTokenBucket::full(rate, start);
        // A hundred attempts a second for ten seconds: the burst and a hundred get through.
        let at = |step: u64| start + Duration::from_millis(10 * step);
        let passed = (0..1000).filter(|step| bucket.take_request(at(*step)).is_ok()).count();
        assert!((102..=103).contains(&passed), "{passed}");
        let (_, wait) = bucket.take_request(at(1000)).and_then(|()| bucket.take_request(at(1000))).unwrap_err();
        assert!(
            wait <= Duration::from_millis(100)
                && bucket.take_request(at(1000) + wait + Duration::from_millis(1)).is_ok()
        );
    }
}
