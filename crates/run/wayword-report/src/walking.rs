//! Scenes with walkable ground, in which an agent can take single steps: generated houses and Habitat's scenes, each with its navmesh.

use std::sync::Arc;
use wayword_core::{DVec3, Path, Platform, PlatformError, RecentCache, SceneId};
use wayword_habitat::{
    HabitatOptions, HabitatPlatform, NavMesh, NavMeshGround, NavMeshSettings, axes::EYE_M, bake::bake_navmesh,
    scene::SceneModel,
};
use wayword_house::{House, HouseOptions, HousePlatform, build_surfaces, generate_house, seed_of};
use wayword_render::{PinholeCamera, RenderedPicture};
use wayword_run::{error::CommandError, platforms, settings::RunSettings, stores};

/// Height from which the floor under a place is looked for, metres.
const PROBE_HEIGHT_M: f64 = 0.5;
/// Farthest that the floor is from a place on its navmesh, metres.
const MAX_ABOVE_FLOOR_M: f64 = 0.4;
/// Navmeshes that are kept in memory.
const MAX_NAVMESHES: usize = 6;

/// The scenes of a run, with their ground.
pub struct WalkingScenes {
    kind: WalkingPlatform,
    grounds: RecentCache<SceneId, NavMeshGround>,
}

enum WalkingPlatform {
    Houses(HousePlatform),
    Habitat(Box<HabitatPlatform>),
}

impl WalkingScenes {
    /// Generated houses; their pictures get this size in pixels.
    pub fn generated_houses([width_px, height_px]: [u32; 2]) -> Self {
        let houses = HousePlatform::new(HouseOptions { width_px, height_px, ..HouseOptions::default() });
        Self { kind: WalkingPlatform::Houses(houses), grounds: RecentCache::new(MAX_NAVMESHES) }
    }

    /// The scenes of a run; their pictures get this size in pixels.
    ///
    /// # Errors
    /// When the run's platform has no navmeshes, or its data cannot be opened.
    pub(crate) fn open_run(settings: &RunSettings, [width_px, height_px]: [u32; 2]) -> Result<Self, CommandError> {
        let kind = match settings.platform.as_str() {
            "house" => return Ok(Self::generated_houses([width_px, height_px])),
            "habitat" => {
                let (island, connectivity) = (settings.island, settings.connectivity.clone());
                let options = HabitatOptions {
                    width_px,
                    height_px,
                    island,
                    connectivity,
                    off_graph: true,
                    ..HabitatOptions::default()
                };
                let data = settings.data.as_deref().ok_or_else(|| platforms::missing_data_error("habitat"))?;
                WalkingPlatform::Habitat(Box::new(HabitatPlatform::open(
                    &stores::local_data(data)?,
                    options,
                    Arc::new(wayword_run::output::print_foreign_line),
                )?))
            }
            other => {
                let problem = format!("platform {other} has no ground on which single steps can be taken");
                let hint = "make the run with --platform house or habitat; Matterport3D's buildings are scenes of Habitat too \
                            (docs/DATA.md)";
                return Err(CommandError::usage(problem, hint));
            }
        };
        Ok(Self { kind, grounds: RecentCache::new(MAX_NAVMESHES) })
    }

    /// The platform that draws them.
    pub(crate) fn platform(&self) -> &dyn Platform {
        match &self.kind {
            WalkingPlatform::Houses(houses) => houses,
            WalkingPlatform::Habitat(scenes) => scenes.as_ref(),
        }
    }

    /// What a camera sees, which may be pitched: depths, and colours if `coloured`.
    ///
    /// # Errors
    /// When the scene does not exist, or cannot be drawn.
    pub(crate) fn render_camera(
        &self,
        scene: &SceneId,
        camera: &PinholeCamera,
        coloured: bool,
    ) -> Result<RenderedPicture, PlatformError> {
        match &self.kind {
            WalkingPlatform::Houses(houses) => houses.render_camera(scene, camera, coloured),
            WalkingPlatform::Habitat(scenes) => scenes.render_camera(scene, camera, coloured),
        }
    }

    /// How far a place on the navmesh is above the drawn floor, metres; `None` if no floor is drawn near under it.
    ///
    /// # Errors
    /// When the scene does not exist, or cannot be drawn.
    pub(crate) fn above_floor_m(&self, scene: &SceneId, place: DVec3) -> Result<Option<f64>, PlatformError> {
        // One pixel, from a height at which nothing hangs over the place.
        let camera = PinholeCamera {
            position: place + DVec3::Z * PROBE_HEIGHT_M,
            heading_rad: 0.0,
            elevation_rad: -std::f64::consts::FRAC_PI_2,
            vertical_fov_rad: 0.001,
            width: 1,
            height: 1,
        };
        let seen = self.render_camera(scene, &camera, false)?;
        let above_m = seen.depth_m.first().map_or(f64::INFINITY, |depth_m| f64::from(*depth_m)) - PROBE_HEIGHT_M;
        Ok((above_m.abs() <= MAX_ABOVE_FLOOR_M).then_some(above_m))
    }

    /// The ground of a scene.
    ///
    /// # Errors
    /// When the scene does not exist, or its files cannot be read.
    pub fn ground(&self, scene: &SceneId) -> Result<Arc<NavMeshGround>, PlatformError> {
        self.grounds.get_or_make(scene.clone(), || {
            let navmesh = match &self.kind {
                WalkingPlatform::Habitat(scenes) => scenes.navmesh(scene)?,
                WalkingPlatform::Houses(houses) => match seed_of(scene.as_str()) {
                    Some(seed) => bake_house_navmesh(&generate_house(seed))
                        .map_err(|reason| PlatformError::NotDrawn { scene: scene.clone(), reason })?,
                    // The platform has the better error for a scene that it does not have.
                    None => return houses.graph_for_scene(scene).and(Err(no_house(scene))),
                },
            };
            Ok(NavMeshGround::new(&navmesh))
        })
    }
}

fn no_house(scene: &SceneId) -> PlatformError {
    PlatformError::NotDrawn { scene: scene.clone(), reason: "it is no generated house".to_owned() }
}

/// The places on the floor under the frames of a path.
pub fn floor_positions(path: &Path) -> Vec<DVec3> {
    path.frames.iter().map(|frame| frame.pose.position - DVec3::Z * EYE_M).collect()
}

/// The navmesh of a house, baked from its surfaces as Habitat bakes them.
///
/// # Errors
/// When it cannot be baked; with the reason.
pub fn bake_house_navmesh(house: &House) -> Result<NavMesh, String> {
    let model = SceneModel { meshes: build_surfaces(house), ..SceneModel::default() };
    bake_navmesh(&model, &NavMeshSettings::default()).map_err(|error| error.to_string())
}
