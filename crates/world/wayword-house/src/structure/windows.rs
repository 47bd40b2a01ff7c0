//! Windows: a frame, a cross, and a picture of the view outside.

use super::super::{
    model::{HALF_WALL_CM, House, STOREY_CM, Window},
    rect::{SpanCm, Wall},
    shapes::Shape,
    surface::{Pattern, Surface},
};
use super::{metres, on_wall, wall_box};
use glam::Vec3;

/// A window as it is seen from its room.
pub(in super::super) fn window(house: &House, window: &Window) -> Shape {
    let mut shape = Shape::default();
    let wall = house.rooms[window.room].outline.wall_of(&window.span).unwrap_or(Wall::North);
    view(&mut shape, window, wall);
    let SpanCm { from, to, .. } = window.span;
    let (sill, head) = (window.sill_cm, window.head_cm);
    let white = Surface::plain([244, 243, 240]);
    let mut bar = |along, deep, z| {
        let [x, y, z] = wall_box(&window.span, wall, along, deep, z);
        shape.block(white, x, y, z);
    };
    let deep = [0, HALF_WALL_CM + 2];
    bar([from - 5, from + 2], deep, [sill - 5, head + 5]);
    bar([to - 2, to + 5], deep, [sill - 5, head + 5]);
    bar([from, to], deep, [head - 2, head + 5]);
    bar([from - 8, to + 8], [0, HALF_WALL_CM + 3], [sill - 4, sill]);
    let (middle, across) = ((from + to) / 2, sill + (head - sill) * 62 / 100);
    bar([middle - 2, middle + 2], [1, 4], [sill, head]);
    bar([from, to], [1, 4], [across - 2, across + 2]);
    shape
}

fn view(shape: &mut Shape, window: &Window, wall: Wall) {
    let SpanCm { from, to, .. } = window.span;
    let upstairs = window.sill_cm >= STOREY_CM;
    let outside = Surface::picture(if upstairs { Pattern::Treetops } else { Pattern::Garden }).glowing();
    let (left, right) = if matches!(wall, Wall::North | Wall::West) { (from, to) } else { (to, from) };
    let corner = on_wall(&window.span, wall, left, 0, window.sill_cm);
    let u = on_wall(&window.span, wall, right, 0, window.sill_cm) - corner;
    shape.picture(outside, corner, u, Vec3::Z * metres(window.head_cm - window.sill_cm));
}
