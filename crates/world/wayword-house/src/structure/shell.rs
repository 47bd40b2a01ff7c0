//! Builds the inside of a room: floor, ceiling, and walls with holes for doors and windows.

use super::super::{
    model::{CEILING_CM, FloorFinish, HALF_WALL_CM, House, RoomKind},
    rect::{RectCm, SpanCm, WallSide},
    shapes::HouseShape,
    surface::{HouseSurface, SurfacePattern},
};
use super::{point_on_wall, to_metres};
use glam::{Vec2, Vec3};

/// Height of the skirting board, centimetres.
const SKIRTING_CM: i32 = 9;

/// Up to which height the walls of a room are tiled, centimetres.
fn tiled_height_cm(kind: RoomKind) -> i32 {
    if kind == RoomKind::Bathroom { 129 } else { 0 }
}

/// A hole in a wall: from, to, lower and upper edge, centimetres.
type WallHole = [i32; 4];

/// The lines at which a stretch is cut, so that no piece is longer than `step` and every hole's edge is a line.
fn cut_lines(from: i32, to: i32, edges: impl Iterator<Item = i32>, step: i32) -> Vec<i32> {
    let mut lines: Vec<i32> = edges.filter(|edge| (from..to).contains(edge)).chain([from, to]).collect();
    lines.sort_unstable();
    lines.dedup();
    let between = lines.windows(2).flat_map(|pair| {
        let (start, length) = (pair[0], pair[1] - pair[0]);
        let parts = (length + step - 1) / step;
        (0..parts).map(move |part| start + length * part / parts)
    });
    between.chain([to]).collect()
}

/// The four walls of a room.
pub(in super::super) fn build_walls(house: &House, index: usize) -> HouseShape {
    let mut shape = HouseShape::default();
    for wall in WallSide::ALL {
        build_wall(&mut shape, house, index, wall);
    }
    shape
}

/// Builds one wall, in rectangles around its holes: tiles or skirting below, paint above.
fn build_wall(shape: &mut HouseShape, house: &House, index: usize, wall: WallSide) {
    let room = &house.rooms[index];
    let edge = room.inner_area().edge_at(wall);
    let line = room.outline.edge_at(wall);
    let (base, top) = (room.base_cm(), room.base_cm() + room.height_cm);
    let holes = wall_holes(house, index, wall);
    let paint = HouseSurface::new(SurfacePattern::Plaster, room.wall_colour.rgb());
    let trim = HouseSurface::from_rgb([238, 237, 233]);
    let (tiles, tiled_to) =
        (HouseSurface::new(SurfacePattern::Tiles, [246, 247, 248]), base + tiled_height_cm(room.kind));
    let columns = cut_lines(edge.from, edge.to, holes.iter().flat_map(|hole| [hole[0], hole[1]]), 40);
    let rows = cut_lines(
        base,
        top,
        holes.iter().flat_map(|hole| [hole[2], hole[3]]).chain([base + SKIRTING_CM, tiled_to]),
        45,
    );
    for column in columns.windows(2) {
        for row in rows.windows(2) {
            let inside = |hole: &WallHole| {
                hole[0] <= column[0] && column[1] <= hole[1] && hole[2] <= row[0] && row[1] <= hole[3]
            };
            if !holes.iter().any(inside) {
                let surface = if row[1] <= tiled_to {
                    tiles
                } else if row[1] <= base + SKIRTING_CM {
                    trim
                } else {
                    paint
                };
                add_wall_piece(shape, surface, &line, wall, [column[0], column[1], row[0], row[1]]);
            }
        }
    }
}

/// Adds a rectangle of a wall; the array has its ends along the wall and its lower and upper edge, centimetres.
fn add_wall_piece(
    shape: &mut HouseShape,
    surface: HouseSurface,
    line: &SpanCm,
    wall: WallSide,
    [from, to, low, high]: WallHole,
) {
    // Seen from inside, a north wall runs west to east and an east wall north to south.
    let (left, right) = if matches!(wall, WallSide::North | WallSide::West) { (from, to) } else { (to, from) };
    let corner = point_on_wall(line, wall, left, HALF_WALL_CM, low);
    let u = point_on_wall(line, wall, right, HALF_WALL_CM, low) - corner;
    let scale = surface.pattern.repeat_m();
    let uv0 = Vec2::new(to_metres(from) / scale, -to_metres(high) / scale);
    let uv1 = uv0 + Vec2::new(to_metres(to - from), to_metres(high - low)) / scale;
    shape.add_quad(surface, corner, u, Vec3::Z * to_metres(high - low), uv0, uv1);
}

/// The openings and windows in one wall of a room.
fn wall_holes(house: &House, index: usize, wall: WallSide) -> Vec<WallHole> {
    let outline = house.rooms[index].outline;
    let on_this = |span: &SpanCm| outline.wall_of(span) == Some(wall);
    let openings = house.openings.iter().filter(|opening| opening.room == index || opening.beyond == Some(index));
    let openings = openings.filter(|opening| on_this(&opening.span));
    let openings = openings.map(|opening| (opening.span, opening.base_cm, opening.base_cm + opening.height_cm));
    let windows = house.windows.iter().filter(|window| window.room == index && on_this(&window.span));
    let windows = windows.map(|window| (window.span, window.sill_cm, window.head_cm));
    openings.chain(windows).map(|(span, low, high)| [span.from, span.to, low, high]).collect()
}

/// A level rectangle in pieces, so that light and shadow can vary over it.
fn add_level(shape: &mut HouseShape, surface: HouseSurface, area: &RectCm, z: i32, up: bool, step: i32) {
    let scale = surface.pattern.repeat_m();
    let (columns, rows) =
        (cut_lines(area.x0, area.x1, [].into_iter(), step), cut_lines(area.y0, area.y1, [].into_iter(), step));
    for x in columns.windows(2) {
        for y in rows.windows(2) {
            let (dx, dy) = (Vec3::X * to_metres(x[1] - x[0]), Vec3::Y * to_metres(y[1] - y[0]));
            let corner = Vec3::new(to_metres(x[0]), to_metres(y[0]), to_metres(z));
            let uv0 = Vec2::new(to_metres(x[0]), -to_metres(y[1])) / scale;
            let uv1 = Vec2::new(to_metres(x[1]), -to_metres(y[0])) / scale;
            if up {
                shape.add_quad(surface, corner, dx, dy, uv0, uv1);
            } else {
                shape.add_quad(surface, corner + dy, dx, -dy, uv0, uv1);
            }
        }
    }
}

/// A room's floor, with the sills of its own openings.
pub(in super::super) fn build_floor(house: &House, index: usize) -> HouseShape {
    let room = &house.rooms[index];
    let mut shape = HouseShape::default();
    let pattern = match room.floor_finish {
        FloorFinish::Planks => SurfacePattern::Planks,
        FloorFinish::Tiles => SurfacePattern::Tiles,
        FloorFinish::Carpet => SurfacePattern::Carpet,
        FloorFinish::Concrete => SurfacePattern::Concrete,
    };
    let surface = HouseSurface::new(pattern, room.floor_colour.rgb());
    add_level(&mut shape, surface, &room.inner_area(), room.base_cm(), true, 22);
    for opening in house.openings.iter().filter(|opening| opening.room == index) {
        add_level(&mut shape, surface, &opening.span.thickened_by(HALF_WALL_CM), opening.base_cm, true, 60);
    }
    shape
}

/// A room's ceiling.
pub(in super::super) fn build_ceiling(house: &House, index: usize) -> HouseShape {
    let room = &house.rooms[index];
    let mut shape = HouseShape::default();
    let surface = HouseSurface::new(SurfacePattern::Plaster, [250, 249, 246]);
    let z = room.base_cm() + room.height_cm.max(CEILING_CM);
    add_level(&mut shape, surface, &room.inner_area(), z, false, 60);
    shape
}
