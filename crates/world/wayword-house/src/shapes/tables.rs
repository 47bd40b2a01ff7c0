//! Builds tables and desks. Lengths are metres; `hw` and `hd` are half
//! the width and half the depth of a piece, `look.h` its height.

use super::{
    super::{
        colour::Colour,
        surface::{HouseSurface, SurfacePattern},
    },
    FurnitureLook, HouseShape,
    clutter::{self, ClutterItem},
};
use glam::Vec3;

/// A top on four legs.
pub(super) fn build_table(look: &FurnitureLook) -> HouseShape {
    if look.colour == Colour::Glass {
        return build_glass_table(look);
    }
    let mut shape = HouseShape::default();
    let ((hw, hd), wood) = (look.half_size(), HouseSurface::for_wood(look.colour));
    shape.add_soft_box(wood, [-hw, hw], [-hd, hd], [look.h - 0.04, look.h], 0.012);
    let (aw, ad) = (hw - 0.06, hd - 0.05);
    shape.add_block(wood.shaded_by(0.85), [-aw, aw], [-ad, ad], [look.h - 0.11, look.h - 0.04]);
    shape.add_legs(wood.shaded_by(0.92), (hw - 0.02, hd - 0.01), 0.06, look.h - 0.04);
    if look.h < 0.6 {
        shape.add_block(wood.shaded_by(0.9), [-aw, aw], [-ad, ad], [0.12, 0.14]);
    }
    shape
}

/// A table with things on it, which depend on its size.
pub(super) fn build_laid_table(look: &FurnitureLook) -> HouseShape {
    let mut shape = build_table(look);
    let (hw, hd) = look.half_size();
    let things: &[ClutterItem] = if look.h < 0.6 {
        &[
            ClutterItem::Books,
            ClutterItem::Remote,
            ClutterItem::Tray,
            ClutterItem::Candles,
            ClutterItem::Bowl,
            ClutterItem::Cup,
        ]
    } else if look.d < 0.4 {
        &[ClutterItem::Photo, ClutterItem::Candles, ClutterItem::Bowl, ClutterItem::Books, ClutterItem::Box]
    } else {
        &[ClutterItem::Cup, ClutterItem::Bowl, ClutterItem::Bottles, ClutterItem::Candles, ClutterItem::Papers]
    };
    clutter::scatter_items(&mut shape, things, [-hw + 0.06, hw - 0.06], -hd * 0.35, look.h, look.variant);
    shape
}

/// A pane of glass on a steel frame, which shows below it.
fn build_glass_table(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), steel) = (look.half_size(), HouseSurface::for_metal(Colour::Silver));
    let pane = HouseSurface::new(SurfacePattern::Reflection, [214, 236, 238]);
    let top = Vec3::new(-hw, -hd, look.h);
    shape.add_picture(pane, top, Vec3::X * look.w, Vec3::Y * look.d);
    shape.add_block(HouseSurface::from_rgb([150, 196, 196]), [-hw, hw], [-hd, hd], [look.h - 0.018, look.h - 0.001]);
    for y in [-hd + 0.06, hd - 0.06] {
        shape.add_rod(steel, Vec3::new(-hw + 0.06, y, look.h - 0.03), Vec3::new(hw - 0.06, y, look.h - 0.03), 0.014);
        for x in [-hw + 0.06, hw - 0.06] {
            shape.add_rod(steel, Vec3::new(x, y, 0.0), Vec3::new(x, y, look.h - 0.02), 0.018);
        }
    }
    if look.h < 0.6 {
        shape.add_block(pane.shaded_by(0.9), [-hw + 0.08, hw - 0.08], [-hd + 0.08, hd - 0.08], [0.14, 0.152]);
    }
    shape
}

/// A desk with a block of drawers at its right, and a keyboard and papers on it.
pub(super) fn build_desk(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), wood) = (look.half_size(), HouseSurface::for_wood(look.colour));
    let under = look.h - 0.035;
    shape.add_block(wood, [-hw, hw], [-hd, hd], [under, look.h]);
    shape.add_block(wood.shaded_by(0.9), [-hw + 0.02, -hw + 0.06], [-hd + 0.04, hd - 0.02], [0.0, under]);
    shape.add_block(wood.shaded_by(0.9), [hw - 0.4, hw - 0.02], [-hd + 0.04, hd - 0.02], [0.04, under]);
    shape.add_block(wood.shaded_by(0.8), [-hw + 0.05, hw - 0.4], [hd - 0.05, hd - 0.03], [0.35, under]);
    for row in 0..3 {
        let z = 0.08 + 0.21 * row as f32;
        shape.add_block(wood.shaded_by(1.05), [hw - 0.38, hw - 0.04], [-hd + 0.02, -hd + 0.04], [z, z + 0.19]);
        let handle = HouseSurface::for_metal(Colour::Silver);
        shape.add_block(handle, [hw - 0.27, hw - 0.15], [-hd, -hd + 0.02], [z + 0.1, z + 0.12]);
    }
    shape.add_block(
        HouseSurface::from_rgb([52, 52, 56]),
        [-0.22, 0.22],
        [-hd + 0.1, -hd + 0.24],
        [look.h, look.h + 0.02],
    );
    let left = [ClutterItem::Papers, ClutterItem::Books, ClutterItem::Cup][look.variant as usize % 3];
    clutter::put_item(&mut shape, left, Vec3::new(-hw + 0.2, -hd + 0.22, look.h), look.variant as usize);
    let right = [ClutterItem::Cup, ClutterItem::Photo, ClutterItem::Books][(look.variant / 3) as usize % 3];
    clutter::put_item(&mut shape, right, Vec3::new(hw - 0.18, -hd + 0.2, look.h), look.variant as usize + 3);
    shape
}
