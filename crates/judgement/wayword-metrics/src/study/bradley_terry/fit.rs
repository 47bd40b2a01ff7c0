//! Fits the Bradley-Terry model: finds the parameters with the greatest likelihood. The parameters are the strengths of all systems
//! but the last (that one is 0), the advantage of the first side, and the parameter of ties.
//!
//! The three outcomes form a multinomial logit with utilities that are linear in the parameters. Its log-likelihood is concave, so
//! it has a single maximum, and Newton's method finds it.

use super::NoStrength;
use std::collections::BTreeMap;

/// The outcome of a choice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum ChoiceOutcome {
    /// The system that was shown first was preferred.
    First,
    /// The system that was shown second was preferred.
    Second,
    /// Neither was preferred.
    Tie,
}

/// A choice between two systems, by number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct SystemPair {
    pub(super) first: usize,
    pub(super) second: usize,
    pub(super) outcome: ChoiceOutcome,
}

/// Newton's method ends when no parameter moves by more than this.
const STEP_PRECISION: f64 = 1e-12;
/// Newton steps at most. Fits that have a maximum need far fewer; after this many there is taken to be none.
const MAX_NEWTON_STEPS: usize = 100;
/// A likelihood that falls by less than this share has only lost digits by rounding; the step is accepted.
const LIKELIHOOD_ROUNDING_SHARE: f64 = 1e-12;
/// Largest parameter. Choices of people cannot show odds of e^20, so a fit that gets there has no maximum.
const MAX_LOG_ODDS: f64 = 20.0;

/// The fitted parameters, with the score vectors and the information matrix that their errors are computed from.
pub(super) struct StrengthFit {
    systems: usize,
    has_ties: bool,
    parameters: Vec<f64>,
    /// The gradient of one choice's log-likelihood, for each combination of systems and outcome.
    scores: BTreeMap<SystemPair, Vec<f64>>,
    information: CholeskyFactor,
}

impl StrengthFit {
    /// Fits the parameters to choices between `systems` systems.
    pub(super) fn from_pairs(pairs: &[SystemPair], systems: usize) -> Result<Self, NoStrength> {
        let has_ties = pairs.iter().any(|pair| pair.outcome == ChoiceOutcome::Tie);
        let mut counts: BTreeMap<SystemPair, f64> = BTreeMap::new();
        pairs.iter().for_each(|pair| *counts.entry(*pair).or_default() += 1.0);
        let model = ChoiceModel { systems, has_ties, counts };
        let mut parameters = vec![0.0; model.parameter_count()];
        for step in 0..MAX_NEWTON_STEPS {
            let LikelihoodPoint { likelihood, gradient, scores, information } = model.likelihood_at(&parameters);
            let singular = if step == 0 { NoStrength::Sides } else { NoStrength::Endless };
            let information = CholeskyFactor::from_matrix(information).ok_or(singular)?;
            let mut step = information.solve(&gradient);
            // A step that would lower the likelihood is halved until it no longer does.
            while model.likelihood_at(&vector_sum(&parameters, &step)).likelihood
                < likelihood - LIKELIHOOD_ROUNDING_SHARE * likelihood.abs()
            {
                step.iter_mut().for_each(|part| *part /= 2.0);
            }
            parameters = vector_sum(&parameters, &step);
            if parameters.iter().any(|value| value.abs() > MAX_LOG_ODDS) {
                return Err(NoStrength::Endless);
            }
            if step.iter().all(|part| part.abs() <= STEP_PRECISION) {
                return Ok(Self { systems, has_ties, parameters, scores, information });
            }
        }
        Err(NoStrength::Endless)
    }

    /// The weight of each parameter in a system's strength relative to the mean of all. Such a vector is called a direction.
    pub(super) fn strength_direction(&self, system: usize) -> Vec<f64> {
        let mut direction = vec![0.0; self.parameters.len()];
        let mean = 1.0 / self.systems as f64;
        direction[..self.systems - 1].iter_mut().for_each(|part| *part = -mean);
        if system + 1 < self.systems {
            direction[system] += 1.0;
        }
        direction
    }

    /// The direction of the advantage of the side that is shown first.
    pub(super) fn side_direction(&self) -> Vec<f64> {
        self.unit_direction(self.systems - 1)
    }

    /// The direction of the parameter of ties; `None` where there are none.
    pub(super) fn tie_direction(&self) -> Option<Vec<f64>> {
        self.has_ties.then(|| self.unit_direction(self.systems))
    }

    /// The direction of a single parameter.
    fn unit_direction(&self, at: usize) -> Vec<f64> {
        (0..self.parameters.len()).map(|other| f64::from(u8::from(other == at))).collect()
    }

    /// The fitted value of the sum of parameters that is weighted by `direction`.
    pub(super) fn value_along(&self, direction: &[f64]) -> f64 {
        dot_product(&self.parameters, direction)
    }

    /// The contribution of each choice to the error of a weighted sum of parameters.
    pub(super) fn choice_influences(&self, direction: &[f64], pairs: &[SystemPair]) -> Vec<f64> {
        let weights = self.information.solve(direction);
        pairs.iter().map(|pair| self.scores.get(pair).map_or(0.0, |score| dot_product(score, &weights))).collect()
    }
}

/// The model without its parameters: the number of systems, whether there are ties, and how often each choice was made.
struct ChoiceModel {
    systems: usize,
    has_ties: bool,
    counts: BTreeMap<SystemPair, f64>,
}

/// The log-likelihood at some parameters, with its derivatives.
struct LikelihoodPoint {
    likelihood: f64,
    gradient: Vec<f64>,
    scores: BTreeMap<SystemPair, Vec<f64>>,
    information: Vec<Vec<f64>>,
}

impl ChoiceModel {
    fn parameter_count(&self) -> usize {
        self.systems + usize::from(self.has_ties)
    }

    /// The log-likelihood and its derivatives at some parameters.
    fn likelihood_at(&self, parameters: &[f64]) -> LikelihoodPoint {
        let size = self.parameter_count();
        let zeros = || vec![0.0; size];
        let mut point = LikelihoodPoint {
            likelihood: 0.0,
            gradient: zeros(),
            scores: BTreeMap::new(),
            information: vec![zeros(); size],
        };
        for (pair, count) in &self.counts {
            let utilities = self.outcome_utilities(pair);
            let utilities = &utilities[..if self.has_ties { 3 } else { 2 }];
            let logs = chances_ln(utilities, parameters);
            let mut mean = zeros();
            utilities.iter().zip(&logs).for_each(|(utility, ln)| add_scaled(&mut mean, ln.exp(), utility));
            let happened = pair.outcome as usize;
            let score = vector_difference(&utilities[happened], &mean);
            point.likelihood += count * logs[happened];
            add_scaled(&mut point.gradient, *count, &score);
            point.scores.insert(*pair, score);
            for (utility, ln) in utilities.iter().zip(&logs) {
                let deviation = vector_difference(utility, &mean);
                let rows = point.information.iter_mut().zip(&deviation);
                rows.for_each(|(row, part)| add_scaled(row, count * ln.exp() * part, &deviation));
            }
        }
        point
    }

    /// The weight of each parameter in the utilities of the three outcomes: first, second, tie.
    fn outcome_utilities(&self, pair: &SystemPair) -> [Vec<f64>; 3] {
        let side = self.systems - 1;
        let mut utilities = [(); 3].map(|()| vec![0.0; self.parameter_count()]);
        if pair.first < side {
            utilities[0][pair.first] = 1.0;
            utilities[2][pair.first] = 0.5;
        }
        if pair.second < side {
            utilities[1][pair.second] = 1.0;
            utilities[2][pair.second] = 0.5;
        }
        utilities[0][side] = 1.0;
        utilities[2][side] = 0.5;
        if self.has_ties {
            utilities[2][self.systems] = 1.0;
        }
        utilities
    }
}

/// The Cholesky factor of a symmetric positive definite matrix: a lower triangle L with L Lᵀ = the matrix.
struct CholeskyFactor(Vec<Vec<f64>>);

impl CholeskyFactor {
    /// Factors a matrix; `None` if it is singular.
    fn from_matrix(mut matrix: Vec<Vec<f64>>) -> Option<Self> {
        let size = matrix.len();
        let greatest = (0..size).map(|at| matrix[at][at]).fold(0.0, f64::max);
        for row in 0..size {
            for column in 0..=row {
                let known: f64 = (0..column).map(|k| matrix[row][k] * matrix[column][k]).sum();
                let remainder = matrix[row][column] - known;
                if row != column {
                    matrix[row][column] = remainder / matrix[column][column];
                } else if remainder > 1e-11 * greatest {
                    matrix[row][row] = remainder.sqrt();
                } else {
                    // A remainder this small is zero up to rounding, so the matrix is singular.
                    return None;
                }
            }
        }
        Some(Self(matrix))
    }

    /// Solves the linear system of the matrix with the right-hand side `right`.
    fn solve(&self, right: &[f64]) -> Vec<f64> {
        let Self(lower) = self;
        let mut solved = right.to_vec();
        for row in 0..solved.len() {
            let known: f64 = (0..row).map(|k| lower[row][k] * solved[k]).sum();
            solved[row] = (solved[row] - known) / lower[row][row];
        }
        for row in (0..solved.len()).rev() {
            let known: f64 = (row + 1..solved.len()).map(|k| lower[k][row] * solved[k]).sum();
            solved[row] = (solved[row] - known) / lower[row][row];
        }
        solved
    }
}

/// The logarithms of the probabilities of outcomes with these utilities (a softmax).
fn chances_ln(utilities: &[Vec<f64>], parameters: &[f64]) -> Vec<f64> {
    let values: Vec<f64> = utilities.iter().map(|utility| dot_product(utility, parameters)).collect();
    let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let sum: f64 = values.iter().map(|value| (value - highest).exp()).sum();
    values.iter().map(|value| value - highest - sum.ln()).collect()
}

fn dot_product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Adds `vector` times `factor` to `sum`.
fn add_scaled(sum: &mut [f64], factor: f64, vector: &[f64]) {
    sum.iter_mut().zip(vector).for_each(|(sum, part)| *sum += factor * part);
}

fn vector_sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

fn vector_difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}
