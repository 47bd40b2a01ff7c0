//! Computes how long to wait before a request is repeated: exponential backoff with a repeatable jitter.

use crate::faults::ServiceLoad;
use std::time::Duration;
use wayword_core::seed;

/// Wait before the second attempt, seconds. It doubles with each further attempt.
const FIRST_WAIT_S: f64 = 0.3;

/// The same where a service reports too many requests and names no time. Its limits are mostly per minute.
const FIRST_LOAD_WAIT_S: f64 = 3.0;

/// Longest wait that the program chooses itself, seconds. A server may ask for a longer one.
const MAX_WAIT_S: f64 = 30.0;

/// A wait that doubles with each attempt, minus up to half of it. The reduction depends only on the call's key and the
/// attempt, so that a run is repeatable and calls that failed together are not repeated together.
pub(crate) fn backoff_wait(key: &str, attempt: u32, load: ServiceLoad) -> Duration {
    let first_s = if load == ServiceLoad::Over { FIRST_LOAD_WAIT_S } else { FIRST_WAIT_S };
    // 16 doublings are far beyond the longest wait, and keep the power from overflowing.
    let whole = first_s * f64::from(2_u32.saturating_pow(attempt.saturating_sub(1).min(16)));
    Duration::from_secs_f64(whole.min(MAX_WAIT_S) * (1.0 - 0.5 * wait_fraction(key, attempt)))
}

/// A wait that is up to a quarter of a second longer than the server asked for, so that not all calls are repeated at
/// the same moment.
pub(crate) fn wait_after(asked: Duration, key: &str, attempt: u32) -> Duration {
    asked + Duration::from_secs_f64(0.25 * wait_fraction(key, attempt))
}

/// A number in [0, 1), always the same for a key and an attempt.
fn wait_fraction(key: &str, attempt: u32) -> f64 {
    // The seed is a hash (FNV), in which the low bits vary most; multiplying by an odd constant carries them into the
    // high bits, which are used here.
    let spread = seed::derive_seed(u64::from(attempt), &["backoff", key]).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (spread >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waits_double_and_are_bounded() {
        for attempt in 1..40 {
            let wait = backoff_wait("key", attempt, ServiceLoad::Unknown).as_secs_f64();
            let whole = (0.3 * 2_f64.powi(attempt as i32 - 1)).min(30.0);
            assert!(wait > whole / 2.0 - 1e-9 && wait <= whole, "{attempt}: {wait}");
        }
    }

    #[test]
    fn waits_are_the_same_each_time_and_differ_between_calls() {
        let wait = |load| backoff_wait("a", 2, load);
        assert_eq!(wait(ServiceLoad::Slow), wait(ServiceLoad::Slow));
        assert!(wait(ServiceLoad::Over) > 5 * wait(ServiceLoad::Slow));
        let fractions: Vec<f64> = (0..1000).map(|i| wait_fraction(&format!("call {i}"), 1)).collect();
        let mean = fractions.iter().sum::<f64>() / 1000.0;
        assert!((0.45..0.55).contains(&mean), "{mean}");
    }
}
