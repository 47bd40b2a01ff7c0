//! Builds windows: a frame, a cross, and a picture of the view outside on the pane.

use super::super::{
    model::{HALF_WALL_CM, House, HouseWindow, RoomKind, STOREY_CM},
    outlook::WindowOutlook,
    rect::{SpanCm, WallSide},
    shapes::HouseShape,
    surface::{HouseSurface, SurfacePattern},
};
use super::{point_on_wall, to_metres, wall_box};
use glam::{Vec2, Vec3};

/// Width of the wall that one picture of the view fills, metres.
const OUTLOOK_WIDTH_M: f32 = 2.4;
/// Height of the picture's upper edge above the floor, metres.
const OUTLOOK_TOP_M: f32 = 2.4;
/// Height of the picture, metres.
const OUTLOOK_HEIGHT_M: f32 = 2.1;

/// A window as seen from its room. `outlooks` are the views of the four sides, in the order of [`WallSide::ALL`].
pub(in super::super) fn build_window(house: &House, window: &HouseWindow, outlooks: &[WindowOutlook; 4]) -> HouseShape {
    let mut shape = HouseShape::default();
    let wall = house.rooms[window.room].outline.wall_of(&window.span).unwrap_or(WallSide::North);
    add_view(&mut shape, house, window, wall, outlooks[usize::from(wall.quarter_turns()) % 4]);
    let SpanCm { from, to, .. } = window.span;
    let (sill, head) = (window.sill_cm, window.head_cm);
    let white = HouseSurface::from_rgb([244, 243, 240]);
    let mut bar = |along, deep, z| {
        let [x, y, z] = wall_box(&window.span, wall, along, deep, z);
        shape.add_block(white, x, y, z);
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

/// The view on the pane. It is laid out over the whole wall, with the horizon at eye level, so that windows side by side
/// show parts of one view.
fn add_view(shape: &mut HouseShape, house: &House, window: &HouseWindow, wall: WallSide, outlook: WindowOutlook) {
    let SpanCm { from, to, .. } = window.span;
    let (sill, head) = (window.sill_cm, window.head_cm);
    let is_well = house.rooms[window.room].kind == RoomKind::Staircase;
    // Above the landing, the eye is higher than on the room's own floor.
    let floor_cm = if is_well { sill - 90 } else { house.rooms[window.room].base_cm() };
    let upstairs = floor_cm >= STOREY_CM / 2;
    let pattern = if upstairs { SurfacePattern::FromAbove(outlook) } else { SurfacePattern::Outside(outlook) };
    // Seen from inside, the lower end of a north or west wall is on the left.
    let is_low_end_left = matches!(wall, WallSide::North | WallSide::West);
    let (left, right, across) = if is_low_end_left { (from, to, from) } else { (to, from, -to) };
    let corner = point_on_wall(&window.span, wall, left, 0, sill);
    let u = point_on_wall(&window.span, wall, right, 0, sill) - corner;
    let uv = |along: i32, z: i32| {
        Vec2::new(to_metres(along) / OUTLOOK_WIDTH_M, (OUTLOOK_TOP_M - to_metres(z - floor_cm)) / OUTLOOK_HEIGHT_M)
    };
    let (uv0, uv1) = (uv(across, head), uv(across + to - from, sill));
    shape.add_quad(HouseSurface::for_picture(pattern).glowing(), corner, u, Vec3::Z * to_metres(head - sill), uv0, uv1);
}
