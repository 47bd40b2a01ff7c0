//! Distances of scenes, each computed once.

use super::Distances;
use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
};
use wayword_core::{Platform, PlatformError, SceneId};

/// Distances of a platform's scenes, each computed when it is first asked for.
pub struct Atlas<'a> {
    platform: &'a dyn Platform,
    scenes: Mutex<BTreeMap<SceneId, Arc<Distances>>>,
}

impl<'a> Atlas<'a> {
    /// Nothing computed yet.
    #[must_use]
    pub fn new(platform: &'a dyn Platform) -> Self {
        Self { platform, scenes: Mutex::default() }
    }

    /// A scene's distances.
    ///
    /// # Errors
    /// When the scene cannot be read.
    pub fn scene(&self, scene: &SceneId) -> Result<Arc<Distances>, PlatformError> {
        if let Some(known) = self.scenes.lock().unwrap_or_else(PoisonError::into_inner).get(scene) {
            return Ok(Arc::clone(known));
        }
        // Not under the lock: other scenes need not wait.
        let computed = Arc::new(Distances::new(&*self.platform.graph(scene)?));
        let mut scenes = self.scenes.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(Arc::clone(scenes.entry(scene.clone()).or_insert(computed)))
    }
}
