//! Offers generated houses as a [`Platform`].

use super::{
    graph::EYE_M,
    names::scene_name,
    prepared_house::{PreparedHouse, unknown_scene_error},
    sample,
};
use std::{collections::BTreeSet, sync::Arc};
use wayword_core::{
    DVec3, DepthImage, Frame, FromAbove, Ground, GroundRoute, ObjectId, Path, PathRequest, Platform, PlatformError,
    RecentCache, SceneCatalogue, SceneId, View, ViewGaze, ViewpointGraph, ViewpointId,
};
use wayword_render::{PinholeCamera, RenderedPicture, to_flat_gaze};

/// How many houses are kept in memory; each takes about 20 MB.
const MAX_READY_HOUSES: usize = 6;

/// Homes from seeds: scene `house2-7` is the home of seed 7.
#[derive(Debug)]
pub struct HousePlatform {
    options: HouseOptions,
    ready: RecentCache<SceneId, PreparedHouse>,
}

/// The options of the platform.
#[derive(Debug, Clone, PartialEq)]
pub struct HouseOptions {
    /// How many scenes it lists, from `house2-0` on. The scene of any other seed can be asked for by its name.
    pub scenes: u64,
    /// Width of pictures, pixels.
    pub width_px: u32,
    /// Height of pictures, pixels.
    pub height_px: u32,
    /// Distance between two frames of a random path, metres.
    pub interval_m: f64,
}

impl Default for HouseOptions {
    fn default() -> Self {
        Self { scenes: 20, width_px: 640, height_px: 480, interval_m: 1.0 }
    }
}

impl HousePlatform {
    /// The platform with these options.
    #[must_use]
    pub fn new(options: HouseOptions) -> Self {
        Self { options, ready: RecentCache::new(MAX_READY_HOUSES) }
    }

    /// The scene of a seed.
    ///
    /// # Errors
    /// Never: every seed has a house. There is an error type only because making an id can fail.
    pub fn scene_of(seed: u64) -> Result<SceneId, PlatformError> {
        let name = scene_name(seed);
        SceneId::new(name.clone()).map_err(|_| unknown_scene_error(&name))
    }

    /// What a camera sees, which may be pitched: depths, and colours if `coloured`.
    ///
    /// # Errors
    /// When the scene is unknown, or the camera's numbers give no picture.
    pub fn render_camera(
        &self,
        scene: &SceneId,
        camera: &PinholeCamera,
        coloured: bool,
    ) -> Result<RenderedPicture, PlatformError> {
        let home = self.ready_house(scene)?;
        if coloured {
            home.scene.render_picture(camera).map_err(|error| home.not_drawn_error(&error))
        } else {
            home.scene.render_object_ids(camera).map_err(|error| home.not_drawn_error(&error))
        }
    }

    fn ready_house(&self, scene: &SceneId) -> Result<Arc<PreparedHouse>, PlatformError> {
        self.ready.get_or_make(scene.clone(), || PreparedHouse::for_scene(scene))
    }

    fn checked_view(
        &self,
        scene: &SceneId,
        from: &Frame,
        gaze: ViewGaze,
        pictured: bool,
    ) -> Result<View, PlatformError> {
        let home = self.ready_house(scene)?;
        home.check_within(from)?;
        home.view_from(from.pose, to_flat_gaze(gaze), [self.options.width_px, self.options.height_px], pictured)
    }
}

impl Default for HousePlatform {
    fn default() -> Self {
        Self::new(HouseOptions::default())
    }
}

impl Platform for HousePlatform {
    fn name(&self) -> &'static str {
        "house"
    }

    fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        let mut scenes = (0..self.options.scenes).map(Self::scene_of).collect::<Result<Vec<_>, _>>()?;
        scenes.sort();
        Ok(scenes)
    }

    fn graph_for_scene(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        Ok(self.ready_house(scene)?.graph.clone())
    }

    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        sample::sample_house_path(scene, &*self.ready_house(scene)?, request, seed, self.options.interval_m)
    }

    fn look_from(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        self.checked_view(scene, from, gaze, true)
    }

    fn look_without_picture(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        self.checked_view(scene, from, gaze, false)
    }

    fn ground(&self) -> &dyn Ground {
        self
    }

    fn catalogue(&self) -> &dyn SceneCatalogue {
        self
    }
}

impl Ground for HousePlatform {
    fn view_depth(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<Option<DepthImage>, PlatformError> {
        let home = self.ready_house(scene)?;
        home.check_within(from)?;
        home.depth_from(from.pose, to_flat_gaze(gaze), [self.options.width_px, self.options.height_px]).map(Some)
    }

    fn look_down(&self, scene: &SceneId, level: u32) -> Result<Option<FromAbove>, PlatformError> {
        let home = self.ready_house(scene)?;
        home.scene.look_down(&home.graph, level).map_err(|error| home.not_drawn_error(&error))
    }

    fn ground_route(&self, scene: &SceneId, from: &Frame, to: &Frame) -> Result<Option<GroundRoute>, PlatformError> {
        let feet = |frame: &Frame| frame.pose.position - DVec3::Z * EYE_M;
        let way = self.ready_house(scene)?.ground.shortest_route(feet(from), feet(to)).ok();
        Ok(way.map(|way| GroundRoute { corners: way.corners, length_m: way.length_m }))
    }
}

impl SceneCatalogue for HousePlatform {
    fn object_name(&self, scene: &SceneId, _: &Frame, object: &ObjectId) -> Result<Option<String>, PlatformError> {
        let home = self.ready_house(scene)?;
        let number: Option<u32> = object.as_str().parse().ok();
        Ok(number.and_then(|id| home.scene.objects.get(&id)).map(|object| object.name.clone()))
    }

    fn visible_from(&self, scene: &SceneId, object: &ObjectId) -> Result<Option<BTreeSet<ViewpointId>>, PlatformError> {
        let home = self.ready_house(scene)?;
        Ok(Some(home.seen_from()?.get(object).cloned().unwrap_or_default()))
    }
}

#[cfg(test)]
mod tests;
