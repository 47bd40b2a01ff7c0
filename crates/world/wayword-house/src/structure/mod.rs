//! Builds the meshes of walls, floors, doors, windows and stairs, in the world frame.

mod doors;
mod shell;
mod stairs;
mod windows;

pub(super) use doors::{build_opening, post_footprints};
pub(super) use shell::{build_ceiling, build_floor, build_walls};
pub(super) use stairs::{build_railing, build_steps};
pub(super) use windows::build_window;

use super::rect::{SpanCm, WallSide};
use glam::Vec3;

fn to_metres(cm: i32) -> f32 {
    cm as f32 / 100.0
}

/// A point on a wall's line: `along` and `z` in centimetres, `inward` centimetres into the room.
fn point_on_wall(span: &SpanCm, wall: WallSide, along: i32, inward: i32, z: i32) -> Vec3 {
    let (dx, dy) = wall.inward();
    let (x, y) = if span.along_x { (along, span.at) } else { (span.at, along) };
    Vec3::new(to_metres(x + dx * inward), to_metres(y + dy * inward), to_metres(z))
}

/// A box on a wall's line between two places along it, two depths into the room, and two heights, centimetres.
fn wall_box(span: &SpanCm, wall: WallSide, along: [i32; 2], inward: [i32; 2], z: [i32; 2]) -> [[f32; 2]; 3] {
    let (a, b) =
        (point_on_wall(span, wall, along[0], inward[0], z[0]), point_on_wall(span, wall, along[1], inward[1], z[1]));
    let (low, high) = (a.min(b), a.max(b));
    [[low.x, high.x], [low.y, high.y], [low.z, high.z]]
}
