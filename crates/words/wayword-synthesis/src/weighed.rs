//! A draw by weights.

use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// A place in a list, by the weights there; `None` where the list is empty.
pub(crate) fn weighed(weights: &[f64], rng: &mut ChaCha8Rng) -> Option<usize> {
    let mut rest = rng.random_range(0.0..1.0) * weights.iter().sum::<f64>();
    let found = weights.iter().position(|weight| {
        rest -= weight;
        rest < 0.0
    });
    found.or(weights.len().checked_sub(1))
}
