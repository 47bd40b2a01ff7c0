//! Car and bicycle.

use super::{
    super::{colour::Colour, surface::Surface},
    Look, Shape,
};
use glam::Vec3;

/// A small car; its nose looks forward.
pub(super) fn car(look: &Look) -> Shape {
    let mut shape = Shape::default();
    let ((hw, hd), paint) = (look.half(), Surface::plain(look.colour.rgb()));
    let glass = Surface::plain([44, 54, 64]);
    shape.soft(paint, [-hw, hw], [-hd, hd], [0.26, 0.84], 0.16);
    shape.soft(paint, [-hw + 0.14, hw - 0.14], [-hd * 0.36, hd * 0.86], [0.7, look.h], 0.2);
    let (front, back) = (-hd * 0.36 - 0.01, hd * 0.86 + 0.01);
    shape.soft(glass, [-hw + 0.24, hw - 0.24], [front, front + 0.1], [0.9, 1.32], 0.04);
    shape.soft(glass, [-hw + 0.24, hw - 0.24], [back - 0.1, back], [0.9, 1.32], 0.04);
    for side in [-1.0, 1.0] {
        let x = side * (hw - 0.145);
        for (y0, y1) in [(-hd * 0.28, hd * 0.2), (hd * 0.26, hd * 0.74)] {
            shape.soft(glass, [x - 0.015, x + 0.015], [y0, y1], [0.9, 1.3], 0.01);
        }
        let (low, lamp) = (side * (hw - 0.3), Surface::plain([255, 252, 226]).glowing());
        shape.soft(lamp, [low - 0.15, low + 0.15], [-hd - 0.01, -hd + 0.1], [0.58, 0.72], 0.05);
        let rear = Surface::plain([200, 30, 30]);
        shape.soft(rear, [low - 0.15, low + 0.15], [hd - 0.1, hd + 0.01], [0.6, 0.74], 0.05);
        for y in [-hd * 0.62, hd * 0.6] {
            wheel(&mut shape, Vec3::new(side * (hw - 0.12), y, 0.32), side);
        }
    }
    shape.block(Surface::plain([30, 30, 32]), [-0.35, 0.35], [-hd - 0.005, -hd + 0.1], [0.4, 0.54]);
    shape.block(Surface::plain([250, 250, 246]), [-0.25, 0.25], [-hd - 0.02, -hd], [0.3, 0.4]);
    shape.block(Surface::plain([250, 250, 246]), [-0.25, 0.25], [hd, hd + 0.02], [0.46, 0.57]);
    shape
}

fn wheel(shape: &mut Shape, centre: Vec3, side: f32) {
    let (out, tyre) = (Vec3::X * side, Surface::plain([30, 30, 32]));
    shape.rod(tyre, centre - out * 0.1, centre + out * 0.13, 0.32);
    shape.disc(tyre, centre + out * 0.13, out, 0.32);
    shape.disc(Surface::metal(Colour::Silver), centre + out * 0.132, out, 0.19);
}

/// Two wheels, a frame, saddle and handlebar.
pub(super) fn bicycle(look: &Look) -> Shape {
    let mut shape = Shape::default();
    let (paint, black) = (Surface::plain(look.colour.rgb()), Surface::plain([30, 30, 32]));
    let r = 0.33;
    let x = look.w / 2.0 - r - 0.02;
    let (rear, fore) = (Vec3::new(-x, 0.0, r + 0.01), Vec3::new(x, 0.0, r + 0.01));
    for hub in [rear, fore] {
        shape.hoop(black, hub, Vec3::Y, r - 0.02, 0.02);
        for spoke in 0..4 {
            let angle = std::f32::consts::FRAC_PI_4 * spoke as f32;
            let out = Vec3::new(libm::cosf(angle), 0.0, libm::sinf(angle)) * (r - 0.03);
            shape.rod(Surface::metal(Colour::Silver), hub - out, hub + out, 0.003);
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
        shape.rod(paint, from, to, 0.02);
    }
    shape.soft(black, [seat.x - 0.14, seat.x + 0.12], [-0.07, 0.07], [seat.z + 0.03, seat.z + 0.09], 0.03);
    shape.rod(black, head + Vec3::new(-0.02, -0.24, 0.16), head + Vec3::new(-0.02, 0.24, 0.16), 0.016);
    shape.hoop(Surface::metal(Colour::Silver), pedal, Vec3::Y, 0.08, 0.012);
    shape
}
