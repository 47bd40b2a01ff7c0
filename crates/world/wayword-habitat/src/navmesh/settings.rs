//! The settings that a navmesh was baked with: 56 bytes of a version 2 file.

use super::{cursor::NavMeshCursor, error::NavMeshError};

/// Habitat's `NavMeshSettings` (habitat-sim 0.3.3, `PathFinder.h`), in the order of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NavMeshSettings {
    /// Horizontal side of a voxel, metres.
    pub cell_size_m: f32,
    /// Height of a voxel, metres.
    pub cell_height_m: f32,
    /// Height that an agent needs above the ground, metres.
    pub agent_height_m: f32,
    /// Distance that it keeps from walls, metres.
    pub agent_radius_m: f32,
    /// Highest step that it takes, metres.
    pub agent_max_climb_m: f32,
    /// Steepest ground that it walks, degrees.
    pub agent_max_slope_deg: f32,
    /// Regions with fewer cells than this squared are dropped.
    pub region_min_size: f32,
    /// Regions with fewer cells than this squared are merged into others where possible.
    pub region_merge_size: f32,
    /// Longest edge along the border, metres (as in Habitat; Recast has voxels).
    pub edge_max_len: f32,
    /// How far a simplified border may lie off the true one, cells.
    pub edge_max_error: f32,
    /// Most corners of a polygon.
    pub verts_per_poly: f32,
    /// Distance between samples of the height, in cells.
    pub detail_sample_dist: f32,
    /// How far the surface may lie off those heights, in units of the cell height.
    pub detail_sample_max_error: f32,
    /// Four switches: filter low hanging obstacles, ledges and low ceilings; include static objects. Older writers
    /// leave the last byte unset.
    pub switches: [u8; 4],
}

impl Default for NavMeshSettings {
    /// `NavMeshSettings::setDefaults`.
    fn default() -> Self {
        Self {
            cell_size_m: 0.05,
            cell_height_m: 0.2,
            agent_height_m: 1.5,
            agent_radius_m: 0.1,
            agent_max_climb_m: 0.2,
            agent_max_slope_deg: 45.0,
            region_min_size: 20.0,
            region_merge_size: 20.0,
            edge_max_len: 12.0,
            edge_max_error: 1.3,
            verts_per_poly: 6.0,
            detail_sample_dist: 6.0,
            detail_sample_max_error: 1.0,
            switches: [1, 1, 1, 0],
        }
    }
}

impl NavMeshSettings {
    pub(super) fn read(cursor: &mut NavMeshCursor<'_>) -> Result<Self, NavMeshError> {
        let mut numbers = [0.0; 13];
        for number in &mut numbers {
            *number = cursor.read_f32("a number of the settings")?;
        }
        let mut switches = [0; 4];
        switches.copy_from_slice(cursor.take_bytes(4, "the switches of the settings")?);
        let [
            cell_size_m,
            cell_height_m,
            agent_height_m,
            agent_radius_m,
            agent_max_climb_m,
            agent_max_slope_deg,
            region_min_size,
            region_merge_size,
            edge_max_len,
            edge_max_error,
            verts_per_poly,
            detail_sample_dist,
            detail_sample_max_error,
        ] = numbers;
        Ok(Self {
            cell_size_m,
            cell_height_m,
            agent_height_m,
            agent_radius_m,
            agent_max_climb_m,
            agent_max_slope_deg,
            region_min_size,
            region_merge_size,
            edge_max_len,
            edge_max_error,
            verts_per_poly,
            detail_sample_dist,
            detail_sample_max_error,
            switches,
        })
    }

    pub(super) fn write(&self, out: &mut Vec<u8>) {
        let numbers = [
            self.cell_size_m,
            self.cell_height_m,
            self.agent_height_m,
            self.agent_radius_m,
            self.agent_max_climb_m,
            self.agent_max_slope_deg,
            self.region_min_size,
            self.region_merge_size,
            self.edge_max_len,
            self.edge_max_error,
            self.verts_per_poly,
            self.detail_sample_dist,
            self.detail_sample_max_error,
        ];
        out.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        out.extend_from_slice(&self.switches);
    }
}
