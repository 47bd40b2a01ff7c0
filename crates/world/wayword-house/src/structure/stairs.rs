//! Builds the steps, the landing and the railing of stairs.

use super::super::{
    colour::Colour,
    model::{STOREY_CM, Stairs},
    shapes::Shape,
    surface::{Pattern, Surface},
};
use super::metres;
use glam::Vec3;

/// Treads of one flight; the landing, or the upper floor, is one more riser up.
const TREADS: i32 = 7;

/// Both flights and the landing, solid down to the floor.
pub(in super::super) fn steps(stairs: &Stairs) -> Shape {
    let mut shape = Shape::default();
    let (tread, side) = (Surface::wood(Colour::Brown), Surface::new(Pattern::Plaster, [240, 238, 232]));
    let half_cm = STOREY_CM / 2;
    for step in 0..TREADS {
        let deep = [stairs.flight_cm * step / TREADS, stairs.flight_cm * (step + 1) / TREADS];
        let rise = half_cm * (step + 1) / (TREADS + 1);
        slab(&mut shape, stairs, (tread, side), true, deep, rise);
        let deep = [stairs.flight_cm - deep[1], stairs.flight_cm - deep[0]];
        slab(&mut shape, stairs, (tread, side), false, deep, half_cm + rise);
    }
    let landing = stairs.across(0, stairs.width_cm(), [stairs.flight_cm, stairs.depth_cm()]);
    let (x, y) = ([landing.x0, landing.x1].map(metres), [landing.y0, landing.y1].map(metres));
    shape.block(side, x, y, [0.0, metres(half_cm) - 0.04]);
    shape.block(tread, x, y, [metres(half_cm) - 0.04, metres(half_cm)]);
    shape
}

fn slab(shape: &mut Shape, stairs: &Stairs, (tread, side): (Surface, Surface), lower: bool, deep: [i32; 2], top: i32) {
    let (from, to) = stairs.flight_across(lower);
    let area = stairs.across(from, to, deep);
    let (x, y) = ([area.x0, area.x1].map(metres), [area.y0, area.y1].map(metres));
    shape.block(side, x, y, [0.0, metres(top) - 0.04]);
    shape.block(tread, x, y, [metres(top) - 0.04, metres(top)]);
}

/// A handrail on balusters along each flight, at the middle of the well.
pub(in super::super) fn railing(stairs: &Stairs) -> Shape {
    let mut shape = Shape::default();
    let (rail, white) = (Surface::wood(Colour::Brown), Surface::plain([244, 243, 240]));
    let middle = stairs.width_cm() / 2;
    for lower in [true, false] {
        let towards_low = lower == stairs.lower_flight_low;
        let across = middle + if towards_low { -3 } else { 3 };
        let foot = |deep: i32| {
            let height_cm = stairs.height_at_depth(lower, f64::from(deep) / 100.0) * 100.0;
            let at = stairs.across(across, across, [deep, deep]);
            Vec3::new(metres(at.x0), metres(at.y0), height_cm as f32 / 100.0)
        };
        for step in 0..=14 {
            let at = foot(stairs.flight_cm * step / 14);
            shape.rod(white, at - Vec3::Z * 0.1, at + Vec3::Z * 0.88, 0.013);
        }
        let (from, to) = (foot(0) + Vec3::Z * 0.9, foot(stairs.flight_cm) + Vec3::Z * 0.9);
        shape.rod(rail, from, to, 0.032);
        for post in [from, to] {
            shape.rod(rail, post - Vec3::Z * 1.0, post + Vec3::Z * 0.08, 0.04);
        }
    }
    shape
}
