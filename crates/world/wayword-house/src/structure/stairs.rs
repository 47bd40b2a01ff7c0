//! Builds the steps, the landing and the railing of stairs.

use super::super::{
    colour::Colour,
    model::{HouseStairs, STOREY_CM},
    shapes::HouseShape,
    surface::{HouseSurface, SurfacePattern},
};
use super::to_metres;
use glam::Vec3;

/// Treads of one flight; the landing, or the upper floor, is one more riser up.
const TREADS_PER_FLIGHT: i32 = 7;

/// Both flights and the landing, solid down to the floor.
pub(in super::super) fn build_steps(stairs: &HouseStairs) -> HouseShape {
    let mut shape = HouseShape::default();
    let (tread, side) =
        (HouseSurface::for_wood(Colour::Brown), HouseSurface::new(SurfacePattern::Plaster, [240, 238, 232]));
    let half_cm = STOREY_CM / 2;
    for step in 0..TREADS_PER_FLIGHT {
        let deep = [stairs.flight_cm * step / TREADS_PER_FLIGHT, stairs.flight_cm * (step + 1) / TREADS_PER_FLIGHT];
        let rise = half_cm * (step + 1) / (TREADS_PER_FLIGHT + 1);
        add_step(&mut shape, stairs, (tread, side), true, deep, rise);
        let deep = [stairs.flight_cm - deep[1], stairs.flight_cm - deep[0]];
        add_step(&mut shape, stairs, (tread, side), false, deep, half_cm + rise);
    }
    let landing = stairs.rect_across(0, stairs.width_cm(), [stairs.flight_cm, stairs.depth_cm()]);
    let (x, y) = ([landing.x0, landing.x1].map(to_metres), [landing.y0, landing.y1].map(to_metres));
    shape.add_block(side, x, y, [0.0, to_metres(half_cm) - 0.04]);
    shape.add_block(tread, x, y, [to_metres(half_cm) - 0.04, to_metres(half_cm)]);
    shape
}

/// A step of a flight: its top `top` centimetres above the ground floor, between two depths from the entry.
fn add_step(
    shape: &mut HouseShape,
    stairs: &HouseStairs,
    (tread, side): (HouseSurface, HouseSurface),
    lower: bool,
    deep: [i32; 2],
    top: i32,
) {
    let (from, to) = stairs.flight_across(lower);
    let area = stairs.rect_across(from, to, deep);
    let (x, y) = ([area.x0, area.x1].map(to_metres), [area.y0, area.y1].map(to_metres));
    shape.add_block(side, x, y, [0.0, to_metres(top) - 0.04]);
    shape.add_block(tread, x, y, [to_metres(top) - 0.04, to_metres(top)]);
}

/// A handrail on balusters along each flight, at the middle of the well.
pub(in super::super) fn build_railing(stairs: &HouseStairs) -> HouseShape {
    let mut shape = HouseShape::default();
    let (rail, white) = (HouseSurface::for_wood(Colour::Brown), HouseSurface::from_rgb([244, 243, 240]));
    let middle = stairs.width_cm() / 2;
    for lower in [true, false] {
        let towards_low = lower == stairs.lower_flight_low;
        let across = middle + if towards_low { -3 } else { 3 };
        let foot = |deep: i32| {
            let height_cm = stairs.height_at_depth(lower, f64::from(deep) / 100.0) * 100.0;
            let at = stairs.rect_across(across, across, [deep, deep]);
            Vec3::new(to_metres(at.x0), to_metres(at.y0), height_cm as f32 / 100.0)
        };
        for step in 0..=14 {
            let at = foot(stairs.flight_cm * step / 14);
            shape.add_rod(white, at - Vec3::Z * 0.1, at + Vec3::Z * 0.88, 0.013);
        }
        let (from, to) = (foot(0) + Vec3::Z * 0.9, foot(stairs.flight_cm) + Vec3::Z * 0.9);
        shape.add_rod(rail, from, to, 0.032);
        for post in [from, to] {
            shape.add_rod(rail, post - Vec3::Z * 1.0, post + Vec3::Z * 0.08, 0.04);
        }
    }
    shape
}
