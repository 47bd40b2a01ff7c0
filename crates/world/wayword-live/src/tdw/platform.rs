//! The platform on top of a live build.

use super::{
    controller::{Controller, ControllerOptions},
    error::TdwError,
    scenes::{self, Plan},
    session::{self, Shot, Survey},
};
use crate::{sight, walk};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::PathBuf,
    sync::{Arc, Mutex, PoisonError},
};
use wayword_core::{
    DVec3, Frame, Gaze, GroundTruth, Image, Label, ObjectId, Path, PathRequest, Platform, PlatformError, Pose, SceneId,
    View, ViewpointGraph, ViewpointId,
};
use wayword_render::Camera;

/// Widest gaze that one flat picture can show, radians.
const WIDEST_RAD: f64 = 2.6;

/// What can be chosen about the platform.
#[derive(Debug, Clone, PartialEq)]
pub struct TdwOptions {
    /// Where to wait for the build.
    pub controller: ControllerOptions,
    /// Folder of the Python package `tdw`, whose lists of furniture are needed for furnished floor plans.
    pub package: Option<PathBuf>,
    /// Width of pictures, pixels.
    pub width_px: u32,
    /// Height of pictures, pixels.
    pub height_px: u32,
    /// Distance between two frames of a random path, metres.
    pub interval_m: f64,
}

impl Default for TdwOptions {
    fn default() -> Self {
        Self { controller: ControllerOptions::default(), package: None, width_px: 640, height_px: 480, interval_m: 1.0 }
    }
}

/// ThreeDWorld over a live build: scenes `floorplan_1a` to `floorplan_5c` (with furniture `floorplan_1a_0`), and procedural
/// rooms like `room_8x10`.
///
/// One build serves one look at a time. A build that is lost is waited for again, once, and its scene loaded anew.
#[derive(Debug)]
pub struct TdwPlatform {
    options: TdwOptions,
    live: Mutex<Live>,
}

#[derive(Debug)]
struct Live {
    controller: Controller,
    /// The scene that is in the build.
    loaded: Option<SceneId>,
    surveys: BTreeMap<SceneId, Arc<Scene>>,
}

/// A scene that has been surveyed.
#[derive(Debug)]
struct Scene {
    graph: Arc<ViewpointGraph>,
    palette: sight::Palette,
    /// The viewpoints from which each object is seen; looked for when first asked for.
    seen_from: std::sync::OnceLock<BTreeMap<ObjectId, BTreeSet<ViewpointId>>>,
}

impl TdwPlatform {
    /// A platform that waits for a build when it is first asked for something that takes one.
    ///
    /// # Errors
    /// When the port cannot be had.
    pub fn new(options: TdwOptions) -> Result<Self, TdwError> {
        let controller = Controller::bind(options.controller)?;
        Ok(Self { options, live: Mutex::new(Live { controller, loaded: None, surveys: BTreeMap::new() }) })
    }

    /// Where builds connect to.
    #[must_use]
    pub fn address(&self) -> std::net::SocketAddr {
        self.live.lock().unwrap_or_else(PoisonError::into_inner).controller.address()
    }

    /// Does something with the build while a scene is in it; once more with a new build, if this one is lost over it.
    fn with<T>(
        &self,
        scene: &SceneId,
        mut act: impl FnMut(&mut Controller, &Scene) -> Result<T, TdwError>,
    ) -> Result<T, PlatformError> {
        let plan = Plan::of(scene).ok_or_else(|| PlatformError::UnknownScene {
            scene: scene.to_string(),
            hint: "floor plans are named as in floorplan_1a or floorplan_1a_0, rooms as in room_8x10".to_owned(),
        })?;
        let mut live = self.live.lock().unwrap_or_else(PoisonError::into_inner);
        let mut attempt = || {
            let survey = self.enter(&mut live, scene, &plan)?;
            act(&mut live.controller, &survey)
        };
        let done = match attempt() {
            Err(error) if error.is_loss() => attempt(),
            done => done,
        };
        let file = PathBuf::from(format!("tcp://{}", live.controller.address()));
        done.map_err(|error| PlatformError::File {
            file,
            reason: error.to_string(),
            hint: "the live build must run and stay connected",
        })
    }

    fn enter(&self, live: &mut Live, scene: &SceneId, plan: &Plan) -> Result<Arc<Scene>, TdwError> {
        if !live.controller.is_connected() {
            live.loaded = None;
            live.controller.connect()?;
        }
        if live.loaded.as_ref() != Some(scene) {
            live.loaded = None;
            let size = (self.options.width_px, self.options.height_px);
            session::load(&mut live.controller, plan, self.options.package.as_deref(), size)?;
            live.loaded = Some(scene.clone());
        }
        if let Some(known) = live.surveys.get(scene) {
            return Ok(known.clone());
        }
        let Survey { graph, palette } = session::survey(&mut live.controller)?;
        let known = Arc::new(Scene { graph: Arc::new(graph), palette, seen_from: std::sync::OnceLock::new() });
        live.surveys.insert(scene.clone(), known.clone());
        Ok(known)
    }

    fn camera(&self, eye: DVec3, gaze: Gaze) -> Camera {
        let (width, height) = (self.options.width_px, self.options.height_px);
        let aspect = f64::from(height) / f64::from(width.max(1));
        Camera {
            position: eye,
            heading_rad: gaze.heading.rad(),
            elevation_rad: 0.0,
            vertical_fov_rad: 2.0 * libm::atan(libm::tan(gaze.horizontal_fov_rad / 2.0) * aspect),
            width,
            height,
        }
    }

    fn survey(&self, scene: &SceneId) -> Result<Arc<Scene>, PlatformError> {
        if let Some(known) = self.live.lock().unwrap_or_else(PoisonError::into_inner).surveys.get(scene) {
            return Ok(known.clone());
        }
        self.with(scene, |_, _| Ok(()))?;
        let live = self.live.lock().unwrap_or_else(PoisonError::into_inner);
        let unknown = || PlatformError::UnknownScene { scene: scene.to_string(), hint: "ask again".to_owned() };
        live.surveys.get(scene).cloned().ok_or_else(unknown)
    }

    fn seen(&self, scene: &SceneId, eye: DVec3, gaze: Gaze) -> Result<(Shot, Vec<Label>), PlatformError> {
        let camera = self.camera(eye, gaze);
        self.with(scene, |controller, survey| {
            let mut shot = session::shoot(controller, &camera)?;
            let ids = std::mem::take(&mut shot.ids);
            Ok((shot, sight::labels(&camera, gaze, ids, &survey.palette)))
        })
    }
}

/// A scene to walk through.
struct Walker<'a>(&'a TdwPlatform, &'a SceneId);

impl walk::Walkable for Walker<'_> {
    fn way(&mut self, from: DVec3, to: DVec3) -> Result<Option<Vec<DVec3>>, PlatformError> {
        self.0.with(self.1, |controller, _| session::way(controller, from, to))
    }

    fn labels(&mut self, pose: Pose, gaze: Gaze) -> Result<Vec<Label>, PlatformError> {
        self.0.seen(self.1, pose.position, gaze).map(|(_, labels)| labels)
    }
}

impl Platform for TdwPlatform {
    fn name(&self) -> &'static str {
        "tdw"
    }

    fn scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        let names = scenes::names(self.options.package.as_deref()).into_iter();
        let mut scenes: Vec<SceneId> = names.filter_map(|name| SceneId::new(name).ok()).collect();
        scenes.sort();
        Ok(scenes)
    }

    fn graph(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        Ok(self.survey(scene)?.graph.clone())
    }

    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        let graph = self.graph(scene)?;
        let eyes: Vec<DVec3> = graph.viewpoints().filter_map(|id| graph.position(id)).collect();
        walk::path(&mut Walker(self, scene), (scene, &eyes), request, seed, self.options.interval_m)
    }

    fn look(&self, scene: &SceneId, from: &Frame, gaze: Gaze) -> Result<View, PlatformError> {
        walk::check(scene, from)?;
        let gaze = Gaze { horizontal_fov_rad: gaze.horizontal_fov_rad.clamp(0.05, WIDEST_RAD), ..gaze };
        let (shot, labels) = self.seen(scene, from.pose.position, gaze)?;
        let image = Image::new(self.options.width_px, self.options.height_px, shot.rgb);
        let truth = GroundTruth { labels, lists_objects: true, room: None };
        let pose = Pose::level(from.pose.position, gaze.heading);
        // The picture was held against this size when it was decoded.
        Ok(View::new(pose, gaze.horizontal_fov_rad, image.ok().map(Arc::new), Some(truth)))
    }

    fn object_name(&self, scene: &SceneId, _: &Frame, object: &ObjectId) -> Result<Option<String>, PlatformError> {
        Ok(walk::name_of(self.survey(scene)?.palette.values(), object))
    }

    fn visible_from(&self, scene: &SceneId, object: &ObjectId) -> Result<Option<BTreeSet<ViewpointId>>, PlatformError> {
        let survey = self.survey(scene)?;
        if survey.seen_from.get().is_none() {
            let seen = walk::seen_from(&mut Walker(self, scene), &survey.graph)?;
            let _ = survey.seen_from.set(seen);
        }
        let found = survey.seen_from.get().and_then(|seen| seen.get(object)).cloned();
        Ok(Some(found.unwrap_or_default()))
    }
}
