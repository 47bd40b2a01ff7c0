//! Offers Matterport3D as a [`Platform`].

use super::{
    boxes::{self, Listed},
    house_file::HouseObject,
    labels,
    layout::Layout,
    object_positions::{self, ObjectPositions},
    photographs::Photographs,
    scene::{Everywhere, Scene},
};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path as FilePath, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};
use wayword_core::{
    Frame, Gaze, GroundTruth, Image, Label, ObjectId, Path, PathRequest, Placed, Platform, PlatformError, Pose, Recent,
    SceneId, View, ViewpointGraph, ViewpointId,
};
use wayword_world::{connectivity::Viewpoint, graph_walk};

/// Number of viewpoints with their boxes in memory.
const BOXES_KEPT: usize = 256;
/// Number of viewpoints with their photographs in memory: 5 MB each for small skyboxes, 19 for full ones, 33 for 36
/// views.
const PHOTOGRAPHS_KEPT: usize = 8;

/// Matterport3D's buildings, from the files that the user has.
///
/// If there are photographs, pictures have 640x480 square pixels and the requested horizontal field of view: a quarter
/// of a panorama is 73.7 degrees high. Labels have exact directions but no boxes, because REVERIE's boxes belong to
/// other views.
pub struct Matterport {
    layout: Layout,
    centres: ObjectPositions,
    scenes: Mutex<BTreeMap<SceneId, Arc<Scene>>>,
    boxes: Recent<(SceneId, ViewpointId), Option<Vec<Listed>>>,
    photographs: Recent<(SceneId, ViewpointId), Option<Photographs>>,
}

impl Matterport {
    /// Finds the data below a folder. `connectivity` is needed; rooms, `.house` files, REVERIE's boxes and object
    /// centres, and photographs are used if they are there.
    ///
    /// # Errors
    /// If there are no connectivity graphs, or the object centres cannot be read.
    pub fn open(data: &FilePath) -> Result<Self, PlatformError> {
        let layout = Layout::find(data)?;
        let centres = layout.object_positions.as_deref().map(object_positions::read).transpose()?.unwrap_or_default();
        Ok(Self {
            layout,
            centres,
            scenes: Mutex::default(),
            boxes: Recent::new(BOXES_KEPT),
            photographs: Recent::new(PHOTOGRAPHS_KEPT),
        })
    }

    /// A warning that names the files about objects that are missing below a folder, with advice; `None` if none are missing,
    /// or if the folder contains no buildings.
    #[must_use]
    pub fn lack_of_objects(data: &FilePath) -> Option<String> {
        Layout::find(data).ok()?.lack_of_objects(data)
    }

    fn scene(&self, scene: &SceneId) -> Result<Arc<Scene>, PlatformError> {
        if let Some(loaded) = self.scenes.lock().unwrap_or_else(PoisonError::into_inner).get(scene) {
            return Ok(Arc::clone(loaded));
        }
        // Loaded without the lock, so that other buildings need not wait. If two threads load the same one, the first
        // result counts.
        let loaded = Arc::new(Scene::load(&self.layout, scene)?);
        let mut scenes = self.scenes.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(Arc::clone(scenes.entry(scene.clone()).or_insert(loaded)))
    }

    fn listed(&self, scene: &SceneId, viewpoint: &ViewpointId) -> Result<Arc<Option<Vec<Listed>>>, PlatformError> {
        self.boxes.get_or_make((scene.clone(), viewpoint.clone()), || {
            let file = self.layout.boxes(scene, viewpoint);
            file.map(|file| boxes::read(&file, viewpoint)).transpose().map(Option::flatten)
        })
    }

    /// All objects that are visible from a viewpoint, or `None` if there is no data about its objects.
    fn labels(
        &self,
        id: &SceneId,
        scene: &Scene,
        viewpoint: &ViewpointId,
    ) -> Result<Option<Vec<Label>>, PlatformError> {
        let eye = known(id, scene, viewpoint)?.position;
        let nowhere = BTreeMap::new();
        let centres = self.centres.get(id.as_str()).unwrap_or(&nowhere);
        if let Some(listed) = self.listed(id, viewpoint)?.as_ref() {
            return Ok(Some(labels::from_boxes(listed, eye, centres)));
        }
        let house = scene.house.as_ref().filter(|house| !house.objects.is_empty());
        Ok(house.map(|house| labels::from_house(house, viewpoint, eye)))
    }

    /// The picture along a gaze, if there are photographs and the gaze fits a flat picture.
    fn image(&self, id: &SceneId, viewpoint: &Viewpoint, gaze: Gaze) -> Result<Option<Arc<Image>>, PlatformError> {
        let photographs = self
            .photographs
            .get_or_make((id.clone(), viewpoint.id.clone()), || Photographs::read(&self.layout, id, viewpoint))?;
        Ok(photographs.as_ref().as_ref().and_then(|photographs| photographs.view(gaze)).map(Arc::new))
    }

    /// All objects that are listed anywhere in a building. The viewpoints' files are read one after another and not
    /// kept.
    fn objects<'a>(&self, id: &SceneId, scene: &'a Scene) -> Result<&'a BTreeMap<ObjectId, Everywhere>, PlatformError> {
        if let Some(objects) = scene.objects.get() {
            return Ok(objects);
        }
        let mut objects: BTreeMap<ObjectId, Everywhere> = BTreeMap::new();
        for viewpoint in scene.viewpoints.keys() {
            let Some(file) = self.layout.boxes(id, viewpoint) else { break };
            for entry in boxes::read(&file, viewpoint)?.into_iter().flatten() {
                let object = objects.entry(entry.object).or_default();
                object.name = object.name.take().or(entry.name);
                if !entry.boxes.is_empty() {
                    object.visible_from.insert(viewpoint.clone());
                }
            }
        }
        Ok(scene.objects.get_or_init(|| objects))
    }
}

/// The viewpoint of this name; an error if the building has none.
fn known<'a>(id: &SceneId, scene: &'a Scene, viewpoint: &ViewpointId) -> Result<&'a Viewpoint, PlatformError> {
    let found = scene.viewpoints.get(viewpoint);
    found.ok_or_else(|| PlatformError::UnknownViewpoint { scene: id.clone(), viewpoint: viewpoint.clone() })
}

fn viewpoint_of<'a>(id: &SceneId, frame: &'a Frame) -> Result<&'a ViewpointId, PlatformError> {
    frame.viewpoint.as_ref().ok_or_else(|| PlatformError::NotAViewpoint { scene: id.clone() })
}

impl Platform for Matterport {
    fn name(&self) -> &'static str {
        "matterport"
    }

    fn scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        self.layout.scenes()
    }

    fn graph(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        Ok(Arc::clone(&self.scene(scene)?.graph))
    }

    fn sample_path(&self, id: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        let scene = self.scene(id)?;
        graph_walk::path(id, &scene.graph, request, seed, |viewpoint| {
            Ok(self.labels(id, &scene, viewpoint)?.unwrap_or_default())
        })
    }

    fn look(&self, id: &SceneId, from: &Frame, gaze: Gaze) -> Result<View, PlatformError> {
        let mut view = self.look_without_picture(id, from, gaze)?;
        let scene = self.scene(id)?;
        view.image = self.image(id, known(id, &scene, viewpoint_of(id, from)?)?, gaze)?;
        Ok(view)
    }

    fn look_without_picture(&self, id: &SceneId, from: &Frame, gaze: Gaze) -> Result<View, PlatformError> {
        let scene = self.scene(id)?;
        let viewpoint = viewpoint_of(id, from)?;
        let here = known(id, &scene, viewpoint)?;
        let labels = self.labels(id, &scene, viewpoint)?;
        let truth = (labels.is_some() || scene.knows_rooms()).then(|| GroundTruth {
            lists_objects: labels.is_some(),
            labels: labels.into_iter().flatten().filter(|label| gaze.holds(label.heading)).collect(),
            room: scene.room(viewpoint).map(str::to_owned),
        });
        Ok(View::new(Pose::level(here.position, gaze.heading), gaze.horizontal_fov_rad, None, truth))
    }

    fn object_name(&self, id: &SceneId, near: &Frame, object: &ObjectId) -> Result<Option<String>, PlatformError> {
        let scene = self.scene(id)?;
        if let Some(viewpoint) = &near.viewpoint {
            known(id, &scene, viewpoint)?;
            let here = self.listed(id, viewpoint)?;
            let entry = here.iter().flatten().find(|entry| entry.object == *object);
            if let Some(name) = entry.and_then(|entry| entry.name.clone()) {
                return Ok(Some(name));
            }
        }
        let in_house = scene.house.as_ref().and_then(|house| house.objects.iter().find(|other| other.id == *object));
        if let Some(name) = in_house.and_then(|found| found.name.clone()) {
            return Ok(Some(name));
        }
        Ok(self.objects(id, &scene)?.get(object).and_then(|object| object.name.clone()))
    }

    /// From the viewpoints where REVERIE's boxes show it, as in REVERIE's evaluator; without boxes, from those where
    /// the `.house` file's labels list it.
    fn listed_objects(&self, id: &SceneId) -> Result<Vec<Placed>, PlatformError> {
        let scene = self.scene(id)?;
        let objects = self.objects(id, &scene)?;
        if objects.is_empty() {
            let placed = |object: &HouseObject| {
                Some(Placed { object: object.id.clone(), name: object.name.clone()?, position: object.centre })
            };
            return Ok(scene.house.iter().flat_map(|house| &house.objects).filter_map(placed).collect());
        }
        let Some(centres) = self.centres.get(id.as_str()) else { return Ok(Vec::new()) };
        let placed = |(object, everywhere): (&ObjectId, &Everywhere)| {
            let position = *centres.get(object.as_str())?;
            Some(Placed { object: object.clone(), name: everywhere.name.clone()?, position })
        };
        Ok(objects.iter().filter_map(placed).collect())
    }

    fn visible_from(&self, id: &SceneId, object: &ObjectId) -> Result<Option<BTreeSet<ViewpointId>>, PlatformError> {
        let scene = self.scene(id)?;
        let objects = self.objects(id, &scene)?;
        if !objects.is_empty() {
            return Ok(Some(objects.get(object).map(|object| object.visible_from.clone()).unwrap_or_default()));
        }
        let Some(house) = scene.house.as_ref().filter(|house| !house.objects.is_empty()) else { return Ok(None) };
        let sees = |(name, viewpoint): &(&ViewpointId, &Viewpoint)| {
            labels::from_house(house, name, viewpoint.position).iter().any(|label| label.object == *object)
        };
        Ok(Some(scene.viewpoints.iter().filter(sees).map(|(name, _)| name.clone()).collect()))
    }

    /// False: labels are listed only up to two or three metres from a viewpoint.
    fn lists_everything(&self) -> bool {
        false
    }

    fn files(&self, id: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        Ok(self.layout.files(id, self.scene(id)?.viewpoints.keys()))
    }
}
