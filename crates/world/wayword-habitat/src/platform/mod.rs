//! Habitat's scenes as a platform.

mod files;
mod home;
mod islands;
mod sample;
#[cfg(test)]
mod tests;

use crate::{axes::EYE_M, navmesh::NavMesh, scene::Stage};
use files::SceneFiles;
use home::Home;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path as FilePath, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};
use wayword_core::{
    DVec3, Depth, Frame, FromAbove, Gaze, Island, ObjectId, Path, PathRequest, Platform, PlatformError, Recent,
    SceneId, View, ViewpointGraph, ViewpointId, Way,
};
use wayword_render::flat;
use wayword_world::said::Hear;

/// Scenes that are kept in memory at a time: one of HM3D takes a few hundred MB.
const READY: usize = 2;

/// Scenes as Habitat reads them.
pub struct HabitatPlatform {
    options: HabitatOptions,
    hear: Hear,
    scenes: BTreeMap<SceneId, SceneFiles>,
    ready: Recent<SceneId, Home>,
    /// Scenes for which a warning was already given, so that each is given once.
    told: Mutex<BTreeSet<SceneId>>,
}

/// Options of the platform.
#[derive(Debug, Clone, PartialEq)]
pub struct HabitatOptions {
    /// Width of pictures, pixels.
    pub width_px: u32,
    /// Height of pictures, pixels.
    pub height_px: u32,
    /// Largest distance between two frames of a random path, metres.
    pub interval_m: f64,
    /// A navmesh to use instead of the one beside the scene.
    pub navmesh: Option<PathBuf>,
    /// The island that paths stay on; 0 is the largest. If `None`, the program chooses one for each scene.
    pub island: Option<usize>,
}

impl Default for HabitatOptions {
    fn default() -> Self {
        Self { width_px: 640, height_px: 480, interval_m: 1.0, navmesh: None, island: None }
    }
}

impl HabitatPlatform {
    /// Opens the scenes at a path: one file (`.glb`, `.gltf`, `.stage_config.json`), or a folder of them, such as
    /// HM3D's, Matterport3D's or Gibson's. The navmesh and the semantic files beside a scene belong to it; if there is
    /// no navmesh, one is baked. `hear` receives a warning if it is doubtful on which of a scene's islands people walk.
    ///
    /// # Errors
    /// If there is no scene, or the folder cannot be read.
    pub fn open(place: &FilePath, options: HabitatOptions, hear: Hear) -> Result<Self, PlatformError> {
        let (scenes, ready) = (files::scenes(place)?, Recent::one_at_a_time(READY));
        Ok(Self { options, hear, scenes, ready, told: Mutex::default() })
    }

    /// The navmesh of a scene, from its file or baked. [`NavMesh::to_bytes`] returns a file that Habitat can read.
    ///
    /// # Errors
    /// If there is no such scene, or its files cannot be read.
    pub fn navmesh(&self, scene: &SceneId) -> Result<NavMesh, PlatformError> {
        Ok(self.home(scene)?.navmesh.clone())
    }

    fn home(&self, scene: &SceneId) -> Result<Arc<Home>, PlatformError> {
        let files = self.scenes.get(scene).ok_or_else(|| self.unknown(scene))?;
        self.ready.get_or_make(scene.clone(), || {
            let home = Home::build(scene, files, &self.options)?;
            if let Some(doubt) = &home.doubt
                && self.told.lock().unwrap_or_else(PoisonError::into_inner).insert(scene.clone())
            {
                (self.hear)(doubt);
            }
            Ok(home)
        })
    }

    fn unknown(&self, scene: &SceneId) -> PlatformError {
        let some: Vec<&str> = self.scenes.keys().take(3).map(SceneId::as_str).collect();
        PlatformError::UnknownScene {
            scene: scene.to_string(),
            hint: format!("there are {}: {} ...", self.scenes.len(), some.join(", ")),
        }
    }

    fn seen(&self, scene: &SceneId, from: &Frame, gaze: Gaze, pictured: bool) -> Result<View, PlatformError> {
        let home = self.home(scene)?;
        home.check(from)?;
        home.view(from.pose.position, flat(gaze), [self.options.width_px, self.options.height_px], pictured)
    }
}

impl Platform for HabitatPlatform {
    fn name(&self) -> &'static str {
        "habitat"
    }

    fn scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        Ok(self.scenes.keys().cloned().collect())
    }

    fn graph(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        Ok(self.home(scene)?.graph.clone())
    }

    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        sample::path(&*self.home(scene)?, request, seed, self.options.interval_m)
    }

    fn look(&self, scene: &SceneId, from: &Frame, gaze: Gaze) -> Result<View, PlatformError> {
        self.seen(scene, from, gaze, true)
    }

    fn look_without_picture(&self, scene: &SceneId, from: &Frame, gaze: Gaze) -> Result<View, PlatformError> {
        self.seen(scene, from, gaze, false)
    }

    fn depth(&self, scene: &SceneId, from: &Frame, gaze: Gaze) -> Result<Option<Depth>, PlatformError> {
        let home = self.home(scene)?;
        home.check(from)?;
        let size = [self.options.width_px, self.options.height_px];
        home.depth(from.pose.position, flat(gaze), size).map(Some)
    }

    fn look_down(&self, scene: &SceneId, level: u32) -> Result<Option<FromAbove>, PlatformError> {
        self.home(scene)?.look_down(level)
    }

    fn object_name(&self, scene: &SceneId, _: &Frame, object: &ObjectId) -> Result<Option<String>, PlatformError> {
        let home = self.home(scene)?;
        let thing = home.semantics.as_ref().and_then(|semantics| semantics.named(object));
        Ok(thing.and_then(|thing| thing.name.clone()))
    }

    fn visible_from(&self, scene: &SceneId, object: &ObjectId) -> Result<Option<BTreeSet<ViewpointId>>, PlatformError> {
        let home = self.home(scene)?;
        if home.semantics.is_none() {
            return Ok(None);
        }
        Ok(Some(home.seen_from()?.get(object).cloned().unwrap_or_default()))
    }

    /// The way over the navmesh, as Habitat measures it.
    fn way(&self, scene: &SceneId, from: &Frame, to: &Frame) -> Result<Option<Way>, PlatformError> {
        let feet = |frame: &Frame| frame.pose.position - DVec3::Z * EYE_M;
        Ok(self.home(scene)?.ground.geodesic(feet(from), feet(to)).ok())
    }

    fn islands(&self, scene: &SceneId) -> Result<Vec<Island>, PlatformError> {
        Ok(self.home(scene)?.islands())
    }

    fn scene_file(&self, scene: &SceneId) -> Result<Option<PathBuf>, PlatformError> {
        let files = self.scenes.get(scene).ok_or_else(|| self.unknown(scene))?;
        Ok(Some(files.stage.clone()))
    }

    fn files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        let files = self.scenes.get(scene).ok_or_else(|| self.unknown(scene))?;
        let all = files.all(&Stage::of(&files.stage)?);
        Ok(all.into_iter().chain(self.options.navmesh.clone()).collect())
    }
}
