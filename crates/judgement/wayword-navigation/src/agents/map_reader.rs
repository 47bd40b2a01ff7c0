//! The agent that reads and knows the map: every viewpoint of the scene, every room and every label. Its figures show how much of
//! the way an instruction determines for a reader who knows the building.

use super::{Start, Walked, baselines::follow};
use crate::{directions::beginning_of, error::WalkError};
use wayword_core::{Survey, ViewpointGraph, ViewpointId};
use wayword_follower::{Building, Fit, Guide, MOST_WORK, Prior, Tree, Trial, Weights, best};

/// A scene that is known as a whole.
#[derive(Debug)]
pub struct Surveyed {
    building: Building,
    /// In the order of the survey.
    viewpoints: Vec<ViewpointId>,
}

impl Surveyed {
    /// Takes over the viewpoints and labels of a survey.
    #[must_use]
    pub fn of(survey: &Survey) -> Self {
        let viewpoints = survey.viewpoints().iter().map(|viewpoint| viewpoint.id.clone()).collect();
        Self { building: Building::of(survey), viewpoints }
    }
}

/// A reader at a start, with the tree of all walks from there that it considers.
#[derive(Debug)]
pub struct MapReader<'a> {
    graph: &'a ViewpointGraph,
    known: &'a Surveyed,
    start: &'a Start,
    tree: Tree,
}

impl<'a> MapReader<'a> {
    /// A reader at a start.
    ///
    /// # Errors
    /// When the start is not in the survey.
    pub fn new(
        graph: &'a ViewpointGraph,
        known: &'a Surveyed,
        start: &'a Start,
        prior: Prior,
    ) -> Result<Self, WalkError> {
        let unknown = || WalkError::Unknown { scene: start.scene.clone(), viewpoint: start.viewpoint.clone() };
        let at = known.viewpoints.iter().position(|viewpoint| *viewpoint == start.viewpoint).ok_or_else(unknown)?;
        let tree = Tree::of(&known.building, at, start.heading.rad(), prior);
        Ok(Self { graph, known, start, tree })
    }

    /// The walk that an instruction fits best; only the start if no walk fits. Of walks with equal fit, the one of middle length is
    /// taken. With the shortest or the longest, the figures by an empty text, which all walks fit equally, would be too low.
    #[must_use]
    pub fn walk(&self, text: &str) -> Walked {
        let guide = Guide::read(beginning_of(text));
        let mut walk = Vec::new();
        if guide.len().saturating_mul(self.tree.len()) <= MOST_WORK {
            let fit = Fit::new(&Trial::new(&guide, &self.known.building), &self.tree, Weights::fitted());
            walk = best(&fit, &self.tree).map(|best| self.middle(&fit, best)).unwrap_or_default();
        }
        let mut rest = walk.into_iter().skip(1);
        follow(self.graph, self.start, usize::MAX, |_, _| self.known.viewpoints.get(rest.next()?).cloned())
    }

    /// The viewpoints of the walk of middle length, among those that fit as well as the best.
    fn middle(&self, fit: &Fit, best: usize) -> Vec<usize> {
        let least = fit.score(best) - 1e-9;
        let equal = (1..self.tree.len()).filter(|walk| fit.score(*walk) >= least);
        let length_m =
            |walk: &[usize]| -> f64 { walk.windows(2).map(|hop| self.known.building.distance(hop[0], hop[1])).sum() };
        let mut equal: Vec<(f64, Vec<usize>)> =
            equal.map(|walk| self.tree.viewpoints(walk)).map(|walk| (length_m(&walk), walk)).collect();
        equal.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
        equal.swap_remove(equal.len() / 2).1
    }
}
