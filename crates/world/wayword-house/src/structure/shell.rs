//! Builds the inside of a room: floor, ceiling, and walls with holes for doors and windows.

use super::super::{
    model::{CEILING_CM, FloorFinish, HALF_WALL_CM, House, RoomKind},
    rect::{RectCm, SpanCm, Wall},
    shapes::Shape,
    surface::{Pattern, Surface},
};
use super::{metres, on_wall};
use glam::{Vec2, Vec3};

/// Height of the skirting board, centimetres.
const SKIRTING_CM: i32 = 9;

/// Up to which height the walls of a room are tiled, centimetres.
fn tiled_cm(kind: RoomKind) -> i32 {
    if kind == RoomKind::Bathroom { 129 } else { 0 }
}

/// A hole in a wall: from, to, lower and upper edge, centimetres.
type Hole = [i32; 4];

/// The lines at which a stretch is cut, so that no piece is longer than `step` and every hole's edge is a line.
fn cuts(from: i32, to: i32, edges: impl Iterator<Item = i32>, step: i32) -> Vec<i32> {
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
pub(in super::super) fn walls(house: &House, index: usize) -> Shape {
    let mut shape = Shape::default();
    for wall in Wall::ALL {
        one_wall(&mut shape, house, index, wall);
    }
    shape
}

fn one_wall(shape: &mut Shape, house: &House, index: usize, wall: Wall) {
    let room = &house.rooms[index];
    let edge = room.inner().edge(wall);
    let line = room.outline.edge(wall);
    let (base, top) = (room.base_cm(), room.base_cm() + room.height_cm);
    let holes = holes(house, index, wall);
    let paint = Surface::new(Pattern::Plaster, room.wall_colour.rgb());
    let trim = Surface::plain([238, 237, 233]);
    let (tiles, tiled_to) = (Surface::new(Pattern::Tiles, [246, 247, 248]), base + tiled_cm(room.kind));
    let columns = cuts(edge.from, edge.to, holes.iter().flat_map(|hole| [hole[0], hole[1]]), 40);
    let rows =
        cuts(base, top, holes.iter().flat_map(|hole| [hole[2], hole[3]]).chain([base + SKIRTING_CM, tiled_to]), 45);
    for column in columns.windows(2) {
        for row in rows.windows(2) {
            let inside =
                |hole: &Hole| hole[0] <= column[0] && column[1] <= hole[1] && hole[2] <= row[0] && row[1] <= hole[3];
            if !holes.iter().any(inside) {
                let surface = if row[1] <= tiled_to {
                    tiles
                } else if row[1] <= base + SKIRTING_CM {
                    trim
                } else {
                    paint
                };
                wall_piece(shape, surface, &line, wall, [column[0], column[1], row[0], row[1]]);
            }
        }
    }
}

fn wall_piece(shape: &mut Shape, surface: Surface, line: &SpanCm, wall: Wall, [from, to, low, high]: Hole) {
    // Seen from inside, a north wall runs west to east and an east wall north to south.
    let (left, right) = if matches!(wall, Wall::North | Wall::West) { (from, to) } else { (to, from) };
    let corner = on_wall(line, wall, left, HALF_WALL_CM, low);
    let u = on_wall(line, wall, right, HALF_WALL_CM, low) - corner;
    let scale = surface.pattern.repeat_m();
    let uv0 = Vec2::new(metres(from) / scale, -metres(high) / scale);
    let uv1 = uv0 + Vec2::new(metres(to - from), metres(high - low)) / scale;
    shape.quad(surface, corner, u, Vec3::Z * metres(high - low), uv0, uv1);
}

fn holes(house: &House, index: usize, wall: Wall) -> Vec<Hole> {
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
fn level(shape: &mut Shape, surface: Surface, area: &RectCm, z: i32, up: bool, step: i32) {
    let scale = surface.pattern.repeat_m();
    let (columns, rows) = (cuts(area.x0, area.x1, [].into_iter(), step), cuts(area.y0, area.y1, [].into_iter(), step));
    for x in columns.windows(2) {
        for y in rows.windows(2) {
            let (dx, dy) = (Vec3::X * metres(x[1] - x[0]), Vec3::Y * metres(y[1] - y[0]));
            let corner = Vec3::new(metres(x[0]), metres(y[0]), metres(z));
            let uv0 = Vec2::new(metres(x[0]), -metres(y[1])) / scale;
            let uv1 = Vec2::new(metres(x[1]), -metres(y[0])) / scale;
            if up {
                shape.quad(surface, corner, dx, dy, uv0, uv1);
            } else {
                shape.quad(surface, corner + dy, dx, -dy, uv0, uv1);
            }
        }
    }
}

/// A room's floor, with the sills of its own openings.
pub(in super::super) fn floor(house: &House, index: usize) -> Shape {
    let room = &house.rooms[index];
    let mut shape = Shape::default();
    let pattern = match room.floor_finish {
        FloorFinish::Planks => Pattern::Planks,
        FloorFinish::Tiles => Pattern::Tiles,
        FloorFinish::Carpet => Pattern::Carpet,
        FloorFinish::Concrete => Pattern::Concrete,
    };
    let surface = Surface::new(pattern, room.floor_colour.rgb());
    level(&mut shape, surface, &room.inner(), room.base_cm(), true, 22);
    for opening in house.openings.iter().filter(|opening| opening.room == index) {
        level(&mut shape, surface, &opening.span.thickened(HALF_WALL_CM), opening.base_cm, true, 60);
    }
    shape
}

/// A room's ceiling.
pub(in super::super) fn ceiling(house: &House, index: usize) -> Shape {
    let room = &house.rooms[index];
    let mut shape = Shape::default();
    let surface = Surface::new(Pattern::Plaster, [250, 249, 246]);
    let z = room.base_cm() + room.height_cm.max(CEILING_CM);
    level(&mut shape, surface, &room.inner(), z, false, 60);
    shape
}
