//! One scene, read and prepared.

use super::{
    HabitatOptions,
    files::SceneFiles,
    islands::{self, Choice, Survey},
};
use crate::{
    axes::EYE_M,
    bake::bake,
    columns::Columns,
    fault::{self, FileError},
    ground::{Ground, viewpoint_graph},
    navmesh::{NavMesh, NavMeshSettings},
    scene::{Model, Stage},
    semantics::{self, Semantics},
};
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{Arc, OnceLock},
};
use wayword_core::{
    DVec3, Depth, Frame, FromAbove, Gaze, GroundTruth, Heading, Image, Island, Label, ObjectId, PlatformError, Pose,
    SceneId, View, ViewpointGraph, ViewpointId,
};
use wayword_render::{Camera, RenderError, Scene, render, render_ids, storey};
use wayword_world::seen_from;

const MAX_NAVMESH: u64 = 1 << 30;
const NAVMESH_HINT: &str = "remove the file, and a navmesh is baked from the scene instead";
const ISLAND_HINT: &str = "choose an existing island with --island, or give the scene a .navmesh of its rooms";
const DRAW_HINT: &str = "export the scene again as GLB";

/// A scene with its ground.
pub(super) struct Home {
    pub(super) id: SceneId,
    scene: Scene,
    pub(super) navmesh: NavMesh,
    pub(super) ground: Ground,
    columns: Columns,
    surveys: Vec<Survey>,
    /// The warning to print if the user may mean another island than the chosen one.
    pub(super) doubt: Option<String>,
    pub(super) graph: Arc<ViewpointGraph>,
    pub(super) semantics: Option<Semantics>,
    /// The viewpoints from which each object is seen; computed when first needed.
    seen_from: OnceLock<BTreeMap<ObjectId, BTreeSet<ViewpointId>>>,
}

impl Home {
    pub(super) fn build(id: &SceneId, files: &SceneFiles, options: &HabitatOptions) -> Result<Self, PlatformError> {
        let stage = Stage::of(&files.stage)?;
        let model = Model::of(&stage)?;
        let navmesh = match options.navmesh.clone().or_else(|| files.navmesh(&stage)) {
            Some(file) => {
                let bytes = fault::bytes(&file, MAX_NAVMESH, NAVMESH_HINT)?;
                NavMesh::from_bytes(&bytes).map_err(|error| FileError::new(&file, error.to_string(), NAVMESH_HINT))?
            }
            None => bake(&model, &NavMeshSettings::default())
                .map_err(|error| FileError::new(&stage.asset, error.to_string(), error.hint()))?,
        };
        let columns = Columns::new(model.triangles());
        let ground = Ground::new(&navmesh);
        let surveys = islands::survey(&ground, &columns);
        let choice = island(&ground, &surveys, options, &stage)?;
        let doubt = choice.is_doubtful.then(|| {
            let listed = islands::listed(&surveys);
            format!(
                "scene {id}: paths stay on island {} of its navmesh; to choose another, use --island ({listed})",
                choice.number
            )
        });
        let ground = ground.keeping_to(choice.number);
        let semantics = semantics::load(&files.semantics(&stage), stage.habitat_from_asset)?;
        let scene = Scene::new(model.meshes, model.materials, model.textures);
        let scene = scene.map_err(|error| FileError::new(&stage.asset, error.to_string(), DRAW_HINT))?;
        let graph = viewpoint_graph(&ground, ground.main())
            .map_err(|source| PlatformError::Graph { scene: id.clone(), source })?;
        let (id, graph) = (id.clone(), Arc::new(graph));
        let seen_from = OnceLock::new();
        Ok(Self { id, scene, navmesh, ground, columns, surveys, doubt, graph, semantics, seen_from })
    }

    /// The islands of its navmesh, the largest first.
    pub(super) fn islands(&self) -> Vec<Island> {
        self.surveys.iter().map(|survey| survey.told(Some(self.ground.main()))).collect()
    }

    /// Whether a person can stand upright at a place on the ground.
    pub(super) fn is_headroom(&self, ground: DVec3) -> bool {
        self.columns.over(ground).is_headroom()
    }

    /// What is seen from an eye: a picture if `pictured`, and labels if the scene has semantics.
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

    /// How far away is what is seen from an eye.
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

    /// The error that something in this scene cannot be drawn.
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

    /// The viewpoints from which each object is seen.
    pub(super) fn seen_from(&self) -> Result<&BTreeMap<ObjectId, BTreeSet<ViewpointId>>, PlatformError> {
        if let Some(seen_from) = self.seen_from.get() {
            return Ok(seen_from);
        }
        let seen = seen_from(&self.graph, |eye, heading| self.labels_around(eye, heading))?;
        Ok(self.seen_from.get_or_init(|| seen))
    }

    /// Returns an error for a frame that is not above the ground.
    pub(super) fn check(&self, frame: &Frame) -> Result<(), PlatformError> {
        let eye = frame.pose.position;
        if self.ground.nearest(eye - DVec3::Z * EYE_M).is_some() {
            return Ok(());
        }
        Err(PlatformError::nowhere(&self.id, frame))
    }
}

/// The island that paths stay on: the one that the user chose, else the one on which people would walk.
fn island(
    ground: &Ground,
    surveys: &[Survey],
    options: &HabitatOptions,
    stage: &Stage,
) -> Result<Choice, PlatformError> {
    let refused = |reason: String| FileError::new(&stage.asset, reason, ISLAND_HINT).into();
    match options.island {
        Some(number) if number < ground.islands_m2().count() => Ok(Choice { number, is_doubtful: false }),
        Some(number) => Err(refused(format!("its navmesh has no island {number}: {}", islands::listed(surveys)))),
        None => islands::choose(surveys).ok_or_else(|| {
            let listed = islands::listed(surveys);
            refused(format!("no island of its navmesh is a place to walk on, indoors or under the open sky: {listed}"))
        }),
    }
}
