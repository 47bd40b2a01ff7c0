//! Frames and leaves of doors.

use super::super::{
    colour::Colour,
    model::{HALF_WALL_CM, House, LEAF_CM, Leaf, Opening},
    rect::{SpanCm, Wall},
    shapes::Shape,
    surface::Surface,
};
use super::wall_box;
use glam::Vec3;

fn add(shape: &mut Shape, surface: Surface, [x, y, z]: [[f32; 2]; 3]) {
    shape.block(surface, x, y, z);
}

/// A frame around an opening, and its leaf.
pub(in super::super) fn opening(house: &House, opening: &Opening) -> Shape {
    let mut shape = Shape::default();
    frame(&mut shape, opening);
    let wall = house.rooms[opening.room].outline.wall_of(&opening.span).unwrap_or(Wall::North);
    match opening.leaf {
        Leaf::None => {}
        Leaf::Open { .. } => open_leaf(&mut shape, house, opening),
        Leaf::Closed => front_door(&mut shape, opening, wall),
        Leaf::Garage => garage_door(&mut shape, opening, wall),
    }
    shape
}

fn frame(shape: &mut Shape, opening: &Opening) {
    let white = Surface::plain([242, 241, 238]);
    let SpanCm { from, to, .. } = opening.span;
    let (base, top) = (opening.base_cm, opening.base_cm + opening.height_cm);
    let deep = [-HALF_WALL_CM - 2, HALF_WALL_CM + 2];
    let wall = if opening.span.along_x { Wall::North } else { Wall::West };
    let mut bar = |along, z| add(shape, white, wall_box(&opening.span, wall, along, deep, z));
    bar([from - 6, from + 1], [base, top + 6]);
    bar([to - 1, to + 6], [base, top + 6]);
    bar([from, to], [top - 1, top + 6]);
}

/// A leaf at a right angle to the wall, with two panels and a knob on each side.
fn open_leaf(shape: &mut Shape, house: &House, opening: &Opening) {
    let Some(area) = opening.open_leaf(&house.rooms, LEAF_CM) else {
        return;
    };
    let paint = Surface::wood(opening.colour);
    let (x, y) = ([area.x0, area.x1].map(super::metres), [area.y0, area.y1].map(super::metres));
    let (base, top) = (super::metres(opening.base_cm), super::metres(opening.base_cm + opening.height_cm - 1));
    shape.block(paint, x, y, [base + 0.008, top]);
    let along_x = area.width() > area.depth();
    let (long, thin) = if along_x { (x, y) } else { (y, x) };
    for (low, high) in [(0.18, 0.9), (1.02, 1.86)] {
        let (from, to) = (long[0] + 0.14, long[1] - 0.14);
        let (out, z) = ([thin[0] - 0.006, thin[1] + 0.006], [base + low, base + high]);
        let (px, py) = if along_x { ([from, to], out) } else { (out, [from, to]) };
        shape.block(paint.shade(0.92), px, py, z);
    }
    let Leaf::Open { into, .. } = opening.leaf else {
        return;
    };
    let (cx, cy) = house.rooms[into].outline.centre();
    // The knob is at the end away from the wall, which is the end nearer to the room's middle.
    let centre = super::metres(if along_x { cx } else { cy });
    let far = if (long[0] - centre).abs() < (long[1] - centre).abs() { long[0] + 0.07 } else { long[1] - 0.07 };
    for side in [thin[0] - 0.04, thin[1] + 0.04] {
        let at = if along_x { Vec3::new(far, side, base + 1.0) } else { Vec3::new(side, far, base + 1.0) };
        shape.ball(Surface::metal(Colour::Gold), at, 0.032);
    }
}

fn front_door(shape: &mut Shape, opening: &Opening, wall: Wall) {
    let paint = Surface::wood(opening.colour);
    let SpanCm { from, to, .. } = opening.span;
    let base = opening.base_cm;
    let top = base + opening.height_cm;
    let boxed = |along, deep, z| wall_box(&opening.span, wall, along, deep, z);
    add(shape, paint, boxed([from, to], [-3, 2], [base, top]));
    let middle = (from + to) / 2;
    for along in [[from + 12, middle - 5], [middle + 5, to - 12]] {
        add(shape, paint.shade(0.8), boxed(along, [2, 3], [base + 18, base + 85]));
        add(shape, paint.shade(0.8), boxed(along, [2, 3], [base + 97, base + 145]));
        add(shape, Surface::plain([190, 216, 232]).glowing(), boxed(along, [2, 3], [base + 157, base + 188]));
    }
    let knob = super::on_wall(&opening.span, wall, to - 9, 7, base + 100);
    shape.ball(Surface::metal(Colour::Gold), knob, 0.04);
    add(shape, Surface::metal(Colour::Gold), boxed([middle - 12, middle + 12], [2, 4], [base + 89, base + 93]));
}

fn garage_door(shape: &mut Shape, opening: &Opening, wall: Wall) {
    let SpanCm { from, to, .. } = opening.span;
    let white = Surface::metal(Colour::White);
    let rows = 5;
    for row in 0..rows {
        let low = opening.base_cm + opening.height_cm * row / rows;
        let high = opening.base_cm + opening.height_cm * (row + 1) / rows;
        let boxed = |along, deep, z| wall_box(&opening.span, wall, along, deep, z);
        add(shape, white.shade(0.8), boxed([from, to], [-3, 1], [low, high]));
        add(shape, white, boxed([from + 2, to - 2], [1, 3], [low + 2, high - 1]));
    }
}
