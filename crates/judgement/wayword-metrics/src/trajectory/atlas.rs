//! The distances of a platform's scenes.

use super::Distances;
use std::{
    collections::BTreeMap,
    fmt,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};
use wayword_core::{Platform, PlatformError, SceneId};

/// Distances of scenes, each computed when it is first asked for and kept. Threads may share it.
pub struct Atlas<'a> {
    platform: &'a dyn Platform,
    scenes: Mutex<BTreeMap<SceneId, Arc<Distances>>>,
}

impl<'a> Atlas<'a> {
    /// An atlas that knows no scene yet.
    #[must_use]
    pub fn new(platform: &'a dyn Platform) -> Self {
        Self { platform, scenes: Mutex::default() }
    }

    /// The distances of a scene. Threads that ask for a new one at the same time may compute it twice; they get the same one.
    ///
    /// # Errors
    /// When the platform cannot give the scene's graph.
    pub fn scene(&self, scene: &SceneId) -> Result<Arc<Distances>, PlatformError> {
        if let Some(known) = self.scenes().get(scene) {
            return Ok(Arc::clone(known));
        }
        // The lock is not held meanwhile, so that other threads can look up known scenes.
        let computed = Arc::new(Distances::new(&*self.platform.graph(scene)?));
        Ok(Arc::clone(self.scenes().entry(scene.clone()).or_insert(computed)))
    }

    fn scenes(&self) -> MutexGuard<'_, BTreeMap<SceneId, Arc<Distances>>> {
        self.scenes.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl fmt::Debug for Atlas<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Atlas").field("platform", &self.platform.name()).finish_non_exhaustive()
    }
}
