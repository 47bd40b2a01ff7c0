//! Logistic regression with a ridge penalty for many sparse features. It takes Newton steps; conjugate gradients solve the linear system of
//! each step, so that the curvature matrix is never built.

/// A row: places of features, each once, and their values.
pub(super) type Row = Vec<(usize, f64)>;

/// Newton steps at most.
const STEPS: usize = 50;
/// Conjugate-gradient steps for one Newton step at most.
const INNER_STEPS: usize = 200;
/// The fit ends when the gradient's length is at most this share of the first gradient's.
const SMALL: f64 = 1e-4;
/// How often a step that does not reduce the loss is halved before the fit gives up.
const HALVINGS: usize = 20;

/// The weights of the features. The score of a row is their product; a row with a score above 0 is put into the class `true`.
#[derive(Debug)]
pub(super) struct Model {
    pub(super) weights: Vec<f64>,
}

impl Model {
    /// Minimises `w·w / 2 + cost * Σ ln(1 + exp(-y s))`, `y` being 1 or -1 and `s` a row's score.
    pub(super) fn fit(rows: &[&Row], classes: &[bool], features: usize, cost: f64) -> Self {
        let problem = Problem { rows, classes, features, cost };
        let mut model = Self { weights: vec![0.0; features] };
        let mut scores = vec![0.0; rows.len()];
        let mut loss = problem.loss(&model.weights, &scores);
        let mut first = None;
        for _ in 0..STEPS {
            let (gradient, bends) = problem.gradient(&model.weights, &scores);
            let length = dot(&gradient, &gradient).sqrt();
            if length <= SMALL * *first.get_or_insert(length) {
                break;
            }
            let step = problem.step(&gradient, &bends);
            let along: Vec<f64> = rows.iter().map(|row| score(&step, row)).collect();
            let better = (0..HALVINGS).map(|halved| 0.5_f64.powi(halved as i32)).find_map(|share| {
                let weights = sum(&model.weights, &step, share);
                let scores = sum(&scores, &along, share);
                let at = problem.loss(&weights, &scores);
                (at < loss).then_some((weights, scores, at))
            });
            let Some(better) = better else { break };
            (model.weights, scores, loss) = better;
        }
        model
    }

    pub(super) fn score(&self, row: &Row) -> f64 {
        score(&self.weights, row)
    }
}

struct Problem<'a> {
    rows: &'a [&'a Row],
    classes: &'a [bool],
    features: usize,
    cost: f64,
}

impl Problem<'_> {
    fn sides(&self) -> impl Iterator<Item = f64> {
        self.classes.iter().map(|class| if *class { 1.0 } else { -1.0 })
    }

    fn loss(&self, weights: &[f64], scores: &[f64]) -> f64 {
        let one = |(score, side): (&f64, f64)| {
            let margin = side * score;
            // The same as ln(1 + exp(-margin)), without overflow.
            (-margin).max(0.0) + (-margin.abs()).exp().ln_1p()
        };
        dot(weights, weights) / 2.0 + self.cost * scores.iter().zip(self.sides()).map(one).sum::<f64>()
    }

    /// The gradient, and for each row the second derivative of the loss along its score.
    fn gradient(&self, weights: &[f64], scores: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let mut gradient = weights.to_vec();
        let mut bends = Vec::with_capacity(self.rows.len());
        for ((row, score), side) in self.rows.iter().zip(scores).zip(self.sides()) {
            let chance = 1.0 / (1.0 + (-score).exp());
            let error = self.cost * (chance - (side + 1.0) / 2.0);
            bends.push(self.cost * chance * (1.0 - chance));
            row.iter().for_each(|(at, value)| gradient[*at] += error * value);
        }
        (gradient, bends)
    }

    /// The Newton step: minus the gradient, divided by the curvature.
    fn step(&self, gradient: &[f64], bends: &[f64]) -> Vec<f64> {
        let mut step = vec![0.0; self.features];
        let mut rest: Vec<f64> = gradient.iter().map(|value| -value).collect();
        let mut direction = rest.clone();
        let mut length = dot(&rest, &rest);
        let enough = length * 0.01;
        for _ in 0..INNER_STEPS {
            if length <= enough {
                break;
            }
            let bent = self.curvature(&direction, bends);
            let share = length / dot(&direction, &bent);
            step = sum(&step, &direction, share);
            rest = sum(&rest, &bent, -share);
            let next = dot(&rest, &rest);
            direction = sum(&rest, &direction, next / length);
            length = next;
        }
        step
    }

    fn curvature(&self, direction: &[f64], bends: &[f64]) -> Vec<f64> {
        let mut bent = direction.to_vec();
        for (row, bend) in self.rows.iter().zip(bends) {
            let along = bend * score(direction, row);
            row.iter().for_each(|(at, value)| bent[*at] += along * value);
        }
        bent
    }
}

fn score(weights: &[f64], row: &Row) -> f64 {
    row.iter().map(|(at, value)| weights[*at] * value).sum()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `a + share * b`
fn sum(a: &[f64], b: &[f64], share: f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + share * b).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_the_fit_no_small_change_makes_the_loss_less() {
        let rows: Vec<Row> = vec![
            vec![(0, 1.0), (2, 1.0)],
            vec![(0, 1.0), (1, 1.0), (2, 1.0)],
            vec![(1, 1.0), (2, 1.0)],
            vec![(0, 0.4), (2, 1.0)],
        ];
        let rows: Vec<&Row> = rows.iter().collect();
        let classes = [true, true, false, false];
        let problem = Problem { rows: &rows, classes: &classes, features: 3, cost: 0.3 };
        let Model { weights } = Model::fit(&rows, &classes, 3, 0.3);
        let loss = |weights: &[f64]| {
            let scores: Vec<f64> = rows.iter().map(|row| score(weights, row)).collect();
            problem.loss(weights, &scores)
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
        let row: Row = vec![(0, 1.0)];
        let model = Model::fit(&[&row, &row], &[true, false], 1, 0.3);
        assert!(model.score(&row).abs() < 1e-9);
    }
}
