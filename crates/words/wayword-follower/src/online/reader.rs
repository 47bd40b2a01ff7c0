//! The walker's decisions.

use super::{
    map::{Map, Sighting},
    onward::{AWAY, Onward, OnwardSlope, OnwardWeights},
};
use crate::{
    Prior,
    fit::Fit,
    guide::{Guide, Trial},
    tree::Tree,
};

/// What a walker does at a viewpoint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Decision {
    /// Takes a hop of the sighting, by its number.
    Go(usize),
    /// Ends the walk.
    Stop,
}

/// A walker that reads.
#[derive(Debug)]
pub struct Reader<'a> {
    guide: &'a Guide,
    weights: &'a OnwardWeights,
    map: Map,
    /// The viewpoints that it goes to one after another, the next one last; then it decides anew, or stops.
    planned: Vec<usize>,
    /// Whether it stops at the end of what is planned.
    then_stops: bool,
    hops: usize,
}

/// Most hops of a walker. Then it stops where it stands.
const MOST_STEPS: usize = 24;
/// Most hops from the start of the walks that it thinks of.
const MOST_HOPS: usize = 10;
/// What speaks against each hop to an option besides the fitted weights. They are fitted to get to the goal at all; going
/// back and forth costs, too.
const CAUTION: f64 = 0.3;

/// What a walker could do next.
struct Options {
    /// The walks from the start.
    tree: Tree,
    /// The ways from where the walker stands.
    back: Tree,
    /// For each walk, the class of hops from there to its end.
    away: Vec<usize>,
    fit: Fit,
    onward: Onward,
    /// For each walk, how good it is to stop there, and to go on to it.
    stop: Vec<f64>,
    go: Vec<f64>,
}

impl<'a> Reader<'a> {
    /// A walker at the start of an instruction, looking ahead.
    #[must_use]
    pub fn new(guide: &'a Guide, weights: &'a OnwardWeights) -> Self {
        Self { guide, weights, map: Map::new(), planned: Vec::new(), then_stops: false, hops: 0 }
    }

    /// Looks around, and decides.
    pub fn decide(&mut self, seen: &Sighting) -> Decision {
        self.look(seen);
        if self.planned.is_empty() {
            if self.then_stops || self.hops >= MOST_STEPS || self.guide.is_empty() {
                return Decision::Stop;
            }
            self.plan();
        }
        let Some(to) = self.planned.pop() else { return Decision::Stop };
        let hop = self.map.ways[self.map.here].iter().position(|way| *way == to);
        hop.map_or(Decision::Stop, |hop| {
            self.take(hop);
            Decision::Go(hop)
        })
    }

    /// Looks around.
    pub fn look(&mut self, seen: &Sighting) {
        self.map.look(seen);
    }

    /// Takes a hop of the sighting here.
    pub fn take(&mut self, hop: usize) {
        if let Some(to) = self.map.ways[self.map.here].get(hop) {
            self.map.go(*to);
            self.hops += 1;
        }
    }

    /// Whether it is on its way to something that it decided on before.
    #[must_use]
    pub fn is_on_its_way(&self) -> bool {
        !self.planned.is_empty()
    }

    /// Takes back a decision to stop.
    pub fn go_on(&mut self) {
        self.planned.clear();
        self.then_stops = false;
    }

    /// Which way it looks, from the way it looked first, radians clockwise.
    #[must_use]
    pub fn heading_rad(&self) -> f64 {
        self.map.heading_rad
    }

    /// Plans the next hop: the one behind which most of what the text may mean lies; or to stop here.
    fn plan(&mut self) {
        let trial = Trial::seen(self.guide, &self.map.building);
        let options = self.options(&trial);
        let cost = |at: usize| CAUTION * options.away[at % options.tree.len()] as f64;
        let all = || options.stop.iter().chain(&options.go).enumerate().map(|(at, worth)| (at, worth - cost(at)));
        let highest = all().map(|(_, worth)| worth).fold(f64::NEG_INFINITY, f64::max);
        let mut shares = vec![0.0; self.map.building.len()];
        for (at, worth) in all().filter(|(_, worth)| worth.is_finite()) {
            let end = options.tree.end(at % options.tree.len());
            let node = (0..options.back.len()).find(|node| options.back.end(*node) == end).unwrap_or(0);
            // The first hop on the way there; none where the walker would stop here.
            let hop = options.back.back(node).take_while(|node| *node != 0).last().unwrap_or(0);
            shares[options.back.end(hop)] += (worth - highest).exp();
        }
        let best = (0..shares.len()).max_by(|a, b| shares[*a].total_cmp(&shares[*b])).unwrap_or(self.map.here);
        self.then_stops = best == self.map.here;
        if best != self.map.here {
            self.planned.push(best);
        }
    }

    fn options(&self, trial: &Trial<'_>) -> Options {
        let building = &self.map.building;
        let tree = Tree::of(building, 0, 0.0, Prior::Shortest(MOST_HOPS));
        let back = Tree::shortest(building, self.map.here, 0.0, usize::MAX);
        let mut away = vec![AWAY - 1; building.len()];
        for node in &back.nodes {
            away[node.viewpoint] = node.hops.min(AWAY - 1);
        }
        let fit = Fit::new(trial, &tree, &self.weights.done);
        let onward = Onward::new(trial, &tree, &fit, self.weights);
        let away: Vec<usize> = (0..tree.len()).map(|node| away[tree.end(node)]).collect();
        let is_known = |node: usize| building.viewpoints[tree.end(node)].is_known;
        let stop = |node: usize| match node > 0 && is_known(node) {
            true => fit.score(node) + self.weights.away[0][away[node]],
            false => f64::NEG_INFINITY,
        };
        let stop = (0..tree.len()).map(stop).collect();
        let go = (0..tree.len()).map(|node| onward.score(node) + self.weights.away[1][away[node]]).collect();
        Options { tree, back, away, fit, onward, stop, go }
    }

    /// Adds to a slope what would have been right here: to go to the end of the shortest way to the goal that is known,
    /// or to stop at the goal. The way is given by its hops, each by its number at its viewpoint.
    pub fn learn(&self, way: impl IntoIterator<Item = usize>, slope: &mut OnwardSlope) {
        let mut right = self.map.here;
        for hop in way {
            match self.map.ways[right].get(hop) {
                Some(to) => right = *to,
                None => return,
            }
            if !self.map.building.viewpoints[right].is_known {
                break;
            }
        }
        let is_stop = self.map.building.viewpoints[right].is_known;
        let trial = Trial::seen(self.guide, &self.map.building);
        let options = self.options(&trial);
        let all = || options.stop.iter().chain(&options.go).copied();
        let highest = all().fold(f64::NEG_INFINITY, f64::max);
        let whole: f64 = all().map(|score| (score - highest).exp()).sum();
        let share = |score: &f64| (score - highest).exp() / whole;
        let mut by_stop: Vec<f64> = options.stop.iter().map(share).collect();
        let mut by_going: Vec<f64> = options.go.iter().map(share).collect();
        let Some(node) = (1..options.tree.len()).find(|node| options.tree.end(*node) == right) else { return };
        let by = if is_stop { &mut by_stop } else { &mut by_going };
        if !by[node].is_normal() {
            return;
        }
        slope.loss -= by[node].ln();
        by[node] -= 1.0;
        for (by, away) in [&by_stop, &by_going].into_iter().zip(&mut slope.away) {
            by.iter().zip(&options.away).for_each(|(by, class)| away[*class] += by);
        }
        slope.add(&trial, &options.tree, (&options.fit, &options.onward), [&by_stop, &by_going]);
    }
}
