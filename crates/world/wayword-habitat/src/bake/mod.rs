//! Bakes navmeshes for scenes without one, as Habitat does (`PathFinder::Impl::build`, habitat-sim 0.3.3).
//!
//! Recast's steps are: mark the voxels that triangles touch, find the free space above them, keep the parts that an agent can walk
//! on, and outline these with polygons.

mod contours;
mod voxels;

use crate::{
    axes::habitat_from_wayword,
    navmesh::{
        MAX_CORNERS, NavMesh, NavMeshSettings,
        build::{TilePiece, TileSurface, single_tile},
    },
    scene::SceneModel,
};
use glam::{UVec3, Vec3};
use rerecast::{Aabb3d, AreaType, DetailNavmesh, HeightfieldBuilder, PolygonNavmesh, SubMesh, TriMesh};
use wayword_core::contain_panics::run_decoder;

/// Most columns of voxels: 250 m x 250 m at Habitat's 5 cm.
const MAX_COLUMNS: f32 = 25e6;
/// Most voxels in one column (Recast's spans have 13 bits).
const MAX_LAYERS: f32 = 8191.0;

/// Why no navmesh can be baked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BakeError {
    /// The scene has no triangle.
    #[error("the scene has no triangles: there is nothing to walk on")]
    Empty,
    /// The scene would need too many voxels.
    #[error("the scene is {width_m:.0} x {depth_m:.0} m wide and {height_m:.0} m high: too large to bake")]
    TooLarge {
        /// Along Habitat's x.
        width_m: f32,
        /// Along its z.
        depth_m: f32,
        /// Along its y.
        height_m: f32,
    },
    /// Settings that Recast cannot work with.
    #[error("{field} is {value}: expected {wanted}")]
    Setting {
        /// Which one.
        field: &'static str,
        /// Its value.
        value: f32,
        /// The allowed values.
        wanted: &'static str,
    },
    /// Recast failed.
    #[error("the navmesh cannot be baked: {reason}")]
    Recast {
        /// Its error message.
        reason: String,
    },
}

impl BakeError {
    /// A way out of the error.
    #[must_use]
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Empty => "choose another scene",
            Self::TooLarge { .. } => {
                "give the scene a .navmesh, or if its unit is not the metre write units_to_meters into its stage_config.json"
            }
            Self::Recast { .. } => "give the scene a .navmesh, or choose another scene",
            Self::Setting { .. } => "change this setting of the navmesh",
        }
    }
}

/// Bakes the navmesh of a scene.
///
/// # Errors
/// [`BakeError`] if the scene is empty or too large, a setting is out of range, or Recast fails.
pub fn bake_navmesh(model: &SceneModel, settings: &NavMeshSettings) -> Result<NavMesh, BakeError> {
    let voxels = VoxelSettings::from_settings(settings)?;
    let mesh = trimesh_from_model(model);
    let bounds = mesh.compute_aabb().ok_or(BakeError::Empty)?;
    check_size(&bounds, settings)?;
    let recast = || voxels.build_polygons(mesh, bounds).map_err(|error| error.to_string());
    let (polygons, detail) = run_decoder(recast).map_err(|reason| BakeError::Recast { reason })?;
    Ok(single_tile(&tile_surface(&polygons, &detail), *settings))
}

/// Checks that a scene is not empty and not too large to be baked.
///
/// # Errors
/// [`BakeError`] if it is.
pub(crate) fn check_model_size(model: &SceneModel, settings: &NavMeshSettings) -> Result<(), BakeError> {
    let corners = || model.triangles().flatten().map(|corner| habitat_from_wayword(corner.as_dvec3()).as_vec3());
    let (low, high) = corners()
        .fold(None, |bounds: Option<(Vec3, Vec3)>, corner| match bounds {
            Some((low, high)) => Some((low.min(corner), high.max(corner))),
            None => Some((corner, corner)),
        })
        .ok_or(BakeError::Empty)?;
    check_size(&Aabb3d { min: low, max: high }, settings)
}

/// The settings in voxels (`rcConfig`).
struct VoxelSettings {
    settings: NavMeshSettings,
    /// Height and highest step of the agent, in heights of a voxel.
    height: u16,
    climb: u16,
    /// Radius of the agent and longest border edge, in sides of a voxel.
    radius: u16,
    max_edge: u16,
    /// Regions with fewer voxels than the first are dropped, and with fewer than the second merged into others.
    least_region: u16,
    merged_region: u16,
}

impl VoxelSettings {
    fn from_settings(settings: &NavMeshSettings) -> Result<Self, BakeError> {
        let within = |field, value: f32, low: f32, high: f32, wanted| {
            let fits = value.is_finite() && (low..=high).contains(&value);
            if fits { Ok(()) } else { Err(BakeError::Setting { field, value, wanted }) }
        };
        within("cell_size_m", settings.cell_size_m, 0.005, 10.0, "0.005 to 10 m")?;
        within("cell_height_m", settings.cell_height_m, 0.005, 10.0, "0.005 to 10 m")?;
        within("agent_height_m", settings.agent_height_m, 0.01, 100.0, "0.01 to 100 m")?;
        within("agent_radius_m", settings.agent_radius_m, 0.0, 10.0, "0 to 10 m")?;
        within("agent_max_climb_m", settings.agent_max_climb_m, 0.0, 10.0, "0 to 10 m")?;
        within("agent_max_slope_deg", settings.agent_max_slope_deg, 0.0, 89.0, "0 to 89 degrees")?;
        within("region_min_size", settings.region_min_size, 0.0, 255.0, "0 to 255")?;
        within("region_merge_size", settings.region_merge_size, 0.0, 255.0, "0 to 255")?;
        within("verts_per_poly", settings.verts_per_poly, 3.0, MAX_CORNERS as f32, "3 to 6")?;
        // Casts saturate.
        Ok(Self {
            settings: *settings,
            height: (settings.agent_height_m / settings.cell_height_m).ceil() as u16,
            climb: (settings.agent_max_climb_m / settings.cell_height_m).floor() as u16,
            radius: (settings.agent_radius_m / settings.cell_size_m).ceil() as u16,
            max_edge: (settings.edge_max_len / settings.cell_size_m) as u16,
            least_region: (settings.region_min_size * settings.region_min_size) as u16,
            merged_region: (settings.region_merge_size * settings.region_merge_size) as u16,
        })
    }

    /// Recast's steps, in the order in which Habitat takes them.
    fn build_polygons(
        &self,
        mut mesh: TriMesh,
        aabb: Aabb3d,
    ) -> Result<(PolygonNavmesh, DetailNavmesh), Box<dyn std::error::Error>> {
        let settings = &self.settings;
        mesh.mark_walkable_triangles(settings.agent_max_slope_deg.to_radians());
        let (cell_size, cell_height) = (settings.cell_size_m, settings.cell_height_m);
        let mut solid = HeightfieldBuilder { aabb, cell_size, cell_height }.build()?;
        voxels::fill_voxels(&mut solid, &mesh, self.climb)?;
        let [obstacles, ledges, ceilings, _] = settings.switches.map(|switch| switch != 0);
        if obstacles {
            solid.filter_low_hanging_walkable_obstacles(self.climb);
        }
        if ledges {
            solid.filter_ledge_spans(self.height, self.climb);
        }
        if ceilings {
            solid.filter_walkable_low_height_spans(self.height);
        }
        let mut open = solid.into_compact(self.height, self.climb)?;
        open.erode_walkable_area(self.radius);
        open.build_distance_field();
        open.build_regions(0, self.least_region, self.merged_region)?;
        let polygons = contours::polygons_from_regions(&open, self)?;
        // Habitat takes a distance below 0.9 cells as none.
        let sample_m = if settings.detail_sample_dist < 0.9 { 0.0 } else { cell_size * settings.detail_sample_dist };
        let detail = DetailNavmesh::new(&polygons, &open, sample_m, cell_height * settings.detail_sample_max_error)?;
        Ok((polygons, detail))
    }
}

/// A model's triangles in Habitat's frame.
fn trimesh_from_model(model: &SceneModel) -> TriMesh {
    let mut mesh = TriMesh::default();
    for triangle in model.triangles() {
        let first = mesh.vertices.len() as u32;
        mesh.vertices.extend(triangle.map(|corner| habitat_from_wayword(corner.as_dvec3()).as_vec3().to_vec3a()));
        mesh.indices.push(UVec3::new(first, first + 1, first + 2));
        mesh.area_types.push(AreaType::NOT_WALKABLE);
    }
    mesh
}

/// Returns an error for a scene that would need too many voxels.
fn check_size(bounds: &Aabb3d, settings: &NavMeshSettings) -> Result<(), BakeError> {
    let size = bounds.max - bounds.min;
    let (across, along) = (size.x / settings.cell_size_m, size.z / settings.cell_size_m);
    let fits = across * along <= MAX_COLUMNS
        && across.max(along) < f32::from(u16::MAX)
        && size.y / settings.cell_height_m <= MAX_LAYERS;
    // A size that is not a number does not fit.
    if fits { Ok(()) } else { Err(BakeError::TooLarge { width_m: size.x, depth_m: size.z, height_m: size.y }) }
}

/// Recast's polygons in Detour's form.
fn tile_surface(polygons: &PolygonNavmesh, detail: &DetailNavmesh) -> TileSurface {
    let low = polygons.aabb.min;
    let place = |vertex: &glam::U16Vec3| {
        let steps = vertex.as_vec3() * Vec3::new(polygons.cell_size, polygons.cell_height, polygons.cell_size);
        (low + steps).to_array()
    };
    let width = usize::from(polygons.max_vertices_per_polygon).max(1);
    let rows = polygons.polygons.chunks_exact(width).zip(polygons.polygon_neighbors.chunks_exact(width));
    let pieces = rows.zip(&detail.meshes).map(|((corners, neighbours), mesh)| {
        let corners: Vec<u16> =
            corners.iter().copied().take_while(|corner| *corner != PolygonNavmesh::NO_INDEX).collect();
        let behind = |neighbour: &u16| match *neighbour {
            PolygonNavmesh::NO_CONNECTION => 0,
            other => other.wrapping_add(1),
        };
        let neighbours = neighbours.iter().take(corners.len()).map(behind).collect();
        let (detail_verts, detail_tris) = detail_for_polygon(detail, mesh, corners.len());
        TilePiece { corners, neighbours, detail_verts, detail_tris }
    });
    TileSurface {
        verts: polygons.vertices.iter().map(place).collect(),
        pieces: pieces.collect(),
        low_m: low.to_array(),
        high_m: polygons.aabb.max.to_array(),
    }
}

/// The detail mesh of a polygon: its additional vertices after the polygon's own corners, and triangles with their flags.
fn detail_for_polygon(detail: &DetailNavmesh, mesh: &SubMesh, corners: usize) -> (Vec<[f32; 3]>, Vec<[u8; 4]>) {
    let first = mesh.base_vertex_index as usize + corners;
    let end = mesh.base_vertex_index as usize + mesh.vertex_count as usize;
    let verts = detail.vertices.get(first..end).unwrap_or_default().iter().map(|vertex| vertex.to_array()).collect();
    let range = mesh.base_triangle_index as usize..(mesh.base_triangle_index + mesh.triangle_count) as usize;
    let triangles = detail.triangles.get(range.clone()).unwrap_or_default();
    let flags = detail.triangle_flags.get(range).unwrap_or_default();
    (verts, triangles.iter().zip(flags).map(|([a, b, c], flag)| [*a, *b, *c, *flag]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NavMeshGround;
    use wayword_core::DVec3;
    use wayword_render::Mesh;

    /// A floor of 6 x 4 m with a block of 2 x 1 m in its middle; `block_m` is the height of the block.
    fn room(block_m: f32) -> SceneModel {
        let mut mesh = Mesh::default();
        let mut quad = |corners: [[f32; 3]; 4]| {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(corners.map(Vec3::from));
            mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        };
        quad([[0.0, 0.0, 0.0], [6.0, 0.0, 0.0], [6.0, 4.0, 0.0], [0.0, 4.0, 0.0]]);
        let (low, high) = ([2.0, 1.5], [4.0, 2.5]);
        let corners = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]];
        quad(corners.map(|[x, y]| [x, y, block_m]));
        for side in 0..4 {
            let ([ax, ay], [bx, by]) = (corners[side], corners[(side + 1) % 4]);
            quad([[ax, ay, 0.0], [bx, by, 0.0], [bx, by, block_m], [ax, ay, block_m]]);
        }
        SceneModel { meshes: vec![mesh], ..SceneModel::default() }
    }

    #[test]
    fn a_block_is_walked_around_and_the_file_reads_back() {
        let mesh = bake_navmesh(&room(0.8), &NavMeshSettings::default()).unwrap();
        assert_eq!(NavMesh::from_bytes(&mesh.to_bytes()).unwrap(), mesh);
        let ground = NavMeshGround::new(&mesh);
        let islands: Vec<f64> = ground.islands_m2().collect();
        // The floor without a border of one voxel for the ledge and two for the agent's radius, and the same around the
        // block.
        let floor_m2 = 5.7 * 3.7 - 2.3 * 1.3;
        assert!((islands[0] / floor_m2 - 1.0).abs() < 0.03, "{islands:?}");
        let way = ground.geodesic(DVec3::new(1.0, 2.0, 0.0), DVec3::new(5.0, 2.1, 0.0)).unwrap();
        let bends = &way.corners[1..way.corners.len() - 1];
        assert!(!bends.is_empty() && bends.iter().all(|bend| bend.y > 2.5), "{way:?}");
        assert!((4.1..4.5).contains(&way.length_m), "{way:?}");
    }

    #[test]
    fn bake_reports_why_a_scene_cannot_be_baked() {
        assert_eq!(bake_navmesh(&SceneModel::default(), &NavMeshSettings::default()), Err(BakeError::Empty));
        let mut wide = room(0.8);
        wide.meshes[0].positions[1].x = 9e5;
        let too_large = bake_navmesh(&wide, &NavMeshSettings::default()).unwrap_err();
        assert!(matches!(too_large, BakeError::TooLarge { .. }) && too_large.hint().contains(".navmesh"));
        let coarse = NavMeshSettings { cell_size_m: 0.0, ..NavMeshSettings::default() };
        assert_eq!(
            bake_navmesh(&room(0.8), &coarse).unwrap_err().to_string(),
            "cell_size_m is 0: expected 0.005 to 10 m"
        );
    }
}
