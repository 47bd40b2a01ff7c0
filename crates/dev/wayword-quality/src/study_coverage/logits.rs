//! Functions on the logit scale, on which persons and items vary with a normal distribution.

use rand::Rng;

/// Draws normal numbers with mean 0 and standard deviation `sd`.
pub(super) fn draw_normals(count: usize, sd: f64, rng: &mut impl Rng) -> Vec<f64> {
    (0..count).map(|_| sd * draw_normal(rng)).collect()
}

/// Draws a normal number with mean 0 and standard deviation 1, by the Box-Muller transform.
pub(super) fn draw_normal(rng: &mut impl Rng) -> f64 {
    let radius = (-2.0 * libm::log(1.0 - rng.random::<f64>())).sqrt();
    radius * libm::cos(std::f64::consts::TAU * rng.random::<f64>())
}

/// The share with this logit, from 0 to 1.
pub(super) fn expit(logit: f64) -> f64 {
    1.0 / (1.0 + libm::exp(-logit))
}

/// The mean of a function of a normal variable, by the trapezoid rule: over 9 standard deviations on each side, in steps of
/// an eighth of one.
pub(super) fn mean_over_normal(mean: f64, sd: f64, value: impl Fn(f64) -> f64) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for step in -72..=72 {
        let at = f64::from(step) / 8.0;
        let weight = libm::exp(-at * at / 2.0);
        sum += weight * value(mean + sd * at);
        weights += weight;
    }
    sum / weights
}

/// The logit at which the mean share over all persons and items is `share`, by bisection. With variation it is farther from 0 than the
/// logit of `share` itself.
pub(super) fn centre_for_share(share: f64, sd: f64) -> f64 {
    // The interval is halved until it is narrower than the rounding of a number.
    let (mut low, mut high) = (-30.0, 30.0);
    for _ in 0..80 {
        let middle = f64::midpoint(low, high);
        if mean_over_normal(middle, sd, expit) < share {
            low = middle;
        } else {
            high = middle;
        }
    }
    f64::midpoint(low, high)
}
