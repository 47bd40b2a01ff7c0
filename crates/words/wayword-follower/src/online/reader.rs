//! The walker: it looks, scores all options that it knows, and decides where to go or to stop.

use super::{
    map::{WalkerMap, WalkerSighting},
    onward::{HOPS_AWAY_CLASSES, OnwardFit, OnwardSlope, OnwardWeights},
};
use crate::{
    WalkPrior,
    fit::WalkFit,
    guide::{Guide, GuideTrial},
    tree::WalkTree,
};

/// A walker's decision at a viewpoint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WalkerDecision {
    /// Takes a hop of the sighting, by its number.
    Go(usize),
    /// Ends the walk.
    Stop,
}

/// A walker that follows an instruction.
#[derive(Debug)]
pub struct WalkingFollower<'a> {
    guide: &'a Guide,
    weights: &'a OnwardWeights,
    map: WalkerMap,
    /// Hops so far.
    hops: usize,
}

/// Most hops of a walker. After these it stops wherever it is.
const MAX_WALKER_HOPS: usize = 60;
/// Most hops of the walks from the start that a walker considers.
const MAX_CONSIDERED_HOPS: usize = 24;
/// Deduction for each hop to an option, natural logs, in addition to the fitted weights. The fit only rewards reaching the goal;
/// going back and forth on the way has a cost too.
const HOP_COST: f64 = 0.3;

/// A walker's options at its viewpoint.
struct WalkerChoices {
    /// The walks from the start.
    tree: WalkTree,
    /// For each walk, the class of hops from the walker's viewpoint to its end.
    away: Vec<usize>,
    /// For each walk, the first viewpoint on the way from there to its end; the walker's own where it ends there.
    next: Vec<usize>,
    fit: WalkFit,
    onward: OnwardFit,
    /// For each walk, the score of stopping at its end, and of going on to it.
    stop: Vec<f64>,
    go: Vec<f64>,
}

impl<'a> WalkingFollower<'a> {
    /// A walker at the start of an instruction, looking ahead.
    #[must_use]
    pub fn new(guide: &'a Guide, weights: &'a OnwardWeights) -> Self {
        Self { guide, weights, map: WalkerMap::new(), hops: 0 }
    }

    /// Adds a sighting to the map, and decides.
    pub fn decide_next(&mut self, sighting: &WalkerSighting) -> WalkerDecision {
        self.look_around(sighting);
        if self.hops >= MAX_WALKER_HOPS || self.guide.is_empty() {
            return WalkerDecision::Stop;
        }
        let next = self.next_viewpoint();
        let hop = self.map.ways[self.map.here].iter().position(|way| *way == next && next != self.map.here);
        hop.map_or(WalkerDecision::Stop, |hop| {
            self.take_hop(hop);
            WalkerDecision::Go(hop)
        })
    }

    /// Adds a sighting at the walker's viewpoint to the map.
    pub fn look_around(&mut self, sighting: &WalkerSighting) {
        self.map.note_sighting(sighting);
    }

    /// Takes a hop of the sighting here.
    pub fn take_hop(&mut self, hop: usize) {
        if let Some(to) = self.map.ways[self.map.here].get(hop) {
            self.map.go_to(*to);
            self.hops += 1;
        }
    }

    /// The viewpoint to go to next: the one behind which most of the probability lies; the walker's own if it should
    /// stop.
    fn next_viewpoint(&self) -> usize {
        let options = self.find_choices(&GuideTrial::new_partial(self.guide, &self.map.building));
        let cost = |walk: usize| HOP_COST * options.away[walk] as f64;
        let both = options.stop.iter().enumerate().chain(options.go.iter().enumerate());
        let all: Vec<(usize, f64)> = both.map(|(walk, score)| (walk, score - cost(walk))).collect();
        let highest = all.iter().map(|(_, score)| *score).fold(f64::NEG_INFINITY, f64::max);
        let mut shares = vec![0.0; self.map.building.len()];
        for (walk, score) in all.iter().filter(|(_, score)| score.is_finite()) {
            shares[options.next[*walk]] += (score - highest).exp();
        }
        (0..shares.len()).max_by(|a, b| shares[*a].total_cmp(&shares[*b])).unwrap_or(self.map.here)
    }

    /// Scores stopping at each known viewpoint, and going on to each unvisited one.
    fn find_choices(&self, trial: &GuideTrial<'_>) -> WalkerChoices {
        let building = &self.map.building;
        let tree = WalkTree::from_prior(building, 0, 0.0, WalkPrior::Shortest(MAX_CONSIDERED_HOPS));
        let back = WalkTree::shortest_paths(building, self.map.here, 0.0, usize::MAX);
        let (mut away, mut next) = (vec![HOPS_AWAY_CLASSES - 1; building.len()], vec![self.map.here; building.len()]);
        for node in &back.nodes {
            away[node.viewpoint] = node.hops.min(HOPS_AWAY_CLASSES - 1);
            next[node.viewpoint] = if node.hops > 1 { next[back.end_viewpoint(node.before)] } else { node.viewpoint };
        }
        let fit = WalkFit::new(trial, &tree, &self.weights.done);
        let onward = OnwardFit::new(trial, &tree, &fit, self.weights);
        let [away, next] = [away, next]
            .map(|by_viewpoint| (0..tree.len()).map(|walk| by_viewpoint[tree.end_viewpoint(walk)]).collect::<Vec<_>>());
        let is_known = |node: usize| building.viewpoints[tree.end_viewpoint(node)].is_known;
        let stop = |node: usize| match node > 0 && is_known(node) {
            true => fit.score(node) + self.weights.away[0][away[node]],
            false => f64::NEG_INFINITY,
        };
        let stop = (0..tree.len()).map(stop).collect();
        let go = (0..tree.len()).map(|node| onward.score(node) + self.weights.away[1][away[node]]).collect();
        WalkerChoices { tree, away, next, fit, onward, stop, go }
    }

    /// Adds the right decision at this viewpoint to a gradient: to go to the last known viewpoint of the shortest way
    /// to the goal, or to stop at the goal. The way is given by its hops, each by its number at its viewpoint.
    pub fn learn_decision(&self, way: impl IntoIterator<Item = usize>, slope: &mut OnwardSlope) {
        let mut target = self.map.here;
        for hop in way {
            match self.map.ways[target].get(hop) {
                Some(to) => target = *to,
                None => return,
            }
            if !self.map.building.viewpoints[target].is_known {
                break;
            }
        }
        let is_stop = self.map.building.viewpoints[target].is_known;
        let trial = GuideTrial::new_partial(self.guide, &self.map.building);
        let options = self.find_choices(&trial);
        let all = || options.stop.iter().chain(&options.go).copied();
        let highest = all().fold(f64::NEG_INFINITY, f64::max);
        let whole: f64 = all().map(|score| (score - highest).exp()).sum();
        let share = |score: &f64| (score - highest).exp() / whole;
        let mut by_stop: Vec<f64> = options.stop.iter().map(share).collect();
        let mut by_going: Vec<f64> = options.go.iter().map(share).collect();
        let Some(node) = (1..options.tree.len()).find(|node| options.tree.end_viewpoint(*node) == target) else {
            return;
        };
        let by = if is_stop { &mut by_stop } else { &mut by_going };
        if !by[node].is_normal() {
            return;
        }
        slope.loss -= by[node].ln();
        by[node] -= 1.0;
        for (by, away) in [&by_stop, &by_going].into_iter().zip(&mut slope.away) {
            by.iter().zip(&options.away).for_each(|(by, class)| away[*class] += by);
        }
        slope.add_decision(&trial, &options.tree, (&options.fit, &options.onward), [&by_stop, &by_going]);
    }
}

#[cfg(test)]
mod tests;
