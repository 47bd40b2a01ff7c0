//! Scenes with walkable ground, in which an agent can take single steps: generated houses and Habitat's scenes, each with its navmesh.

use std::sync::Arc;
use wayword_core::{DVec3, Frame, Gaze, Heading, Image, Path, Platform, PlatformError, Pose, Recent, SceneId};
use wayword_habitat::{
    Ground, HabitatOptions, HabitatPlatform, NavMesh, NavMeshSettings, axes::EYE_M, bake::bake, scene::Model,
};
use wayword_house::{House, HouseOptions, HousePlatform, generate, seed_of, surfaces};
use wayword_run::{error::Error, platforms, settings::Settings, stores};

/// Navmeshes that are kept in memory.
const READY: usize = 6;

/// The scenes of a run, with their ground.
pub struct Scenes {
    kind: Kind,
    grounds: Recent<SceneId, Ground>,
}

enum Kind {
    Houses(HousePlatform),
    Habitat(Box<HabitatPlatform>),
}

impl Scenes {
    /// Generated houses; their pictures get this size in pixels.
    pub fn houses([width_px, height_px]: [u32; 2]) -> Self {
        let houses = HousePlatform::new(HouseOptions { width_px, height_px, ..HouseOptions::default() });
        Self { kind: Kind::Houses(houses), grounds: Recent::new(READY) }
    }

    /// The scenes of a run; their pictures get this size in pixels.
    ///
    /// # Errors
    /// When the run's platform has no navmeshes, or its data cannot be opened.
    pub(crate) fn open(settings: &Settings, [width_px, height_px]: [u32; 2]) -> Result<Self, Error> {
        let kind = match settings.platform.as_str() {
            "house" => return Ok(Self::houses([width_px, height_px])),
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
                let data = settings.data.as_deref().ok_or_else(|| platforms::no_data("habitat"))?;
                Kind::Habitat(Box::new(HabitatPlatform::open(
                    &stores::local(data)?,
                    options,
                    Arc::new(wayword_run::output::pass_on),
                )?))
            }
            other => {
                let problem = format!("platform {other} has no ground on which single steps can be taken");
                let hint = "make the run with --platform house or habitat; Matterport3D's buildings are scenes of Habitat too \
                            (docs/DATA.md)";
                return Err(Error::usage(problem, hint));
            }
        };
        Ok(Self { kind, grounds: Recent::new(READY) })
    }

    /// The platform that draws them.
    pub(crate) fn platform(&self) -> &dyn Platform {
        match &self.kind {
            Kind::Houses(houses) => houses,
            Kind::Habitat(scenes) => scenes.as_ref(),
        }
    }

    /// The picture that an agent sees from a place on the floor, looking along a heading. `eye_m` is the height of its eye.
    ///
    /// # Errors
    /// When the scene does not exist, or cannot be drawn.
    pub(crate) fn picture(
        &self,
        scene: &SceneId,
        (floor, heading): (DVec3, Heading),
        eye_m: f64,
        horizontal_fov_rad: f64,
    ) -> Result<Arc<Image>, PlatformError> {
        let from = Frame { pose: Pose::level(floor + DVec3::Z * eye_m, heading), viewpoint: None, level: None };
        let view = self.platform().look(scene, &from, Gaze { heading, horizontal_fov_rad })?;
        view.image.ok_or_else(|| PlatformError::NotDrawn { scene: scene.clone(), reason: "it has no picture".into() })
    }

    /// The ground of a scene.
    ///
    /// # Errors
    /// When the scene does not exist, or its files cannot be read.
    pub fn ground(&self, scene: &SceneId) -> Result<Arc<Ground>, PlatformError> {
        self.grounds.get_or_make(scene.clone(), || {
            let navmesh = match &self.kind {
                Kind::Habitat(scenes) => scenes.navmesh(scene)?,
                Kind::Houses(houses) => match seed_of(scene.as_str()) {
                    Some(seed) => navmesh(&generate(seed))
                        .map_err(|reason| PlatformError::NotDrawn { scene: scene.clone(), reason })?,
                    // The platform has the better error for a scene that it does not have.
                    None => return houses.graph(scene).and(Err(no_house(scene))),
                },
            };
            Ok(Ground::new(&navmesh))
        })
    }
}

fn no_house(scene: &SceneId) -> PlatformError {
    PlatformError::NotDrawn { scene: scene.clone(), reason: "it is no generated house".to_owned() }
}

/// The places on the floor under the frames of a path.
pub fn feet(path: &Path) -> Vec<DVec3> {
    path.frames.iter().map(|frame| frame.pose.position - DVec3::Z * EYE_M).collect()
}

/// The navmesh of a house, baked from its surfaces as Habitat bakes them.
///
/// # Errors
/// When it cannot be baked; with the reason.
pub fn navmesh(house: &House) -> Result<NavMesh, String> {
    let model = Model { meshes: surfaces(house), ..Model::default() };
    bake(&model, &NavMeshSettings::default()).map_err(|error| error.to_string())
}
