//! One building of Matterport3D in memory: its graph, cameras, rooms and objects.

use super::{
    file_reading,
    house_file::{self, MatterportHouseFile},
    layout::MatterportLayout,
    rooms,
};
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{Arc, OnceLock},
};
use wayword_core::{ObjectId, PlatformError, SceneId, ViewpointGraph, ViewpointId};
use wayword_world::{
    connectivity::{self, PanoramaViewpoint},
    region_letters,
};

const GRAPH_HINT: &str = "copy the file again from Matterport3DSimulator's folder `connectivity`";

/// A building.
pub(crate) struct MatterportScene {
    pub(crate) graph: Arc<ViewpointGraph>,
    pub(crate) viewpoints: BTreeMap<ViewpointId, PanoramaViewpoint>,
    pub(crate) house: Option<MatterportHouseFile>,
    rooms: Option<rooms::RoomLetters>,
    /// All objects that REVERIE lists anywhere in the building; read when first needed.
    pub(crate) objects: OnceLock<BTreeMap<ObjectId, ObjectListing>>,
}

/// One object, collected from REVERIE's lists at all viewpoints of a building.
#[derive(Debug, Default)]
pub(crate) struct ObjectListing {
    /// In plain words; `None` if the annotators' name has no plain words.
    pub(crate) name: Option<String>,
    /// The viewpoints that list it with a box.
    pub(crate) visible_from: BTreeSet<ViewpointId>,
}

impl MatterportScene {
    /// Reads a building's graph, rooms and `.house` file.
    ///
    /// # Errors
    /// If it does not exist, or one of its files is broken.
    pub(crate) fn load_scene(layout: &MatterportLayout, scene: &SceneId) -> Result<Self, PlatformError> {
        let file = layout.connectivity_file(scene);
        let read = connectivity::read_connectivity_file(&file, GRAPH_HINT)?.ok_or_else(|| PlatformError::UnknownScene {
            scene: scene.to_string(),
            hint: format!(
                "{} does not exist; copy it from Matterport3DSimulator's folder `connectivity`, or leave the items of this scene out",
                file.display()
            ),
        })?;
        let house =
            layout.house_segmentation_file(scene).map(|file| house_file::read_house_file(&file)).transpose()?.flatten();
        let rooms = layout.rooms_file(scene).map(|file| rooms::read_rooms(&file)).transpose()?.flatten();
        let level = |viewpoint: &ViewpointId| house.as_ref().and_then(|house| house.storey_of_viewpoint(viewpoint));
        let graph = read
            .to_viewpoint_graph(level)
            .map_err(|error| file_reading::file_error(&file, error.to_string(), GRAPH_HINT))?;
        let viewpoints = read.viewpoints.into_iter().map(|viewpoint| (viewpoint.id.clone(), viewpoint)).collect();
        Ok(Self { graph: Arc::new(graph), viewpoints, house, rooms, objects: OnceLock::new() })
    }

    /// Whether there is a file that gives the rooms.
    pub(crate) fn knows_rooms(&self) -> bool {
        self.rooms.is_some() || self.house.is_some()
    }

    /// The room of a viewpoint, as a person would call it.
    pub(crate) fn room_name(&self, viewpoint: &ViewpointId) -> Option<&'static str> {
        let listed = self.rooms.as_ref().and_then(|rooms| rooms.get(viewpoint)).copied();
        let letter = listed.or_else(|| self.house.as_ref()?.room_letter(viewpoint))?;
        region_letters::room_for_letter(letter)
    }
}
