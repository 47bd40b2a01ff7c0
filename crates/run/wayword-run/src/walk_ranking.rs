//! Ranks the walks that a text may mean from a given start, for the Python package.

use crate::{
    error::CommandError,
    follow::{KnownScenes, read_guide},
};
use serde::Serialize;
use wayword_core::{Heading, Platform, PlatformError, SceneId, ViewpointId};
use wayword_follower::{FeatureWeights, GuideTrial, MAX_FOLLOW_WORK, WalkFit, WalkPrior, WalkTree, walk_shares};

/// A walk that a text may mean.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeantWalk {
    /// Its viewpoints, from the start.
    pub viewpoints: Vec<ViewpointId>,
    /// The probability that the text means it, among the walks that were considered.
    pub share: f64,
}

impl KnownScenes {
    /// The walks from a viewpoint that a text may mean, the likeliest first, at most `most` of them. The follower knows the map
    /// with its rooms and labels, and considers the shortest paths of up to eight hops.
    ///
    /// # Errors
    /// When the scene cannot be surveyed, does not have the viewpoint, or the text cannot be followed.
    pub fn meant_walks(
        &self,
        platform: &dyn Platform,
        (scene, start, heading): (&SceneId, &ViewpointId, Heading),
        text: &str,
        most: usize,
    ) -> Result<Vec<MeantWalk>, CommandError> {
        let known = self.get_or_survey(platform, scene)?;
        let unknown_start = || PlatformError::UnknownViewpoint { scene: scene.clone(), viewpoint: start.clone() };
        let place = known.survey.viewpoint_index(start).ok_or_else(unknown_start)?;
        let unfollowed = |why: &str| {
            let hint = "give the steps of a walk in English, as in \"Go past the bed and turn left\"";
            CommandError::usage(format!("the text cannot be followed: {why}"), hint)
        };
        let guide = read_guide(text).map_err(unfollowed)?;
        let tree = WalkTree::from_prior(&known.building, place, heading.rad(), WalkPrior::default());
        if guide.len().saturating_mul(tree.len()) > MAX_FOLLOW_WORK {
            return Err(unfollowed("it has too many steps"));
        }
        let fit = WalkFit::new(&GuideTrial::new(&guide, &known.building), &tree, FeatureWeights::fitted());
        // Place 0 of the tree is the start alone, which is no walk.
        let mut by_share: Vec<(usize, f64)> = walk_shares(&fit, &tree).into_iter().enumerate().skip(1).collect();
        by_share.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let viewpoint_id = |place: usize| known.survey.viewpoints().get(place).map(|viewpoint| viewpoint.id.clone());
        let walk = |(walk, share): (usize, f64)| MeantWalk {
            viewpoints: tree.viewpoints(walk).into_iter().filter_map(viewpoint_id).collect(),
            share,
        };
        Ok(by_share.into_iter().take(most).map(walk).collect())
    }
}
