//! The cache of distances over the built-in houses: threads share it, and its errors are those of the platform.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::{sync::Arc, thread};
use wayword_core::{Platform, PlatformError, SceneId};
use wayword_house::HousePlatform;
use wayword_metrics::{DistanceAtlas, SceneDistances};

#[test]
fn threads_share_one_and_the_same_distances_of_a_scene() {
    let platform = HousePlatform::default();
    let atlas = DistanceAtlas::new(&platform);
    let scenes: Vec<SceneId> = platform.list_scenes().unwrap().into_iter().take(2).collect();
    let ask =
        || -> Vec<Arc<SceneDistances>> { scenes.iter().map(|scene| atlas.scene_distances(scene).unwrap()).collect() };
    let asked = thread::scope(|scope| {
        let threads: Vec<_> = (0..4).map(|_| scope.spawn(ask)).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect::<Vec<_>>()
    });
    for (at, scene) in scenes.iter().enumerate() {
        assert!(asked.iter().all(|by| Arc::ptr_eq(&by[at], &asked[0][at])));
        let graph = platform.graph_for_scene(scene).unwrap();
        assert!(graph.viewpoints().all(|viewpoint| asked[0][at].has_viewpoint(viewpoint)));
    }
    assert!(!Arc::ptr_eq(&asked[0][0], &asked[0][1]), "each scene has its own");
}

#[test]
fn atlas_passes_on_the_platforms_error_for_unknown_scenes() {
    let platform = HousePlatform::default();
    let found = DistanceAtlas::new(&platform).scene_distances(&SceneId::new("no-such-scene").unwrap());
    assert!(matches!(found, Err(PlatformError::UnknownScene { .. })));
}
