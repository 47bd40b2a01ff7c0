//! The next token, by its scores.

use rand::Rng;
use rand_chacha::ChaCha8Rng;
use wayword_core::Sampling;

/// Tokens are drawn among the likeliest that have this much of the probability together: what Qwen and Llama advise.
const NUCLEUS: f64 = 0.95;
/// Scores so far below the best are as good as impossible (e^-20).
const FAR_BELOW: f64 = 20.0;

/// Draws tokens.
pub(super) struct Draw {
    temperature: f64,
    rng: ChaCha8Rng,
}

impl Draw {
    /// By a request's temperature and seed: at temperature 0 the likeliest token, the first of equal ones.
    pub(super) fn new(sampling: &Sampling) -> Result<Self, String> {
        let temperature = sampling.temperature;
        if !temperature.is_finite() || temperature < 0.0 {
            return Err(format!("a temperature of {temperature} is none; 0 is for the likeliest words"));
        }
        Ok(Self { temperature, rng: wayword_core::rng(sampling.seed, &["gguf"]) })
    }

    /// The next token; `None` where the scores are not numbers.
    pub(super) fn next(&mut self, scores: &[f32]) -> Option<u32> {
        let best = best(scores)?;
        if self.temperature == 0.0 {
            return Some(best as u32);
        }
        let score = |at: usize| (f64::from(scores[at]) - f64::from(scores[best])) / self.temperature;
        let mut likely: Vec<(u32, f64)> =
            (0..scores.len()).filter(|&at| score(at) > -FAR_BELOW).map(|at| (at as u32, score(at).exp())).collect();
        likely.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let all: f64 = likely.iter().map(|(_, weight)| weight).sum();
        let mut kept = 0.0;
        let within = likely.iter().take_while(|(_, weight)| {
            let within = kept < NUCLEUS * all;
            kept += if within { *weight } else { 0.0 };
            within
        });
        let within = within.count();
        let mut point = self.rng.random::<f64>() * kept;
        let drawn = likely[..within].iter().find(|(_, weight)| {
            point -= weight;
            point < 0.0
        });
        drawn.or(likely.first()).map(|(token, _)| *token)
    }
}

/// Where the best score is, the first of equal ones.
fn best(scores: &[f32]) -> Option<usize> {
    let mut best = 0;
    for (at, score) in scores.iter().enumerate() {
        if score.is_nan() {
            return None;
        }
        if *score > scores[best] {
            best = at;
        }
    }
    scores.get(best).filter(|score| score.is_finite()).map(|_| best)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draw(temperature: f64, seed: u64) -> Draw {
        Draw::new(&Sampling { temperature, max_tokens: 1, seed }).unwrap()
    }

    #[test]
    fn at_temperature_0_the_first_of_the_best_is_drawn() {
        assert_eq!(draw(0.0, 1).next(&[0.0, 2.0, 2.0, f32::NEG_INFINITY]), Some(1));
        assert_eq!(draw(0.0, 1).next(&[0.0, f32::NAN]), None);
        assert_eq!(draw(1.0, 1).next(&[f32::NEG_INFINITY]), None);
        assert_eq!(draw(1.0, 1).next(&[]), None);
        [f64::NAN, -1.0, f64::INFINITY].into_iter().for_each(|none| {
            assert!(Draw::new(&Sampling { temperature: none, max_tokens: 1, seed: 0 }).is_err());
        });
    }

    #[test]
    fn tokens_come_as_often_as_they_are_likely_and_the_least_likely_never() {
        // Probabilities 0.6, 0.3, 0.08, 0.02: the last lies beyond 0.95.
        let scores = [0.08_f32, 0.6, 0.02, 0.3].map(f32::ln);
        let mut draw = draw(1.0, 7);
        let mut times = [0; 4];
        for _ in 0..10_000 {
            times[draw.next(&scores).unwrap() as usize] += 1;
        }
        assert_eq!(times[2], 0);
        for (times, expected) in [(times[1], 0.6 / 0.98), (times[3], 0.3 / 0.98), (times[0], 0.08 / 0.98)] {
            assert!((f64::from(times) / 10_000.0 - expected).abs() < 0.02, "{times} are not {expected}");
        }
    }

    #[test]
    fn a_low_temperature_is_nearly_none() {
        let mut draw = draw(0.01, 3);
        assert!((0..100).all(|_| draw.next(&[0.0, 1.0, 0.5]) == Some(1)));
    }
}
