//! All ways to cut a walk into consecutive stretches, one for each part of a text: the sum over them, and the share of each.

use std::ops::Range;

/// All ways to cut a walk among the parts of a text, and their scores. The score of a cut is the sum of the scores of its parts on their
/// stretches, and its share is a softmax of it.
#[derive(Debug)]
pub struct WalkCuts {
    /// For each part, the scores of the stretches, by [`stretch_index`].
    scores: Vec<Vec<f64>>,
    /// Number of places of the walk.
    places: usize,
    /// For each number of parts and each place: the log of the sum over the ways in which these parts lead there.
    before: Vec<Vec<f64>>,
    /// For each number of parts and each place: the log of the sum over the ways in which the other parts lead from there to the end.
    after: Vec<Vec<f64>>,
}

/// The log of the sum of two numbers, from their logs.
#[must_use]
pub fn log_sum(a: f64, b: f64) -> f64 {
    let (high, low) = if a > b { (a, b) } else { (b, a) };
    if low == f64::NEG_INFINITY { high } else { high + (low - high).exp().ln_1p() }
}

/// The index of a stretch among all stretches of a walk with this number of places.
#[must_use]
pub fn stretch_index(places: usize, [from, to]: [usize; 2]) -> usize {
    from * places + to
}

/// The stretches of a walk with this number of places: from each place to itself and each later one.
pub fn all_stretches(places: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..places).flat_map(move |from| (from..places).map(move |to| [from, to]))
}

impl WalkCuts {
    /// `scores` has, for each part, a score for each pair of places; those of no stretch are ignored. A walk has one place at least.
    #[must_use]
    pub fn new(scores: Vec<Vec<f64>>, places: usize) -> Self {
        let nothing = vec![vec![f64::NEG_INFINITY; places]; scores.len() + 1];
        let (mut before, mut after) = (nothing.clone(), nothing);
        before[0][0] = 0.0;
        after[scores.len()][places - 1] = 0.0;
        for (part, scores) in scores.iter().enumerate() {
            for stretch @ [from, to] in all_stretches(places) {
                let sum = before[part][from] + scores[stretch_index(places, stretch)];
                before[part + 1][to] = log_sum(before[part + 1][to], sum);
            }
        }
        for (part, scores) in scores.iter().enumerate().rev() {
            for stretch @ [from, to] in all_stretches(places) {
                let sum = after[part + 1][to] + scores[stretch_index(places, stretch)];
                after[part][from] = log_sum(after[part][from], sum);
            }
        }
        Self { scores, places, before, after }
    }

    /// The log of the sum over all cuts.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.after[0][0]
    }

    /// The share of the cuts in which a part takes a stretch.
    #[must_use]
    pub fn stretch_share(&self, part: usize, stretch: [usize; 2]) -> f64 {
        let score = self.scores[part][stretch_index(self.places, stretch)];
        (self.before[part][stretch[0]] + score + self.after[part + 1][stretch[1]] - self.total()).exp()
    }

    /// The share of the cuts in which consecutive parts together take a stretch.
    #[must_use]
    pub fn joint_share(&self, parts: Range<usize>, [from, to]: [usize; 2]) -> f64 {
        let mut sums = vec![f64::NEG_INFINITY; self.places];
        sums[from] = 0.0;
        for part in parts.clone() {
            let mut next = vec![f64::NEG_INFINITY; self.places];
            for (at, before) in sums.iter().enumerate().take(to + 1).skip(from) {
                for (end, sum) in next.iter_mut().enumerate().take(to + 1).skip(at) {
                    *sum = log_sum(*sum, before + self.scores[part][stretch_index(self.places, [at, end])]);
                }
            }
            sums = next;
        }
        (self.before[parts.start][from] + sums[to] + self.after[parts.end][to] - self.total()).exp()
    }

    /// For each place, the share of the cuts in which a part ends there.
    #[must_use]
    pub fn end_shares(&self, part: usize) -> Vec<f64> {
        let (before, after) = (&self.before[part + 1], &self.after[part + 1]);
        before.iter().zip(after).map(|(before, after)| (before + after - self.total()).exp()).collect()
    }

    /// The cut with the highest score, as the stretch of each part.
    #[must_use]
    pub fn best_cut(&self) -> Vec<[usize; 2]> {
        let parts = self.scores.len();
        // For each number of parts and each place, the highest score, and where the last of these parts begins.
        let mut best = vec![vec![(f64::NEG_INFINITY, 0); self.places]; parts + 1];
        best[0][0].0 = 0.0;
        for part in 0..parts {
            for stretch @ [from, to] in all_stretches(self.places) {
                let score = best[part][from].0 + self.scores[part][stretch_index(self.places, stretch)];
                if score > best[part + 1][to].0 {
                    best[part + 1][to] = (score, from);
                }
            }
        }
        let mut to = self.places - 1;
        let mut cut: Vec<[usize; 2]> = (0..parts)
            .rev()
            .map(|part| {
                let from = best[part + 1][to].1;
                let stretch = [from, to];
                to = from;
                stretch
            })
            .collect();
        cut.reverse();
        cut
    }
}

#[cfg(test)]
mod tests;
