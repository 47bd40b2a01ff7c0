//! Wraps a platform so that its world appears altered: [`AlteredPlatform`] forwards each request to the original platform and maps poses,
//! views and paths between the two worlds.

use super::labels::with_truth;
use std::{collections::BTreeSet, path::PathBuf, sync::Arc};
use wayword_core::{
    DVec3, DepthImage, Frame, Ground, GroundIsland, GroundRoute, Heading, ObjectId, Path, PathRequest, PlacedObject,
    Platform, PlatformError, Pose, SceneCatalogue, SceneFiles, SceneId, View, ViewGaze, ViewpointGraph, ViewpointId,
    graph::GraphError,
};

/// An alteration of a world. By default every method leaves its argument unchanged.
///
/// "Before" is the world of the original platform, "after" the altered one.
pub trait WorldAlteration: Send + Sync {
    /// Maps a position to the altered world, metres, world frame.
    fn place_after(&self, before: DVec3) -> DVec3 {
        before
    }

    /// Maps a position back: the inverse of [`place_after`](Self::place_after).
    fn place_before(&self, after: DVec3) -> DVec3 {
        after
    }

    /// Maps a direction to the altered world.
    fn heading_after(&self, before: Heading) -> Heading {
        before
    }

    /// Maps a direction back: the inverse of [`heading_after`](Self::heading_after).
    fn heading_before(&self, after: Heading) -> Heading {
        after
    }

    /// The frame and the gaze in the original world from which a view of the altered world is made.
    fn look_before(&self, _scene: &SceneId, from: &Frame, gaze: ViewGaze) -> (Frame, ViewGaze) {
        let gaze = ViewGaze { heading: self.heading_before(gaze.heading), ..gaze };
        (self.frame_before(from), gaze)
    }

    /// Makes the view of the altered world from the view of the original one.
    ///
    /// # Errors
    /// When the view cannot be made.
    fn view_after(&self, _look: AlteredLook<'_>, before: View) -> Result<View, PlatformError> {
        Ok(before)
    }

    /// Whether the room of a view is that of the frame, although `look_before` moves the eye. The room is then looked up at the frame.
    fn keeps_room(&self) -> bool {
        false
    }

    /// The depths of a view in the altered world; `None` if the alteration cannot give them.
    fn depth_after(&self, before: DepthImage) -> Option<DepthImage> {
        Some(before)
    }

    /// Maps a frame back to the original world.
    fn frame_before(&self, after: &Frame) -> Frame {
        let Pose { position, heading, elevation_rad } = after.pose;
        let pose = Pose { position: self.place_before(position), heading: self.heading_before(heading), elevation_rad };
        Frame { pose, ..after.clone() }
    }

    /// Maps a path to the altered world. It drops the words that distinguish the target from similar things, because they may no longer
    /// be right.
    fn path_after(&self, before: Path) -> Path {
        let frame = |frame: Frame| {
            let Pose { position, heading, elevation_rad } = frame.pose;
            let pose =
                Pose { position: self.place_after(position), heading: self.heading_after(heading), elevation_rad };
            Frame { pose, ..frame }
        };
        let mut path = Path { frames: before.frames.into_iter().map(frame).collect(), ..before };
        if let Some(target) = &mut path.target {
            target.told_by.clear();
            target.descriptions.clear();
        }
        path
    }
}

/// The scene, the frame and the gaze of a request, in the altered world.
#[derive(Debug, Clone, Copy)]
pub struct AlteredLook<'a> {
    /// The scene.
    pub scene: &'a SceneId,
    /// The position of the eye.
    pub from: &'a Frame,
    /// The direction and width of the view.
    pub gaze: ViewGaze,
}

/// A platform with an altered world.
#[derive(Debug, Clone)]
pub struct AlteredPlatform<P, A> {
    platform: P,
    alter: A,
}

impl<P: Platform, A: WorldAlteration> AlteredPlatform<P, A> {
    /// Wraps a platform.
    pub fn new(platform: P, alter: A) -> Self {
        Self { platform, alter }
    }

    /// The altered view. `look` asks the original platform for a view, with or without a picture.
    fn altered_view(
        &self,
        scene: &SceneId,
        from: &Frame,
        gaze: ViewGaze,
        look: impl Fn(&Frame, ViewGaze) -> Result<View, PlatformError>,
    ) -> Result<View, PlatformError> {
        let (before, gaze_before) = self.alter.look_before(scene, from, gaze);
        let after = self.alter.view_after(AlteredLook { scene, from, gaze }, look(&before, gaze_before)?)?;
        if !self.alter.keeps_room() {
            return Ok(after);
        }
        let here = self.platform.look_without_picture(scene, &self.alter.frame_before(from), gaze_before)?;
        let room = here.ground_truth().and_then(|truth| truth.room.clone());
        Ok(with_truth(after, |truth| truth.room = room))
    }
}

/// `inner` keeps its default: nothing of the original world may be reached past the alteration.
impl<P: Platform, A: WorldAlteration> Platform for AlteredPlatform<P, A> {
    fn name(&self) -> &'static str {
        self.platform.name()
    }

    fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        self.platform.list_scenes()
    }

    fn graph_for_scene(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        let before = self.platform.graph_for_scene(scene)?;
        let graph = graph_after(&before, &self.alter);
        graph.map(Arc::new).map_err(|source| PlatformError::Graph { scene: scene.clone(), source })
    }

    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        Ok(self.alter.path_after(self.platform.sample_path(scene, request, seed)?))
    }

    fn look_from(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        self.altered_view(scene, from, gaze, |from, gaze| self.platform.look_from(scene, from, gaze))
    }

    fn look_without_picture(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        self.altered_view(scene, from, gaze, |from, gaze| self.platform.look_without_picture(scene, from, gaze))
    }

    fn ground(&self) -> &dyn Ground {
        self
    }

    fn catalogue(&self) -> &dyn SceneCatalogue {
        self
    }

    fn files(&self) -> &dyn SceneFiles {
        self
    }
}

/// `look_down` keeps its default, because an altered world has no picture from above.
impl<P: Platform, A: WorldAlteration> Ground for AlteredPlatform<P, A> {
    fn view_depth(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<Option<DepthImage>, PlatformError> {
        let (from, gaze) = self.alter.look_before(scene, from, gaze);
        let before = self.platform.ground().view_depth(scene, &from, gaze)?;
        Ok(before.and_then(|before| self.alter.depth_after(before)))
    }

    fn ground_route(&self, scene: &SceneId, from: &Frame, to: &Frame) -> Result<Option<GroundRoute>, PlatformError> {
        let (from, to) = (self.alter.frame_before(from), self.alter.frame_before(to));
        let before = self.platform.ground().ground_route(scene, &from, &to)?;
        let after = |way: GroundRoute| GroundRoute {
            corners: way.corners.into_iter().map(|corner| self.alter.place_after(corner)).collect(),
            ..way
        };
        Ok(before.map(after))
    }

    fn ground_islands(&self, scene: &SceneId) -> Result<Vec<GroundIsland>, PlatformError> {
        self.platform.ground().ground_islands(scene)
    }
}

impl<P: Platform, A: WorldAlteration> SceneCatalogue for AlteredPlatform<P, A> {
    fn object_name(&self, scene: &SceneId, near: &Frame, object: &ObjectId) -> Result<Option<String>, PlatformError> {
        self.platform.catalogue().object_name(scene, &self.alter.frame_before(near), object)
    }

    fn visible_from(&self, scene: &SceneId, object: &ObjectId) -> Result<Option<BTreeSet<ViewpointId>>, PlatformError> {
        self.platform.catalogue().visible_from(scene, object)
    }

    fn listed_objects(&self, scene: &SceneId) -> Result<Vec<PlacedObject>, PlatformError> {
        let after = |placed: PlacedObject| PlacedObject { position: self.alter.place_after(placed.position), ..placed };
        Ok(self.platform.catalogue().listed_objects(scene)?.into_iter().map(after).collect())
    }

    fn lists_everything(&self) -> bool {
        self.platform.catalogue().lists_everything()
    }
}

/// The names of scenes and the files behind them stay the same. `scene_file` keeps its default, because no file holds an altered world;
/// `candidate_scenes` and `examine_scene` keep theirs, because the files show only what the original world offers.
impl<P: Platform, A: WorldAlteration> SceneFiles for AlteredPlatform<P, A> {
    fn check_scenes(&self, scenes: &BTreeSet<&SceneId>) -> Result<(), PlatformError> {
        self.platform.files().check_scenes(scenes)
    }

    fn canonical_scene(&self, scene: &SceneId) -> SceneId {
        self.platform.files().canonical_scene(scene)
    }

    fn source_files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        self.platform.files().source_files(scene)
    }
}

/// The place of a frame as text, which serves as a key for random draws.
pub(super) fn frame_key(frame: &Frame) -> String {
    let (bits, viewpoint) = frame.place_key();
    let [x, y, z] = bits;
    format!("{x:x} {y:x} {z:x} {}", viewpoint.as_ref().map_or("", ViewpointId::as_str))
}

/// The graph with the positions of the altered world.
fn graph_after(before: &ViewpointGraph, alter: &impl WorldAlteration) -> Result<ViewpointGraph, GraphError> {
    let mut after = ViewpointGraph::default();
    for id in before.viewpoints() {
        let Some(position) = before.position_of(id) else { continue };
        after.add_viewpoint(id.clone(), alter.place_after(position), before.level_of(id))?;
        if let Some(floor_m) = before.floor_m(id) {
            after.set_floor(id, floor_m)?;
        }
    }
    for (a, b, _) in before.edges() {
        after.join_viewpoints(a, b)?;
    }
    Ok(after)
}
