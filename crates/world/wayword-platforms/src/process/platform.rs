//! Offers a child process as a [`Platform`].

use super::{
    child_keeper::ChildKeeper,
    graph,
    label_places::LabelPlaces,
    labels::{self, MAX_COORDINATE_M, ObserveAnswer},
    options::ProcessOptions,
    path, picture,
    protocol::{self, WorldOffer, WorldProgram},
};
use serde::Deserialize;
use serde_json::{Value, json};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path as FilePath,
    sync::{Arc, Mutex, OnceLock, PoisonError},
};
use wayword_core::{
    Frame, GroundTruth, Heading, Image, ObjectId, Path, PathRequest, Platform, PlatformError, Pose, SceneCatalogue,
    SceneId, View, ViewGaze, ViewpointGraph, ViewpointId,
};
use wayword_render::to_flat_gaze;
use wayword_world::{episode_path::labels_around, graph_walk, output_lines::OutputListener};

/// Most scenes that a child may list.
const MAX_SCENES: usize = 10_000;

/// A platform with scenes that another program provides.
///
/// The child is asked for a scene's graph only once. Requests go to the child one after another. If a request meets a
/// fault, its caller gets an error, and the child is restarted for the next request.
pub struct ProcessPlatform {
    keeper: ChildKeeper,
    known: Mutex<BTreeMap<SceneId, Arc<ProcessSceneFacts>>>,
    label_places: Mutex<LabelPlaces>,
}

/// The answers of the child about a scene that are asked for only once.
struct ProcessSceneFacts {
    graph: Arc<ViewpointGraph>,
    objects: OnceLock<BTreeMap<ObjectId, ObjectVisibility>>,
}

/// One object, collected from the labels at all viewpoints of a scene.
#[derive(Default)]
struct ObjectVisibility {
    name: String,
    visible_from: BTreeSet<ViewpointId>,
}

/// The answer to `scenes`.
#[derive(Deserialize)]
struct ScenesAnswer {
    scenes: Vec<SceneId>,
}

/// The answer to `object_name`.
#[derive(Deserialize)]
struct NameAnswer {
    name: Option<String>,
}

/// The answer to `visible_from`.
#[derive(Deserialize)]
struct ViewpointsAnswer {
    viewpoints: Option<BTreeSet<ViewpointId>>,
}

impl ProcessPlatform {
    /// Starts the program that a file names (see [`ProcessOptions::read_world_file`]) and reads its greeting. `hear` receives each
    /// line that the child writes to its standard error.
    ///
    /// # Errors
    /// If the file is not a valid world file, the child cannot be started, or its greeting cannot be used.
    pub fn open(file: &FilePath, hear: OutputListener) -> Result<Self, PlatformError> {
        Self::start(ProcessOptions::read_world_file(file)?, hear)
    }

    /// Starts a program and reads its greeting.
    ///
    /// # Errors
    /// If the child cannot be started, or its greeting cannot be used.
    pub fn start(options: ProcessOptions, hear: OutputListener) -> Result<Self, PlatformError> {
        Ok(Self { keeper: ChildKeeper::start(options, hear)?, known: Mutex::default(), label_places: Mutex::default() })
    }

    /// What the child is and what it offers.
    #[must_use]
    pub fn world(&self) -> &WorldProgram {
        self.keeper.world()
    }

    fn has_offer(&self, offer: WorldOffer) -> bool {
        self.world().has_offer(offer)
    }

    /// The child's answers about a scene, which are asked for on first use.
    fn known_scene(&self, scene: &SceneId) -> Result<Arc<ProcessSceneFacts>, PlatformError> {
        if let Some(known) = self.known.lock().unwrap_or_else(PoisonError::into_inner).get(scene) {
            return Ok(Arc::clone(known));
        }
        // Asked without the lock, so that views of other scenes need not wait. If two threads ask for the same graph,
        // the first result counts.
        let graph = Arc::new(graph::ask_scene_graph(&self.keeper, scene)?);
        let made = Arc::new(ProcessSceneFacts { graph, objects: OnceLock::new() });
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(Arc::clone(known.entry(scene.clone()).or_insert(made)))
    }

    /// Asks the child for a view. Data that the child does not offer are left out.
    fn ask_view(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze, picture: bool) -> Result<View, PlatformError> {
        let eye = from.pose.position;
        if !eye.is_finite() || eye.abs().max_element() > MAX_COORDINATE_M {
            return Err(PlatformError::NotAViewpoint { scene: scene.clone() });
        }
        let gaze = to_flat_gaze(gaze);
        let picture = picture && self.has_offer(WorldOffer::Pictures);
        let pose = Pose::looking_level(eye, gaze.heading);
        if !picture && !self.has_offer(WorldOffer::Labels) && !self.has_offer(WorldOffer::Rooms) {
            return Ok(View::new(pose, gaze.horizontal_fov_rad, None, None));
        }
        let (seen, file) =
            self.keeper.ask_and_take("observe", &self.look_request(scene, from, gaze, picture), |result, folder| {
                let mut seen: ObserveAnswer =
                    serde_path_to_error::deserialize(result).map_err(|error| error.to_string())?;
                let file = seen.image.take().filter(|_| picture).map(|sent| sent.into_bytes(folder)).transpose()?;
                Ok((seen, file))
            })?;
        let misfit = |reason: String| self.keeper.misfit_error("observe", reason);
        let size_px = self.size_px();
        if picture && file.is_none() {
            return Err(misfit("no `image`, although it offers pictures".into()));
        }
        let image: Option<Image> =
            file.map(|file| picture::decode_child_picture(&file, size_px)).transpose().map_err(misfit)?;
        let truth = self.labels_and_room(scene, seen, &pose, gaze).map_err(misfit)?;
        Ok(View::new(pose, gaze.horizontal_fov_rad, image.map(Arc::new), truth))
    }

    fn size_px(&self) -> (u32, u32) {
        let options = self.keeper.options();
        (options.width_px, options.height_px)
    }

    /// The parameters of the request `observe`.
    fn look_request(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze, picture: bool) -> Value {
        let (width_px, height_px) = self.size_px();
        let half_width = libm::tan(gaze.horizontal_fov_rad / 2.0);
        json!({
            "scene": scene,
            "position": from.pose.position.to_array(),
            "viewpoint": from.viewpoint,
            "heading_rad": gaze.heading.rad(),
            "horizontal_fov_rad": gaze.horizontal_fov_rad,
            // Pixels are square.
            "vertical_fov_rad": 2.0 * libm::atan(half_width * f64::from(height_px) / f64::from(width_px)),
            "width_px": width_px,
            "height_px": height_px,
            "picture": picture,
        })
    }

    /// The ground truth in an answer; `None` if the child offers neither labels nor rooms.
    fn labels_and_room(
        &self,
        scene: &SceneId,
        seen: ObserveAnswer,
        pose: &Pose,
        gaze: ViewGaze,
    ) -> Result<Option<GroundTruth>, String> {
        let lists_objects = self.has_offer(WorldOffer::Labels);
        if !lists_objects && !self.has_offer(WorldOffer::Rooms) {
            return Ok(None);
        }
        let labels = match seen.labels {
            Some(seen) if lists_objects => {
                let all = labels::labels_of_answer(seen, pose.position, gaze, self.size_px())?;
                let mut places = self.label_places.lock().unwrap_or_else(PoisonError::into_inner);
                places.check_view(scene, pose.position, gaze, self.size_px().0, &all)?;
                labels::labels_in_view(all, gaze)
            }
            None if lists_objects => return Err("no `labels`, although it offers them (send [] for none)".into()),
            _ => Vec::new(),
        };
        let room = seen
            .room
            .filter(|_| self.has_offer(WorldOffer::Rooms))
            .map(|room| protocol::checked_name("`room`", &room))
            .transpose()?;
        Ok(Some(GroundTruth { labels, lists_objects, room }))
    }

    /// All objects that are seen from any viewpoint of the graph. The child is asked for every viewpoint, without a
    /// picture.
    fn objects_of_scene<'a>(
        &self,
        scene: &SceneId,
        known: &'a ProcessSceneFacts,
    ) -> Result<&'a BTreeMap<ObjectId, ObjectVisibility>, PlatformError> {
        if let Some(objects) = known.objects.get() {
            return Ok(objects);
        }
        let mut objects: BTreeMap<ObjectId, ObjectVisibility> = BTreeMap::new();
        for viewpoint in known.graph.viewpoints() {
            for label in self.labels_at(scene, &known.graph, viewpoint)? {
                let object = objects.entry(label.object).or_default();
                object.name = label.name;
                object.visible_from.insert(viewpoint.clone());
            }
        }
        Ok(known.objects.get_or_init(|| objects))
    }

    /// The labels all around a viewpoint; none if the child offers no labels.
    fn labels_at(
        &self,
        scene: &SceneId,
        graph: &ViewpointGraph,
        viewpoint: &ViewpointId,
    ) -> Result<Vec<wayword_core::ObjectLabel>, PlatformError> {
        if !self.has_offer(WorldOffer::Labels) {
            return Ok(Vec::new());
        }
        let pose = Pose::looking_level(graph.position_of(viewpoint).unwrap_or_default(), Heading::NORTH);
        let frame = Frame { pose, viewpoint: Some(viewpoint.clone()), level: graph.level_of(viewpoint) };
        labels_around(self, scene, &frame)
    }
}

impl Platform for ProcessPlatform {
    fn name(&self) -> &'static str {
        "process"
    }

    fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        let ScenesAnswer { mut scenes } = self.keeper.ask_and_read("scenes", &json!({}))?;
        if scenes.len() > MAX_SCENES {
            return Err(self.keeper.misfit_error("scenes", format!("more than {MAX_SCENES} scenes")));
        }
        scenes.sort();
        match scenes.array_windows().find(|[scene, next]| scene == next) {
            Some([scene, _]) => Err(self.keeper.misfit_error("scenes", format!("`scenes` lists {scene} twice"))),
            None => Ok(scenes),
        }
    }

    fn graph_for_scene(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        Ok(Arc::clone(&self.known_scene(scene)?.graph))
    }

    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        if self.has_offer(WorldOffer::SamplePath) {
            return path::ask_random_path(&self.keeper, self, scene, request, seed);
        }
        let graph = self.graph_for_scene(scene)?;
        graph_walk::sample_graph_path(scene, &graph, request, seed, |viewpoint| {
            self.labels_at(scene, &graph, viewpoint)
        })
    }

    fn look_from(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        self.ask_view(scene, from, gaze, true)
    }

    fn look_without_picture(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        self.ask_view(scene, from, gaze, false)
    }

    fn catalogue(&self) -> &dyn SceneCatalogue {
        self
    }
}

impl SceneCatalogue for ProcessPlatform {
    fn object_name(&self, scene: &SceneId, near: &Frame, object: &ObjectId) -> Result<Option<String>, PlatformError> {
        if self.has_offer(WorldOffer::ObjectName) {
            let NameAnswer { name } =
                self.keeper.ask_and_read("object_name", &json!({ "scene": scene, "object": object }))?;
            let name = name.map(|name| protocol::checked_name("`name`", &name)).transpose();
            return name.map_err(|reason| self.keeper.misfit_error("object_name", reason));
        }
        if !self.has_offer(WorldOffer::Labels) {
            return Ok(None);
        }
        let here = labels_around(self, scene, near)?.into_iter().find(|label| label.object == *object);
        if let Some(label) = here {
            return Ok(Some(label.name));
        }
        let known = self.known_scene(scene)?;
        Ok(self.objects_of_scene(scene, &known)?.get(object).map(|object| object.name.clone()))
    }

    /// The viewpoints that the child names, or else those from which its labels show the object.
    fn visible_from(&self, scene: &SceneId, object: &ObjectId) -> Result<Option<BTreeSet<ViewpointId>>, PlatformError> {
        if self.has_offer(WorldOffer::VisibleFrom) {
            let asked = json!({ "scene": scene, "object": object });
            let ViewpointsAnswer { viewpoints } = self.keeper.ask_and_read("visible_from", &asked)?;
            return Ok(viewpoints);
        }
        if !self.has_offer(WorldOffer::Labels) {
            return Ok(None);
        }
        let known = self.known_scene(scene)?;
        Ok(Some(
            self.objects_of_scene(scene, &known)?
                .get(object)
                .map(|object| object.visible_from.clone())
                .unwrap_or_default(),
        ))
    }
}
