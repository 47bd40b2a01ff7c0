//! Joins tiles: finds the edges on a tile's side that lie along edges of the neighbouring tile, and enters a portal at
//! both (`dtNavMesh::connectExtLinks`).

use super::polygon::{EdgePortal, GroundPolygon, wayword_place};
use crate::navmesh::{EdgeNeighbour, NavMesh};
use std::collections::BTreeMap;
use wayword_core::DVec3;

/// Least length that two edges must share for a portal, metres.
const MIN_SHARED_LENGTH_M: f64 = 0.02;
/// How far the sides of two tiles may lie apart, metres.
const MAX_SIDE_GAP_M: f64 = 0.01;
/// Most portals in one edge; further ones are not entered. Detour allows four. Without a limit, every one of many edges at the
/// same place would be joined with every other.
const MAX_PORTALS_PER_EDGE: usize = 32;

/// An edge on a side of a tile, where a portal may be.
#[derive(Debug)]
struct TileOpening {
    polygon: usize,
    /// Index of the corner at which the edge begins.
    corner: usize,
    ends: [DVec3; 2],
    /// The axis along which one crosses the side: 0 for Habitat's x, 1 for its z.
    axis: usize,
}

/// Finds the portals between neighbouring tiles, and enters each on both sides.
pub(super) fn open_portals(mesh: &NavMesh, polygons: &mut [GroundPolygon], climb_m: f64) {
    // Keyed by the tile's place and the side: 0 is +x, 2 is +z, 4 is -x, 6 is -z.
    let mut sides: BTreeMap<([i32; 2], u8), Vec<TileOpening>> = BTreeMap::new();
    let mut first = 0;
    for tile in &mesh.tiles {
        let [x, z, _] = tile.header.place;
        for (index, poly) in tile.polys.iter().enumerate() {
            for edge in 0..poly.corners().len() {
                let EdgeNeighbour::Portal(side) = poly.neighbour_behind(edge) else { continue };
                let place = |corner: usize| wayword_place(tile.verts[usize::from(poly.corners()[corner])]);
                let ends = [place(edge), place((edge + 1) % poly.corners().len())];
                let corner = polygons[first + index].corners.iter().position(|corner| ends.contains(&corner.place));
                let Some(corner) = corner.and_then(|_| find_edge(&polygons[first + index], ends)) else { continue };
                let axis = usize::from(side == 2 || side == 6);
                let opening = TileOpening { polygon: first + index, corner, ends, axis };
                sides.entry(([x, z], side)).or_default().push(opening);
            }
        }
        first += tile.polys.len();
    }
    for ((place, side), openings) in &sides {
        let (beside, opposite) = match side {
            0 => (place[0].checked_add(1).map(|x| [x, place[1]]), 4),
            2 => (place[1].checked_add(1).map(|z| [place[0], z]), 6),
            // The other two sides are handled from the neighbouring tile.
            _ => continue,
        };
        let Some(others) = beside.and_then(|beside| sides.get(&(beside, opposite))) else { continue };
        for one in openings {
            for other in others {
                join_openings(polygons, one, other, climb_m);
            }
        }
    }
}

/// The corner at which the edge with these ends begins, whatever their order.
fn find_edge(polygon: &GroundPolygon, ends: [DVec3; 2]) -> Option<usize> {
    polygon.edges().position(|(a, b)| ends == [a.place, b.place] || ends == [b.place, a.place])
}

/// Enters a portal at two openings, if they lie along each other at about the same height.
fn join_openings(polygons: &mut [GroundPolygon], one: &TileOpening, other: &TileOpening, climb_m: f64) {
    // Wayword's x is Habitat's x, and Wayword's y is Habitat's -z. The side runs along the axis that does not cross it.
    let across = |place: DVec3| if one.axis == 0 { place.x } else { place.y };
    let along = |place: DVec3| if one.axis == 0 { place.y } else { place.x };
    if (across(one.ends[0]) - across(other.ends[0])).abs() > MAX_SIDE_GAP_M {
        return;
    }
    let span = |opening: &TileOpening| {
        let [a, b] = opening.ends.map(along);
        (a.min(b), a.max(b))
    };
    let (a, b) = (span(one), span(other));
    let (low, high) = (a.0.max(b.0), a.1.min(b.1));
    if high - low < MIN_SHARED_LENGTH_M {
        return;
    }
    let height = |opening: &TileOpening, at: f64| {
        let [from, to] = opening.ends;
        let length = along(to) - along(from);
        from.z + (to.z - from.z) * ((at - along(from)) / length)
    };
    // Within twice the climb of one another at an end, or crossing in between (`overlapSlabs`).
    let gap = |at: f64| height(one, at) - height(other, at);
    let (at_low, at_high) = (gap(low), gap(high));
    let near = at_low.abs() <= 2.0 * climb_m || at_high.abs() <= 2.0 * climb_m || at_low * at_high < 0.0;
    if !near {
        return;
    }
    let portal_count = |opening: &TileOpening| polygons[opening.polygon].corners[opening.corner].portals.len();
    if portal_count(one) >= MAX_PORTALS_PER_EDGE || portal_count(other) >= MAX_PORTALS_PER_EDGE {
        return;
    }
    for (opening, beyond) in [(one, other), (other, one)] {
        let corners = &mut polygons[opening.polygon].corners;
        let (start, next) = (corners[opening.corner].place, corners[(opening.corner + 1) % corners.len()].place);
        let share = |at: f64| ((at - along(start)) / (along(next) - along(start))).clamp(0.0, 1.0);
        let (from, to) = (share(low).min(share(high)), share(low).max(share(high)));
        corners[opening.corner].portals.push(EdgePortal { polygon: beyond.polygon, from, to });
    }
}
