//! The episode that every format's reader returns: a path and its instructions. Fields that were read keep their
//! spelling, so that an unchanged episode is written as it was.

use crate::item;
use serde_json::{Map, Value};
use wayword_core::{DVec3, Heading, ObjectId, Path, SceneId, ViewpointId};

/// An episode of a dataset, whatever its format.
#[derive(Debug, Clone, PartialEq)]
pub struct Episode {
    /// Its name, unique in its file: REVERIE's `id`, R2R's `path_id`, RxR's `instruction_id`, VLN-CE's `episode_id`.
    pub id: String,
    /// Name of its path, which several items may share: `path_id`, VLN-CE's `trajectory_id`.
    pub path_id: String,
    /// The scene that its path lies in.
    pub scene: SceneId,
    /// Nodes of the viewpoint graph, from start to goal. Empty where the path has none (VLN-CE, continuous platforms).
    pub viewpoints: Vec<ViewpointId>,
    /// Positions on the floor (not the eye's), world frame, metres, from start to goal. Only VLN-CE has them; empty
    /// elsewhere.
    pub floor_positions: Vec<DVec3>,
    /// Whether its path is all of a recording, which the scene names. The platform knows its places, and the file none.
    pub is_whole_recording: bool,
    /// What Habitat needs to know of the scene and the distance. Only VLN-CE's writer uses it.
    pub in_habitat: InHabitat,
    /// Which way the agent looks before the first hop. `None` where the file does not give it.
    pub start_heading: Option<Heading>,
    /// The object of the closing task, where the item has one (REVERIE).
    pub target_object: Option<ObjectId>,
    /// The part of the dataset that it belongs to ("train", "val_seen"), where the item itself names it.
    pub split: Option<String>,
    /// The path's instructions; empty where it has none yet.
    pub instructions: Vec<String>,
    /// The language of each instruction that was read, as its file tags it: "en-IN", "hi-IN" (RxR; VLN-CE where its
    /// episodes come from RxR). Empty where the file tags none.
    pub languages: Vec<String>,
    /// The ids of each instruction's tokens, for agents that load them: written as `instr_encodings` (RxR:
    /// `instr_encoding`). Empty where there are none; ids that were read from a file are in [`Self::extra`].
    pub encodings: Vec<Vec<u32>>,
    /// Fields that the format does not name, in the order of the file. Written back where the loaders accept them (R2R,
    /// REVERIE, RxR).
    pub extra: Map<String, Value>,
    /// Known fields as the file spelt them. An unchanged field is written as it was read (a heading of 7.0, an id in
    /// quotes).
    pub(crate) as_read: Map<String, Value>,
}

/// Facts about an item that Habitat needs and only the platform knows. Every field has a default.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct InHabitat {
    /// VLN-CE's `scene_id`: the scene's file below the folder of scenes. `mp3d/SCENE/SCENE.glb` where it is `None`.
    pub scene_id: Option<String>,
    /// Files that the user has to put there first, in words, where the scene is not a dataset's file.
    pub scene_needs: Option<String>,
    /// Shortest distance on foot from start to goal over the scene's navmesh, metres.
    pub geodesic_m: Option<f64>,
}

impl Episode {
    /// An episode without a path.
    #[must_use]
    pub fn new(id: impl Into<String>, path_id: impl Into<String>, scene: SceneId) -> Self {
        Self {
            id: id.into(),
            path_id: path_id.into(),
            scene,
            viewpoints: Vec::new(),
            floor_positions: Vec::new(),
            is_whole_recording: false,
            in_habitat: InHabitat::default(),
            start_heading: None,
            target_object: None,
            split: None,
            instructions: Vec::new(),
            languages: Vec::new(),
            encodings: Vec::new(),
            extra: Map::new(),
            as_read: Map::new(),
        }
    }

    /// The episode of all of a recording, with the texts about it.
    pub(crate) fn for_recording(scene: SceneId, instructions: Vec<String>) -> Self {
        let name = scene.as_str().to_owned();
        Self { is_whole_recording: true, instructions, ..Self::new(name.clone(), name, scene) }
    }

    /// The episode of a path, with the path's name. It has viewpoints where each frame has one. Where the motion is
    /// unknown, it has neither viewpoints (the frames' names are those of pictures) nor a heading.
    #[must_use]
    pub fn from_path(path: &Path, instructions: Vec<String>) -> Self {
        let frames = if path.motion.is_known() { path.frames.as_slice() } else { &[] };
        let viewpoints = frames.iter().map(|frame| frame.viewpoint.clone()).collect::<Option<Vec<_>>>();
        Self {
            viewpoints: viewpoints.unwrap_or_default(),
            start_heading: frames.first().map(|frame| frame.pose.heading),
            target_object: path.target.as_ref().map(|target| target.object.clone()),
            instructions,
            ..Self::new(path.id.clone(), path.id.clone(), path.scene.clone())
        }
    }

    /// Whether its path has two different places. If not, its way is not known: a test split gives the start alone.
    #[must_use]
    pub fn goes_anywhere(&self) -> bool {
        let Self { viewpoints, floor_positions, .. } = self;
        self.is_whole_recording
            || viewpoints.iter().any(|other| viewpoints.first() != Some(other))
            || floor_positions.iter().any(|other| floor_positions.first() != Some(other))
    }

    /// The tag of an instruction's language, where the file gives one.
    #[must_use]
    pub fn language_of(&self, instruction: usize) -> Option<&str> {
        self.languages.get(instruction).map(String::as_str)
    }

    /// The item with positions on the floor, which VLN-CE needs. The floor lies `eye_height_m` below the eyes of the
    /// path's frames (a camera's height over the floor: about 1.5 m in Matterport3D). A path with unknown motion has
    /// none.
    #[must_use]
    pub fn with_floor_positions(mut self, path: &Path, eye_height_m: f64) -> Self {
        let frames = path.frames.iter().filter(|_| path.motion.is_known());
        self.floor_positions = frames.map(|frame| frame.pose.position - DVec3::Z * eye_height_m).collect();
        self
    }

    /// Length over the floor positions, metres; `None` where they are not known.
    #[must_use]
    pub fn floor_length_m(&self) -> Option<f64> {
        let hops = self.floor_positions.array_windows().map(|[from, to]| from.distance(*to));
        (!self.floor_positions.is_empty()).then(|| hops.sum())
    }

    /// The value to write for a known field: the one that was read where it still means the same, else a new one.
    pub(crate) fn field_value(
        &self,
        key: &str,
        still_means: impl Fn(&Value) -> bool,
        anew: impl FnOnce() -> Value,
    ) -> Value {
        self.as_read.get(key).filter(|value| still_means(value)).cloned().unwrap_or_else(anew)
    }

    /// A field that holds a name.
    pub(crate) fn name_field(&self, key: &str, name: &str) -> Value {
        self.field_value(key, |value| item::name_of(value).as_deref() == Some(name), || item::value_of(name))
    }

    /// The heading in radians; 0 where the item has none, because every loader needs one.
    pub(crate) fn heading_field(&self) -> Value {
        let heading = self.start_heading.unwrap_or(Heading::NORTH);
        let same = |value: &Value| value.as_f64().and_then(|rad| Heading::new(rad).ok()) == Some(heading);
        self.field_value("heading", same, || heading.rad().into())
    }

    /// Keeps a known field's spelling.
    pub(crate) fn remember_spelling(&mut self, key: &str, value: Value) {
        self.as_read.insert(key.to_owned(), value);
    }
}
