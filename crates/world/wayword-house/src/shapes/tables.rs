//! Tables and desks.

use super::{
    super::{
        colour::Colour,
        surface::{Pattern, Surface},
    },
    Look, Shape,
    clutter::{self, Thing},
};
use glam::Vec3;

/// A top on four legs.
pub(super) fn table(look: &Look) -> Shape {
    if look.colour == Colour::Glass {
        return glass_table(look);
    }
    let mut shape = Shape::default();
    let ((hw, hd), wood) = (look.half(), Surface::wood(look.colour));
    shape.soft(wood, [-hw, hw], [-hd, hd], [look.h - 0.04, look.h], 0.012);
    let (aw, ad) = (hw - 0.06, hd - 0.05);
    shape.block(wood.shade(0.85), [-aw, aw], [-ad, ad], [look.h - 0.11, look.h - 0.04]);
    shape.legs(wood.shade(0.92), (hw - 0.02, hd - 0.01), 0.06, look.h - 0.04);
    if look.h < 0.6 {
        shape.block(wood.shade(0.9), [-aw, aw], [-ad, ad], [0.12, 0.14]);
    }
    shape
}

/// A table with things on it, which depend on its size.
pub(super) fn laid_table(look: &Look) -> Shape {
    let mut shape = table(look);
    let (hw, hd) = look.half();
    let things: &[Thing] = if look.h < 0.6 {
        &[Thing::Books, Thing::Remote, Thing::Tray, Thing::Candles, Thing::Bowl, Thing::Cup]
    } else if look.d < 0.4 {
        &[Thing::Photo, Thing::Candles, Thing::Bowl, Thing::Books, Thing::Box]
    } else {
        &[Thing::Cup, Thing::Bowl, Thing::Bottles, Thing::Candles, Thing::Papers]
    };
    clutter::scatter(&mut shape, things, [-hw + 0.06, hw - 0.06], -hd * 0.35, look.h, look.variant);
    shape
}

/// A pane of glass on a steel frame, which shows below it.
fn glass_table(look: &Look) -> Shape {
    let mut shape = Shape::default();
    let ((hw, hd), steel) = (look.half(), Surface::metal(Colour::Silver));
    let pane = Surface::new(Pattern::Reflection, [214, 236, 238]);
    let top = Vec3::new(-hw, -hd, look.h);
    shape.picture(pane, top, Vec3::X * look.w, Vec3::Y * look.d);
    shape.block(Surface::plain([150, 196, 196]), [-hw, hw], [-hd, hd], [look.h - 0.018, look.h - 0.001]);
    for y in [-hd + 0.06, hd - 0.06] {
        shape.rod(steel, Vec3::new(-hw + 0.06, y, look.h - 0.03), Vec3::new(hw - 0.06, y, look.h - 0.03), 0.014);
        for x in [-hw + 0.06, hw - 0.06] {
            shape.rod(steel, Vec3::new(x, y, 0.0), Vec3::new(x, y, look.h - 0.02), 0.018);
        }
    }
    if look.h < 0.6 {
        shape.block(pane.shade(0.9), [-hw + 0.08, hw - 0.08], [-hd + 0.08, hd - 0.08], [0.14, 0.152]);
    }
    shape
}

/// A desk with a block of drawers at its right, and a keyboard and papers on it.
pub(super) fn desk(look: &Look) -> Shape {
    let mut shape = Shape::default();
    let ((hw, hd), wood) = (look.half(), Surface::wood(look.colour));
    let under = look.h - 0.035;
    shape.block(wood, [-hw, hw], [-hd, hd], [under, look.h]);
    shape.block(wood.shade(0.9), [-hw + 0.02, -hw + 0.06], [-hd + 0.04, hd - 0.02], [0.0, under]);
    shape.block(wood.shade(0.9), [hw - 0.4, hw - 0.02], [-hd + 0.04, hd - 0.02], [0.04, under]);
    shape.block(wood.shade(0.8), [-hw + 0.05, hw - 0.4], [hd - 0.05, hd - 0.03], [0.35, under]);
    for row in 0..3 {
        let z = 0.08 + 0.21 * row as f32;
        shape.block(wood.shade(1.05), [hw - 0.38, hw - 0.04], [-hd + 0.02, -hd + 0.04], [z, z + 0.19]);
        let handle = Surface::metal(Colour::Silver);
        shape.block(handle, [hw - 0.27, hw - 0.15], [-hd, -hd + 0.02], [z + 0.1, z + 0.12]);
    }
    shape.block(Surface::plain([52, 52, 56]), [-0.22, 0.22], [-hd + 0.1, -hd + 0.24], [look.h, look.h + 0.02]);
    let left = [Thing::Papers, Thing::Books, Thing::Cup][look.variant as usize % 3];
    clutter::put(&mut shape, left, Vec3::new(-hw + 0.2, -hd + 0.22, look.h), look.variant as usize);
    let right = [Thing::Cup, Thing::Photo, Thing::Books][(look.variant / 3) as usize % 3];
    clutter::put(&mut shape, right, Vec3::new(hw - 0.18, -hd + 0.2, look.h), look.variant as usize + 3);
    shape
}
