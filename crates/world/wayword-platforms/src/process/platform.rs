//! Offers a child process as a [`Platform`].

use super::{
    graph,
    keeper::Keeper,
    labels::{self, MAX_COORDINATE_M, Observed},
    options::ProcessOptions,
    path, picture,
    protocol::{self, Offer, World},
};
use serde::Deserialize;
use serde_json::{Value, json};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path as FilePath,
    sync::{Arc, Mutex, OnceLock, PoisonError},
};
use wayword_core::{
    Frame, Gaze, GroundTruth, Heading, Image, ObjectId, Path, PathRequest, Platform, PlatformError, Pose, SceneId,
    View, ViewpointGraph, ViewpointId,
};
use wayword_render::flat;
use wayword_world::{episode_path::labels_around, graph_walk, said::Hear};

/// Most scenes that a child may list.
const MAX_SCENES: usize = 10_000;

/// A platform with scenes that another program provides.
///
/// The child is asked for a scene's graph only once. Requests go to the child one after another. If a request meets a
/// fault, its caller gets an error, and the child is restarted for the next request.
pub struct ProcessPlatform {
    keeper: Keeper,
    known: Mutex<BTreeMap<SceneId, Arc<Known>>>,
}

/// The answers of the child about a scene that are asked for only once.
struct Known {
    graph: Arc<ViewpointGraph>,
    objects: OnceLock<BTreeMap<ObjectId, Everywhere>>,
}

/// One object, collected from the labels at all viewpoints of a scene.
#[derive(Default)]
struct Everywhere {
    name: String,
    visible_from: BTreeSet<ViewpointId>,
}

/// The answer to `scenes`.
#[derive(Deserialize)]
struct Scenes {
    scenes: Vec<SceneId>,
}

/// The answer to `object_name`.
#[derive(Deserialize)]
struct Name {
    name: Option<String>,
}

/// The answer to `visible_from`.
#[derive(Deserialize)]
struct Viewpoints {
    viewpoints: Option<BTreeSet<ViewpointId>>,
}

impl ProcessPlatform {
    /// Starts the program that a file names (see [`ProcessOptions::read`]) and reads its greeting. `hear` receives each
    /// line that the child writes to its standard error.
    ///
    /// # Errors
    /// If the file is not a valid world file, the child cannot be started, or its greeting cannot be used.
    pub fn open(file: &FilePath, hear: Hear) -> Result<Self, PlatformError> {
        Self::start(ProcessOptions::read(file)?, hear)
    }

    /// Starts a program and reads its greeting.
    ///
    /// # Errors
    /// If the child cannot be started, or its greeting cannot be used.
    pub fn start(options: ProcessOptions, hear: Hear) -> Result<Self, PlatformError> {
        Ok(Self { keeper: Keeper::start(options, hear)?, known: Mutex::default() })
    }

    /// What the child is and what it offers.
    #[must_use]
    pub fn world(&self) -> &World {
        self.keeper.world()
    }

    fn has(&self, offer: Offer) -> bool {
        self.world().has(offer)
    }

    fn known(&self, scene: &SceneId) -> Result<Arc<Known>, PlatformError> {
        if let Some(known) = self.known.lock().unwrap_or_else(PoisonError::into_inner).get(scene) {
            return Ok(Arc::clone(known));
        }
        // Asked without the lock, so that views of other scenes need not wait. If two threads ask for the same graph,
        // the first result counts.
        let graph = Arc::new(graph::of_scene(&self.keeper, scene)?);
        let made = Arc::new(Known { graph, objects: OnceLock::new() });
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(Arc::clone(known.entry(scene.clone()).or_insert(made)))
    }

    fn view(&self, scene: &SceneId, from: &Frame, gaze: Gaze, picture: bool) -> Result<View, PlatformError> {
        let eye = from.pose.position;
        if !eye.is_finite() || eye.abs().max_element() > MAX_COORDINATE_M {
            return Err(PlatformError::NotAViewpoint { scene: scene.clone() });
        }
        let gaze = flat(gaze);
        let picture = picture && self.has(Offer::Pictures);
        let pose = Pose::level(eye, gaze.heading);
        if !picture && !self.has(Offer::Labels) && !self.has(Offer::Rooms) {
            return Ok(View::new(pose, gaze.horizontal_fov_rad, None, None));
        }
        let (seen, file) =
            self.keeper.ask_and_take("observe", &self.look_request(scene, from, gaze, picture), |result, folder| {
                let mut seen: Observed = serde_path_to_error::deserialize(result).map_err(|error| error.to_string())?;
                let file = seen.image.take().filter(|_| picture).map(|sent| sent.bytes(folder)).transpose()?;
                Ok((seen, file))
            })?;
        let misfit = |reason: String| self.keeper.misfit("observe", reason);
        let size_px = self.size_px();
        if picture && file.is_none() {
            return Err(misfit("no `image`, although it offers pictures".into()));
        }
        let image: Option<Image> = file.map(|file| picture::decode(&file, size_px)).transpose().map_err(misfit)?;
        let truth = self.truth(seen, &pose, gaze).map_err(misfit)?;
        Ok(View::new(pose, gaze.horizontal_fov_rad, image.map(Arc::new), truth))
    }

    fn size_px(&self) -> (u32, u32) {
        let options = self.keeper.options();
        (options.width_px, options.height_px)
    }

    fn look_request(&self, scene: &SceneId, from: &Frame, gaze: Gaze, picture: bool) -> Value {
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

    fn truth(&self, seen: Observed, pose: &Pose, gaze: Gaze) -> Result<Option<GroundTruth>, String> {
        let lists_objects = self.has(Offer::Labels);
        if !lists_objects && !self.has(Offer::Rooms) {
            return Ok(None);
        }
        let labels = match seen.labels {
            Some(seen) if lists_objects => labels::of_view(seen, pose.position, gaze, self.size_px())?,
            None if lists_objects => return Err("no `labels`, although it offers them (send [] for none)".into()),
            _ => Vec::new(),
        };
        let room =
            seen.room.filter(|_| self.has(Offer::Rooms)).map(|room| protocol::name("`room`", &room)).transpose()?;
        Ok(Some(GroundTruth { labels, lists_objects, room }))
    }

    /// All objects that are seen from any viewpoint of the graph. The child is asked for every viewpoint, without a
    /// picture.
    fn objects<'a>(
        &self,
        scene: &SceneId,
        known: &'a Known,
    ) -> Result<&'a BTreeMap<ObjectId, Everywhere>, PlatformError> {
        if let Some(objects) = known.objects.get() {
            return Ok(objects);
        }
        let mut objects: BTreeMap<ObjectId, Everywhere> = BTreeMap::new();
        for viewpoint in known.graph.viewpoints() {
            for label in self.labels_at(scene, &known.graph, viewpoint)? {
                let object = objects.entry(label.object).or_default();
                object.name = label.name;
                object.visible_from.insert(viewpoint.clone());
            }
        }
        Ok(known.objects.get_or_init(|| objects))
    }

    fn labels_at(
        &self,
        scene: &SceneId,
        graph: &ViewpointGraph,
        viewpoint: &ViewpointId,
    ) -> Result<Vec<wayword_core::Label>, PlatformError> {
        if !self.has(Offer::Labels) {
            return Ok(Vec::new());
        }
        let pose = Pose::level(graph.position(viewpoint).unwrap_or_default(), Heading::NORTH);
        let frame = Frame { pose, viewpoint: Some(viewpoint.clone()), level: graph.level(viewpoint) };
        labels_around(self, scene, &frame)
    }
}

impl Platform for ProcessPlatform {
    fn name(&self) -> &'static str {
        "process"
    }

    fn scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        let Scenes { mut scenes } = self.keeper.ask("scenes", &json!({}))?;
        if scenes.len() > MAX_SCENES {
            return Err(self.keeper.misfit("scenes", format!("more than {MAX_SCENES} scenes")));
        }
        scenes.sort();
        scenes.dedup();
        Ok(scenes)
    }

    fn graph(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        Ok(Arc::clone(&self.known(scene)?.graph))
    }

    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        if self.has(Offer::SamplePath) {
            return path::drawn(&self.keeper, self, scene, request, seed);
        }
        let graph = self.graph(scene)?;
        graph_walk::path(scene, &graph, request, seed, |viewpoint| self.labels_at(scene, &graph, viewpoint))
    }

    fn look(&self, scene: &SceneId, from: &Frame, gaze: Gaze) -> Result<View, PlatformError> {
        self.view(scene, from, gaze, true)
    }

    fn look_without_picture(&self, scene: &SceneId, from: &Frame, gaze: Gaze) -> Result<View, PlatformError> {
        self.view(scene, from, gaze, false)
    }

    fn object_name(&self, scene: &SceneId, near: &Frame, object: &ObjectId) -> Result<Option<String>, PlatformError> {
        if self.has(Offer::ObjectName) {
            let Name { name } = self.keeper.ask("object_name", &json!({ "scene": scene, "object": object }))?;
            let name = name.map(|name| protocol::name("`name`", &name)).transpose();
            return name.map_err(|reason| self.keeper.misfit("object_name", reason));
        }
        if !self.has(Offer::Labels) {
            return Ok(None);
        }
        let here = labels_around(self, scene, near)?.into_iter().find(|label| label.object == *object);
        if let Some(label) = here {
            return Ok(Some(label.name));
        }
        let known = self.known(scene)?;
        Ok(self.objects(scene, &known)?.get(object).map(|object| object.name.clone()))
    }

    /// The viewpoints that the child names, or else those from which its labels show the object.
    fn visible_from(&self, scene: &SceneId, object: &ObjectId) -> Result<Option<BTreeSet<ViewpointId>>, PlatformError> {
        if self.has(Offer::VisibleFrom) {
            let asked = json!({ "scene": scene, "object": object });
            let Viewpoints { viewpoints } = self.keeper.ask("visible_from", &asked)?;
            return Ok(viewpoints);
        }
        if !self.has(Offer::Labels) {
            return Ok(None);
        }
        let known = self.known(scene)?;
        Ok(Some(self.objects(scene, &known)?.get(object).map(|object| object.visible_from.clone()).unwrap_or_default()))
    }
}
