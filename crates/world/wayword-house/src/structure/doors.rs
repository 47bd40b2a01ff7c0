//! Builds the frames and leaves of doors.

use super::super::{
    colour::Colour,
    leaf::OpenLeaf,
    model::{DoorLeaf, HALF_WALL_CM, House, LEAF_CM, WallOpening},
    rect::{RectCm, SpanCm, WallSide},
    shapes::HouseShape,
    surface::HouseSurface,
};
use super::wall_box;
use glam::Vec3;

/// From the middle of a wall to the face of a door's frame, centimetres.
const FRAME_DEPTH_CM: i32 = HALF_WALL_CM + 2;

fn add_box(shape: &mut HouseShape, surface: HouseSurface, [x, y, z]: [[f32; 2]; 3]) {
    shape.add_block(surface, x, y, z);
}

/// A frame around an opening, and its leaf.
pub(in super::super) fn build_opening(house: &House, opening: &WallOpening) -> HouseShape {
    let mut shape = HouseShape::default();
    add_frame(&mut shape, opening);
    let wall = house.rooms[opening.room].outline.wall_of(&opening.span).unwrap_or(WallSide::North);
    match opening.leaf {
        DoorLeaf::None => {}
        DoorLeaf::Open { .. } => open_leaf(&mut shape, house, opening),
        DoorLeaf::Closed => add_front_door(&mut shape, opening, wall),
        DoorLeaf::Garage => add_garage_door(&mut shape, opening, wall),
    }
    shape
}

/// From where to where the two posts of an opening's frame reach along the wall, centimetres.
fn post_spans(span: &SpanCm) -> [[i32; 2]; 2] {
    [[span.from - 6, span.from + 1], [span.to - 1, span.to + 6]]
}

/// The floor under the posts of an opening's frame.
pub(in super::super) fn post_footprints(opening: &WallOpening) -> [RectCm; 2] {
    post_spans(&opening.span).map(|[from, to]| SpanCm { from, to, ..opening.span }.thickened_by(FRAME_DEPTH_CM))
}

/// The white frame around an opening: two posts and a lintel.
fn add_frame(shape: &mut HouseShape, opening: &WallOpening) {
    let white = HouseSurface::from_rgb([242, 241, 238]);
    let SpanCm { from, to, .. } = opening.span;
    let (base, top) = (opening.base_cm, opening.base_cm + opening.height_cm);
    let deep = [-FRAME_DEPTH_CM, FRAME_DEPTH_CM];
    let wall = if opening.span.along_x { WallSide::North } else { WallSide::West };
    let mut bar = |along, z| add_box(shape, white, wall_box(&opening.span, wall, along, deep, z));
    for post in post_spans(&opening.span) {
        bar(post, [base, top + 6]);
    }
    bar([from, to], [top - 1, top + 6]);
}

/// An open leaf with two panels and a knob on each side.
fn open_leaf(shape: &mut HouseShape, house: &House, opening: &WallOpening) {
    let Some(leaf) = OpenLeaf::for_opening(opening, &house.rooms) else {
        return;
    };
    let mut standing = leaf_in_own_frame(opening, super::to_metres(leaf.length_cm));
    let turned = |x: f32, y: f32| {
        let on = |along: f64, through: f64| along as f32 * x + through as f32 * y;
        (on(leaf.along.0, leaf.through.0), on(leaf.along.1, leaf.through.1))
    };
    let hinge = Vec3::new(leaf.hinge.0 as f32, leaf.hinge.1 as f32, opening.base_cm as f32) / 100.0;
    for part in &mut standing.parts {
        for position in &mut part.positions {
            let (x, y) = turned(position.x, position.y);
            *position = hinge + Vec3::new(x, y, position.z);
        }
        for normal in &mut part.normals {
            let (x, y) = turned(normal.x, normal.y);
            *normal = Vec3::new(x, y, normal.z);
        }
        if leaf.is_mirrored() {
            part.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
    }
    shape.parts.append(&mut standing.parts);
}

/// A leaf in its own frame: x from the hinge along the leaf, y through its thickness, metres.
fn leaf_in_own_frame(opening: &WallOpening, length: f32) -> HouseShape {
    let mut shape = HouseShape::default();
    let paint = HouseSurface::for_wood(opening.colour);
    let (thick, top) = (super::to_metres(LEAF_CM), super::to_metres(opening.height_cm - 1));
    shape.add_block(paint, [0.0, length], [0.0, thick], [0.008, top]);
    for z in [[0.18, 0.9], [1.02, 1.86]] {
        shape.add_block(paint.shaded_by(0.92), [0.14, length - 0.14], [-0.006, thick + 0.006], z);
    }
    for side in [-0.04, thick + 0.04] {
        shape.add_ball(HouseSurface::for_metal(Colour::Gold), Vec3::new(length - 0.07, side, 1.0), 0.032);
    }
    shape
}

/// A closed front door with four panels, two small windows and a letter slot.
fn add_front_door(shape: &mut HouseShape, opening: &WallOpening, wall: WallSide) {
    let paint = HouseSurface::for_wood(opening.colour);
    let SpanCm { from, to, .. } = opening.span;
    let base = opening.base_cm;
    let top = base + opening.height_cm;
    let boxed = |along, deep, z| wall_box(&opening.span, wall, along, deep, z);
    add_box(shape, paint, boxed([from, to], [-3, 2], [base, top]));
    let middle = (from + to) / 2;
    for along in [[from + 12, middle - 5], [middle + 5, to - 12]] {
        add_box(shape, paint.shaded_by(0.8), boxed(along, [2, 3], [base + 18, base + 85]));
        add_box(shape, paint.shaded_by(0.8), boxed(along, [2, 3], [base + 97, base + 145]));
        add_box(
            shape,
            HouseSurface::from_rgb([190, 216, 232]).glowing(),
            boxed(along, [2, 3], [base + 157, base + 188]),
        );
    }
    let knob = super::point_on_wall(&opening.span, wall, to - 9, 7, base + 100);
    shape.add_ball(HouseSurface::for_metal(Colour::Gold), knob, 0.04);
    add_box(
        shape,
        HouseSurface::for_metal(Colour::Gold),
        boxed([middle - 12, middle + 12], [2, 4], [base + 89, base + 93]),
    );
}

/// A closed garage door of five level panels.
fn add_garage_door(shape: &mut HouseShape, opening: &WallOpening, wall: WallSide) {
    let SpanCm { from, to, .. } = opening.span;
    let white = HouseSurface::for_metal(Colour::White);
    let rows = 5;
    for row in 0..rows {
        let low = opening.base_cm + opening.height_cm * row / rows;
        let high = opening.base_cm + opening.height_cm * (row + 1) / rows;
        let boxed = |along, deep, z| wall_box(&opening.span, wall, along, deep, z);
        add_box(shape, white.shaded_by(0.8), boxed([from, to], [-3, 1], [low, high]));
        add_box(shape, white, boxed([from + 2, to - 2], [1, 3], [low + 2, high - 1]));
    }
}
