//! Converts money to whole billionths of a US dollar, so that sums in the database are exact.

/// Billionths in a dollar.
const NANOS_PER_USD: f64 = 1e9;

/// Largest amount, billionths of a dollar: a billion dollars. Larger ones are cut to it, so that sums of a few fit into 64 bits.
const MAX_NANOS: f64 = 1e18;

/// An amount that is closer than this to a whole number of billionths is that number: the difference is a rounding error of the
/// multiplication.
const ROUNDING_TOLERANCE_NANOS: f64 = 1e-3;

/// An amount that is spent or reserved, rounded up.
pub(super) fn nanos_rounded_up(usd: f64) -> i64 {
    round_nanos(usd, f64::ceil)
}

/// A limit, rounded down. A limit that is not a number allows no spending.
pub(super) fn limit_nanos(usd: f64) -> i64 {
    if usd.is_nan() { i64::MIN } else { round_nanos(usd, f64::floor) }
}

/// An amount in dollars.
pub(super) fn usd_from_nanos(nanos: i64) -> f64 {
    nanos as f64 / NANOS_PER_USD
}

/// Billionths of a dollar, rounded by `round` where they are not whole.
fn round_nanos(usd: f64, round: impl Fn(f64) -> f64) -> i64 {
    let nanos = (usd * NANOS_PER_USD).clamp(-MAX_NANOS, MAX_NANOS);
    let nearest = nanos.round();
    let whole = if (nanos - nearest).abs() < ROUNDING_TOLERANCE_NANOS { nearest } else { round(nanos) };
    whole as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_are_rounded_up_and_limits_down() {
        assert_eq!(
            (
                nanos_rounded_up(0.001),
                nanos_rounded_up(0.1 + 0.2),
                nanos_rounded_up(1.0000000004),
                nanos_rounded_up(0.0)
            ),
            (1_000_000, 300_000_000, 1_000_000_001, 0)
        );
        assert_eq!(
            (limit_nanos(1.0), limit_nanos(1.0000000006), limit_nanos(-1.0)),
            (1_000_000_000, 1_000_000_000, -1_000_000_000)
        );
        assert_eq!(
            (limit_nanos(f64::NAN), limit_nanos(f64::INFINITY), nanos_rounded_up(1e300)),
            (i64::MIN, MAX_NANOS as i64, MAX_NANOS as i64)
        );
        assert_eq!(usd_from_nanos(nanos_rounded_up(12.5)), 12.5);
    }
}
