//! Aligns the parts of a text with a known walk: finds for each part the stretch of the walk that it describes, and how sure that is.
//!
//! All ways to cut the walk into consecutive stretches, one for each part, are compared. The score of a way is a sum of weights of
//! features of each part on its stretch: how long it is, which turns and climbs it has, and the follower's own score of the part's
//! steps there. The share of a way is a softmax of these scores. The weights are fitted to stretches that people gave to the parts of
//! R2R's texts (Fine-Grained R2R, Hong et al. 2020).

mod features;
mod learn;
mod parts;
mod places;
mod tables;
mod weights;

pub use learn::{AlignmentLearner, AlignmentSlope};
pub use parts::{PartedText, TextPart};
pub(crate) use places::walk_places;
pub use weights::{AlignmentWeights, PartReading};

use crate::{building::KnownBuilding, fit::WalkFit, guide::GuideTrial, tree::WalkTree, weights::FeatureWeights};
use features::{AlignedWalk, PartedTrial, ValuedFeature};
use wayword_core::{
    InstructionPart,
    walk_cuts::{WalkCuts, all_stretches, log_sum, stretch_index},
};

/// The alignment of a text with a walk.
#[derive(Debug, Clone, PartialEq)]
pub struct WalkAlignment {
    /// The parts of the text, in order.
    pub parts: Vec<AlignedPart>,
}

impl WalkAlignment {
    /// The parts as records have them. The places of the walk are the frames of the path.
    #[must_use]
    pub fn into_parts(self) -> Vec<InstructionPart> {
        let part = |part: AlignedPart| InstructionPart {
            span: part.span,
            frames: part.stretch,
            confidence: Some(part.confidence),
        };
        self.parts.into_iter().map(part).collect()
    }
}

/// A part of a text with its stretch of the walk. Places of the walk are numbered from 0.
#[derive(Debug, Clone, PartialEq)]
pub struct AlignedPart {
    /// Its byte range in the text.
    pub span: [usize; 2],
    /// The places where it begins and ends on the best way to cut the walk. The next part begins where it ends.
    pub stretch: [usize; 2],
    /// How likely it takes exactly this stretch, from 0 to 1.
    pub confidence: f64,
    /// For each place of the walk, how likely the part ends there.
    pub end_shares: Vec<f64>,
}

impl AlignedPart {
    /// The place where the part ends with a probability of at least one half that it ends there or before.
    #[must_use]
    pub fn median_end(&self) -> usize {
        let mut sum = 0.0;
        let reaches_half = |share: &f64| {
            sum += share;
            sum >= 0.5
        };
        self.end_shares.iter().position(reaches_half).unwrap_or(self.end_shares.len().saturating_sub(1))
    }

    /// The likeliest place for its end.
    #[must_use]
    pub fn likeliest_end(&self) -> usize {
        let places = self.end_shares.iter().enumerate();
        places.max_by(|a, b| a.1.total_cmp(b.1).then(b.0.cmp(&a.0))).map_or(0, |(place, _)| place)
    }
}

/// A text with a known walk in a building: what an alignment needs, for any weights.
#[derive(Debug)]
pub struct AlignmentCase<'a> {
    trial: PartedTrial<'a>,
    /// The index in the walk of each place between which it is cut.
    walk_places: Vec<usize>,
    /// Length of the walk, viewpoints.
    walk_len: usize,
    /// For each part and stretch, the follower's score of the part's steps, natural logs.
    follower_scores: Vec<Vec<f64>>,
}

impl<'a> AlignmentCase<'a> {
    /// `walk` lists the viewpoints of the walk, one at least, and `heading_rad` is the direction of the walker at its start (radians from +y,
    /// clockwise).
    #[must_use]
    pub fn new(
        text: &'a PartedText,
        building: &KnownBuilding,
        walk: &[usize],
        heading_rad: f64,
        follower: &FeatureWeights,
    ) -> Self {
        let walk_places = places::walk_places(building, walk);
        let cut_walk: Vec<usize> = walk_places.iter().map(|place| walk[*place]).collect();
        let tree = WalkTree::single_walk(building, &cut_walk, heading_rad);
        let trial = PartedTrial { text, walk: AlignedWalk::new(building, &tree) };
        let fit = WalkFit::from_anywhere(&GuideTrial::new(&text.guide, building), &tree, follower);
        let follower_scores = (0..text.parts.len()).map(|part| follower_scores(text, part, &fit, tree.len())).collect();
        Self { trial, walk_places, walk_len: walk.len(), follower_scores }
    }

    /// Aligns the text.
    #[must_use]
    pub fn align_parts(&self, weights: &AlignmentWeights) -> WalkAlignment {
        let cuts = self.walk_cuts(weights);
        let cut = cuts.best_cut();
        let parts = self.trial.text.parts.iter().zip(cut).enumerate().map(|(number, (part, stretch))| AlignedPart {
            span: part.span,
            stretch: stretch.map(|place| self.walk_places[place]),
            confidence: cuts.stretch_share(number, stretch),
            end_shares: self.shares_along_walk(&cuts.end_shares(number)),
        });
        WalkAlignment { parts: parts.collect() }
    }

    /// Shares of the places, for each viewpoint of the walk; 0 where it is not cut.
    fn shares_along_walk(&self, shares: &[f64]) -> Vec<f64> {
        let mut along = vec![0.0; self.walk_len];
        self.walk_places.iter().zip(shares).for_each(|(place, share)| along[*place] = *share);
        along
    }

    /// The number of the place at a viewpoint of the walk, or of the next one after it.
    fn place_near(&self, at: usize) -> usize {
        self.walk_places.partition_point(|place| *place < at).min(self.places() - 1)
    }

    /// Number of places between which the walk is cut.
    fn places(&self) -> usize {
        self.trial.walk.last_place() + 1
    }

    fn walk_cuts(&self, weights: &AlignmentWeights) -> WalkCuts {
        let places = self.places();
        let mut found = Vec::new();
        let score_part = |part: usize| {
            let mut scores = vec![f64::NEG_INFINITY; places * places];
            for stretch in all_stretches(places) {
                found.clear();
                self.part_features(part, stretch, weights.reading, &mut found);
                scores[stretch_index(places, stretch)] = weights.sum_weights(&found);
            }
            scores
        };
        WalkCuts::new((0..self.trial.text.parts.len()).map(score_part).collect(), places)
    }

    fn part_features(&self, part: usize, stretch: [usize; 2], reading: PartReading, found: &mut Vec<ValuedFeature>) {
        self.trial.length_features(part, stretch, found);
        if reading == PartReading::Words {
            let score = self.follower_scores[part][stretch_index(self.places(), stretch)];
            self.trial.word_features(part, stretch, score, found);
        }
    }
}

/// The follower's score of a part's steps on each stretch: the sum over all ways to cut the stretch, one piece for each step. Where the
/// steps cannot lead so far, the score is below the lowest of the others.
fn follower_scores(text: &PartedText, part: usize, fit: &WalkFit, places: usize) -> Vec<f64> {
    /// How much lower than the lowest score a stretch is that the steps cannot take, natural logs.
    const UNREACHED_LOSS: f64 = 3.0;
    let steps = text.parts[part].steps.clone();
    let mut scores = vec![0.0; places * places];
    if steps.is_empty() {
        return scores;
    }
    for from in 0..places {
        let mut sums = vec![f64::NEG_INFINITY; places];
        sums[from] = 0.0;
        for step in steps.clone() {
            let ends = (0..places).map(|end| {
                let reached = (from..=end).filter(|at| sums[*at].is_finite());
                let sum = |at: usize| sums[at] + fit.stretch_weight(places, step, end, end - at);
                reached.map(sum).fold(f64::NEG_INFINITY, log_sum)
            });
            sums = ends.collect();
        }
        (from..places).for_each(|to| scores[stretch_index(places, [from, to])] = sums[to]);
    }
    let stretches = || all_stretches(places).map(|stretch| stretch_index(places, stretch));
    let lowest = stretches().map(|at| scores[at]).filter(|score| score.is_finite()).fold(0.0, f64::min);
    for at in stretches().collect::<Vec<_>>() {
        if !scores[at].is_finite() {
            scores[at] = lowest - UNREACHED_LOSS;
        }
    }
    scores
}

#[cfg(test)]
mod tests;
