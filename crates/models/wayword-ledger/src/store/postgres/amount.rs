//! Converts money to whole billionths of a US dollar, so that sums in the database are exact.

/// Billionths in a dollar.
const NANOS: f64 = 1e9;

/// Largest amount, so that sums of a few do not overflow.
const MOST: f64 = 1e18;

/// An amount that is closer than this to a whole number of billionths is that number: the difference is a rounding error of the
/// multiplication.
const ROUNDING: f64 = 1e-3;

/// An amount that is spent or reserved, rounded up.
pub(super) fn up(usd: f64) -> i64 {
    whole(usd, f64::ceil)
}

/// A limit, rounded down. A limit that is not a number allows no spending.
pub(super) fn limit(usd: f64) -> i64 {
    if usd.is_nan() { i64::MIN } else { whole(usd, f64::floor) }
}

/// An amount in dollars.
pub(super) fn usd(nanos: i64) -> f64 {
    nanos as f64 / NANOS
}

fn whole(usd: f64, to: impl Fn(f64) -> f64) -> i64 {
    let nanos = (usd * NANOS).clamp(-MOST, MOST);
    let nearest = nanos.round();
    let whole = if (nanos - nearest).abs() < ROUNDING { nearest } else { to(nanos) };
    whole as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_are_rounded_up_and_limits_down() {
        assert_eq!((up(0.001), up(0.1 + 0.2), up(1.0000000004), up(0.0)), (1_000_000, 300_000_000, 1_000_000_001, 0));
        assert_eq!((limit(1.0), limit(1.0000000006), limit(-1.0)), (1_000_000_000, 1_000_000_000, -1_000_000_000));
        assert_eq!((limit(f64::NAN), limit(f64::INFINITY), up(1e300)), (i64::MIN, MOST as i64, MOST as i64));
        assert_eq!(usd(up(12.5)), 12.5);
    }
}
