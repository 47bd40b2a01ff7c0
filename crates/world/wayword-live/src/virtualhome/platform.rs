//! The platform on top of a running VirtualHome.

use super::{
    client::{Camera as HomeCamera, Client, Mode},
    error::HomeError,
    floor,
    graph::{EnvironmentGraph, Node},
    names,
};
use crate::{
    live::{Ear, Live, Pictures, Room, Shot, Simulator, Survey, Wanted},
    sight::{Palette, Thing, colour_id},
    unity::unity_from_wayword,
    walk::EYE_M,
};
use std::{collections::BTreeMap, time::Duration};
use wayword_core::{DVec3, Failure, SceneId};
use wayword_render::Camera;

/// Homes that VirtualHome has.
const HOMES: std::ops::Range<u32> = 0..50;

/// Options of the platform.
#[derive(Debug, Clone, PartialEq)]
pub struct VirtualHomeOptions {
    /// Address at which the simulator listens.
    pub url: String,
    /// How long each of its answers may take.
    pub timeout: Duration,
    /// Size of pictures, and distance between frames.
    pub pictures: Pictures,
}

impl Default for VirtualHomeOptions {
    fn default() -> Self {
        let url = "http://127.0.0.1:8080".to_owned();
        Self { url, timeout: Duration::from_secs(120), pictures: Pictures::default() }
    }
}

/// VirtualHome over its running executable: scenes `home_0` to `home_49`.
pub type VirtualHomePlatform = Live<VirtualHome>;

/// The executable, and the home that it has loaded.
#[derive(Debug)]
pub struct VirtualHome {
    client: Client,
    size: (u32, u32),
    /// The home that is loaded, and the number of our camera in it.
    loaded: Option<(SceneId, i64)>,
    ear: Ear,
}

impl VirtualHomePlatform {
    /// A platform that contacts the simulator at the first request that needs it.
    #[must_use]
    pub fn new(options: VirtualHomeOptions) -> Self {
        let VirtualHomeOptions { url, timeout, pictures } = options;
        let size = (pictures.width_px, pictures.height_px);
        Self::over(VirtualHome { client: Client::new(url, timeout), size, loaded: None, ear: Ear::deaf() }, pictures)
    }
}

/// The names of all homes.
pub(super) fn homes() -> Vec<String> {
    HOMES.map(|home| format!("home_{home}")).collect()
}

/// The number in a scene's name.
fn home_of(scene: &SceneId) -> Option<u32> {
    let number: u32 = scene.as_str().strip_prefix("home_")?.parse().ok()?;
    (HOMES.contains(&number) && scene.as_str() == format!("home_{number}")).then_some(number)
}

fn home_camera(camera: &Camera) -> HomeCamera {
    HomeCamera {
        position: unity_from_wayword(camera.position),
        // Unity's positive rotation about its up axis is clockwise from above, as a heading is.
        rotation_deg: [0.0, camera.heading_rad.to_degrees(), 0.0],
        field_of_view_deg: camera.vertical_fov_rad.to_degrees(),
    }
}

fn thing(node: &Node) -> Option<Thing> {
    let (low, high) = node.bounding_box?.bounds_m()?;
    let half = (high - low) / 2.0;
    let sides = [DVec3::X * half.x, DVec3::Y * half.y, DVec3::Z * half.z];
    node.is_thing().then(|| Thing::new(node.id, &names::words(&node.class_name), (low + high) / 2.0, sides))?
}

fn palette(graph: &EnvironmentGraph, colours: &BTreeMap<i64, [u8; 3]>) -> Palette {
    let coloured = |node: &Node| Some((colour_id(*colours.get(&node.id)?), thing(node)?));
    graph.nodes.iter().filter_map(coloured).collect()
}

fn rooms(graph: &EnvironmentGraph) -> Vec<Room> {
    let room =
        |node: &Node| Some(Room { name: names::words(&node.class_name), bounds_m: node.bounding_box?.bounds_m()? });
    graph.nodes.iter().filter(|node| node.is_room()).filter_map(room).collect()
}

impl Simulator for VirtualHome {
    type Error = HomeError;
    const NAME: &'static str = "virtualhome";

    fn address(&self) -> String {
        self.client.url().to_owned()
    }

    fn tell(&mut self, ear: Ear) {
        self.ear = ear;
    }

    fn scenes(&self) -> Vec<String> {
        homes()
    }

    fn refuses(&self, scene: &SceneId) -> Option<&'static str> {
        home_of(scene).is_none().then_some("homes are named home_0 to home_49")
    }

    fn enter(&mut self, scene: &SceneId) -> Result<(), HomeError> {
        if self.loaded.as_ref().is_some_and(|(loaded, _)| loaded == scene) {
            return Ok(());
        }
        self.loaded = None;
        let home = home_of(scene).ok_or_else(|| HomeError::Floor(format!("of {scene} is not known")))?;
        let url = self.client.url();
        let port = url.rsplit(':').next().filter(|port| port.parse::<u16>().is_ok()).unwrap_or("8080");
        self.ear.hear(&format!(
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

    fn survey(&mut self) -> Result<Survey, HomeError> {
        let graph = self.client.environment_graph()?;
        let colours = self.client.instance_colors()?;
        let (floor_m, raster) = floor::raster(&graph)?;
        let eye = |[x, y]: [f64; 2]| DVec3::new(x, y, floor_m + EYE_M);
        let eyes: Vec<DVec3> = raster.places().into_iter().map(eye).collect();
        let viewpoints = raster.graph(&eyes).map_err(|error| HomeError::Floor(error.to_string()))?;
        Ok(Survey {
            graph: viewpoints,
            raster,
            palette: palette(&graph, &colours),
            rooms: rooms(&graph),
            thresholds: floor::thresholds(&graph),
        })
    }

    fn shoot(&mut self, camera: &Camera, wanted: Wanted) -> Result<Shot, HomeError> {
        let index = self.loaded.as_ref().map_or(0, |(_, index)| *index);
        let shot = (|| {
            self.client.update_camera(index, &home_camera(camera))?;
            let mut picture = || self.client.camera_image(index, Mode::Normal, self.size);
            let rgb = (wanted == Wanted::Picture).then(&mut picture).transpose()?;
            let colours = self.client.camera_image(index, Mode::Instances, self.size)?;
            Ok(Shot { rgb, ids: colours.as_chunks().0.iter().map(|rgb| colour_id(*rgb)).collect() })
        })();
        if shot.is_err() {
            // A simulator that was restarted has another home loaded, or none.
            self.loaded = None;
        }
        shot
    }

    fn way(&mut self, survey: &Survey, from: DVec3, to: DVec3) -> Result<Option<Vec<DVec3>>, HomeError> {
        let way = survey.raster.shortest([from.x, from.y], [to.x, to.y]);
        Ok(way.map(|corners| corners.into_iter().map(|[x, y]| DVec3::new(x, y, from.z)).collect()))
    }

    fn hint(error: &HomeError) -> &'static str {
        match error {
            HomeError::Floor(_) => "choose another home",
            HomeError::Unreachable { .. } => "it is a separate program that runs beside Wayword",
            _ => "restart the simulator, or look into its log",
        }
    }

    fn is_loss(error: &HomeError) -> bool {
        matches!(error, HomeError::Unreachable { .. } | HomeError::Status { .. } | HomeError::Failed { .. })
    }

    fn failure(error: &HomeError) -> Failure {
        match error {
            HomeError::Unreachable { .. } | HomeError::Status { .. } => Failure::Lost,
            HomeError::Failed { .. } | HomeError::Malformed { .. } | HomeError::Floor(_) => Failure::Broken,
        }
    }
}
