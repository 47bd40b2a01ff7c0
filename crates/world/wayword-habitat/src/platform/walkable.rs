//! The ground of a scene for paths: its navmesh, and the island that paths stay on.

use super::{
    HabitatOptions,
    files::SceneFiles,
    islands::{self, Choice, Survey},
};
use crate::{
    axes::EYE_M,
    bake::bake,
    columns::Columns,
    fault::{self, FileError},
    ground::{Ground, viewpoint_graph},
    navmesh::{NavMesh, NavMeshSettings},
    scene::{Model, Stage},
};
use wayword_core::{DVec3, Island, PlatformError, ViewpointGraph, Way, graph::GraphError};

const MAX_NAVMESH: u64 = 1 << 30;
const NAVMESH_HINT: &str = "remove the file, and a navmesh is baked from the scene instead";
const ISLAND_HINT: &str = "choose an existing island with --island, or give the scene a .navmesh of its rooms";

/// The ground of a scene.
pub(super) struct Walkable {
    pub(super) navmesh: NavMesh,
    pub(super) ground: Ground,
    columns: Columns,
    surveys: Vec<Survey>,
    /// Whether the user may prefer another island to the chosen one.
    is_doubtful: bool,
}

/// The navmesh of a scene, from its file or baked.
pub(super) fn navmesh(
    model: &Model,
    stage: &Stage,
    files: &SceneFiles,
    options: &HabitatOptions,
) -> Result<NavMesh, FileError> {
    match options.navmesh.clone().or_else(|| files.navmesh(stage)) {
        Some(file) => {
            let bytes = fault::bytes(&file, MAX_NAVMESH, NAVMESH_HINT)?;
            NavMesh::from_bytes(&bytes).map_err(|error| FileError::new(&file, error.to_string(), NAVMESH_HINT))
        }
        None => bake(model, &NavMeshSettings::default())
            .map_err(|error| FileError::new(&stage.asset, error.to_string(), error.hint())),
    }
}

impl Walkable {
    pub(super) fn of(
        model: &Model,
        stage: &Stage,
        files: &SceneFiles,
        options: &HabitatOptions,
    ) -> Result<Self, PlatformError> {
        let columns = Columns::new(model.triangles());
        let navmesh = navmesh(model, stage, files, options)?;
        let ground = Ground::new(&navmesh);
        let surveys = islands::survey(&ground, &columns);
        let Choice { number, is_doubtful } = island(&ground, &surveys, options, stage)?;
        Ok(Self { navmesh, ground: ground.keeping_to(number), columns, surveys, is_doubtful })
    }

    /// The warning to print if the user may prefer another island to the chosen one.
    pub(super) fn doubt(&self) -> Option<String> {
        self.is_doubtful.then(|| {
            let listed = islands::listed(&self.surveys);
            format!(
                "paths stay on island {} of its navmesh; to choose another, use --island ({listed})",
                self.ground.main()
            )
        })
    }

    /// The viewpoint graph of the island that paths stay on.
    pub(super) fn viewpoint_graph(&self) -> Result<ViewpointGraph, GraphError> {
        viewpoint_graph(&self.ground, self.ground.main())
    }

    /// The islands of the navmesh, the largest first.
    pub(super) fn islands(&self) -> Vec<Island> {
        self.surveys.iter().map(|survey| survey.told(Some(self.ground.main()))).collect()
    }

    /// The shortest way over the ground between two eyes.
    pub(super) fn way(&self, from: DVec3, to: DVec3) -> Option<Way> {
        let feet = |eye: DVec3| eye - DVec3::Z * EYE_M;
        self.ground.geodesic(feet(from), feet(to)).ok()
    }

    /// Whether there is ground under an eye.
    pub(super) fn is_under(&self, eye: DVec3) -> bool {
        self.ground.nearest(eye - DVec3::Z * EYE_M).is_some()
    }

    /// Whether a person can stand upright at a place on the ground.
    pub(super) fn is_headroom(&self, ground: DVec3) -> bool {
        self.columns.over(ground).is_headroom()
    }
}

/// The island that paths stay on: the user's choice, else the one on which people would walk.
fn island(
    ground: &Ground,
    surveys: &[Survey],
    options: &HabitatOptions,
    stage: &Stage,
) -> Result<Choice, PlatformError> {
    let refused = |reason: String| FileError::new(&stage.asset, reason, ISLAND_HINT).into();
    match options.island {
        Some(number) if number < ground.islands_m2().count() => Ok(Choice { number, is_doubtful: false }),
        Some(number) => Err(refused(format!("its navmesh has no island {number}: {}", islands::listed(surveys)))),
        None => islands::choose(surveys).ok_or_else(|| {
            let listed = islands::listed(surveys);
            refused(format!("no island of its navmesh is a place to walk on, indoors or under the open sky: {listed}"))
        }),
    }
}
