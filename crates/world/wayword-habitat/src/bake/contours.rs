//! Turns the regions of a baked navmesh into polygons, and repairs contours that cannot be cut into triangles.

use super::VoxelSettings;
use rerecast::{BuildContoursFlags, CompactHeightfield, Contour, ContourSet, PolygonNavmesh};

/// Fractions of the allowed error of simplified borders, tried in turn for contours that the full error makes unusable.
const FINER_ERROR_SHARES: [f32; 3] = [0.5, 0.25, 0.0];

/// The polygons of all regions. Simplifying a border can make it cross itself. Recast then warns and keeps the
/// triangles that it has cut so far (`rcBuildPolyMesh`), but rerecast gives up. This function simplifies such a contour
/// less. The edges to other regions stay the same, because those are never simplified. If even the full contour fails, it
/// is dropped.
pub(super) fn polygons_from_regions(
    open: &CompactHeightfield,
    voxels: &VoxelSettings,
) -> Result<PolygonNavmesh, Box<dyn std::error::Error>> {
    let settings = &voxels.settings;
    let corners = settings.verts_per_poly as u16;
    let build = |share: f32| {
        let flags = BuildContoursFlags::TESSELLATE_SOLID_WALL_EDGES;
        open.build_contours(settings.edge_max_error * share, voxels.max_edge, flags)
    };
    let mut set = build(1.0);
    if let Ok(polygons) = set.clone().into_polygon_mesh(corners) {
        return Ok(polygons);
    }
    let finer = FINER_ERROR_SHARES.map(build);
    let contours = std::mem::take(&mut set.contours);
    let is_sound = |contour: &Contour| single_contour_set(&set, contour).into_polygon_mesh(corners).is_ok();
    let mended = contours.into_iter().enumerate().filter_map(|(at, contour)| {
        if is_sound(&contour) {
            return Some(contour);
        }
        let others = finer.iter().filter_map(|set| set.contours.get(at));
        others.filter(|other| other.region == contour.region).find(|other| is_sound(other)).cloned()
    });
    let contours = mended.collect();
    set.contours = contours;
    Ok(set.into_polygon_mesh(corners)?)
}

/// A contour set with only this contour.
fn single_contour_set(set: &ContourSet, contour: &Contour) -> ContourSet {
    ContourSet { contours: vec![contour.clone()], ..set.clone() }
}
