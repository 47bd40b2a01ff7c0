//! Wraps a platform with a cache of its views, so that each view is rendered or read once.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
};
use wayword_core::{
    Frame, Path, PathRequest, Platform, PlatformError, SceneId, View, ViewGaze, ViewpointGraph, ViewpointId,
};

/// A platform that caches its views, because perception, evidence and report look at the same ones.
pub struct RememberingPlatform<'a> {
    platform: &'a dyn Platform,
    views: Mutex<BTreeMap<ViewKey, View>>,
    /// Whether its views have pictures.
    has_pictures: bool,
}

/// Scene, place, heading and width, as bits: equal looks give equal views.
type ViewKey = (SceneId, ([u64; 3], Option<ViewpointId>), u64, u64);

impl<'a> RememberingPlatform<'a> {
    /// An empty cache over a platform.
    #[must_use]
    pub fn new(platform: &'a dyn Platform) -> Self {
        Self { platform, views: Mutex::default(), has_pictures: true }
    }

    /// The same without pictures, for callers that read only labels. The labels of all views of a run fit into memory.
    #[must_use]
    pub fn for_labels(platform: &'a dyn Platform) -> Self {
        Self { has_pictures: false, ..Self::new(platform) }
    }

    fn remembered_view(&self, key: &ViewKey) -> Option<View> {
        self.views.lock().unwrap_or_else(PoisonError::into_inner).get(key).cloned()
    }

    fn remember_view(&self, key: ViewKey, view: &View) {
        self.views.lock().unwrap_or_else(PoisonError::into_inner).insert(key, view.clone());
    }

    fn look_at_labels(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        let key = view_key(scene, from, gaze);
        if let Some(view) = self.remembered_view(&key) {
            return Ok(view);
        }
        let mut view = self.platform.look_without_picture(scene, from, gaze)?;
        view.image = None;
        self.remember_view(key, &view);
        Ok(view)
    }
}

fn view_key(scene: &SceneId, from: &Frame, gaze: ViewGaze) -> ViewKey {
    // Headings that differ only by rounding look at the same thing.
    let micro_rad = |rad: f64| (rad * 1e6).round() as u64;
    (scene.clone(), from.place_key(), micro_rad(gaze.heading.rad()), micro_rad(gaze.horizontal_fov_rad))
}

impl Platform for RememberingPlatform<'_> {
    fn name(&self) -> &'static str {
        self.platform.name()
    }

    fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        self.platform.list_scenes()
    }

    fn graph_for_scene(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        self.platform.graph_for_scene(scene)
    }

    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        self.platform.sample_path(scene, request, seed)
    }

    fn look_from(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        if !self.has_pictures {
            return self.look_at_labels(scene, from, gaze);
        }
        let key = view_key(scene, from, gaze);
        if let Some(view) = self.remembered_view(&key) {
            return Ok(view);
        }
        let view = self.platform.look_from(scene, from, gaze)?;
        self.remember_view(key, &view);
        Ok(view)
    }

    fn look_without_picture(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        if !self.has_pictures {
            return self.look_at_labels(scene, from, gaze);
        }
        let key = view_key(scene, from, gaze);
        if let Some(view) = self.remembered_view(&key) {
            return Ok(view);
        }
        let view = self.platform.look_without_picture(scene, from, gaze)?;
        // A view with its picture is complete.
        if view.image.is_some() {
            self.remember_view(key, &view);
        }
        Ok(view)
    }

    /// Everything but views comes from the platform itself, uncached. Depth, for one, is larger than a picture, and
    /// asked for once.
    fn inner(&self) -> Option<&dyn Platform> {
        Some(self.platform)
    }
}
