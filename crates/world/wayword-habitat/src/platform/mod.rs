//! Habitat's scenes as a [`Platform`]: paths lead over a navmesh, or along a viewpoint graph from a file, and views are drawn
//! from the scene's mesh.

mod examine;
mod files;
mod graph;
mod graph_fit;
mod graph_pairing;
#[cfg(test)]
mod graph_tests;
mod islands;
mod placed;
#[cfg(test)]
mod placement_tests;
mod sample;
mod scene;
#[cfg(test)]
mod tests;
mod walkable;

use crate::{
    navmesh::NavMesh,
    scene::{HabitatStage, SceneModel},
};
use files::StageFiles;
use graph_pairing::GraphPairing;
use placed::PlacedStage;
use scene::HabitatScene;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path as FilePath, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};
use wayword_core::{
    DepthImage, Frame, FromAbove, Ground, GroundIsland, GroundRoute, Image, ObjectId, Path, PathRequest, Platform,
    PlatformError, RecentCache, SceneCatalogue, SceneCondition, SceneFiles, SceneId, View, ViewGaze, ViewpointGraph,
    ViewpointId,
};
use wayword_render::{PinholeCamera, RenderedPicture, to_flat_gaze};
use wayword_world::output_lines::OutputListener;

/// Scenes that are kept in memory at a time: one of HM3D takes a few hundred MB.
const SCENES_IN_MEMORY: usize = 2;

/// Scenes as Habitat reads them.
pub struct HabitatPlatform {
    options: HabitatOptions,
    hear: OutputListener,
    /// The scenes with their files and graphs.
    pairs: GraphPairing,
    /// The scenes in memory.
    ready: RecentCache<SceneId, HabitatScene>,
    /// The condition of each scene that was examined, so that none is examined twice.
    examined: Mutex<BTreeMap<SceneId, SceneCondition>>,
    /// Scenes for which warnings were already given.
    warned: Mutex<BTreeSet<SceneId>>,
    /// Scenes of which a picture was drawn.
    pictured: Mutex<BTreeSet<SceneId>>,
}

/// Whether all pixels of a picture are alike.
fn has_one_colour(image: &Image) -> bool {
    let pixels = image.rgb_bytes().as_chunks::<3>().0;
    pixels.iter().all(|pixel| pixels.first() == Some(pixel))
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
    /// A folder of viewpoint graphs in Matterport's format (`SCENE_connectivity.json`). Paths then follow these graphs, no
    /// navmesh is read or baked, and scenes without a graph are left out.
    pub connectivity: Option<PathBuf>,
    /// Whether views may be taken off these graphs too, as for an agent that walks over the navmesh.
    pub off_graph: bool,
}

impl Default for HabitatOptions {
    fn default() -> Self {
        Self {
            width_px: 640,
            height_px: 480,
            interval_m: 1.0,
            navmesh: None,
            island: None,
            connectivity: None,
            off_graph: false,
        }
    }
}

impl HabitatPlatform {
    /// Opens the scenes at a path: one file (`.glb`, `.gltf`, `.stage_config.json`), or a folder of them, such as
    /// HM3D's, Matterport3D's or Gibson's. The navmesh and the semantic files beside a scene belong to it; if there is
    /// no navmesh, one is baked. `hear` receives a warning if it is doubtful on which of a scene's islands people walk, or
    /// if few of a semantic mesh's colours are in its list.
    ///
    /// # Errors
    /// If there is no scene, or a folder cannot be read.
    pub fn open(place: &FilePath, options: HabitatOptions, hear: OutputListener) -> Result<Self, PlatformError> {
        let scenes = files::find_scenes(place)?;
        let pairs = match &options.connectivity {
            Some(folder) => graph_pairing::pair_graphs(scenes, folder)?,
            None => GraphPairing::without_graphs(scenes),
        };
        let ready = RecentCache::one_at_a_time(SCENES_IN_MEMORY);
        let (examined, warned, pictured) = (Mutex::default(), Mutex::default(), Mutex::default());
        if let Some(idle) = pairs.describe_idle_graphs() {
            hear(&idle);
        }
        Ok(Self { options, hear, pairs, ready, examined, warned, pictured })
    }

    /// The navmesh of a scene, from its file or baked. [`NavMesh::to_bytes`] returns a file that Habitat can read.
    ///
    /// # Errors
    /// If the scene is unknown, or its files cannot be read.
    pub fn navmesh(&self, scene: &SceneId) -> Result<NavMesh, PlatformError> {
        if let Some(walkable) = &self.prepared_scene(scene)?.walkable {
            return Ok(walkable.navmesh.clone());
        }
        let (_, files) = self.find_files(scene)?;
        let PlacedStage { stage, model, .. } = PlacedStage::read(files, &self.options, SceneModel::read_file)?;
        Ok(walkable::read_or_bake_navmesh(&model, &stage, files, &self.options)?)
    }

    /// What a camera sees, which may be pitched: depths, and colours if `coloured`.
    ///
    /// # Errors
    /// When the scene is unknown or cannot be read, or the camera's numbers give no picture.
    pub fn render_camera(
        &self,
        scene: &SceneId,
        camera: &PinholeCamera,
        coloured: bool,
    ) -> Result<RenderedPicture, PlatformError> {
        self.prepared_scene(scene)?.render_camera(camera, coloured)
    }

    /// A scene in memory, read if necessary.
    fn prepared_scene(&self, scene: &SceneId) -> Result<Arc<HabitatScene>, PlatformError> {
        let (scene, files) = self.find_files(scene)?;
        self.ready.get_or_make(scene.clone(), || {
            let fits = self.known_condition(scene).is_some_and(|condition| condition.unusable.is_none());
            let prepared = HabitatScene::from_files(scene, files, &self.options, fits)?;
            if self.warned.lock().unwrap_or_else(PoisonError::into_inner).insert(scene.clone()) {
                prepared.doubts().for_each(|doubt| (self.hear)(&format!("scene {scene}: {doubt}")));
            }
            Ok(prepared)
        })
    }

    /// A scene's id and files, by its id or by another name that it has.
    fn find_files(&self, name: &SceneId) -> Result<(&SceneId, &StageFiles), PlatformError> {
        let id = self.pairs.aliases.get(name).unwrap_or(name);
        self.pairs.scenes.get_key_value(id).ok_or_else(|| self.unknown_scene(name))
    }

    /// The condition of a scene, if it was examined.
    fn known_condition(&self, scene: &SceneId) -> Option<SceneCondition> {
        self.examined.lock().unwrap_or_else(PoisonError::into_inner).get(scene).cloned()
    }

    fn unknown_scene(&self, scene: &SceneId) -> PlatformError {
        let some: Vec<&str> = self.pairs.scenes.keys().take(3).map(SceneId::as_str).collect();
        let hint = match self.pairs.unpaired.get(scene) {
            Some(lack) => format!("{}; {}", lack.what, lack.hint),
            None => format!("there are {}: {} ...", self.pairs.scenes.len(), some.join(", ")),
        };
        PlatformError::UnknownScene { scene: scene.to_string(), hint }
    }

    fn view_from(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze, pictured: bool) -> Result<View, PlatformError> {
        let prepared = self.prepared_scene(scene)?;
        prepared.check_frame(from)?;
        let size = [self.options.width_px, self.options.height_px];
        let view = prepared.view_from(from.pose.position, to_flat_gaze(gaze), size, pictured)?;
        if let Some(image) = &view.image
            && self.pictured.lock().unwrap_or_else(PoisonError::into_inner).insert(prepared.id.clone())
            && has_one_colour(image)
        {
            (self.hear)(&format!(
                "scene {scene}: its first view is of one single colour; perhaps its file keeps its colours where they \
                 are not read"
            ));
        }
        Ok(view)
    }
}

impl Platform for HabitatPlatform {
    fn name(&self) -> &'static str {
        "habitat"
    }

    fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        Ok(self.pairs.scenes.keys().cloned().collect())
    }

    fn graph_for_scene(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        Ok(self.prepared_scene(scene)?.graph.clone())
    }

    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        sample::sample_path(&*self.prepared_scene(scene)?, request, seed, self.options.interval_m)
    }

    fn look_from(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        self.view_from(scene, from, gaze, true)
    }

    fn look_without_picture(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        self.view_from(scene, from, gaze, false)
    }

    fn ground(&self) -> &dyn Ground {
        self
    }

    fn catalogue(&self) -> &dyn SceneCatalogue {
        self
    }

    fn files(&self) -> &dyn SceneFiles {
        self
    }
}

impl Ground for HabitatPlatform {
    fn view_depth(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<Option<DepthImage>, PlatformError> {
        let prepared = self.prepared_scene(scene)?;
        prepared.check_frame(from)?;
        let size = [self.options.width_px, self.options.height_px];
        prepared.depth_from(from.pose.position, to_flat_gaze(gaze), size).map(Some)
    }

    fn look_down(&self, scene: &SceneId, level: u32) -> Result<Option<FromAbove>, PlatformError> {
        self.prepared_scene(scene)?.look_down(level)
    }

    /// The way over the navmesh, as Habitat measures it; `None` if the scene has a graph from a file instead.
    fn ground_route(&self, scene: &SceneId, from: &Frame, to: &Frame) -> Result<Option<GroundRoute>, PlatformError> {
        Ok(self.prepared_scene(scene)?.way_between(from.pose.position, to.pose.position))
    }

    fn ground_islands(&self, scene: &SceneId) -> Result<Vec<GroundIsland>, PlatformError> {
        Ok(self.prepared_scene(scene)?.islands())
    }
}

impl SceneCatalogue for HabitatPlatform {
    fn object_name(&self, scene: &SceneId, _: &Frame, object: &ObjectId) -> Result<Option<String>, PlatformError> {
        let prepared = self.prepared_scene(scene)?;
        let thing = prepared.semantics.as_ref().and_then(|semantics| semantics.find_thing(object));
        Ok(thing.and_then(|thing| thing.name.clone()))
    }

    fn visible_from(&self, scene: &SceneId, object: &ObjectId) -> Result<Option<BTreeSet<ViewpointId>>, PlatformError> {
        let prepared = self.prepared_scene(scene)?;
        if prepared.semantics.is_none() {
            return Ok(None);
        }
        Ok(Some(prepared.seen_from()?.get(object).cloned().unwrap_or_default()))
    }
}

impl SceneFiles for HabitatPlatform {
    fn canonical_scene(&self, scene: &SceneId) -> SceneId {
        self.find_files(scene).map_or_else(|_| scene.clone(), |(id, _)| id.clone())
    }

    fn candidate_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        let all: BTreeSet<&SceneId> = self.pairs.scenes.keys().chain(self.pairs.unpaired.keys()).collect();
        Ok(all.into_iter().cloned().collect())
    }

    fn examine_scene(&self, scene: &SceneId) -> Result<Option<SceneCondition>, PlatformError> {
        if let Some(why) = self.pairs.unpaired.get(scene) {
            return Ok(Some(SceneCondition::for_unusable(scene.clone(), why.clone())));
        }
        let (id, files) = self.find_files(scene)?;
        let found = match self.known_condition(id) {
            Some(known) => known,
            None => {
                let found = examine::examine_scene(id, files, &self.options)?;
                self.examined.lock().unwrap_or_else(PoisonError::into_inner).insert(id.clone(), found.clone());
                found
            }
        };
        // The caller may have used another name of the scene, and gets that name back.
        Ok(Some(SceneCondition { scene: scene.clone(), ..found }))
    }

    fn scene_file(&self, scene: &SceneId) -> Result<Option<PathBuf>, PlatformError> {
        let (_, files) = self.find_files(scene)?;
        Ok(Some(files.stage.clone()))
    }

    fn source_files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        let (_, files) = self.find_files(scene)?;
        let all = files.all_files(&HabitatStage::from_file(&files.stage)?);
        Ok(all.into_iter().chain(self.options.navmesh.clone()).collect())
    }
}
