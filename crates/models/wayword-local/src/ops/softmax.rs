//! The exponentials and their sum for a softmax, in vector instructions of the CPU.

use rten_simd::{
    Isa, Simd, SimdIterable, SimdOp, SimdUnaryOp,
    functional::simd_map,
    ops::{BitOps, NumOps},
};
use rten_vecmath::Exp;

/// Replaces scores by exp(score - largest score), and returns their sum. The numbers divided by the sum are the
/// softmax. The caller divides, because it may do so later, with fewer numbers.
pub(super) fn replace_by_exponentials(scores: &mut [f32]) -> f32 {
    ExponentialsOp(scores).dispatch()
}

/// [`replace_by_exponentials`] in the vector instructions of any CPU.
struct ExponentialsOp<'a>(&'a mut [f32]);

impl SimdOp for ExponentialsOp<'_> {
    type Output = f32;

    #[inline(always)]
    fn eval<I: Isa>(self, isa: I) -> f32 {
        let ops = isa.f32();
        let mut scores = self.0.simd_iter(ops);
        let largest = scores.by_ref().fold(ops.splat(f32::MIN), |largest, score| ops.max(largest, score));
        let largest = largest.to_array().into_iter().fold(f32::MIN, f32::max);
        // The number of last scores, which do not fill a vector.
        let rest = self.0.len() % ops.len();
        let largest = self.0[self.0.len() - rest..].iter().copied().fold(largest, f32::max);
        let (largest_in_lanes, exp) = (ops.splat(largest), Exp {});
        let (mut sum, mut before) = (ops.zero(), ops.zero());
        simd_map(
            ops,
            self.0,
            #[inline(always)]
            |score| {
                let share = exp.eval(isa, ops.sub(score, largest_in_lanes));
                before = sum;
                sum = ops.add(sum, share);
                share
            },
        );
        if rest > 0 {
            // The lanes beyond the last score do not count.
            sum = ops.select(sum, before, ops.first_n_mask(rest));
        }
        sum.to_array().into_iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponentials_return_their_sum_for_every_length() {
        for length in 1..70 {
            let before: Vec<f32> = (0..length).map(|at| (at * 37 % 11) as f32 - 5.0).collect();
            let mut after = before.clone();
            let sum = replace_by_exponentials(&mut after);
            let largest = before.iter().copied().fold(f32::MIN, f32::max);
            let expected: Vec<f32> = before.iter().map(|score| (score - largest).exp()).collect();
            assert!(after.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-6), "{length}");
            assert!((sum - expected.iter().sum::<f32>()).abs() < 1e-4, "{length}: {sum}");
        }
    }

    #[test]
    fn a_score_that_is_hidden_has_no_share() {
        let mut scores = [f32::NEG_INFINITY, 3.0, f32::NEG_INFINITY, 3.0, 1000.0, f32::NEG_INFINITY];
        assert!((replace_by_exponentials(&mut scores) - 1.0).abs() < 1e-6);
        assert_eq!(scores, [0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    }
}
