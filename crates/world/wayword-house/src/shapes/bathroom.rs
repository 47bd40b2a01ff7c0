//! Builds bathroom furniture. Lengths are metres; `hw` and `hd` are half
//! the width and half the depth of a piece, `look.h` its height.

use super::{
    super::{
        colour::Colour,
        surface::{HouseSurface, SurfacePattern},
    },
    FurnitureLook, HouseShape,
    clutter::{self, ClutterItem},
    kitchen::add_tap,
};
use glam::{Vec2, Vec3};

const CHINA_RGB: [u8; 3] = [246, 246, 244];

/// A bowl on a foot, seat and raised lid, and a cistern behind.
pub(super) fn build_toilet(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), china) = (look.half_size(), HouseSurface::from_rgb(CHINA_RGB));
    let middle = (0.0, -0.1);
    shape.add_soft_box(china.shaded_by(0.95), [-0.11, 0.11], [-0.22, hd - 0.12], [0.0, 0.3], 0.06);
    let bowl = [(0.09, 0.12), (0.13, 0.2), (0.175, 0.3), (0.19, 0.38), (0.19, 0.4), (0.13, 0.4)];
    shape.add_turned(china, middle, 1.28, &bowl);
    let inside = [(0.13, 0.4), (0.1, 0.3), (0.04, 0.25), (0.0, 0.25)];
    shape.add_turned(china.shaded_by(0.8), middle, 1.28, &inside);
    shape.add_tube(HouseSurface::from_rgb([150, 190, 210]), middle, [0.055, 0.055], [0.25, 0.262]);
    let seat = [(0.2, 0.4), (0.2, 0.425), (0.12, 0.43), (0.12, 0.4)];
    shape.add_turned(china.shaded_by(0.97), middle, 1.25, &seat);
    // The lid leans against the cistern.
    shape.add_soft_box(china, [-0.18, 0.18], [hd - 0.25, hd - 0.22], [0.42, 0.74], 0.02);
    shape.add_soft_box(china, [-hw, hw], [hd - 0.2, hd], [0.38, look.h], 0.04);
    shape.add_soft_box(china.shaded_by(0.96), [-hw - 0.01, hw + 0.01], [hd - 0.21, hd], [look.h - 0.05, look.h], 0.015);
    shape.add_rod(
        HouseSurface::for_metal(Colour::Silver),
        Vec3::new(0.0, hd - 0.1, look.h),
        Vec3::new(0.0, hd - 0.1, look.h + 0.015),
        0.025,
    );
    shape
}

/// A cabinet with a basin set into its top, and a tap.
pub(super) fn build_vanity(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), china) = (look.half_size(), HouseSurface::from_rgb(CHINA_RGB));
    let wood =
        HouseSurface::for_wood([Colour::Wooden, Colour::Grey, Colour::White, Colour::Brown][look.variant as usize % 4]);
    shape.add_block(wood.shaded_by(0.8), [-hw + 0.02, hw - 0.02], [-hd + 0.04, hd], [0.12, look.h - 0.08]);
    for (x0, x1, knob) in [(-hw + 0.02, 0.0, -0.05), (0.0, hw - 0.02, 0.05)] {
        shape.add_block(wood, [x0 + 0.006, x1 - 0.006], [-hd + 0.02, -hd + 0.042], [0.13, look.h - 0.09]);
        shape.add_block(
            HouseSurface::for_metal(Colour::DarkGrey),
            [knob - 0.008, knob + 0.008],
            [-hd - 0.005, -hd + 0.02],
            [0.5, 0.64],
        );
    }
    shape.add_block(china, [-hw, hw], [-hd, hd], [look.h - 0.08, look.h - 0.03]);
    let r = hw.min(0.26);
    let basin = [
        (r * 0.8, look.h - 0.03),
        (r, look.h + 0.05),
        (r * 0.93, look.h + 0.05),
        (r * 0.6, look.h - 0.02),
        (0.0, look.h - 0.025),
    ];
    shape.add_turned(china, (0.0, -0.03), 0.72, &basin);
    shape.add_tube(
        HouseSurface::for_metal(Colour::Silver),
        (0.0, -0.03),
        [0.025, 0.025],
        [look.h - 0.024, look.h - 0.018],
    );
    add_tap(&mut shape, Vec3::new(0.0, hd - 0.05, look.h - 0.03), 0.2);
    if look.w > 0.7 {
        clutter::put_item(
            &mut shape,
            ClutterItem::Cup,
            Vec3::new(hw - 0.07, -hd + 0.12, look.h - 0.03),
            look.variant as usize,
        );
        clutter::put_item(
            &mut shape,
            ClutterItem::Bottles,
            Vec3::new(-hw + 0.13, hd - 0.06, look.h - 0.03),
            look.variant as usize,
        );
    }
    shape
}

/// A tub with a thick rim, a hollow, and taps at one end.
pub(super) fn build_bathtub(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), china) = (look.half_size(), HouseSurface::from_rgb(CHINA_RGB));
    let rim = 0.08;
    shape.add_soft_box(china, [-hw, hw], [-hd, -hd + rim], [0.0, look.h], 0.03);
    shape.add_soft_box(china, [-hw, hw], [hd - rim, hd], [0.0, look.h], 0.03);
    shape.add_soft_box(china, [-hw, -hw + rim], [-hd, hd], [0.0, look.h], 0.03);
    shape.add_soft_box(china, [hw - rim * 1.8, hw], [-hd, hd], [0.0, look.h], 0.03);
    shape.add_block(china.shaded_by(0.9), [-hw + rim, hw - rim], [-hd + rim, hd - rim], [0.1, 0.16]);
    shape.add_block(HouseSurface::from_rgb([176, 212, 226]), [-hw + rim, hw - rim], [-hd + rim, hd - rim], [0.3, 0.34]);
    add_tap(&mut shape, Vec3::new(hw - 0.08, 0.04, look.h), 0.16);
    let steel = HouseSurface::for_metal(Colour::Silver);
    for y in [-0.12, 0.14] {
        shape.add_ball(steel, Vec3::new(hw - 0.08, y, look.h + 0.04), 0.03);
    }
    shape
}

/// A tray with two glass sides in steel frames, and a shower head.
pub(super) fn build_shower(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), steel) = (look.half_size(), HouseSurface::for_metal(Colour::Silver));
    shape.add_block(HouseSurface::from_rgb(CHINA_RGB), [-hw, hw], [-hd, hd], [0.0, 0.1]);
    let wall = HouseSurface::new(SurfacePattern::Tiles, [170, 206, 220]);
    shape.add_picture(wall, Vec3::new(-hw, hd - 0.005, 0.1), Vec3::X * look.w, Vec3::Z * (look.h - 0.1));
    // The renderer has no transparency. So the panes end at hip height, and only the frame goes up further.
    for (x, y) in [(-hw, -hd), (hw - 0.03, -hd), (-hw, hd - 0.03), (hw - 0.03, hd - 0.03)] {
        shape.add_block(steel, [x, x + 0.03], [y, y + 0.03], [0.08, look.h]);
    }
    for z in [1.0, look.h - 0.03] {
        shape.add_block(steel, [-hw, hw], [-hd, -hd + 0.03], [z, z + 0.03]);
        shape.add_block(steel, [hw - 0.03, hw], [-hd, hd], [z, z + 0.03]);
        shape.add_block(steel, [-hw, -hw + 0.03], [-hd, hd], [z, z + 0.03]);
    }
    let glass = HouseSurface::from_rgb([176, 208, 222]);
    shape.add_block(glass, [-hw + 0.03, hw - 0.03], [-hd + 0.01, -hd + 0.02], [0.1, 1.0]);
    for x in [-hw + 0.01, hw - 0.02] {
        shape.add_block(glass, [x, x + 0.01], [-hd + 0.03, hd - 0.03], [0.1, 1.0]);
    }
    shape.add_block(HouseSurface::for_metal(Colour::DarkGrey), [hw - 0.2, hw - 0.17], [-hd - 0.03, -hd], [0.7, 0.95]);
    let pipe = Vec3::new(0.0, hd - 0.04, 0.0);
    shape.add_rod(steel, pipe + Vec3::Z * 1.0, pipe + Vec3::Z * 1.95, 0.014);
    shape.add_rod(steel, pipe + Vec3::Z * 1.95, Vec3::new(0.0, hd - 0.28, 1.97), 0.014);
    shape.add_tube(steel, (0.0, hd - 0.3), [0.11, 0.05], [1.88, 1.96]);
    shape.add_ball(steel, pipe + Vec3::new(0.0, -0.02, 1.05), 0.045);
    shape
}

/// A towel over a rail.
pub(super) fn build_towel(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), cloth) = (look.half_size(), HouseSurface::for_fabric(look.colour));
    let steel = HouseSurface::for_metal(Colour::Silver);
    shape.add_rod(steel, Vec3::new(-hw, 0.0, look.h - 0.02), Vec3::new(hw, 0.0, look.h - 0.02), 0.012);
    for x in [-hw + 0.01, hw - 0.01] {
        shape.add_rod(steel, Vec3::new(x, 0.0, look.h - 0.02), Vec3::new(x, hd, look.h - 0.02), 0.01);
    }
    shape.add_soft_box(cloth, [-hw + 0.06, hw - 0.06], [-hd, hd - 0.02], [0.0, look.h], 0.015);
    for z in [0.06, 0.11] {
        let corner = Vec3::new(-hw + 0.06, -hd - 0.002, z);
        let stripe = HouseSurface::for_fabric(if look.colour == Colour::White { Colour::Blue } else { Colour::White });
        shape.add_quad(stripe, corner, Vec3::X * (look.w - 0.12), Vec3::Z * 0.025, Vec2::ZERO, Vec2::new(1.0, 0.1));
    }
    shape
}
