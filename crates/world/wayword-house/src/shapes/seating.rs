//! Builds seats. Lengths are metres; `hw` and `hd` are half
//! the width and half the depth of a piece, `look.h` its height.

use super::{
    super::{colour::Colour, surface::HouseSurface},
    FurnitureLook, HouseShape,
};
use glam::Vec3;

/// Sofas and armchairs: arms, a back, and a cushion for every seat.
pub(super) fn build_sofa(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), fabric) = (look.half_size(), HouseSurface::for_fabric(look.colour));
    let (arm, seat) = (0.16, 0.26);
    let dark = HouseSurface::for_wood(Colour::Brown);
    shape.add_legs(dark, (hw - 0.02, hd - 0.02), 0.06, 0.1);
    shape.add_soft_box(fabric.shaded_by(0.9), [-hw + 0.02, hw - 0.02], [-hd + 0.02, hd], [0.08, seat + 0.04], 0.03);
    shape.add_soft_box(fabric, [-hw, hw], [hd - 0.2, hd], [0.1, look.h], 0.08);
    for side in [-1.0, 1.0] {
        let x = side * (hw - arm / 2.0);
        shape.add_soft_box(fabric, [x - arm / 2.0, x + arm / 2.0], [-hd, hd], [0.08, 0.62], 0.07);
    }
    let seats = ((look.w - 2.0 * arm) / 0.6).max(1.0) as usize;
    let width = (look.w - 2.0 * arm) / seats as f32;
    for seat_at in 0..seats {
        let x = -hw + arm + width * seat_at as f32;
        let across = [x + 0.006, x + width - 0.006];
        shape.add_soft_box(fabric.shaded_by(1.06), across, [-hd + 0.01, hd - 0.18], [seat + 0.02, 0.46], 0.06);
        shape.add_soft_box(fabric.shaded_by(1.06), across, [hd - 0.34, hd - 0.12], [0.44, look.h - 0.04], 0.08);
    }
    if seats > 1 {
        add_pillows(&mut shape, look, hw - arm, hd);
    }
    shape
}

fn add_pillows(shape: &mut HouseShape, look: &FurnitureLook, half: f32, hd: f32) {
    let colour = [Colour::Orange, Colour::Yellow, Colour::White, Colour::Teal, Colour::Red][look.variant as usize % 5];
    for side in [-1.0, 1.0] {
        let x = side * (half - 0.22);
        let soft = HouseSurface::for_fabric(colour);
        shape.add_soft_box(soft, [x - 0.2, x + 0.2], [hd - 0.44, hd - 0.3], [0.45, 0.82], 0.07);
    }
}

/// Four legs, a seat, and a back with slats.
pub(super) fn build_chair(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), wood) = (look.half_size(), HouseSurface::for_wood(look.colour));
    shape.add_legs(wood, (hw, hd), 0.04, 0.44);
    shape.add_block(wood, [-hw + 0.01, hw - 0.01], [-hd + 0.01, hd - 0.01], [0.43, 0.47]);
    let cushion = HouseSurface::for_fabric(Colour::Cream);
    shape.add_soft_box(cushion, [-hw + 0.03, hw - 0.03], [-hd + 0.03, hd - 0.06], [0.46, 0.5], 0.02);
    for x in [-hw + 0.04, hw - 0.04] {
        shape.add_block(wood, [x - 0.02, x + 0.02], [hd - 0.06, hd - 0.02], [0.44, look.h]);
    }
    for z in [0.62, 0.75, 0.87] {
        shape.add_block(wood, [-hw + 0.03, hw - 0.03], [hd - 0.055, hd - 0.025], [z - 0.035, z + 0.035]);
    }
    shape
}

/// A bar stool with a round seat.
pub(super) fn build_stool(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let (r, wood) = (look.w / 2.0, HouseSurface::for_wood(look.colour));
    shape.add_tube(wood, (0.0, 0.0), [r, r], [look.h - 0.05, look.h]);
    let foot = r * 0.85;
    for (sx, sy) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        let top = Vec3::new(sx * r * 0.5, sy * r * 0.5, look.h - 0.04);
        shape.add_rod(wood, Vec3::new(sx * foot, sy * foot, 0.0), top, 0.018);
    }
    shape.add_tube(HouseSurface::for_metal(Colour::Silver), (0.0, 0.0), [r * 0.8, r * 0.8], [0.24, 0.26]);
    shape
}

/// A low wooden bench.
pub(super) fn build_bench(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), wood) = (look.half_size(), HouseSurface::for_wood(look.colour));
    shape.add_block(wood, [-hw, hw], [-hd, hd], [look.h - 0.08, look.h - 0.04]);
    shape.add_soft_box(HouseSurface::for_fabric(Colour::Beige), [-hw, hw], [-hd, hd], [look.h - 0.05, look.h], 0.02);
    shape.add_legs(wood, (hw, hd), 0.06, look.h - 0.06);
    shape
}

/// A swivel chair on five castors.
pub(super) fn build_office_chair(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let fabric = HouseSurface::for_fabric(look.colour);
    let black = HouseSurface::from_rgb([34, 34, 36]);
    for foot in 0..5 {
        let angle = std::f32::consts::TAU * foot as f32 / 5.0;
        let end = Vec3::new(0.27 * libm::cosf(angle), 0.27 * libm::sinf(angle), 0.06);
        shape.add_rod(black, Vec3::new(0.0, 0.0, 0.1), end, 0.02);
        shape.add_ball(black, end - Vec3::Z * 0.025, 0.03);
    }
    shape.add_tube(HouseSurface::for_metal(Colour::Silver), (0.0, 0.0), [0.03, 0.03], [0.08, 0.44]);
    shape.add_soft_box(fabric, [-0.25, 0.25], [-0.25, 0.23], [0.43, 0.52], 0.04);
    shape.add_soft_box(fabric, [-0.23, 0.23], [0.2, 0.28], [0.58, look.h], 0.035);
    shape.add_block(black, [-0.03, 0.03], [0.24, 0.27], [0.46, 0.7]);
    for side in [-1.0, 1.0] {
        let x = side * 0.28;
        shape.add_block(black, [x - 0.02, x + 0.02], [-0.12, 0.14], [0.66, 0.69]);
        shape.add_block(black, [x - 0.015, x + 0.015], [0.0, 0.03], [0.47, 0.67]);
    }
    shape
}
