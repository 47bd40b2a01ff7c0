//! Helpers for the tests of changed worlds.

use std::sync::{Arc, LazyLock};
use wayword_core::{
    Frame, ObjectLabel, Path, PathRequest, Platform, PlatformError, SceneId, View, ViewGaze, ViewpointGraph,
};
use wayword_house::{HouseOptions, HousePlatform};

static HOUSE: LazyLock<HousePlatform> =
    LazyLock::new(|| HousePlatform::new(HouseOptions { width_px: 160, height_px: 120, ..HouseOptions::default() }));

/// The built-in homes with small pictures, made once for all tests.
#[derive(Debug, Clone, Copy)]
pub(crate) struct House;

impl Platform for House {
    fn name(&self) -> &'static str {
        HOUSE.name()
    }

    fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        HOUSE.list_scenes()
    }

    fn graph_for_scene(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        HOUSE.graph_for_scene(scene)
    }

    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        HOUSE.sample_path(scene, request, seed)
    }

    fn look_from(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        HOUSE.look_from(scene, from, gaze)
    }

    fn inner(&self) -> Option<&dyn Platform> {
        Some(&*HOUSE)
    }
}

/// A path through a home.
pub(crate) fn walk() -> (SceneId, Path) {
    walk_of(7)
}

/// A path through the home of a seed.
pub(crate) fn walk_of(seed: u64) -> (SceneId, Path) {
    let scene = HousePlatform::scene_of(seed).unwrap();
    let path = House.sample_path(&scene, &PathRequest::default(), seed).unwrap();
    (scene, path)
}

/// The labels of a view.
pub(crate) fn labels(view: &View) -> &[ObjectLabel] {
    &view.ground_truth().unwrap().labels
}

/// Mean difference of two pictures, levels of 255.
pub(crate) fn mean_difference(a: &View, b: &View) -> f64 {
    let [a, b] = [a, b].map(|view| view.image.as_ref().unwrap().rgb_bytes());
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / a.len() as f64
}
