//! Mean shares over persons and items that differ on the logit scale, ln(p / (1 - p)). A normal distribution of logits models how
//! persons differ in skill and items in difficulty.

/// The mean share if the logit is normally distributed around `logit` with standard deviation `sd`.
///
/// The trapezoid rule over ±9 standard deviations; for a smooth function that falls off as the normal density does, its
/// error is far below 1e-12.
pub(super) fn mean_share(logit: f64, sd: f64) -> f64 {
    mean_over_normal(logit, sd, expit)
}

/// The mean of a function of a normal variable.
pub(super) fn mean_over_normal(mean: f64, sd: f64, function: impl Fn(f64) -> f64) -> f64 {
    // 144 steps of 1/16 are 9 standard deviations on each side.
    const STEPS_PER_SIDE: i32 = 144;
    const STEP_DEVIATIONS: f64 = 1.0 / 16.0;
    let (mut sum, mut weights) = (0.0, 0.0);
    for step in -STEPS_PER_SIDE..=STEPS_PER_SIDE {
        let at = f64::from(step) * STEP_DEVIATIONS;
        let weight = (-at * at / 2.0).exp();
        sum += weight * function(mean + sd * at);
        weights += weight;
    }
    sum / weights
}

/// The inverse of [`mean_share`]: the logit for which the mean share, with standard deviation `sd`, is `share`; by bisection.
pub(super) fn centre_logit(share: f64, sd: f64) -> f64 {
    // Shares at these logits are 0 and 1 in all digits.
    let (mut low, mut high) = (-60.0, 60.0);
    for _ in 0..100 {
        let middle = f64::midpoint(low, high);
        if mean_share(middle, sd) < share {
            low = middle;
        } else {
            high = middle;
        }
    }
    f64::midpoint(low, high)
}

/// The logit of a share: ln(p / (1 - p)).
pub(super) fn logit(share: f64) -> f64 {
    (share / (1.0 - share)).ln()
}

/// The share of a logit, the inverse of [`logit`].
pub(super) fn expit(logit: f64) -> f64 {
    1.0 / (1.0 + (-logit).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_variation_the_share_is_that_of_the_logit() {
        assert!((mean_share(1.3, 0.0) - expit(1.3)).abs() < 1e-15);
        assert!((mean_share(0.0, 2.0) - 0.5).abs() < 1e-15);
    }

    /// By SciPy (`scipy.integrate.quad`, tolerance 1e-13).
    #[test]
    fn mean_shares_are_known() {
        for (logit, sd, expected) in KNOWN {
            let found = mean_share(logit, sd);
            assert!((found - expected).abs() < 1e-12, "{logit} {sd}: {found} for {expected}");
        }
    }

    #[test]
    fn the_centre_gives_the_share_back() {
        for share in [0.02, 0.3, 0.5, 0.8, 0.99] {
            assert!((mean_share(centre_logit(share, 1.7), 1.7) - share).abs() < 1e-12);
        }
    }

    const KNOWN: [(f64, f64, f64); 4] = [
        (1.3862943611198906, 0.75, 0.7761853689887881),
        (1.3862943611198906, 2.0, 0.7002712994936103),
        (-3.0, 1.5, 0.09661088315272187),
        (0.5, 3.0, 0.5572182216794164),
    ];
}
