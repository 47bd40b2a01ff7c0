//! A cache of the distances in a platform's scenes.

use super::SceneDistances;
use std::{
    collections::BTreeMap,
    fmt,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};
use wayword_core::{Platform, PlatformError, SceneId};

/// Caches the distances of scenes. Those of a scene are computed at the first request. Threads may share the cache.
pub struct DistanceAtlas<'a> {
    platform: &'a dyn Platform,
    scenes: Mutex<BTreeMap<SceneId, Arc<SceneDistances>>>,
}

impl<'a> DistanceAtlas<'a> {
    /// An empty cache.
    #[must_use]
    pub fn new(platform: &'a dyn Platform) -> Self {
        Self { platform, scenes: Mutex::default() }
    }

    /// The distances of a scene. Threads that ask for a new one at the same time may compute it twice; they get the same one.
    ///
    /// # Errors
    /// When the platform cannot give the scene's graph.
    pub fn scene_distances(&self, scene: &SceneId) -> Result<Arc<SceneDistances>, PlatformError> {
        if let Some(known) = self.lock_scenes().get(scene) {
            return Ok(Arc::clone(known));
        }
        // Computed without the lock, so that other threads can look up known scenes meanwhile.
        let computed = Arc::new(SceneDistances::new(&*self.platform.graph_for_scene(scene)?));
        Ok(Arc::clone(self.lock_scenes().entry(scene.clone()).or_insert(computed)))
    }

    fn lock_scenes(&self) -> MutexGuard<'_, BTreeMap<SceneId, Arc<SceneDistances>>> {
        self.scenes.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl fmt::Debug for DistanceAtlas<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Atlas").field("platform", &self.platform.name()).finish_non_exhaustive()
    }
}
