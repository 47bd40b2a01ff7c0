//! Logistic regression with a ridge penalty over sparse, named features, by Newton's method.

use std::collections::BTreeMap;

/// One observation with its features: a claim, a pair.
pub struct WeighedSample {
    /// The names and values of the features that are not zero.
    pub features: Vec<(String, f64)>,
    /// Whether it is wrong: the outcome that the regression predicts.
    pub wrong: bool,
    /// How many observations this one counts as.
    pub weight: f64,
}

/// Newton steps of a fit at most. A fit that has not converged by then keeps the weights it has; most converge earlier.
const MAX_NEWTON_STEPS: usize = 25;

/// Fits a weight for each feature. The sum of its weights is the natural logarithm of the odds that it is wrong. `ridge` pulls all
/// weights except the bias to zero.
pub fn fit_weights(samples: &[WeighedSample], ridge: f64) -> BTreeMap<String, f64> {
    let mut places: BTreeMap<&str, usize> = BTreeMap::new();
    for (name, _) in samples.iter().flat_map(|sample| &sample.features) {
        let next = places.len();
        places.entry(name).or_insert(next);
    }
    let rows: Vec<Vec<(usize, f64)>> = samples
        .iter()
        .map(|sample| sample.features.iter().map(|(name, value)| (places[name.as_str()], *value)).collect())
        .collect();
    let size = places.len();
    let bias = places.get("bias").copied();
    let mut weights = vec![0.0; size];
    for _ in 0..MAX_NEWTON_STEPS {
        // The bias has a tiny penalty, so that the system stays solvable.
        let penalty = |at: usize| if Some(at) == bias { 1e-6 } else { ridge };
        let mut gradient: Vec<f64> = (0..size).map(|at| -penalty(at) * weights[at]).collect();
        let mut curvature = vec![vec![0.0; size]; size];
        for (at, row) in curvature.iter_mut().enumerate() {
            row[at] = penalty(at);
        }
        for (row, sample) in rows.iter().zip(samples) {
            let score: f64 = row.iter().map(|(at, value)| weights[*at] * value).sum();
            let chance = 1.0 / (1.0 + (-score).exp());
            let error = (f64::from(u8::from(sample.wrong)) - chance) * sample.weight;
            let sample_curvature = (chance * (1.0 - chance)).max(1e-9) * sample.weight;
            for (at, value) in row {
                gradient[*at] += error * value;
                for (other, factor) in row {
                    curvature[*at][*other] += sample_curvature * value * factor;
                }
            }
        }
        let step = solve_cholesky(curvature, gradient);
        let longest = step.iter().fold(0.0_f64, |longest, part| longest.max(part.abs()));
        // No weight moves by more than 2 in one step, so that a step cannot overshoot far.
        let scale = if longest > 2.0 { 2.0 / longest } else { 1.0 };
        weights.iter_mut().zip(&step).for_each(|(weight, step)| *weight += step * scale);
        if longest < 1e-6 {
            break;
        }
    }
    places.into_iter().map(|(name, at)| (name.to_owned(), weights[at])).collect()
}

/// Solves `matrix` x = `right` for a positive definite matrix, by Cholesky decomposition. The solution replaces `right`.
fn solve_cholesky(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Vec<f64> {
    let size = right.len();
    for at in 0..size {
        for row in at..size {
            let sum: f64 = (0..at).map(|k| matrix[row][k] * matrix[at][k]).sum();
            let rest = matrix[row][at] - sum;
            matrix[row][at] = if row == at { rest.max(1e-12).sqrt() } else { rest / matrix[at][at] };
        }
    }
    for at in 0..size {
        let sum: f64 = (0..at).map(|k| matrix[at][k] * right[k]).sum();
        right[at] = (right[at] - sum) / matrix[at][at];
    }
    for at in (0..size).rev() {
        let sum: f64 = (at + 1..size).map(|k| matrix[k][at] * right[k]).sum();
        right[at] = (right[at] - sum) / matrix[at][at];
    }
    right
}
