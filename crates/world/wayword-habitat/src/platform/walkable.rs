//! The ground of a scene for paths: its navmesh, and the island that paths stay on.

use super::{
    HabitatOptions,
    files::StageFiles,
    islands::{self, IslandChoice, IslandSurvey},
};
use crate::{
    axes::EYE_M,
    bake::bake_navmesh,
    file_error::{self, FileError},
    ground::{NavMeshGround, viewpoint_graph},
    navmesh::{NavMesh, NavMeshSettings},
    placement::judge_placement,
    scene::{HabitatStage, SceneModel},
    triangle_columns::TriangleColumns,
};
use wayword_core::{DVec3, GroundIsland, GroundRoute, PlatformError, ViewpointGraph, graph::GraphError};

/// Largest navmesh file that is read, bytes; a larger one is an error.
const MAX_NAVMESH_BYTES: u64 = 1 << 30;
const NAVMESH_HINT: &str = "remove the file, and a navmesh is baked from the scene instead";
const NAVMESH_LIES_HINT: &str =
    "give the scene its own navmesh, or write up, front and units_to_meters into a stage_config.json beside the scene";
/// Least share of a navmesh that lies on a surface of its scene.
const MIN_SURFACE_SHARE: f64 = 0.5;
const ISLAND_HINT: &str = "choose an existing island with --island, or give the scene a .navmesh of its rooms";

/// The ground of a scene.
pub(super) struct WalkableGround {
    pub(super) navmesh: NavMesh,
    pub(super) ground: NavMeshGround,
    /// The scene's triangles, to find ceilings.
    columns: TriangleColumns,
    /// The examined islands.
    surveys: Vec<IslandSurvey>,
    /// Whether the user may prefer another island to the chosen one.
    is_doubtful: bool,
}

/// The navmesh of a scene, from its file or baked.
pub(super) fn read_or_bake_navmesh(
    model: &SceneModel,
    stage: &HabitatStage,
    files: &StageFiles,
    options: &HabitatOptions,
) -> Result<NavMesh, FileError> {
    match options.navmesh.clone().or_else(|| files.navmesh_file(stage)) {
        Some(file) => {
            let bytes = file_error::read_bytes(&file, MAX_NAVMESH_BYTES, NAVMESH_HINT)?;
            NavMesh::from_bytes(&bytes).map_err(|error| FileError::new(&file, error.to_string(), NAVMESH_HINT))
        }
        None => bake_navmesh(model, &NavMeshSettings::default())
            .map_err(|error| FileError::new(&stage.asset, error.to_string(), error.hint())),
    }
}

impl WalkableGround {
    /// Reads or bakes the navmesh of a scene, and chooses the island for its paths.
    pub(super) fn from_files(
        model: &SceneModel,
        stage: &HabitatStage,
        files: &StageFiles,
        options: &HabitatOptions,
    ) -> Result<Self, PlatformError> {
        let columns = TriangleColumns::new(model.triangles());
        let navmesh = read_or_bake_navmesh(model, stage, files, options)?;
        let ground = NavMeshGround::new(&navmesh);
        check_navmesh_lies(&ground, &columns, model, stage)?;
        let surveys = islands::survey_islands(&ground, &columns);
        let IslandChoice { number, is_doubtful } = resolve_island(&ground, &surveys, options, stage)?;
        Ok(Self { navmesh, ground: ground.keeping_to(number), columns, surveys, is_doubtful })
    }

    /// The warning to print if the user may prefer another island to the chosen one.
    pub(super) fn island_doubt(&self) -> Option<String> {
        self.is_doubtful.then(|| {
            let listed = islands::list_islands(&self.surveys);
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
    pub(super) fn islands(&self) -> Vec<GroundIsland> {
        self.surveys.iter().map(|survey| survey.ground_island(Some(self.ground.main()))).collect()
    }

    /// The shortest way over the ground between two eyes.
    pub(super) fn way_between(&self, from: DVec3, to: DVec3) -> Option<GroundRoute> {
        let feet = |eye: DVec3| eye - DVec3::Z * EYE_M;
        self.ground.geodesic(feet(from), feet(to)).ok()
    }

    /// Whether there is ground under an eye.
    pub(super) fn has_ground_under(&self, eye: DVec3) -> bool {
        self.ground.nearest_foothold(eye - DVec3::Z * EYE_M).is_some()
    }

    /// Whether a person can stand upright at a place on the ground.
    pub(super) fn has_headroom(&self, ground: DVec3) -> bool {
        self.columns.cover_over(ground).is_headroom()
    }
}

/// Returns an error for a navmesh that does not lie on the surfaces of its scene, where the scene's own floors show that its axes
/// or its unit are others.
fn check_navmesh_lies(
    ground: &NavMeshGround,
    columns: &TriangleColumns,
    model: &SceneModel,
    stage: &HabitatStage,
) -> Result<(), FileError> {
    let share = islands::share_on_surfaces(ground, columns);
    if share >= MIN_SURFACE_SHARE {
        return Ok(());
    }
    let Some(note) = judge_placement(model, stage).ok().and_then(|placement| placement.note) else { return Ok(()) };
    let reason = format!(
        "only {:.0} % of its navmesh lie on a surface of the scene as it is read; by the scene's own floors {note}",
        100.0 * share
    );
    Err(FileError::new(&stage.asset, reason, NAVMESH_LIES_HINT))
}

/// The island that paths stay on: the user's choice, else the one on which people would walk.
fn resolve_island(
    ground: &NavMeshGround,
    surveys: &[IslandSurvey],
    options: &HabitatOptions,
    stage: &HabitatStage,
) -> Result<IslandChoice, PlatformError> {
    let refused = |reason: String| FileError::new(&stage.asset, reason, ISLAND_HINT).into();
    match options.island {
        Some(number) if number < ground.islands_m2().count() => Ok(IslandChoice { number, is_doubtful: false }),
        Some(number) => Err(refused(format!("its navmesh has no island {number}: {}", islands::list_islands(surveys)))),
        None => islands::choose_island(surveys).ok_or_else(|| {
            let listed = islands::list_islands(surveys);
            refused(format!("no island of its navmesh is a place to walk on, indoors or under the open sky: {listed}"))
        }),
    }
}
