//! Builds a car and a bicycle. Lengths are metres; `hw` and `hd` are half
//! the width and half the depth of a piece, `look.h` its height.

use super::{
    super::{colour::Colour, surface::HouseSurface},
    FurnitureLook, HouseShape,
};
use glam::Vec3;

/// A car with a bonnet, a cabin with sloping screens, and a boot; its nose looks forward.
pub(super) fn build_car(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), paint) = (look.half_size(), HouseSurface::from_rgb(look.colour.rgb()));
    shape.add_soft_box(paint, [-hw, hw], [-hd, hd], [0.26, BELT_LINE_M], 0.16);
    shape.add_soft_box(
        paint.shaded_by(0.94),
        [-hw + 0.1, hw - 0.1],
        [-hd + 0.12, -hd * 0.34],
        [0.6, BELT_LINE_M + 0.05],
        0.06,
    );
    add_cabin(&mut shape, look, paint);
    let (dark, white) = (HouseSurface::from_rgb([30, 30, 32]), HouseSurface::from_rgb([250, 250, 246]));
    for side in [-1.0, 1.0] {
        let (low, lamp) = (side * (hw - 0.3), HouseSurface::from_rgb([255, 252, 226]).glowing());
        shape.add_soft_box(lamp, [low - 0.16, low + 0.16], [-hd - 0.01, -hd + 0.1], [0.56, 0.72], 0.05);
        let rear = HouseSurface::from_rgb([200, 30, 30]);
        shape.add_soft_box(rear, [low - 0.15, low + 0.15], [hd - 0.1, hd + 0.01], [0.6, 0.74], 0.05);
        for y in [-hd * 0.62, hd * 0.6] {
            add_wheel(&mut shape, Vec3::new(side * (hw - 0.12), y, 0.32), side);
        }
        let x = side * (hw - 0.01);
        for y in [-hd * 0.02, hd * 0.36] {
            shape.add_block(
                HouseSurface::for_metal(Colour::Silver),
                [x - 0.02, x + 0.02],
                [y, y + 0.16],
                [BELT_LINE_M - 0.13, BELT_LINE_M - 0.1],
            );
        }
        let mirror = [side * (hw - 0.06), side * (hw + 0.08)];
        let across = [mirror[0].min(mirror[1]), mirror[0].max(mirror[1])];
        shape.add_soft_box(
            paint.shaded_by(0.9),
            across,
            [-hd * 0.28, -hd * 0.23],
            [BELT_LINE_M + 0.03, BELT_LINE_M + 0.15],
            0.02,
        );
    }
    shape.add_block(dark, [-0.42, 0.42], [-hd - 0.005, -hd + 0.1], [0.44, 0.6]);
    for bar in 0..4 {
        let z = 0.455 + 0.036 * bar as f32;
        shape.add_block(HouseSurface::for_metal(Colour::Silver), [-0.4, 0.4], [-hd - 0.012, -hd], [z, z + 0.012]);
    }
    for (y, z) in [([-hd - 0.02, -hd], [0.3, 0.4]), ([hd, hd + 0.02], [0.46, 0.57])] {
        shape.add_block(white, [-0.26, 0.26], y, z);
        shape.add_block(dark, [-0.2, 0.2], [y[0] - 0.003, y[1] + 0.003], [z[0] + 0.035, z[1] - 0.035]);
    }
    shape
}

/// Height at which the windows of a car begin, metres.
const BELT_LINE_M: f32 = 0.86;

/// Roof, screens and side windows: a box that is smaller above than below.
fn add_cabin(shape: &mut HouseShape, look: &FurnitureLook, paint: HouseSurface) {
    let (hw, hd) = look.half_size();
    let (roof, glass) = (look.h - 0.05, HouseSurface::from_rgb([44, 54, 64]));
    let low = |x: f32, y: f32| Vec3::new(x * (hw - 0.06), y * hd, BELT_LINE_M - 0.04);
    let high = |x: f32, y: f32| Vec3::new(x * (hw - 0.24), y * hd, roof);
    let (fore, aft, fore_up, aft_up) = (-0.36, 0.86, -0.1, 0.62);
    // Each face is given by its lower corners, left to right as seen from outside, and the upper ones.
    let faces = [
        [low(-1.0, fore), low(1.0, fore), high(1.0, fore_up), high(-1.0, fore_up)],
        [low(1.0, aft), low(-1.0, aft), high(-1.0, aft_up), high(1.0, aft_up)],
        [low(1.0, fore), low(1.0, aft), high(1.0, aft_up), high(1.0, fore_up)],
        [low(-1.0, aft), low(-1.0, fore), high(-1.0, fore_up), high(-1.0, aft_up)],
    ];
    for (index, corners) in faces.into_iter().enumerate() {
        shape.add_face(paint, corners);
        let panes: &[[f32; 2]] = if index < 2 { &[[0.07, 0.93]] } else { &[[0.08, 0.48], [0.53, 0.92]] };
        for [from, to] in panes {
            shape.add_face(glass, pane_corners(corners, [*from, *to], [0.16, 0.92]));
        }
    }
    shape.add_soft_box(
        paint,
        [-hw + 0.23, hw - 0.23],
        [fore_up * hd - 0.02, aft_up * hd + 0.02],
        [roof - 0.03, look.h],
        0.03,
    );
}

/// A part of a face, a little before it.
fn pane_corners([a, b, c, d]: [Vec3; 4], across: [f32; 2], up: [f32; 2]) -> [Vec3; 4] {
    let out = (b - a).cross(d - a).normalize_or_zero() * 0.006;
    let at = |s: f32, t: f32| a.lerp(b, s).lerp(d.lerp(c, s), t) + out;
    [at(across[0], up[0]), at(across[1], up[0]), at(across[1], up[1]), at(across[0], up[1])]
}

fn add_wheel(shape: &mut HouseShape, centre: Vec3, side: f32) {
    let (out, tyre) = (Vec3::X * side, HouseSurface::from_rgb([30, 30, 32]));
    shape.add_rod(tyre, centre - out * 0.1, centre + out * 0.13, 0.32);
    shape.add_disc(tyre, centre + out * 0.13, out, 0.32);
    shape.add_disc(HouseSurface::for_metal(Colour::Silver), centre + out * 0.132, out, 0.19);
}

/// Two wheels, a frame, saddle and handlebar.
pub(super) fn build_bicycle(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let (paint, black) = (HouseSurface::from_rgb(look.colour.rgb()), HouseSurface::from_rgb([30, 30, 32]));
    let r = 0.33;
    let x = look.w / 2.0 - r - 0.02;
    let (rear, fore) = (Vec3::new(-x, 0.0, r + 0.01), Vec3::new(x, 0.0, r + 0.01));
    for hub in [rear, fore] {
        shape.add_hoop(black, hub, Vec3::Y, r - 0.02, 0.02);
        for spoke in 0..4 {
            let angle = std::f32::consts::FRAC_PI_4 * spoke as f32;
            let out = Vec3::new(libm::cosf(angle), 0.0, libm::sinf(angle)) * (r - 0.03);
            shape.add_rod(HouseSurface::for_metal(Colour::Silver), hub - out, hub + out, 0.003);
        }
    }
    let (pedal, seat, head) = (Vec3::new(-0.05, 0.0, 0.3), Vec3::new(-0.2, 0.0, 0.82), Vec3::new(x - 0.14, 0.0, 0.82));
    for (from, to) in [
        (pedal, seat),
        (pedal, head),
        (seat - Vec3::Z * 0.12, head),
        (rear, pedal),
        (rear, seat - Vec3::Z * 0.1),
        (head + Vec3::Z * 0.12, fore),
    ] {
        shape.add_rod(paint, from, to, 0.02);
    }
    shape.add_soft_box(black, [seat.x - 0.14, seat.x + 0.12], [-0.07, 0.07], [seat.z + 0.03, seat.z + 0.09], 0.03);
    shape.add_rod(black, head + Vec3::new(-0.02, -0.24, 0.16), head + Vec3::new(-0.02, 0.24, 0.16), 0.016);
    shape.add_hoop(HouseSurface::for_metal(Colour::Silver), pedal, Vec3::Y, 0.08, 0.012);
    shape
}
