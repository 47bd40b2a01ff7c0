//! Generates the house of a seed, and prepares it for use: its scene for drawing, its walkable ground and its viewpoint
//! graph.

use super::{
    furnish::furnish_house,
    graph::{EYE_M, graph_over_places},
    ground::HouseGround,
    labels::{LABELS_SIZE_PX, visible_labels},
    layout::{HouseLayout, lay_out},
    model::{House, WallOpening},
    names::{old_seed_of, scene_name, seed_of},
    scene::HouseScene,
    standing_places::standing_places,
};
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{Arc, OnceLock},
};
use wayword_core::{
    DVec3, DepthImage, Frame, GroundTruth, Heading, Image, ObjectId, ObjectLabel, PlatformError, Pose, SceneId, View,
    ViewGaze, ViewpointGraph, ViewpointId,
};
use wayword_render::PinholeCamera;
use wayword_world::seen_from;

/// An eye in an opening is at most this far from the middle line of the wall, centimetres.
const THRESHOLD_CM: i32 = 25;

/// A standing place is at most so far from a viewpoint over the ground, metres.
const TO_VIEWPOINT_M: f64 = 2.0;

/// Generates the house of a seed. It is the same on every machine.
#[must_use]
pub fn generate_house(seed: u64) -> House {
    let layout = lay_out(seed);
    let furniture = furnish_house(seed, &layout);
    let HouseLayout { storeys, rooms, openings, windows, stairs, .. } = layout;
    House { seed, storeys, rooms, openings, windows, stairs, furniture }
}

/// A house with its scene, its ground and its viewpoint graph.
#[derive(Debug)]
pub(super) struct PreparedHouse {
    pub(super) id: SceneId,
    pub(super) scene: HouseScene,
    pub(super) ground: HouseGround,
    pub(super) graph: Arc<ViewpointGraph>,
    /// The places on the ground at which paths begin and end. A viewpoint is at most about a metre away from each.
    pub(super) standing_places: Vec<DVec3>,
    /// The viewpoints from which each object is seen; computed on first use.
    seen_from: OnceLock<BTreeMap<ObjectId, BTreeSet<ViewpointId>>>,
    /// The largest distance between two viewpoints; computed on first use.
    longest_m: OnceLock<f64>,
}

impl PreparedHouse {
    /// Builds the house that a scene names.
    pub(super) fn for_scene(scene: &SceneId) -> Result<Self, PlatformError> {
        let house = generate_house(seed_of(scene.as_str()).ok_or_else(|| unknown_scene_error(scene.as_str()))?);
        let ground = HouseGround::for_house(&house);
        let places = standing_places(&house, &ground);
        let graph = graph_over_places(&house, &ground, &places)
            .map_err(|source| PlatformError::Graph { scene: scene.clone(), source })?;
        let drawn = HouseScene::new(house)
            .map_err(|error| PlatformError::NotDrawn { scene: scene.clone(), reason: error.to_string() })?;
        Ok(Self {
            id: scene.clone(),
            scene: drawn,
            ground,
            graph: Arc::new(graph),
            standing_places: places.into_iter().map(|(_, place)| place).collect(),
            seen_from: OnceLock::new(),
            longest_m: OnceLock::new(),
        })
    }

    /// The view from a pose, as it fills a picture of this size in pixels; with the picture if `pictured`.
    pub(super) fn view_from(
        &self,
        pose: Pose,
        gaze: ViewGaze,
        size: [u32; 2],
        pictured: bool,
    ) -> Result<View, PlatformError> {
        let labels = visible_labels(&self.scene, pose.position, gaze, size);
        let truth = GroundTruth {
            lists_objects: true,
            labels: labels.map_err(|error| self.not_drawn_error(&error))?,
            room: self.room_seen(pose.position, gaze.heading),
        };
        let draw_image = || {
            let camera = PinholeCamera::for_level_gaze(pose.position, gaze, size);
            let picture = self.scene.render_picture(&camera).map_err(|error| self.not_drawn_error(&error))?;
            Image::new(picture.width, picture.height, picture.rgb).map_err(|error| self.not_drawn_error(&error))
        };
        let image = pictured.then(draw_image).transpose()?.map(Arc::new);
        let pose = Pose::looking_level(pose.position, gaze.heading);
        Ok(View::new(pose, gaze.horizontal_fov_rad, image, Some(truth)))
    }

    /// The depths of the view from a pose, as it fills a picture of this size in pixels.
    pub(super) fn depth_from(&self, pose: Pose, gaze: ViewGaze, size: [u32; 2]) -> Result<DepthImage, PlatformError> {
        let picture = self
            .scene
            .render_object_ids(&PinholeCamera::for_level_gaze(pose.position, gaze, size))
            .map_err(|error| self.not_drawn_error(&error))?;
        DepthImage::new(picture.width, picture.height, picture.depth_m).map_err(|error| self.not_drawn_error(&error))
    }

    /// The error that something in this house cannot be drawn.
    pub(super) fn not_drawn_error(&self, error: &dyn std::error::Error) -> PlatformError {
        PlatformError::NotDrawn { scene: self.id.clone(), reason: error.to_string() }
    }

    fn room_name(&self, eye: DVec3) -> Option<String> {
        let room = self.scene.house.room_at(eye.x, eye.y, eye.z - EYE_M)?;
        Some(room.kind.word().to_owned())
    }

    /// The room in which an eye is. For an eye in an opening, this is the room into which it looks.
    pub(super) fn room_seen(&self, eye: DVec3, heading: Heading) -> Option<String> {
        let ahead = DVec3::new(libm::sin(heading.rad()), libm::cos(heading.rad()), 0.0) * 0.5;
        self.is_in_opening(eye).then(|| self.room_name(eye + ahead)).flatten().or_else(|| self.room_name(eye))
    }

    /// Whether an eye is in an opening between two rooms.
    pub(super) fn is_in_opening(&self, eye: DVec3) -> bool {
        let floor_cm = (eye.z - EYE_M) * 100.0;
        let stands_in = |opening: &WallOpening| {
            opening.span.thickened_by(THRESHOLD_CM).holds_m(eye.x, eye.y)
                && (f64::from(opening.base_cm) - floor_cm).abs() < 50.0
        };
        self.scene.house.openings.iter().any(stands_in)
    }

    /// Everything visible from a pose.
    pub(super) fn labels_around(&self, pose: Pose) -> Result<Vec<ObjectLabel>, PlatformError> {
        let mut all = Vec::new();
        for gaze in ViewGaze::around_heading(pose.heading) {
            all.extend(self.labels_in(pose, gaze)?);
        }
        Ok(all)
    }

    /// What a picture ahead from a pose shows.
    pub(super) fn labels_ahead(&self, pose: Pose) -> Result<Vec<ObjectLabel>, PlatformError> {
        self.labels_in(pose, ViewGaze::quarter_view(pose.heading))
    }

    fn labels_in(&self, pose: Pose, gaze: ViewGaze) -> Result<Vec<ObjectLabel>, PlatformError> {
        visible_labels(&self.scene, pose.position, gaze, LABELS_SIZE_PX).map_err(|error| self.not_drawn_error(&error))
    }

    /// An upper bound of the distance over the ground between two standing places: the largest distance between two viewpoints along the
    /// graph, whose edges can be walked, and the ways to them. So a request for a path that is too long for the house is refused
    /// without a search.
    pub(super) fn longest_m(&self) -> f64 {
        *self.longest_m.get_or_init(|| {
            let from = |id| self.graph.distances_from(id).unwrap_or_default();
            let all = self.graph.viewpoints().flat_map(|id| from(id).into_values());
            all.fold(0.0, f64::max) + 2.0 * TO_VIEWPOINT_M
        })
    }

    /// The viewpoints from which each object is seen.
    pub(super) fn seen_from(&self) -> Result<&BTreeMap<ObjectId, BTreeSet<ViewpointId>>, PlatformError> {
        if let Some(seen_from) = self.seen_from.get() {
            return Ok(seen_from);
        }
        let seen = seen_from(&self.graph, |eye, heading| self.labels_around(Pose::looking_level(eye, heading)))?;
        Ok(self.seen_from.get_or_init(|| seen))
    }

    /// Refuses poses outside the house.
    pub(super) fn check_within(&self, frame: &Frame) -> Result<(), PlatformError> {
        let eye = frame.pose.position;
        // `room_name` takes the eye to be at a person's height. A low camera would be below the floor then, so it is also
        // looked for at its own height.
        let is_within = || self.scene.house.room_at(eye.x, eye.y, eye.z).is_some();
        if eye.is_finite() && (self.room_name(eye).is_some() || is_within()) {
            return Ok(());
        }
        Err(PlatformError::for_unknown_place(&self.id, frame))
    }
}

/// The error for a name that no house of this version has.
pub(super) fn unknown_scene_error(scene: &str) -> PlatformError {
    let hint = match old_seed_of(scene) {
        Some(seed) => format!(
            "it was made by an earlier version of the generator, whose houses this program does not make; the house of \
             seed {seed} is now {}, with other rooms",
            scene_name(seed)
        ),
        None => {
            "the scenes of platform house are named by their seed, as in house2-7; for a scene of another platform, \
                 give --platform, as in --platform matterport"
                .to_owned()
        }
    };
    PlatformError::UnknownScene { scene: scene.to_owned(), hint }
}
