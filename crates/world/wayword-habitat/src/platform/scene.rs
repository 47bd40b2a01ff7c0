//! A scene of the platform in memory, with its model, its ground and its labels.

use super::{HabitatOptions, files::StageFiles, graph, placed::PlacedStage, walkable::WalkableGround};
use crate::{
    file_error::FileError,
    scene::SceneModel,
    semantics::{self, SceneSemantics},
};
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{Arc, OnceLock},
};
use wayword_core::{
    DVec3, DepthImage, Frame, FromAbove, GroundIsland, GroundRoute, GroundTruth, Heading, Image, ObjectId, ObjectLabel,
    PlatformError, Pose, SceneId, SceneLack, View, ViewGaze, ViewpointGraph, ViewpointId,
};
use wayword_render::{PinholeCamera, RenderError, RenderScene, RenderedPicture, draw_storey, render_ids, render_scene};
use wayword_world::seen_from;

const DRAW_HINT: &str = "export the scene again as GLB";

/// A scene, and the ground or the graph for its paths.
pub(super) struct HabitatScene {
    pub(super) id: SceneId,
    scene: RenderScene,
    /// Its ground; `None` if its graph comes from a file.
    pub(super) walkable: Option<WalkableGround>,
    pub(super) graph: Arc<ViewpointGraph>,
    /// Whether views may be taken off the graph from a file.
    off_graph: bool,
    /// Its objects, where some are known.
    pub(super) semantics: Option<SceneSemantics>,
    /// The fault in its labels.
    lack: Option<SceneLack>,
    /// What the user should know of how the scene was read.
    pub(super) notes: Vec<String>,
    /// The viewpoints that see each object; computed when first needed.
    seen_from: OnceLock<BTreeMap<ObjectId, BTreeSet<ViewpointId>>>,
}

impl HabitatScene {
    /// Reads a scene. With `fits` the graph from its file is known to lie in it and is not checked again.
    pub(super) fn from_files(
        id: &SceneId,
        files: &StageFiles,
        options: &HabitatOptions,
        fits: bool,
    ) -> Result<Self, PlatformError> {
        let PlacedStage { stage, model, mut notes } = PlacedStage::read(files, options, SceneModel::read_file)?;
        let graph_error = |source| PlatformError::Graph { scene: id.clone(), source };
        let (walkable, graph) = match &files.graph {
            Some(file) => (None, graph::read_graph(file, (!fits).then_some(&model))?),
            None => {
                let walkable = WalkableGround::from_files(&model, &stage, files, options)?;
                let graph = walkable.viewpoint_graph().map_err(graph_error)?;
                (Some(walkable), graph)
            }
        };
        let semantics = semantics::load_semantics(&files.semantic_files(&stage), stage.habitat_from_asset)?;
        notes.extend(semantics.as_ref().and_then(|semantics| semantics.broken_lines.clone()));
        let lack = semantics.as_ref().and_then(|semantics| semantics.lack.clone());
        let semantics = semantics.filter(|semantics| semantics.has_labels);
        let scene =
            model.into_drawable().map_err(|error| FileError::new(&stage.asset, error.to_string(), DRAW_HINT))?;
        let (id, graph) = (id.clone(), Arc::new(graph));
        let off_graph = options.off_graph;
        Ok(Self { id, scene, walkable, graph, off_graph, semantics, lack, notes, seen_from: OnceLock::new() })
    }

    /// The warnings that the user should see before a run uses the scene.
    pub(super) fn doubts(&self) -> impl Iterator<Item = String> {
        let island = self.walkable.as_ref().and_then(WalkableGround::island_doubt);
        let labels = self.lack.as_ref().map(|lack| format!("{}; {}", lack.what, lack.hint));
        self.notes.iter().cloned().chain(island).chain(labels)
    }

    /// The islands of its navmesh, the largest first.
    pub(super) fn islands(&self) -> Vec<GroundIsland> {
        self.walkable.as_ref().map(WalkableGround::islands).unwrap_or_default()
    }

    /// The shortest way over its ground between two eyes; `None` if there is none, or the ground is not known.
    pub(super) fn way_between(&self, from: DVec3, to: DVec3) -> Option<GroundRoute> {
        self.walkable.as_ref()?.way_between(from, to)
    }

    /// The view from an eye: with a picture if `pictured`, and with labels if the scene has semantics.
    pub(super) fn view_from(
        &self,
        eye: DVec3,
        gaze: ViewGaze,
        size: [u32; 2],
        pictured: bool,
    ) -> Result<View, PlatformError> {
        let camera = PinholeCamera::for_level_gaze(eye, gaze, size);
        let image = pictured.then(|| self.draw_image(&camera)).transpose()?;
        let truth = match &self.semantics {
            Some(semantics) => Some(GroundTruth {
                labels: semantics.visible_labels(&camera, gaze).map_err(|error| self.not_drawn(&error))?,
                lists_objects: semantics.lists_objects,
                room: semantics.room_at(eye, gaze.heading).map(str::to_owned),
            }),
            None => None,
        };
        Ok(View::new(Pose::looking_level(eye, gaze.heading), gaze.horizontal_fov_rad, image, truth))
    }

    /// The depth picture from an eye.
    pub(super) fn depth_from(&self, eye: DVec3, gaze: ViewGaze, size: [u32; 2]) -> Result<DepthImage, PlatformError> {
        let picture = render_ids(&self.scene, &PinholeCamera::for_level_gaze(eye, gaze, size))
            .map_err(|error| self.not_drawn(&error))?;
        DepthImage::new(picture.width, picture.height, picture.depth_m).map_err(|error| self.not_drawn(&error))
    }

    /// What a camera sees: depths, and colours if `coloured`.
    pub(super) fn render_camera(
        &self,
        camera: &PinholeCamera,
        coloured: bool,
    ) -> Result<RenderedPicture, PlatformError> {
        let drawn = if coloured { render_scene(&self.scene, camera) } else { render_ids(&self.scene, camera) };
        drawn.map_err(|error| self.not_drawn(&error))
    }

    /// A storey from above, around its viewpoints.
    pub(super) fn look_down(&self, level: u32) -> Result<Option<FromAbove>, PlatformError> {
        draw_storey(&self.scene, &self.graph, level).map_err(|error| self.not_drawn(&error))
    }

    fn draw_image(&self, camera: &PinholeCamera) -> Result<Arc<Image>, PlatformError> {
        let picture = render_scene(&self.scene, camera).map_err(|error| self.not_drawn(&error))?;
        let image = Image::new(picture.width, picture.height, picture.rgb);
        image.map(Arc::new).map_err(|error| self.not_drawn(&error))
    }

    /// The error for a picture of this scene that cannot be drawn.
    fn not_drawn(&self, error: &dyn std::error::Error) -> PlatformError {
        PlatformError::NotDrawn { scene: self.id.clone(), reason: error.to_string() }
    }

    /// All objects that are visible around a place, found in small pictures.
    pub(super) fn labels_around(&self, eye: DVec3, heading: Heading) -> Result<Vec<ObjectLabel>, PlatformError> {
        let Some(semantics) = &self.semantics else { return Ok(Vec::new()) };
        let quarters = ViewGaze::around_heading(heading).into_iter();
        let labels =
            quarters.map(|gaze| semantics.visible_labels(&PinholeCamera::for_level_gaze(eye, gaze, [320, 240]), gaze));
        let labels: Result<Vec<Vec<ObjectLabel>>, RenderError> = labels.collect();
        Ok(labels.map_err(|error| self.not_drawn(&error))?.into_iter().flatten().collect())
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
    pub(super) fn check_frame(&self, frame: &Frame) -> Result<(), PlatformError> {
        let eye = frame.pose.position;
        let is_there = match &self.walkable {
            Some(walkable) => walkable.has_ground_under(eye),
            None => (self.off_graph && eye.is_finite()) || graph::is_near_graph(&self.graph, eye),
        };
        if is_there { Ok(()) } else { Err(PlatformError::for_unknown_place(&self.id, frame)) }
    }
}
