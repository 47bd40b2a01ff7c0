//! Builds showpieces: fireplace, piano, grandfather clock. Lengths are metres; `hw` and `hd` are half
//! the width and half the depth of a piece, `look.h` its height.

use super::{
    super::{
        colour::Colour,
        surface::{HouseSurface, SurfacePattern},
    },
    FurnitureLook, HouseShape,
};
use glam::Vec3;

/// A surround with a mantel, and a fire behind it.
pub(super) fn build_fireplace(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let (hw, hd) = look.half_size();
    let stone = match look.colour {
        Colour::Red => HouseSurface::new(SurfacePattern::Brick, [255; 3]),
        colour => HouseSurface::new(SurfacePattern::Marble, colour.rgb()),
    };
    let (open_w, open_h) = (hw * 0.58, look.h * 0.66);
    shape.add_block(stone, [-hw, -open_w], [-hd + 0.04, hd], [0.0, look.h - 0.08]);
    shape.add_block(stone, [open_w, hw], [-hd + 0.04, hd], [0.0, look.h - 0.08]);
    shape.add_block(stone, [-open_w, open_w], [-hd + 0.04, hd], [open_h, look.h - 0.08]);
    shape.add_block(stone.shaded_by(1.04), [-hw - 0.06, hw + 0.06], [-hd, hd], [look.h - 0.08, look.h]);
    let soot = HouseSurface::from_rgb([30, 26, 24]);
    shape.add_block(soot, [-open_w, open_w], [hd - 0.04, hd - 0.02], [0.0, open_h]);
    shape.add_block(soot, [-open_w, open_w], [-hd + 0.06, hd], [0.0, 0.03]);
    let wood = HouseSurface::for_wood(Colour::DarkBrown);
    for (x, z) in [(-0.16, 0.08), (0.14, 0.08), (0.0, 0.15)] {
        shape.add_rod(wood, Vec3::new(x - 0.2, -0.04, z), Vec3::new(x + 0.2, 0.04, z + 0.02), 0.05);
    }
    let fire = HouseSurface::for_picture(SurfacePattern::Fire).glowing();
    shape.add_picture(fire, Vec3::new(-open_w * 0.8, hd - 0.05, 0.04), Vec3::X * open_w * 1.6, Vec3::Z * open_h * 0.85);
    shape
}

/// An upright piano with its keys, and a score on the stand.
pub(super) fn build_piano(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), wood) = (look.half_size(), HouseSurface::for_wood(look.colour));
    shape.add_block(wood, [-hw, hw], [hd - 0.32, hd], [0.0, look.h]);
    shape.add_block(wood.shaded_by(1.15), [-hw - 0.01, hw + 0.01], [hd - 0.34, hd], [look.h - 0.03, look.h]);
    shape.add_block(wood.shaded_by(0.9), [-hw, hw], [-hd + 0.02, hd - 0.3], [0.62, 0.7]);
    for x in [-hw, hw - 0.06] {
        shape.add_block(wood, [x, x + 0.06], [-hd + 0.02, hd], [0.0, 0.78]);
    }
    shape.add_block(
        HouseSurface::from_rgb([250, 249, 244]),
        [-hw + 0.08, hw - 0.08],
        [-hd + 0.03, hd - 0.34],
        [0.7, 0.722],
    );
    let key = (look.w - 0.16) / 36.0;
    for at in 1..36 {
        let x = -hw + 0.08 + key * at as f32;
        let line = HouseSurface::from_rgb([120, 120, 118]);
        shape.add_block(line, [x - 0.0015, x + 0.0015], [-hd + 0.03, hd - 0.34], [0.722, 0.7225]);
        if ![3, 0].contains(&(at % 7)) {
            shape.add_block(
                HouseSurface::from_rgb([20, 20, 22]),
                [x - 0.009, x + 0.009],
                [-hd + 0.1, hd - 0.34],
                [0.722, 0.735],
            );
        }
    }
    shape.add_block(HouseSurface::from_rgb([244, 240, 228]), [-0.2, 0.2], [hd - 0.36, hd - 0.345], [0.82, 1.08]);
    shape.add_block(HouseSurface::from_rgb([120, 120, 118]), [-0.003, 0.003], [hd - 0.362, hd - 0.36], [0.82, 1.08]);
    shape
}

/// A tall case with a dial above and a pendulum behind a glass door.
pub(super) fn build_grandfather_clock(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), wood) = (look.half_size(), HouseSurface::for_wood(look.colour));
    let brass = HouseSurface::for_metal(Colour::Gold);
    shape.add_block(wood.shaded_by(0.9), [-hw, hw], [-hd, hd], [0.0, 0.42]);
    shape.add_block(wood, [-hw + 0.06, hw - 0.06], [-hd + 0.03, hd], [0.42, look.h - 0.56]);
    shape.add_block(wood.shaded_by(0.95), [-hw, hw], [-hd, hd], [look.h - 0.56, look.h - 0.06]);
    shape.add_block(wood.shaded_by(0.8), [-hw - 0.02, hw + 0.02], [-hd - 0.02, hd], [look.h - 0.08, look.h]);
    let glass = HouseSurface::from_rgb([54, 44, 36]);
    let corner = Vec3::new(-hw + 0.1, -hd + 0.028, 0.5);
    shape.add_picture(glass, corner, Vec3::X * (look.w - 0.2), Vec3::Z * (look.h - 1.14));
    let bob = Vec3::new(0.0, -hd + 0.024, 0.72);
    shape.add_rod(brass, Vec3::new(0.0, -hd + 0.024, look.h - 0.66), bob, 0.008);
    shape.add_disc(brass, bob - Vec3::Y * 0.008, -Vec3::Y, 0.07);
    let dial = Vec3::new(0.0, -hd - 0.006, look.h - 0.31);
    shape.add_disc(brass, dial + Vec3::Y * 0.004, -Vec3::Y, hw - 0.02);
    shape.add_disc(HouseSurface::for_picture(SurfacePattern::Dial), dial, -Vec3::Y, hw - 0.05);
    shape
}
