//! A random choice with weights.

use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Draws an index with a probability proportional to its weight; `None` if the list is empty.
pub(crate) fn draw_weighted(weights: &[f64], rng: &mut ChaCha8Rng) -> Option<usize> {
    let mut rest = rng.random_range(0.0..1.0) * weights.iter().sum::<f64>();
    let drawn = weights.iter().position(|weight| {
        rest -= weight;
        rest < 0.0
    });
    // Rounding may leave a rest beyond the last weight: the last index is drawn then.
    drawn.or(weights.len().checked_sub(1))
}
