//! The platform on top of a running VirtualHome.

use super::{
    client::{CameraMode, VirtualHomeCamera as HomeCamera, VirtualHomeClient},
    error::HomeError,
    floor,
    graph::{EnvironmentGraph, EnvironmentNode},
    names,
};
use crate::{
    labels::{ObjectPalette, SimulatorObject, colour_id},
    live::{
        LivePictureOptions, LivePlatform, ProgressListener, Simulator, SimulatorRoom, SimulatorShot, SimulatorShotKind,
        SimulatorSurvey,
    },
    path_sampling::EYE_M,
    unity::unity_from_wayword,
};
use std::{collections::BTreeMap, time::Duration};
use wayword_core::{DVec3, FailureKind, SceneId};
use wayword_render::PinholeCamera;

/// Homes that VirtualHome has.
const HOME_NUMBERS: std::ops::Range<u32> = 0..50;

/// Options of the platform.
#[derive(Debug, Clone, PartialEq)]
pub struct VirtualHomeOptions {
    /// Address at which the simulator listens.
    pub url: String,
    /// How long each of its answers may take.
    pub timeout: Duration,
    /// Size of pictures, and distance between frames.
    pub pictures: LivePictureOptions,
}

impl Default for VirtualHomeOptions {
    fn default() -> Self {
        let url = "http://127.0.0.1:8080".to_owned();
        Self { url, timeout: Duration::from_secs(120), pictures: LivePictureOptions::default() }
    }
}

/// VirtualHome over its running executable: scenes `home_0` to `home_49`.
pub type VirtualHomePlatform = LivePlatform<VirtualHome>;

/// The executable, and the home that it has loaded.
#[derive(Debug)]
pub struct VirtualHome {
    client: VirtualHomeClient,
    size: (u32, u32),
    /// The home that is loaded, and the number of our camera in it.
    loaded: Option<(SceneId, i64)>,
    progress_listener: ProgressListener,
}

impl VirtualHomePlatform {
    /// A platform that contacts the simulator at the first request that needs it.
    #[must_use]
    pub fn new(options: VirtualHomeOptions) -> Self {
        let VirtualHomeOptions { url, timeout, pictures } = options;
        let size = (pictures.width_px, pictures.height_px);
        Self::from_simulator(
            VirtualHome {
                client: VirtualHomeClient::new(url, timeout),
                size,
                loaded: None,
                progress_listener: ProgressListener::without_listener(),
            },
            pictures,
        )
    }
}

/// The names of all homes.
pub(super) fn home_names() -> Vec<String> {
    HOME_NUMBERS.map(|home| format!("home_{home}")).collect()
}

/// The number in a scene's name.
fn home_number(scene: &SceneId) -> Option<u32> {
    let number: u32 = scene.as_str().strip_prefix("home_")?.parse().ok()?;
    (HOME_NUMBERS.contains(&number) && scene.as_str() == format!("home_{number}")).then_some(number)
}

/// The camera in the terms of VirtualHome.
fn home_camera(camera: &PinholeCamera) -> HomeCamera {
    HomeCamera {
        position: unity_from_wayword(camera.position),
        // Unity's positive rotation about its up axis is clockwise from above, as a heading is.
        rotation_deg: [0.0, camera.heading_rad.to_degrees(), 0.0],
        field_of_view_deg: camera.vertical_fov_rad.to_degrees(),
    }
}

/// The object of a node; `None` for a part of the building, or a node without a usable box.
fn object_from_node(node: &EnvironmentNode) -> Option<SimulatorObject> {
    let (low, high) = node.bounding_box?.bounds_m()?;
    let half = (high - low) / 2.0;
    let sides = [DVec3::X * half.x, DVec3::Y * half.y, DVec3::Z * half.z];
    node.is_thing()
        .then(|| SimulatorObject::new(node.id, &names::split_class_name(&node.class_name), (low + high) / 2.0, sides))?
}

/// The objects of a home by their colours in pictures of instances.
fn palette_from_graph(graph: &EnvironmentGraph, colours: &BTreeMap<i64, [u8; 3]>) -> ObjectPalette {
    let coloured = |node: &EnvironmentNode| Some((colour_id(*colours.get(&node.id)?), object_from_node(node)?));
    graph.nodes.iter().filter_map(coloured).collect()
}

fn rooms_from_graph(graph: &EnvironmentGraph) -> Vec<SimulatorRoom> {
    let room = |node: &EnvironmentNode| {
        Some(SimulatorRoom {
            name: names::split_class_name(&node.class_name),
            bounds_m: node.bounding_box?.bounds_m()?,
        })
    };
    graph.nodes.iter().filter(|node| node.is_room()).filter_map(room).collect()
}

impl Simulator for VirtualHome {
    type Error = HomeError;
    const NAME: &'static str = "virtualhome";

    fn address(&self) -> String {
        self.client.url().to_owned()
    }

    fn set_listener(&mut self, ear: ProgressListener) {
        self.progress_listener = ear;
    }

    fn scene_names(&self) -> Vec<String> {
        home_names()
    }

    fn scene_name_hint(&self, scene: &SceneId) -> Option<&'static str> {
        home_number(scene).is_none().then_some("homes are named home_0 to home_49")
    }

    fn enter_scene(&mut self, scene: &SceneId) -> Result<(), HomeError> {
        if self.loaded.as_ref().is_some_and(|(loaded, _)| loaded == scene) {
            return Ok(());
        }
        self.loaded = None;
        let home = home_number(scene).ok_or_else(|| HomeError::Floor(format!("of {scene} is not known")))?;
        let url = self.client.url();
        let port = url.rsplit(':').next().filter(|port| port.parse::<u16>().is_ok()).unwrap_or("8080");
        self.progress_listener.report_line(&format!(
            "asking VirtualHome at {url} for {scene}, which takes some seconds; \
             if it does not run, start it with -batchmode -http-port={port}"
        ));
        self.client.reset(home)?;
        let camera = HomeCamera { position: [0.0, EYE_M, 0.0], rotation_deg: [0.0; 3], field_of_view_deg: 60.0 };
        self.client.add_camera(&camera)?;
        let last = self.client.camera_count()? - 1;
        self.loaded = Some((scene.clone(), last));
        Ok(())
    }

    fn survey_scene(&mut self) -> Result<SimulatorSurvey, HomeError> {
        let graph = self.client.environment_graph()?;
        let colours = self.client.instance_colors()?;
        let (floor_m, raster) = floor::compute_floor(&graph)?;
        let eye = |[x, y]: [f64; 2]| DVec3::new(x, y, floor_m + EYE_M);
        let eyes: Vec<DVec3> = raster.viewpoint_places().into_iter().map(eye).collect();
        let viewpoints = raster.viewpoint_graph(&eyes).map_err(|error| HomeError::Floor(error.to_string()))?;
        Ok(SimulatorSurvey {
            graph: viewpoints,
            raster,
            palette: palette_from_graph(&graph, &colours),
            rooms: rooms_from_graph(&graph),
            thresholds: floor::threshold_areas(&graph),
        })
    }

    fn take_picture(&mut self, camera: &PinholeCamera, wanted: SimulatorShotKind) -> Result<SimulatorShot, HomeError> {
        let index = self.loaded.as_ref().map_or(0, |(_, index)| *index);
        let shot = (|| {
            self.client.update_camera(index, &home_camera(camera))?;
            let mut picture = || self.client.camera_image(index, CameraMode::Normal, self.size);
            let rgb = (wanted == SimulatorShotKind::Picture).then(&mut picture).transpose()?;
            let colours = self.client.camera_image(index, CameraMode::Instances, self.size)?;
            Ok(SimulatorShot { rgb, ids: colours.as_chunks().0.iter().map(|rgb| colour_id(*rgb)).collect() })
        })();
        if shot.is_err() {
            // A simulator that was restarted has another home loaded, or none.
            self.loaded = None;
        }
        shot
    }

    fn shortest_way(
        &mut self,
        survey: &SimulatorSurvey,
        from: DVec3,
        to: DVec3,
    ) -> Result<Option<Vec<DVec3>>, HomeError> {
        let way = survey.raster.shortest_way([from.x, from.y], [to.x, to.y]);
        Ok(way.map(|corners| corners.into_iter().map(|[x, y]| DVec3::new(x, y, from.z)).collect()))
    }

    fn error_hint(error: &HomeError) -> &'static str {
        match error {
            HomeError::Floor(_) => "choose another home",
            HomeError::Unreachable { .. } => "it is a separate program that runs beside Wayword",
            _ => "restart the simulator, or look into its log",
        }
    }

    fn is_loss(error: &HomeError) -> bool {
        matches!(error, HomeError::Unreachable { .. } | HomeError::Status { .. } | HomeError::Failed { .. })
    }

    fn failure_kind(error: &HomeError) -> FailureKind {
        match error {
            HomeError::Unreachable { .. } | HomeError::Status { .. } => FailureKind::Lost,
            HomeError::Failed { .. } | HomeError::Malformed { .. } | HomeError::Floor(_) => FailureKind::Broken,
        }
    }
}
