//! For each episode, the conditions by which a trajectory is scored: the reference path, the target, and from where it is visible.

use std::sync::Arc;
use wayword_core::{Platform, SceneId};
use wayword_formats::Episode;
use wayword_metrics::{DistanceAtlas, EpisodeDemand, SceneDistances};
use wayword_run::error::CommandError;

/// Goals nearer to each other than this count as one goal, metres: R2R counts an agent there as arrived. The choices of other
/// paths for comparisons, studies and robustness use it.
pub(crate) const SAME_GOAL_M: f64 = 3.0;

/// Makes the demands of a platform's episodes. It computes the distances of each scene once.
pub struct PlatformDemands<'a> {
    platform: &'a dyn Platform,
    atlas: DistanceAtlas<'a>,
}

impl<'a> PlatformDemands<'a> {
    /// Starts without any distances.
    #[must_use]
    pub fn new(platform: &'a dyn Platform) -> Self {
        Self { platform, atlas: DistanceAtlas::new(platform) }
    }

    /// The distances of a scene.
    ///
    /// # Errors
    /// When the scene cannot be read.
    pub fn scene_distances(&self, scene: &SceneId) -> Result<Arc<SceneDistances>, CommandError> {
        Ok(self.atlas.scene_distances(scene)?)
    }

    /// The demand of an episode, and the distances of its scene.
    ///
    /// # Errors
    /// When the scene cannot be read.
    pub fn for_episode(&self, episode: &Episode) -> Result<(Arc<SceneDistances>, EpisodeDemand), CommandError> {
        let distances = self.scene_distances(&episode.scene)?;
        let visible =
            episode.target_object.as_ref().map(|object| self.platform.catalogue().visible_from(&episode.scene, object));
        let demand = EpisodeDemand {
            reference: episode.viewpoints.clone(),
            object: episode.target_object.clone(),
            visible_from: visible.transpose()?.flatten(),
        };
        Ok((distances, demand))
    }
}
