//! The agent that reads and knows the map: every viewpoint of the scene, every room and every label. Its figures show how much of
//! the way an instruction determines for a reader who knows the building.

use super::{AgentStart, AgentWalk, baselines::follow_nodes};
use crate::{directions::beginning_of, error::WalkError};
use wayword_core::{ViewpointGraph, ViewpointId, ViewpointSurvey};
use wayword_follower::{
    FeatureWeights, Guide, GuideTrial, KnownBuilding, MAX_FOLLOW_WORK, WalkFit, WalkPrior, WalkTree, best_walk,
};

/// A scene that is known as a whole.
#[derive(Debug)]
pub struct MappedScene {
    building: KnownBuilding,
    /// In the order of the survey.
    viewpoints: Vec<ViewpointId>,
}

impl MappedScene {
    /// Takes over the viewpoints and labels of a survey.
    #[must_use]
    pub fn from_survey(survey: &ViewpointSurvey) -> Self {
        let viewpoints = survey.viewpoints().iter().map(|viewpoint| viewpoint.id.clone()).collect();
        Self { building: KnownBuilding::from_survey(survey), viewpoints }
    }
}

/// A reader at a start, with the tree of all walks from there that it considers.
#[derive(Debug)]
pub struct MapReader<'a> {
    graph: &'a ViewpointGraph,
    known: &'a MappedScene,
    start: &'a AgentStart,
    tree: WalkTree,
}

impl<'a> MapReader<'a> {
    /// A reader at a start.
    ///
    /// # Errors
    /// When the start is not in the survey.
    pub fn new(
        graph: &'a ViewpointGraph,
        known: &'a MappedScene,
        start: &'a AgentStart,
        prior: WalkPrior,
    ) -> Result<Self, WalkError> {
        let unknown = || WalkError::Unknown { scene: start.scene.clone(), viewpoint: start.viewpoint.clone() };
        let at = known.viewpoints.iter().position(|viewpoint| *viewpoint == start.viewpoint).ok_or_else(unknown)?;
        let tree = WalkTree::from_prior(&known.building, at, start.heading.rad(), prior);
        Ok(Self { graph, known, start, tree })
    }

    /// The walk that an instruction fits best; only the start if no walk fits. Of walks with equal fit, the one of middle length is
    /// taken. With the shortest or the longest, the figures by an empty text, which all walks fit equally, would be too low.
    #[must_use]
    pub fn best_walk(&self, text: &str) -> AgentWalk {
        let guide = Guide::read_text(beginning_of(text));
        let mut walk = Vec::new();
        if guide.len().saturating_mul(self.tree.len()) <= MAX_FOLLOW_WORK {
            let fit =
                WalkFit::new(&GuideTrial::new(&guide, &self.known.building), &self.tree, FeatureWeights::fitted());
            walk = best_walk(&fit, &self.tree).map(|best| self.middle_walk(&fit, best)).unwrap_or_default();
        }
        let mut rest = walk.into_iter().skip(1);
        follow_nodes(self.graph, self.start, usize::MAX, |_, _| self.known.viewpoints.get(rest.next()?).cloned())
    }

    /// The viewpoints of the walk of middle length, among those that fit as well as the best.
    fn middle_walk(&self, fit: &WalkFit, best: usize) -> Vec<usize> {
        // Scores count as equal if they differ only by rounding.
        let least = fit.score(best) - 1e-9;
        let equal = (1..self.tree.len()).filter(|walk| fit.score(*walk) >= least);
        let length_m =
            |walk: &[usize]| -> f64 { walk.windows(2).map(|hop| self.known.building.distance_m(hop[0], hop[1])).sum() };
        let mut equal: Vec<(f64, Vec<usize>)> =
            equal.map(|walk| self.tree.viewpoints(walk)).map(|walk| (length_m(&walk), walk)).collect();
        equal.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
        equal.swap_remove(equal.len() / 2).1
    }
}
