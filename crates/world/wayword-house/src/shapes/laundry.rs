//! Builds the furniture of a laundry room. Lengths are metres; `hw` and `hd` are half
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

/// A washing machine or dryer with a round door; `glass` is the colour of its window.
fn build_machine(look: &FurnitureLook, glass: [u8; 3]) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), body) = (look.half_size(), HouseSurface::from_rgb(look.colour.rgb()));
    shape.add_soft_box(body, [-hw, hw], [-hd, hd], [0.02, look.h], 0.015);
    shape.add_block(body.shaded_by(0.86), [-hw + 0.01, hw - 0.01], [-hd - 0.008, -hd], [look.h - 0.15, look.h - 0.02]);
    let centre = Vec3::new(0.0, -hd, look.h * 0.45);
    shape.add_rod(HouseSurface::for_metal(Colour::Silver), centre, centre - Vec3::Y * 0.035, 0.23);
    shape.add_disc(HouseSurface::for_metal(Colour::Silver), centre - Vec3::Y * 0.035, -Vec3::Y, 0.23);
    shape.add_disc(HouseSurface::from_rgb(glass), centre - Vec3::Y * 0.038, -Vec3::Y, 0.17);
    let dial = Vec3::new(hw - 0.13, -hd - 0.008, look.h - 0.085);
    shape.add_rod(HouseSurface::for_metal(Colour::DarkGrey), dial, dial - Vec3::Y * 0.025, 0.035);
    shape.add_disc(HouseSurface::for_metal(Colour::Silver), dial - Vec3::Y * 0.026, -Vec3::Y, 0.03);
    shape
}

/// A front loader with a drawer for the powder.
pub(super) fn build_washer(look: &FurnitureLook) -> HouseShape {
    let mut shape = build_machine(look, [56, 74, 92]);
    let (hw, hd) = look.half_size();
    shape.add_block(
        HouseSurface::from_rgb([230, 230, 228]),
        [-hw + 0.03, -hw + 0.2],
        [-hd - 0.016, -hd - 0.008],
        [look.h - 0.13, look.h - 0.04],
    );
    shape.add_block(
        HouseSurface::from_rgb([60, 200, 220]).glowing(),
        [-0.05, 0.08],
        [-hd - 0.012, -hd - 0.008],
        [look.h - 0.11, look.h - 0.06],
    );
    clutter::put_item(&mut shape, ClutterItem::Bottles, Vec3::new(-hw + 0.16, 0.08, look.h), look.variant as usize);
    clutter::put_item(&mut shape, ClutterItem::Box, Vec3::new(hw - 0.18, 0.08, look.h), 0);
    shape
}

/// Like the washer, with a lighter drum and a vent.
pub(super) fn build_dryer(look: &FurnitureLook) -> HouseShape {
    let mut shape = build_machine(look, [120, 124, 130]);
    let (hw, hd) = look.half_size();
    clutter::put_item(&mut shape, ClutterItem::Towels, Vec3::new(0.0, 0.06, look.h), look.variant as usize);
    for bar in 0..5 {
        let z = 0.06 + 0.02 * bar as f32;
        shape.add_block(
            HouseSurface::from_rgb([110, 110, 112]),
            [-hw + 0.06, hw - 0.06],
            [-hd - 0.006, -hd],
            [z, z + 0.008],
        );
    }
    shape
}

/// A wicker basket with clothes that stick out.
pub(super) fn build_basket(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let r = look.w / 2.0;
    let wicker = HouseSurface::new(SurfacePattern::Wicker, look.colour.rgb());
    let profile = [
        (0.0, 0.0),
        (r * 0.8, 0.0),
        (r, look.h - 0.08),
        (r + 0.01, look.h - 0.05),
        (r * 0.9, look.h - 0.06),
        (r * 0.85, look.h - 0.12),
        (0.0, look.h - 0.12),
    ];
    shape.add_turned(wicker, (0.0, 0.0), look.d / look.w, &profile);
    for (x, y, colour) in [(-0.07, 0.0, Colour::Blue), (0.08, 0.03, Colour::White), (0.02, -0.06, Colour::Red)] {
        shape.add_soft_box(
            HouseSurface::for_fabric(colour),
            [x - 0.1, x + 0.1],
            [y - 0.08, y + 0.08],
            [look.h - 0.16, look.h],
            0.07,
        );
    }
    shape
}

/// A padded board on crossed legs, with an iron on it.
pub(super) fn build_ironing_board(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), steel) = (look.half_size(), HouseSurface::for_metal(Colour::Silver));
    let top = look.h - 0.12;
    shape.add_soft_box(HouseSurface::for_fabric(look.colour), [-hw, hw - 0.12], [-hd, hd], [top - 0.04, top], 0.02);
    shape.add_soft_box(
        HouseSurface::for_fabric(look.colour),
        [hw - 0.3, hw],
        [-hd * 0.6, hd * 0.6],
        [top - 0.04, top - 0.002],
        0.02,
    );
    for y in [-hd * 0.7, hd * 0.7] {
        shape.add_rod(steel, Vec3::new(-hw * 0.7, y, 0.0), Vec3::new(hw * 0.5, y, top - 0.03), 0.012);
        shape.add_rod(steel, Vec3::new(hw * 0.7, y, 0.0), Vec3::new(-hw * 0.5, y, top - 0.03), 0.012);
    }
    shape.add_soft_box(
        HouseSurface::from_rgb([60, 110, 180]),
        [-hw + 0.1, -hw + 0.34],
        [-0.055, 0.055],
        [top, top + 0.06],
        0.03,
    );
    shape.add_block(
        HouseSurface::from_rgb([40, 40, 44]),
        [-hw + 0.12, -hw + 0.3],
        [-0.015, 0.015],
        [top + 0.09, top + 0.12],
    );
    shape.add_block(
        HouseSurface::from_rgb([40, 40, 44]),
        [-hw + 0.12, -hw + 0.15],
        [-0.015, 0.015],
        [top + 0.05, top + 0.1],
    );
    shape
}
