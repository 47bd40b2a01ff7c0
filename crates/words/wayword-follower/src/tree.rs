//! The walks that a text may mean, as a tree: walks with the same beginning share its nodes.

use crate::building::{KnownBuilding, wrap_angle};
use std::collections::BTreeMap;

/// Walks from one viewpoint. Each node is the end of one walk, and its `before` is the node one hop earlier. Node 0 is the start.
#[derive(Debug, Clone)]
pub struct WalkTree {
    pub(crate) nodes: Vec<WalkNode>,
}

/// A walk of a tree: the one that ends at this node.
#[derive(Debug, Clone)]
pub(crate) struct WalkNode {
    pub(crate) viewpoint: usize,
    /// The node before it on the walk; node 0 for the start itself.
    pub(crate) before: usize,
    /// Hops from the start.
    pub(crate) hops: usize,
    /// Which way the walker looks there, radians from +y clockwise.
    pub(crate) heading_rad: f64,
    /// The turn before the hop that leads there, radians, positive right.
    pub(crate) turn_rad: f64,
    /// The length of that hop, metres.
    pub(crate) length_m: f64,
    /// The other ways at the start of that hop, and the ways here.
    pub(crate) ways: NodeWays,
}

/// The ways out of a viewpoint, as seen by a walker that arrived there and goes on.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct NodeWays {
    /// Whether a way goes straight on from here.
    pub(crate) onward: bool,
    /// Whether a way leads off here to the left, and to the right.
    pub(crate) aside: [bool; 2],
    /// How many ways at the start of the hop here were nearer to straight ahead than the one taken.
    pub(crate) straighter: usize,
    /// How many ways at the start of the hop here were on the side of the one taken and nearer to a right angle.
    pub(crate) squarer: usize,
}

/// The set of walks that are considered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WalkPrior {
    /// The shortest path to each viewpoint, up to a number of hops.
    Shortest(usize),
    /// Walks of two shortest paths, one after the other, that pass no viewpoint twice, up to a number of hops.
    TwoPieces(usize),
}

/// Largest angle from straight ahead of a way that goes straight on, radians.
const ONWARD_RAD: f64 = 0.6;
/// Angles from straight ahead at which a way leads off to a side, radians.
const ASIDE_RAD: std::ops::Range<f64> = 0.8..2.4;
/// Least difference of angle for a way to count as better than another, radians.
const BETTER_RAD: f64 = 0.2;

impl Default for WalkPrior {
    /// The shortest paths of up to 8 hops: people's paths in R2R and REVERIE are shortest paths of 4 to 7.
    fn default() -> Self {
        Self::Shortest(8)
    }
}

/// Most nodes of a tree, because a large building has very many walks of two pieces. Beyond it no more of these are added.
const MAX_NODES: usize = 20_000;

impl NodeWays {
    /// Records the ways out of a viewpoint, by their turns (radians, positive right).
    fn note_ways(&mut self, turns: &[f64]) {
        self.onward = turns.iter().any(|rad| rad.abs() < ONWARD_RAD);
        self.aside = [-1.0, 1.0].map(|sign| turns.iter().any(|rad| ASIDE_RAD.contains(&(sign * rad))));
    }

    /// Compares a turn with the others that were possible.
    fn compare_turn(&mut self, turns: &[f64], taken_rad: f64) {
        let off = |rad: f64| (rad.abs() - std::f64::consts::FRAC_PI_2).abs();
        let is_straighter = |rad: &&f64| rad.abs() + BETTER_RAD < taken_rad.abs();
        let is_squarer = |rad: &&f64| *rad * taken_rad > 0.0 && off(**rad) + BETTER_RAD < off(taken_rad);
        self.straighter = turns.iter().filter(is_straighter).count();
        self.squarer = turns.iter().filter(is_squarer).count();
    }
}

impl WalkTree {
    /// The walks from a start that looks along `heading_rad` (radians from +y, clockwise).
    #[must_use]
    pub fn from_prior(building: &KnownBuilding, start: usize, heading_rad: f64, prior: WalkPrior) -> Self {
        match prior {
            WalkPrior::Shortest(hops) => Self::shortest_paths(building, start, heading_rad, hops),
            WalkPrior::TwoPieces(hops) => Self::two_pieces(building, start, heading_rad, hops),
        }
    }

    /// One walk alone, and its beginnings.
    #[must_use]
    pub fn single_walk(building: &KnownBuilding, walk: &[usize], heading_rad: f64) -> Self {
        let mut tree = Self::begin_at(building, walk.first().copied().unwrap_or_default(), heading_rad);
        for (at, viewpoint) in walk.iter().skip(1).enumerate() {
            tree.add_hop(building, at, *viewpoint);
        }
        tree
    }

    /// A tree with the start alone.
    fn begin_at(building: &KnownBuilding, viewpoint: usize, heading_rad: f64) -> Self {
        let mut ways = NodeWays::default();
        if viewpoint < building.len() {
            ways.note_ways(&building.turns_from(viewpoint, heading_rad));
        }
        Self {
            nodes: vec![WalkNode { viewpoint, before: 0, hops: 0, heading_rad, turn_rad: 0.0, length_m: 0.0, ways }],
        }
    }

    /// Adds a walk that is one hop longer than another; returns its node.
    fn add_hop(&mut self, building: &KnownBuilding, before: usize, viewpoint: usize) -> usize {
        let from = &self.nodes[before];
        let (bearing_rad, length_m) = building.hop_between(from.viewpoint, viewpoint);
        let heading_rad = bearing_rad.unwrap_or(from.heading_rad);
        let turn_rad = wrap_angle(heading_rad - from.heading_rad);
        let mut ways = NodeWays::default();
        ways.compare_turn(&building.turns_from(from.viewpoint, from.heading_rad), turn_rad);
        ways.note_ways(&building.turns_from(viewpoint, heading_rad));
        self.nodes.push(WalkNode { viewpoint, before, hops: from.hops + 1, heading_rad, turn_rad, length_m, ways });
        self.nodes.len() - 1
    }

    /// The shortest path (metres) to each viewpoint, up to a number of hops.
    pub(crate) fn shortest_paths(building: &KnownBuilding, start: usize, heading_rad: f64, most_hops: usize) -> Self {
        let count = building.len();
        let mut far_m = vec![f64::INFINITY; count];
        // For each viewpoint, the node of the viewpoint before it on its shortest path.
        let mut before: Vec<Option<usize>> = vec![None; count];
        let mut is_done = vec![false; count];
        let mut tree = Self::begin_at(building, start, heading_rad);
        far_m[start] = 0.0;
        loop {
            let open = (0..count).filter(|at| !is_done[*at] && far_m[*at].is_finite());
            let Some(here) = open.min_by(|a, b| far_m[*a].total_cmp(&far_m[*b])) else { return tree };
            is_done[here] = true;
            let node = before[here].map_or(0, |before| tree.add_hop(building, before, here));
            if tree.nodes[node].hops == most_hops {
                continue;
            }
            for to in &building.viewpoints[here].neighbours {
                let way_m = far_m[here] + building.hop_between(here, *to).1;
                if way_m < far_m[*to] - 1e-9 {
                    far_m[*to] = way_m;
                    before[*to] = Some(node);
                }
            }
        }
    }

    /// Walks of two shortest paths, one after the other, that pass no viewpoint twice.
    fn two_pieces(building: &KnownBuilding, start: usize, heading_rad: f64, most_hops: usize) -> Self {
        let mut tree = Self::shortest_paths(building, start, heading_rad, most_hops);
        // The node of each hop, by the node before and the viewpoint: walks with the same beginning share nodes.
        let mut onward: BTreeMap<(usize, usize), usize> =
            tree.nodes.iter().enumerate().skip(1).map(|(at, node)| ((node.before, node.viewpoint), at)).collect();
        let first = tree.clone();
        for node in 1..first.nodes.len() {
            let way = first.viewpoints(node);
            let rest = most_hops - first.nodes[node].hops;
            let second = Self::shortest_paths(building, first.nodes[node].viewpoint, 0.0, rest);
            // For each node of the second piece, the whole walk's node; `None` where it passes a viewpoint twice.
            let mut whole = vec![Some(node)];
            for piece in &second.nodes[1..] {
                let at = whole[piece.before].filter(|_| !way.contains(&piece.viewpoint)).map(|before| {
                    let key = (before, piece.viewpoint);
                    *onward.entry(key).or_insert_with(|| tree.add_hop(building, before, piece.viewpoint))
                });
                whole.push(at);
            }
            if tree.nodes.len() > MAX_NODES {
                break;
            }
        }
        tree
    }

    /// Adds a walk from the tree's start, where it is not there yet; returns its node.
    pub(crate) fn add_walk(&mut self, building: &KnownBuilding, walk: &[usize]) -> usize {
        walk.iter().skip(1).fold(0, |before, viewpoint| {
            let is_next = |node: &WalkNode| node.hops > 0 && node.before == before && node.viewpoint == *viewpoint;
            let known = self.nodes.iter().position(is_next);
            known.unwrap_or_else(|| self.add_hop(building, before, *viewpoint))
        })
    }

    /// Number of walks, the start alone among them.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is no walk but the start alone.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.len() <= 1
    }

    /// The viewpoint where a walk ends.
    #[must_use]
    pub fn end_viewpoint(&self, walk: usize) -> usize {
        self.nodes[walk].viewpoint
    }

    /// The nodes of a walk, from its end back to the start.
    pub(crate) fn nodes_back(&self, walk: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(Some(walk), |at| (*at != 0).then(|| self.nodes[*at].before))
    }

    /// The viewpoints of a walk, from the start on.
    #[must_use]
    pub fn viewpoints(&self, walk: usize) -> Vec<usize> {
        let mut viewpoints: Vec<usize> = self.nodes_back(walk).map(|at| self.nodes[at].viewpoint).collect();
        viewpoints.reverse();
        viewpoints
    }

    /// The turns before the hops of a walk, radians, positive right. The first is from the walker's first direction.
    #[must_use]
    pub fn turns_rad(&self, walk: usize) -> Vec<f64> {
        let mut turns_rad: Vec<f64> =
            self.nodes_back(walk).take(self.nodes[walk].hops).map(|at| self.nodes[at].turn_rad).collect();
        turns_rad.reverse();
        turns_rad
    }

    /// The walk with exactly these viewpoints, if the tree has it.
    #[must_use]
    pub fn find_walk(&self, viewpoints: &[usize]) -> Option<usize> {
        let is_it = |at: &usize| self.nodes[*at].hops + 1 == viewpoints.len() && self.viewpoints(*at) == viewpoints;
        let end = viewpoints.last()?;
        (0..self.nodes.len()).filter(|at| self.nodes[*at].viewpoint == *end).find(is_it)
    }
}

#[cfg(test)]
mod tests;
