//! Logistic regression with a ridge penalty for many sparse features. It takes Newton steps; conjugate gradients solve the linear system of
//! each step, so that the curvature matrix is never built.

/// A row: places of features, each once, and their values.
pub(super) type SparseRow = Vec<(usize, f64)>;

/// Newton steps at most.
const MAX_NEWTON_STEPS: usize = 50;
/// Conjugate-gradient steps for one Newton step at most.
const INNER_STEPS: usize = 200;
/// The fit ends when the gradient's length is at most this share of the first gradient's.
const GRADIENT_STOP_SHARE: f64 = 1e-4;
/// How often a step that does not reduce the loss is halved before the fit gives up.
const MAX_HALVINGS: usize = 20;

/// The weights of the features. The score of a row is the dot product of both; a row with a score above 0 is put into the
/// class `true`.
#[derive(Debug)]
pub(super) struct LogisticModel {
    pub(super) weights: Vec<f64>,
}

impl LogisticModel {
    /// Minimises `w·w / 2 + cost * Σ ln(1 + exp(-y s))`, `y` being 1 or -1 and `s` a row's score.
    pub(super) fn fit_rows(rows: &[&SparseRow], classes: &[bool], features: usize, cost: f64) -> Self {
        let problem = LogisticProblem { rows, classes, features, cost };
        let mut model = Self { weights: vec![0.0; features] };
        let mut scores = vec![0.0; rows.len()];
        let mut loss = problem.loss_at(&model.weights, &scores);
        let mut first = None;
        for _ in 0..MAX_NEWTON_STEPS {
            let (gradient, bends) = problem.gradient_at(&model.weights, &scores);
            let length = dot_product(&gradient, &gradient).sqrt();
            if length <= GRADIENT_STOP_SHARE * *first.get_or_insert(length) {
                break;
            }
            let step = problem.newton_step(&gradient, &bends);
            let along: Vec<f64> = rows.iter().map(|row| sparse_dot(&step, row)).collect();
            let better = (0..MAX_HALVINGS).map(|halved| 0.5_f64.powi(halved as i32)).find_map(|share| {
                let weights = add_scaled(&model.weights, &step, share);
                let scores = add_scaled(&scores, &along, share);
                let at = problem.loss_at(&weights, &scores);
                (at < loss).then_some((weights, scores, at))
            });
            let Some(better) = better else { break };
            (model.weights, scores, loss) = better;
        }
        model
    }

    pub(super) fn score_row(&self, row: &SparseRow) -> f64 {
        sparse_dot(&self.weights, row)
    }
}

/// The rows and classes that a model is fitted to.
struct LogisticProblem<'a> {
    rows: &'a [&'a SparseRow],
    /// The class of each row.
    classes: &'a [bool],
    /// The number of features.
    features: usize,
    /// How much the rows' losses count against the ridge penalty.
    cost: f64,
}

impl LogisticProblem<'_> {
    /// 1 for each row of the class `true`, -1 for the others.
    fn class_signs(&self) -> impl Iterator<Item = f64> {
        self.classes.iter().map(|class| if *class { 1.0 } else { -1.0 })
    }

    /// The value that is minimised, at some weights and the scores that they give.
    fn loss_at(&self, weights: &[f64], scores: &[f64]) -> f64 {
        let row_loss = |(score, side): (&f64, f64)| {
            let margin = side * score;
            // The same as ln(1 + exp(-margin)), without overflow.
            (-margin).max(0.0) + (-margin.abs()).exp().ln_1p()
        };
        dot_product(weights, weights) / 2.0
            + self.cost * scores.iter().zip(self.class_signs()).map(row_loss).sum::<f64>()
    }

    /// The gradient, and for each row the second derivative of the loss along its score.
    fn gradient_at(&self, weights: &[f64], scores: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut gradient = weights.to_vec();
        let mut bends = Vec::with_capacity(self.rows.len());
        for ((row, score), side) in self.rows.iter().zip(scores).zip(self.class_signs()) {
            let chance = 1.0 / (1.0 + (-score).exp());
            let error = self.cost * (chance - (side + 1.0) / 2.0);
            bends.push(self.cost * chance * (1.0 - chance));
            row.iter().for_each(|(at, value)| gradient[*at] += error * value);
        }
        (gradient, bends)
    }

    /// The Newton step: minus the gradient, divided by the curvature.
    fn newton_step(&self, gradient: &[f64], bends: &[f64]) -> Vec<f64> {
        let mut step = vec![0.0; self.features];
        let mut rest: Vec<f64> = gradient.iter().map(|value| -value).collect();
        let mut direction = rest.clone();
        let mut length = dot_product(&rest, &rest);
        // The squared length, so the step is solved to a tenth of the gradient.
        let enough = length * 0.01;
        for _ in 0..INNER_STEPS {
            if length <= enough {
                break;
            }
            let bent = self.curvature_along(&direction, bends);
            let share = length / dot_product(&direction, &bent);
            step = add_scaled(&step, &direction, share);
            rest = add_scaled(&rest, &bent, -share);
            let next = dot_product(&rest, &rest);
            direction = add_scaled(&rest, &direction, next / length);
            length = next;
        }
        step
    }

    /// The product of the curvature matrix and a direction.
    fn curvature_along(&self, direction: &[f64], bends: &[f64]) -> Vec<f64> {
        let mut bent = direction.to_vec();
        for (row, bend) in self.rows.iter().zip(bends) {
            let along = bend * sparse_dot(direction, row);
            row.iter().for_each(|(at, value)| bent[*at] += along * value);
        }
        bent
    }
}

fn sparse_dot(weights: &[f64], row: &SparseRow) -> f64 {
    row.iter().map(|(at, value)| weights[*at] * value).sum()
}

fn dot_product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `a + share * b`
fn add_scaled(a: &[f64], b: &[f64], share: f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + share * b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_the_fit_no_small_change_makes_the_loss_less() {
        let rows: Vec<SparseRow> = vec![
            vec![(0, 1.0), (2, 1.0)],
            vec![(0, 1.0), (1, 1.0), (2, 1.0)],
            vec![(1, 1.0), (2, 1.0)],
            vec![(0, 0.4), (2, 1.0)],
        ];
        let rows: Vec<&SparseRow> = rows.iter().collect();
        let classes = [true, true, false, false];
        let problem = LogisticProblem { rows: &rows, classes: &classes, features: 3, cost: 0.3 };
        let LogisticModel { weights } = LogisticModel::fit_rows(&rows, &classes, 3, 0.3);
        let loss = |weights: &[f64]| {
            let scores: Vec<f64> = rows.iter().map(|row| sparse_dot(weights, row)).collect();
            problem.loss_at(weights, &scores)
        };
        for at in 0..3 {
            for change in [-1e-2, 1e-2] {
                let mut other = weights.clone();
                other[at] += change;
                assert!(loss(&other) > loss(&weights), "{at} {change} {weights:?}");
            }
        }
        assert!(weights[0] > 0.0 && weights[1] < 0.0, "{weights:?}");
    }

    #[test]
    fn rows_without_information_score_zero() {
        let row: SparseRow = vec![(0, 1.0)];
        let model = LogisticModel::fit_rows(&[&row, &row], &[true, false], 1, 0.3);
        assert!(model.score_row(&row).abs() < 1e-9);
    }
}
