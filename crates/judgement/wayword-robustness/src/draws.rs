//! Random numbers that depend only on a seed and on names, and not on earlier draws. So the draw for one frame or thing stays the same
//! when others are added or removed.

use rand::Rng;
use std::f64::consts::TAU;
use wayword_core::seeded_rng;

/// A number from the uniform distribution on [0, 1).
pub(crate) fn draw_uniform(seed: u64, purpose: &[&str]) -> f64 {
    seeded_rng(seed, purpose).random()
}

/// A number from the standard normal distribution.
pub(crate) fn draw_normal(seed: u64, purpose: &[&str]) -> f64 {
    normal_pair(&mut seeded_rng(seed, purpose))[0]
}

/// Two independent numbers from the standard normal distribution (Box and Muller, "A note on the generation of random
/// normal deviates", 1958).
pub(crate) fn normal_pair(rng: &mut impl Rng) -> [f64; 2] {
    // One minus a number in [0, 1) is never 0.
    let radius = libm::sqrt(-2.0 * libm::log(1.0 - rng.random::<f64>()));
    let (sin, cos) = libm::sincos(TAU * rng.random::<f64>());
    [radius * cos, radius * sin]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_numbers_have_their_mean_and_spread() {
        let mut dice = seeded_rng(1, &["test"]);
        let drawn: Vec<f64> = (0..20_000).flat_map(|_| normal_pair(&mut dice)).collect();
        let mean = drawn.iter().sum::<f64>() / drawn.len() as f64;
        let variance = drawn.iter().map(|x| x * x).sum::<f64>() / drawn.len() as f64;
        assert!(mean.abs() < 0.02 && (variance - 1.0).abs() < 0.03, "{mean} {variance}");
    }
}
