//! What is known of whole scenes, for the agent that reads and knows the map.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
};
use wayword_core::{Platform, PlatformError, SceneId};
use wayword_navigation::agents::Surveyed;
use wayword_world::survey;

/// The scenes of a comparison, each surveyed once, when it is first needed.
#[derive(Debug, Default)]
pub(super) struct Surveys {
    scenes: Mutex<BTreeMap<SceneId, Cell>>,
}

/// A scene. Whoever comes while it is surveyed waits for that.
type Cell = Arc<Mutex<Option<Arc<Surveyed>>>>;

impl Surveys {
    /// What is known of a scene.
    ///
    /// # Errors
    /// When it cannot be surveyed.
    pub(super) fn of(&self, platform: &dyn Platform, scene: &SceneId) -> Result<Arc<Surveyed>, PlatformError> {
        let mut scenes = self.scenes.lock().unwrap_or_else(PoisonError::into_inner);
        let cell = Arc::clone(scenes.entry(scene.clone()).or_default());
        drop(scenes);
        let mut known = cell.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = &*known {
            return Ok(Arc::clone(known));
        }
        let surveyed = Arc::new(Surveyed::of(&survey(platform, scene)?));
        *known = Some(Arc::clone(&surveyed));
        Ok(surveyed)
    }
}
