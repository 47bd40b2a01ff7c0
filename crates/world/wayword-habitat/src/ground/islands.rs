//! Finds the connected parts of the ground by a search over shared edges.

use super::{NavMeshIsland, polygon::GroundPolygon};
use std::sync::OnceLock;

/// The islands, the largest first; sets the island of every polygon.
pub(super) fn find_islands(polygons: &mut [GroundPolygon]) -> Vec<NavMeshIsland> {
    let mut islands: Vec<NavMeshIsland> = Vec::new();
    let mut seen = vec![false; polygons.len()];
    for start in 0..polygons.len() {
        if seen[start] || !polygons[start].is_walkable {
            continue;
        }
        let mut members = vec![start];
        seen[start] = true;
        let mut next = 0;
        while let Some(&polygon) = members.get(next) {
            next += 1;
            for neighbour in polygons[polygon].neighbours() {
                if polygons[neighbour].is_walkable && !std::mem::replace(&mut seen[neighbour], true) {
                    members.push(neighbour);
                }
            }
        }
        members.sort_unstable();
        let area_m2 = members.iter().map(|polygon| polygons[*polygon].area_m2).sum();
        islands.push(NavMeshIsland { polygons: members, area_m2, search_mesh: OnceLock::new() });
    }
    islands.sort_by(|a, b| b.area_m2.total_cmp(&a.area_m2));
    for (number, island) in islands.iter().enumerate() {
        for polygon in &island.polygons {
            polygons[*polygon].island = number;
        }
    }
    islands
}
