//! The code that all live simulators share: a platform over a running simulator.
//!
//! A simulator answers one request at a time, so it is behind a mutex. On first use of a scene the platform surveys it
//! (objects, floor, rooms) and keeps the survey; later questions about the graph or an object's name need no simulator.

use crate::{
    labels::{self, ObjectPalette},
    path_sampling::{self, WalkableScene},
    raster::FloorRaster,
};
use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
    path::PathBuf,
    sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError},
};
use wayword_core::{
    DVec3, FailureKind, Frame, GroundTruth, Heading, Image, ObjectId, ObjectLabel, Path, PathRequest, Platform,
    PlatformError, Pose, SceneCatalogue, SceneId, View, ViewGaze, ViewpointGraph, ViewpointId,
};
use wayword_render::{PinholeCamera, to_flat_gaze};
use wayword_world::{output_lines::OutputListener, seen_from};

/// How far ahead of a doorway the room lies into which one looks, metres.
const AHEAD_M: f64 = 0.5;

/// A simulator that runs as a separate program.
pub(crate) trait Simulator: Send + fmt::Debug {
    /// The errors of this simulator.
    type Error: std::error::Error;
    /// Its name, as `--platform` takes it.
    const NAME: &'static str;

    /// Its address, for messages.
    fn address(&self) -> String;

    /// Sets the receiver of progress lines: they report whom the program waits for, and missing parts of scenes.
    fn set_listener(&mut self, ear: ProgressListener);

    /// The scenes that it lists.
    fn scene_names(&self) -> Vec<String>;

    /// `None` where the scene's name is valid; otherwise a hint about how scenes are named.
    fn scene_name_hint(&self, scene: &SceneId) -> Option<&'static str>;

    /// Connects to the simulator and loads this scene. Cheap where the scene is loaded already.
    fn enter_scene(&mut self, scene: &SceneId) -> Result<(), Self::Error>;

    /// Asks where the objects of the scene are, and where one can walk.
    fn survey_scene(&mut self) -> Result<SimulatorSurvey, Self::Error>;

    /// Takes a picture through a level camera (elevation 0). Where only the ids are `wanted`, it may leave out the rest.
    fn take_picture(&mut self, camera: &PinholeCamera, wanted: SimulatorShotKind)
    -> Result<SimulatorShot, Self::Error>;

    /// The corners of the shortest way between two eye positions, both ends included; `None` where there is no way.
    fn shortest_way(
        &mut self,
        survey: &SimulatorSurvey,
        from: DVec3,
        to: DVec3,
    ) -> Result<Option<Vec<DVec3>>, Self::Error>;

    /// What to do about an error.
    fn error_hint(error: &Self::Error) -> &'static str;

    /// Whether an error means that the simulator was lost. Then the program tries once more at once.
    fn is_loss(error: &Self::Error) -> bool;

    /// The kind of failure to report where trying once more did not help.
    fn failure_kind(error: &Self::Error) -> FailureKind;
}

/// Receives the progress lines about a simulator. A new platform discards them ([`ProgressListener::without_listener`]) until somebody listens.
#[derive(Clone)]
pub(crate) struct ProgressListener(OutputListener);

impl ProgressListener {
    pub(crate) fn without_listener() -> Self {
        Self(Arc::new(|_: &str| {}))
    }

    pub(crate) fn report_line(&self, line: &str) {
        (self.0)(line);
    }
}

impl fmt::Debug for ProgressListener {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Ear")
    }
}

/// The contents of a scene, as far as a platform needs them.
#[derive(Debug)]
pub(crate) struct SimulatorSurvey {
    /// Viewpoints at eye height, and between which of them one can walk straight.
    pub(crate) graph: ViewpointGraph,
    /// The floor.
    pub(crate) raster: FloorRaster,
    /// Objects by their colours.
    pub(crate) palette: ObjectPalette,
    /// Rooms, where they have names.
    pub(crate) rooms: Vec<SimulatorRoom>,
    /// The floor in doorways. An eye above it counts as being in the room into which it looks.
    pub(crate) thresholds: Vec<FloorRectangle>,
}

/// A rectangle of floor: lower and upper corner (x, y), metres, world frame.
pub(crate) type FloorRectangle = ([f64; 2], [f64; 2]);

/// Which data of a picture a caller needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SimulatorShotKind {
    /// Colours and object ids.
    Picture,
    /// Object ids alone, which are enough for labels and cost less.
    Ids,
}

/// A room with a name.
#[derive(Debug)]
pub(crate) struct SimulatorRoom {
    pub(crate) name: String,
    /// Lower and upper corner, metres, world frame.
    pub(crate) bounds_m: (DVec3, DVec3),
}

/// A picture, and the colour of each pixel's object as [`labels::colour_id`] encodes it.
pub(crate) struct SimulatorShot {
    /// `None` if the caller did not ask for colours.
    pub(crate) rgb: Option<Vec<u8>>,
    pub(crate) ids: Vec<u32>,
}

/// Size of pictures, and distance between frames.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LivePictureOptions {
    /// Width, pixels.
    pub width_px: u32,
    /// Height, pixels.
    pub height_px: u32,
    /// Distance between two frames of a random path, metres.
    pub interval_m: f64,
}

impl Default for LivePictureOptions {
    fn default() -> Self {
        Self { width_px: 640, height_px: 480, interval_m: 1.0 }
    }
}

/// A platform over a simulator. When the simulator is lost, the platform waits for it once more and reloads the scene.
#[derive(Debug)]
pub struct LivePlatform<S> {
    pictures: LivePictureOptions,
    running: Mutex<RunningSimulator<S>>,
}

/// The simulator, and the scenes that were surveyed in it.
#[derive(Debug)]
struct RunningSimulator<S> {
    simulator: S,
    scenes: BTreeMap<SceneId, Arc<SurveyedScene>>,
}

/// A scene that has been surveyed.
#[derive(Debug)]
struct SurveyedScene {
    survey: SimulatorSurvey,
    graph: Arc<ViewpointGraph>,
    /// The viewpoints from which each object is seen; computed when they are first asked for.
    seen_from: OnceLock<BTreeMap<ObjectId, BTreeSet<ViewpointId>>>,
}

#[allow(private_bounds, reason = "a platform over the simulators of this crate, and no other")]
impl<S: Simulator> LivePlatform<S> {
    pub(crate) fn from_simulator(simulator: S, pictures: LivePictureOptions) -> Self {
        Self { pictures, running: Mutex::new(RunningSimulator { simulator, scenes: BTreeMap::new() }) }
    }

    fn lock_simulator(&self) -> MutexGuard<'_, RunningSimulator<S>> {
        self.running.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn address(&self) -> String {
        self.lock_simulator().simulator.address()
    }

    /// Runs `act` with the simulator while the scene is loaded in it.
    fn with_scene<T>(
        &self,
        scene: &SceneId,
        mut act: impl FnMut(&mut S, &SurveyedScene) -> Result<T, S::Error>,
    ) -> Result<T, PlatformError> {
        let mut running = self.lock_simulator();
        if let Some(hint) = running.simulator.scene_name_hint(scene) {
            return Err(PlatformError::UnknownScene { scene: scene.to_string(), hint: hint.to_owned() });
        }
        let mut attempt = || {
            let known = running.enter_scene(scene)?;
            act(&mut running.simulator, &known)
        };
        let outcome = match attempt() {
            Err(error) if S::is_loss(&error) => attempt(),
            outcome => outcome,
        };
        outcome.map_err(|error| {
            let (world, reason, hint) = (running.simulator.address(), error.to_string(), S::error_hint(&error));
            match S::failure_kind(&error) {
                FailureKind::Lost => PlatformError::Lost { world, reason, hint },
                FailureKind::Missing | FailureKind::Broken => {
                    PlatformError::File { file: PathBuf::from(world), reason, hint }
                }
            }
        })
    }

    /// The scene with its survey. A scene that was surveyed before needs no simulator.
    fn surveyed_scene(&self, scene: &SceneId) -> Result<Arc<SurveyedScene>, PlatformError> {
        if let Some(known) = self.lock_simulator().scenes.get(scene) {
            return Ok(known.clone());
        }
        self.with_scene(scene, |_, _| Ok(()))?;
        let running = self.lock_simulator();
        let lost = || PlatformError::Lost {
            world: running.simulator.address(),
            reason: format!("the survey of {scene} was lost"),
            hint: "try again",
        };
        running.scenes.get(scene).cloned().ok_or_else(lost)
    }

    fn camera_at(&self, eye: DVec3, gaze: ViewGaze) -> PinholeCamera {
        PinholeCamera::for_level_gaze(eye, gaze, [self.pictures.width_px, self.pictures.height_px])
    }

    /// Sends progress lines to `hear`. They report whom the program waits for, and missing parts of
    /// scenes.
    #[must_use]
    pub fn heard_by(self, hear: OutputListener) -> Self {
        self.lock_simulator().simulator.set_listener(ProgressListener(hear));
        self
    }

    /// The picture and its ground truth: labels of the visible objects, and the room. There is no ground truth where the
    /// scene has neither objects nor named rooms.
    fn picture_and_truth(
        &self,
        scene: &SceneId,
        (eye, gaze): (DVec3, ViewGaze),
        wanted: SimulatorShotKind,
    ) -> Result<(Option<Vec<u8>>, Option<GroundTruth>), PlatformError> {
        let camera = self.camera_at(eye, gaze);
        self.with_scene(scene, |simulator, known| {
            let SimulatorShot { rgb, ids } = simulator.take_picture(&camera, wanted)?;
            let labels = labels::labels_in_gaze(&camera, gaze, ids, &known.survey.palette);
            let (lists_objects, room) = (!known.survey.palette.is_empty(), known.survey.room_facing(eye, gaze.heading));
            let is_known = lists_objects || !known.survey.rooms.is_empty();
            Ok((rgb, is_known.then_some(GroundTruth { labels, lists_objects, room })))
        })
    }

    /// The view from a frame, with as much of the picture as is `wanted`.
    fn view_from(
        &self,
        scene: &SceneId,
        from: &Frame,
        gaze: ViewGaze,
        wanted: SimulatorShotKind,
    ) -> Result<View, PlatformError> {
        path_sampling::check_frame(scene, from)?;
        let gaze = to_flat_gaze(gaze);
        let (rgb, truth) = self.picture_and_truth(scene, (from.pose.position, gaze), wanted)?;
        // The decoder has checked the picture's size.
        let image = rgb.and_then(|rgb| Image::new(self.pictures.width_px, self.pictures.height_px, rgb).ok());
        let pose = Pose::looking_level(from.pose.position, gaze.heading);
        Ok(View::new(pose, gaze.horizontal_fov_rad, image.map(Arc::new), truth))
    }
}

impl<S: Simulator> RunningSimulator<S> {
    /// Loads a scene, and surveys it on first use.
    fn enter_scene(&mut self, scene: &SceneId) -> Result<Arc<SurveyedScene>, S::Error> {
        self.simulator.enter_scene(scene)?;
        if let Some(known) = self.scenes.get(scene) {
            return Ok(known.clone());
        }
        let survey = self.simulator.survey_scene()?;
        let graph = Arc::new(survey.graph.clone());
        let known = Arc::new(SurveyedScene { survey, graph, seen_from: OnceLock::new() });
        self.scenes.insert(scene.clone(), known.clone());
        Ok(known)
    }
}

impl SimulatorSurvey {
    /// The room in which an eye is. In a doorway it is the room into which the eye looks.
    fn room_facing(&self, eye: DVec3, heading: Heading) -> Option<String> {
        let holds = |area: &FloorRectangle, at: DVec3| {
            let (low, high) = area;
            (low[0]..=high[0]).contains(&at.x) && (low[1]..=high[1]).contains(&at.y)
        };
        let is_on_threshold = self.thresholds.iter().any(|area| holds(area, eye));
        let ahead = eye + heading.unit_vector() * AHEAD_M;
        is_on_threshold.then(|| self.room_at(ahead)).flatten().or_else(|| self.room_at(eye))
    }

    /// The room with a box around a place.
    fn room_at(&self, place: DVec3) -> Option<String> {
        let holds = |room: &&SimulatorRoom| {
            let (low, high) = room.bounds_m;
            place.cmpge(low).all() && place.cmple(high).all()
        };
        self.rooms.iter().find(holds).map(|room| room.name.clone())
    }
}

/// A scene to walk through.
struct LiveSceneWalker<'a, S>(&'a LivePlatform<S>, &'a SceneId);

impl<S: Simulator> path_sampling::WalkableScene for LiveSceneWalker<'_, S> {
    fn shortest_way(&mut self, from: DVec3, to: DVec3) -> Result<Option<Vec<DVec3>>, PlatformError> {
        self.0.with_scene(self.1, |simulator, known| simulator.shortest_way(&known.survey, from, to))
    }

    fn labels_in_gaze(&mut self, pose: Pose, gaze: ViewGaze) -> Result<Vec<ObjectLabel>, PlatformError> {
        let (_, truth) = self.0.picture_and_truth(self.1, (pose.position, gaze), SimulatorShotKind::Ids)?;
        Ok(truth.map_or_else(Vec::new, |truth| truth.labels))
    }
}

impl<S: Simulator> Platform for LivePlatform<S> {
    fn name(&self) -> &'static str {
        S::NAME
    }

    fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        let names = self.lock_simulator().simulator.scene_names().into_iter();
        let mut scenes: Vec<SceneId> = names.filter_map(|name| SceneId::new(name).ok()).collect();
        scenes.sort();
        Ok(scenes)
    }

    fn graph_for_scene(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        Ok(self.surveyed_scene(scene)?.graph.clone())
    }

    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        let graph = self.graph_for_scene(scene)?;
        let eyes: Vec<DVec3> = graph.viewpoints().filter_map(|id| graph.position_of(id)).collect();
        path_sampling::sample_live_path(
            &mut LiveSceneWalker(self, scene),
            (scene, &eyes),
            request,
            seed,
            self.pictures.interval_m,
        )
    }

    fn look_from(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        self.view_from(scene, from, gaze, SimulatorShotKind::Picture)
    }

    fn look_without_picture(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        self.view_from(scene, from, gaze, SimulatorShotKind::Ids)
    }

    fn catalogue(&self) -> &dyn SceneCatalogue {
        self
    }
}

impl<S: Simulator> SceneCatalogue for LivePlatform<S> {
    fn object_name(&self, scene: &SceneId, _: &Frame, object: &ObjectId) -> Result<Option<String>, PlatformError> {
        let known = self.surveyed_scene(scene)?;
        let found = known.survey.palette.values().find(|thing| thing.object == *object);
        Ok(found.map(|thing| thing.name.clone()))
    }

    fn visible_from(&self, scene: &SceneId, object: &ObjectId) -> Result<Option<BTreeSet<ViewpointId>>, PlatformError> {
        let known = self.surveyed_scene(scene)?;
        if known.survey.palette.is_empty() {
            return Ok(None);
        }
        if known.seen_from.get().is_none() {
            let mut walker = LiveSceneWalker(self, scene);
            let seen = seen_from(&known.graph, |eye, heading| walker.labels_around(Pose::looking_level(eye, heading)))?;
            // Another thread may have been faster: it found the same.
            let _ = known.seen_from.set(seen);
        }
        let found = known.seen_from.get().and_then(|seen| seen.get(object)).cloned();
        Ok(Some(found.unwrap_or_default()))
    }
}
