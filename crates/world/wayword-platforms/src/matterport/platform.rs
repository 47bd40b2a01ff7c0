//! Offers Matterport3D as a [`Platform`].

use super::{
    boxes::{self, ListedObject},
    house_file::HouseObject,
    labels,
    layout::MatterportLayout,
    object_positions::{self, ObjectPositions},
    photographs::ViewpointPhotographs,
    scene::{MatterportScene, ObjectListing},
};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path as FilePath, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};
use wayword_core::{
    Frame, GroundTruth, Image, ObjectId, ObjectLabel, Path, PathRequest, PlacedObject, Platform, PlatformError, Pose,
    RecentCache, SceneCatalogue, SceneFiles, SceneId, View, ViewGaze, ViewpointGraph, ViewpointId,
};
use wayword_world::{
    connectivity::{self, PanoramaViewpoint},
    graph_walk,
};

/// Number of viewpoints with their boxes in memory.
const MAX_VIEWPOINTS_WITH_BOXES: usize = 256;
/// Number of viewpoints with their photographs in memory: 5 MB each for small skyboxes, 19 for full ones, 33 for 36
/// views.
const MAX_VIEWPOINTS_WITH_PHOTOGRAPHS: usize = 8;

/// Matterport3D's buildings, from the files that the user has.
///
/// If there are photographs, pictures have 640x480 square pixels and the requested horizontal field of view: a quarter
/// of a panorama is 73.7 degrees high. Labels have exact directions but no boxes, because REVERIE's boxes belong to
/// other views.
pub struct MatterportPlatform {
    layout: MatterportLayout,
    /// The centres of objects, from REVERIE's file.
    centres: ObjectPositions,
    scenes: Mutex<BTreeMap<SceneId, Arc<MatterportScene>>>,
    boxes: RecentCache<(SceneId, ViewpointId), Option<Vec<ListedObject>>>,
    photographs: RecentCache<(SceneId, ViewpointId), Option<ViewpointPhotographs>>,
}

impl MatterportPlatform {
    /// Finds the data below a folder. `connectivity` is needed; rooms, `.house` files, REVERIE's boxes and object
    /// centres, and photographs are used if they are there.
    ///
    /// # Errors
    /// If there are no connectivity graphs, or the object centres cannot be read.
    pub fn open(data: &FilePath) -> Result<Self, PlatformError> {
        let layout = MatterportLayout::find_data(data)?;
        let centres = layout
            .object_positions
            .as_deref()
            .map(object_positions::read_object_positions)
            .transpose()?
            .unwrap_or_default();
        Ok(Self {
            layout,
            centres,
            scenes: Mutex::default(),
            boxes: RecentCache::new(MAX_VIEWPOINTS_WITH_BOXES),
            photographs: RecentCache::new(MAX_VIEWPOINTS_WITH_PHOTOGRAPHS),
        })
    }

    /// A warning that names the files about objects that are missing below a folder, with advice; `None` if none are missing,
    /// or if the folder contains no buildings.
    #[must_use]
    pub fn lack_of_objects(data: &FilePath) -> Option<String> {
        MatterportLayout::find_data(data).ok()?.lack_of_objects(data)
    }

    /// The edges in one direction of all graphs below a folder, in a line for the user; `None` if there are none.
    #[must_use]
    pub fn one_way_edges(data: &FilePath) -> Option<String> {
        connectivity::describe_one_way_edges(MatterportLayout::find_data(data).ok()?.connectivity_folder())
    }

    /// The scene, which is read from its files on first use.
    fn loaded_scene(&self, scene: &SceneId) -> Result<Arc<MatterportScene>, PlatformError> {
        if let Some(loaded) = self.scenes.lock().unwrap_or_else(PoisonError::into_inner).get(scene) {
            return Ok(Arc::clone(loaded));
        }
        // Loaded without the lock, so that other buildings need not wait. If two threads load the same one, the first
        // result counts.
        let loaded = Arc::new(MatterportScene::load_scene(&self.layout, scene)?);
        let mut scenes = self.scenes.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(Arc::clone(scenes.entry(scene.clone()).or_insert(loaded)))
    }

    /// The objects that REVERIE lists at a viewpoint; `None` if there is no file for it.
    fn objects_listed_at(
        &self,
        scene: &SceneId,
        viewpoint: &ViewpointId,
    ) -> Result<Arc<Option<Vec<ListedObject>>>, PlatformError> {
        self.boxes.get_or_make((scene.clone(), viewpoint.clone()), || {
            let file = self.layout.boxes_file(scene, viewpoint);
            file.map(|file| boxes::read_boxes(&file, viewpoint)).transpose().map(Option::flatten)
        })
    }

    /// All objects that are visible from a viewpoint, or `None` if there is no data about its objects.
    fn labels_from(
        &self,
        id: &SceneId,
        scene: &MatterportScene,
        viewpoint: &ViewpointId,
    ) -> Result<Option<Vec<ObjectLabel>>, PlatformError> {
        let eye = known_viewpoint(id, scene, viewpoint)?.position;
        let no_centres = BTreeMap::new();
        let centres = self.centres.get(id.as_str()).unwrap_or(&no_centres);
        if let Some(listed) = self.objects_listed_at(id, viewpoint)?.as_ref() {
            return Ok(Some(labels::from_boxes(listed, eye, centres)));
        }
        let house = scene.house.as_ref().filter(|house| !house.objects.is_empty());
        Ok(house.map(|house| labels::from_house(house, viewpoint, eye)))
    }

    /// The picture along a gaze, if there are photographs and the gaze fits a flat picture.
    fn image_along(
        &self,
        id: &SceneId,
        viewpoint: &PanoramaViewpoint,
        gaze: ViewGaze,
    ) -> Result<Option<Arc<Image>>, PlatformError> {
        let photographs = self.photographs.get_or_make((id.clone(), viewpoint.id.clone()), || {
            ViewpointPhotographs::read_photographs(&self.layout, id, viewpoint)
        })?;
        Ok(photographs.as_ref().as_ref().and_then(|photographs| photographs.view_along(gaze)).map(Arc::new))
    }

    /// All objects that are listed anywhere in a building. The viewpoints' files are read one after another and not
    /// kept.
    fn objects_of_scene<'a>(
        &self,
        id: &SceneId,
        scene: &'a MatterportScene,
    ) -> Result<&'a BTreeMap<ObjectId, ObjectListing>, PlatformError> {
        if let Some(objects) = scene.objects.get() {
            return Ok(objects);
        }
        let mut objects: BTreeMap<ObjectId, ObjectListing> = BTreeMap::new();
        for viewpoint in scene.viewpoints.keys() {
            let Some(file) = self.layout.boxes_file(id, viewpoint) else { break };
            for entry in boxes::read_boxes(&file, viewpoint)?.into_iter().flatten() {
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
fn known_viewpoint<'a>(
    id: &SceneId,
    scene: &'a MatterportScene,
    viewpoint: &ViewpointId,
) -> Result<&'a PanoramaViewpoint, PlatformError> {
    let found = scene.viewpoints.get(viewpoint);
    found.ok_or_else(|| PlatformError::UnknownViewpoint { scene: id.clone(), viewpoint: viewpoint.clone() })
}

/// The viewpoint of a frame; an error if the frame is at none, because views exist only at viewpoints.
fn required_viewpoint<'a>(id: &SceneId, frame: &'a Frame) -> Result<&'a ViewpointId, PlatformError> {
    frame.viewpoint.as_ref().ok_or_else(|| PlatformError::NotAViewpoint { scene: id.clone() })
}

impl Platform for MatterportPlatform {
    fn name(&self) -> &'static str {
        "matterport"
    }

    fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        self.layout.list_scenes()
    }

    fn graph_for_scene(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        Ok(Arc::clone(&self.loaded_scene(scene)?.graph))
    }

    fn sample_path(&self, id: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        let scene = self.loaded_scene(id)?;
        graph_walk::sample_graph_path(id, &scene.graph, request, seed, |viewpoint| {
            Ok(self.labels_from(id, &scene, viewpoint)?.unwrap_or_default())
        })
    }

    fn look_from(&self, id: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        let mut view = self.look_without_picture(id, from, gaze)?;
        let scene = self.loaded_scene(id)?;
        view.image = self.image_along(id, known_viewpoint(id, &scene, required_viewpoint(id, from)?)?, gaze)?;
        Ok(view)
    }

    fn look_without_picture(&self, id: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        let scene = self.loaded_scene(id)?;
        let viewpoint = required_viewpoint(id, from)?;
        let here = known_viewpoint(id, &scene, viewpoint)?;
        let labels = self.labels_from(id, &scene, viewpoint)?;
        let truth = (labels.is_some() || scene.knows_rooms()).then(|| GroundTruth {
            lists_objects: labels.is_some(),
            labels: labels.into_iter().flatten().filter(|label| gaze.holds_heading(label.heading)).collect(),
            room: scene.room_name(viewpoint).map(str::to_owned),
        });
        Ok(View::new(Pose::looking_level(here.position, gaze.heading), gaze.horizontal_fov_rad, None, truth))
    }

    fn catalogue(&self) -> &dyn SceneCatalogue {
        self
    }

    fn files(&self) -> &dyn SceneFiles {
        self
    }
}

impl SceneCatalogue for MatterportPlatform {
    fn object_name(&self, id: &SceneId, near: &Frame, object: &ObjectId) -> Result<Option<String>, PlatformError> {
        let scene = self.loaded_scene(id)?;
        if let Some(viewpoint) = &near.viewpoint {
            known_viewpoint(id, &scene, viewpoint)?;
            let here = self.objects_listed_at(id, viewpoint)?;
            let entry = here.iter().flatten().find(|entry| entry.object == *object);
            if let Some(name) = entry.and_then(|entry| entry.name.clone()) {
                return Ok(Some(name));
            }
        }
        let in_house = scene.house.as_ref().and_then(|house| house.objects.iter().find(|other| other.id == *object));
        if let Some(name) = in_house.and_then(|found| found.name.clone()) {
            return Ok(Some(name));
        }
        Ok(self.objects_of_scene(id, &scene)?.get(object).and_then(|object| object.name.clone()))
    }

    fn listed_objects(&self, id: &SceneId) -> Result<Vec<PlacedObject>, PlatformError> {
        let scene = self.loaded_scene(id)?;
        let objects = self.objects_of_scene(id, &scene)?;
        if objects.is_empty() {
            let placed = |object: &HouseObject| {
                Some(PlacedObject { object: object.id.clone(), name: object.name.clone()?, position: object.centre })
            };
            return Ok(scene.house.iter().flat_map(|house| &house.objects).filter_map(placed).collect());
        }
        let Some(centres) = self.centres.get(id.as_str()) else { return Ok(Vec::new()) };
        let placed = |(object, listing): (&ObjectId, &ObjectListing)| {
            let position = *centres.get(object.as_str())?;
            Some(PlacedObject { object: object.clone(), name: listing.name.clone()?, position })
        };
        Ok(objects.iter().filter_map(placed).collect())
    }

    /// From the viewpoints where REVERIE's boxes show it, as in REVERIE's evaluator; without boxes, from those where
    /// the `.house` file's labels list it.
    fn visible_from(&self, id: &SceneId, object: &ObjectId) -> Result<Option<BTreeSet<ViewpointId>>, PlatformError> {
        let scene = self.loaded_scene(id)?;
        let objects = self.objects_of_scene(id, &scene)?;
        if !objects.is_empty() {
            return Ok(Some(objects.get(object).map(|object| object.visible_from.clone()).unwrap_or_default()));
        }
        let Some(house) = scene.house.as_ref().filter(|house| !house.objects.is_empty()) else { return Ok(None) };
        let sees = |(name, viewpoint): &(&ViewpointId, &PanoramaViewpoint)| {
            labels::from_house(house, name, viewpoint.position).iter().any(|label| label.object == *object)
        };
        Ok(Some(scene.viewpoints.iter().filter(sees).map(|(name, _)| name.clone()).collect()))
    }

    /// False: labels are listed only up to two or three metres from a viewpoint.
    fn lists_everything(&self) -> bool {
        false
    }
}

impl SceneFiles for MatterportPlatform {
    fn source_files(&self, id: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        Ok(self.layout.files_of_scene(id, self.loaded_scene(id)?.viewpoints.keys()))
    }
}
