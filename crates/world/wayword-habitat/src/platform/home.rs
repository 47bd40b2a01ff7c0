//! A scene of the platform in memory, with its model, its ground and its labels.

use super::{HabitatOptions, files::SceneFiles, graph, walkable::Walkable};
use crate::{
    fault::FileError,
    scene::{Model, Stage},
    semantics::{self, Semantics},
};
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{Arc, OnceLock},
};
use wayword_core::{
    DVec3, Depth, Frame, FromAbove, Gaze, GroundTruth, Heading, Image, Island, Label, ObjectId, PlatformError, Pose,
    SceneId, View, ViewpointGraph, ViewpointId, Way,
};
use wayword_render::{Camera, RenderError, Scene, render, render_ids, storey};
use wayword_world::seen_from;

const DRAW_HINT: &str = "export the scene again as GLB";

/// A scene, and the ground or the graph for its paths.
pub(super) struct Home {
    pub(super) id: SceneId,
    scene: Scene,
    /// Its ground; `None` if its graph comes from a file.
    pub(super) walkable: Option<Walkable>,
    pub(super) graph: Arc<ViewpointGraph>,
    /// Whether views may be taken off the graph from a file.
    off_graph: bool,
    pub(super) semantics: Option<Semantics>,
    /// The viewpoints that see each object; computed when first needed.
    seen_from: OnceLock<BTreeMap<ObjectId, BTreeSet<ViewpointId>>>,
}

impl Home {
    /// Reads a scene. With `fits` the graph from its file is known to lie in it and is not checked again.
    pub(super) fn build(
        id: &SceneId,
        files: &SceneFiles,
        options: &HabitatOptions,
        fits: bool,
    ) -> Result<Self, PlatformError> {
        let stage = Stage::of(&files.stage)?;
        let model = Model::of(&stage)?;
        let named = |source| PlatformError::Graph { scene: id.clone(), source };
        let (walkable, graph) = match &files.graph {
            Some(file) => (None, graph::read(file, (!fits).then_some(&model))?),
            None => {
                let walkable = Walkable::of(&model, &stage, files, options)?;
                let graph = walkable.viewpoint_graph().map_err(named)?;
                (Some(walkable), graph)
            }
        };
        let semantics = semantics::load(&files.semantics(&stage), stage.habitat_from_asset)?;
        let scene = Scene::new(model.meshes, model.materials, model.textures);
        let scene = scene.map_err(|error| FileError::new(&stage.asset, error.to_string(), DRAW_HINT))?;
        let (id, graph) = (id.clone(), Arc::new(graph));
        let off_graph = options.off_graph;
        Ok(Self { id, scene, walkable, graph, off_graph, semantics, seen_from: OnceLock::new() })
    }

    /// The islands of its navmesh, the largest first.
    pub(super) fn islands(&self) -> Vec<Island> {
        self.walkable.as_ref().map(Walkable::islands).unwrap_or_default()
    }

    /// The shortest way over its ground between two eyes; `None` if there is none, or the ground is not known.
    pub(super) fn way(&self, from: DVec3, to: DVec3) -> Option<Way> {
        self.walkable.as_ref()?.way(from, to)
    }

    /// The view from an eye: with a picture if `pictured`, and with labels if the scene has semantics.
    pub(super) fn view(&self, eye: DVec3, gaze: Gaze, size: [u32; 2], pictured: bool) -> Result<View, PlatformError> {
        let camera = Camera::level(eye, gaze, size);
        let image = pictured.then(|| self.image(&camera)).transpose()?;
        let truth = match &self.semantics {
            Some(semantics) => Some(GroundTruth {
                labels: semantics.labels(&camera, gaze).map_err(|error| self.refused(&error))?,
                lists_objects: true,
                room: semantics.room(eye, gaze.heading).map(str::to_owned),
            }),
            None => None,
        };
        Ok(View::new(Pose::level(eye, gaze.heading), gaze.horizontal_fov_rad, image, truth))
    }

    /// The depth picture from an eye.
    pub(super) fn depth(&self, eye: DVec3, gaze: Gaze, size: [u32; 2]) -> Result<Depth, PlatformError> {
        let picture = render_ids(&self.scene, &Camera::level(eye, gaze, size)).map_err(|error| self.refused(&error))?;
        Depth::new(picture.width, picture.height, picture.depth_m).map_err(|error| self.refused(&error))
    }

    /// A storey from above, around its viewpoints.
    pub(super) fn look_down(&self, level: u32) -> Result<Option<FromAbove>, PlatformError> {
        storey(&self.scene, &self.graph, level).map_err(|error| self.refused(&error))
    }

    fn image(&self, camera: &Camera) -> Result<Arc<Image>, PlatformError> {
        let picture = render(&self.scene, camera).map_err(|error| self.refused(&error))?;
        let image = Image::new(picture.width, picture.height, picture.rgb);
        image.map(Arc::new).map_err(|error| self.refused(&error))
    }

    /// The error for a picture of this scene that cannot be drawn.
    fn refused(&self, error: &dyn std::error::Error) -> PlatformError {
        PlatformError::NotDrawn { scene: self.id.clone(), reason: error.to_string() }
    }

    /// All objects that are visible around a place, found in small pictures.
    pub(super) fn labels_around(&self, eye: DVec3, heading: Heading) -> Result<Vec<Label>, PlatformError> {
        let Some(semantics) = &self.semantics else { return Ok(Vec::new()) };
        let quarters = Gaze::around(heading).into_iter();
        let labels = quarters.map(|gaze| semantics.labels(&Camera::level(eye, gaze, [320, 240]), gaze));
        let labels: Result<Vec<Vec<Label>>, RenderError> = labels.collect();
        Ok(labels.map_err(|error| self.refused(&error))?.into_iter().flatten().collect())
    }

    /// The viewpoints that see each object.
    pub(super) fn seen_from(&self) -> Result<&BTreeMap<ObjectId, BTreeSet<ViewpointId>>, PlatformError> {
        if let Some(seen_from) = self.seen_from.get() {
            return Ok(seen_from);
        }
        let seen = seen_from(&self.graph, |eye, heading| self.labels_around(eye, heading))?;
        Ok(self.seen_from.get_or_init(|| seen))
    }

    /// Returns an error for a frame that is not above the ground, or not near the graph.
    pub(super) fn check(&self, frame: &Frame) -> Result<(), PlatformError> {
        let eye = frame.pose.position;
        let is_there = match &self.walkable {
            Some(walkable) => walkable.is_under(eye),
            None => (self.off_graph && eye.is_finite()) || graph::passes(&self.graph, eye),
        };
        if is_there { Ok(()) } else { Err(PlatformError::nowhere(&self.id, frame)) }
    }
}
