//! The agent that reads and knows the map: every viewpoint of the scene, every room and every label. It shows what an
//! instruction says to somebody who knows the building.

use super::{Start, Walked, baselines::follow};
use crate::{directions::beginning_of, error::WalkError};
use wayword_core::{Survey, ViewpointGraph, ViewpointId};
use wayword_follower::{Building, Fit, Guide, Prior, Tree, Trial, Weights, best};

/// A scene that is known as a whole.
#[derive(Debug)]
pub struct Surveyed {
    building: Building,
    /// In the order of the survey.
    viewpoints: Vec<ViewpointId>,
}

impl Surveyed {
    /// Knows what a survey found.
    #[must_use]
    pub fn of(survey: &Survey) -> Self {
        let viewpoints = survey.viewpoints().iter().map(|viewpoint| viewpoint.id.clone()).collect();
        Self { building: Building::of(survey), viewpoints }
    }
}

/// Most steps of a text times walks. A text of more steps is not followed, because it would fill the memory.
const MOST_WORK: usize = 2_000_000;

/// A reader at a start, with all walks that it thinks of.
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

    /// The walk that an instruction fits best; of walks that it fits equally well, the one with the farthest end. The
    /// start alone where there is none.
    #[must_use]
    pub fn walk(&self, text: &str) -> Walked {
        let guide = Guide::read(beginning_of(text));
        let mut walk = Vec::new();
        if guide.len().saturating_mul(self.tree.len()) <= MOST_WORK {
            let fit = Fit::new(&Trial::new(&guide, &self.known.building), &self.tree, Weights::fitted());
            walk = best(&fit, &self.tree).map(|best| self.tree.viewpoints(best)).unwrap_or_default();
        }
        let mut rest = walk.into_iter().skip(1);
        follow(self.graph, self.start, usize::MAX, |_, _| self.known.viewpoints.get(rest.next()?).cloned())
    }
}
