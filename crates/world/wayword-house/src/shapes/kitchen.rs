//! Builds kitchen furniture. Lengths are metres; `hw` and `hd` are half
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

const BLACK_RGB: [u8; 3] = [26, 26, 30];

fn worktop_surface() -> HouseSurface {
    HouseSurface::new(SurfacePattern::Marble, [226, 222, 216])
}

/// Base cabinet up to the worktop, with two doors and a drawer above each.
fn add_base(shape: &mut HouseShape, look: &FurnitureLook, front: HouseSurface) {
    let (hw, hd) = look.half_size();
    shape.add_block(HouseSurface::from_rgb([60, 58, 56]), [-hw, hw], [-hd + 0.08, hd], [0.0, 0.1]);
    shape.add_block(front.shaded_by(0.8), [-hw, hw], [-hd + 0.04, hd], [0.1, look.h - 0.04]);
    let doors = if look.w > 1.0 {
        3
    } else if look.w > 0.7 {
        2
    } else {
        1
    };
    let width = look.w / doors as f32;
    let handle = HouseSurface::for_metal(Colour::DarkGrey);
    for door in 0..doors {
        let x = -hw + width * door as f32;
        let across = [x + 0.008, x + width - 0.008];
        shape.add_block(front, across, [-hd + 0.02, -hd + 0.045], [0.11, look.h - 0.23]);
        shape.add_block(front, across, [-hd + 0.02, -hd + 0.045], [look.h - 0.215, look.h - 0.05]);
        let middle = x + width / 2.0;
        for z in [look.h - 0.29, look.h - 0.14] {
            shape.add_block(handle, [middle - 0.08, middle + 0.08], [-hd - 0.005, -hd + 0.02], [z, z + 0.016]);
        }
    }
}

fn add_worktop(shape: &mut HouseShape, look: &FurnitureLook) {
    let (hw, hd) = look.half_size();
    shape.add_block(worktop_surface(), [-hw, hw], [-hd, hd], [look.h - 0.04, look.h]);
}

/// A stretch of worktop over cupboards.
pub(super) fn build_counter(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    add_base(&mut shape, look, HouseSurface::for_wood(look.colour));
    add_worktop(&mut shape, look);
    let (hw, hd) = look.half_size();
    let things = [ClutterItem::Bottles, ClutterItem::Bowl, ClutterItem::Cup, ClutterItem::Box, ClutterItem::Tray];
    if look.w > 1.0 {
        clutter::scatter_items(&mut shape, &things, [-hw + 0.05, hw - 0.05], hd - 0.2, look.h, look.variant);
    } else {
        // A device may stand behind it.
        let thing = [ClutterItem::Cup, ClutterItem::Bowl, ClutterItem::Bottles][look.variant as usize % 3];
        clutter::put_item(&mut shape, thing, Vec3::new(-hw + 0.14, -hd + 0.14, look.h), look.variant as usize);
    }
    shape
}

/// Worktop with a steel basin and a tap.
pub(super) fn build_sink(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), steel) = (look.half_size(), HouseSurface::for_metal(Colour::Silver));
    add_base(&mut shape, look, HouseSurface::for_wood(Colour::White));
    let (bx, by0, by1) = (hw - 0.08, -hd + 0.08, hd - 0.14);
    shape.add_block(worktop_surface(), [-hw, -bx], [-hd, hd], [look.h - 0.04, look.h]);
    shape.add_block(worktop_surface(), [bx, hw], [-hd, hd], [look.h - 0.04, look.h]);
    shape.add_block(worktop_surface(), [-bx, bx], [-hd, by0], [look.h - 0.04, look.h]);
    shape.add_block(worktop_surface(), [-bx, bx], [by1, hd], [look.h - 0.04, look.h]);
    shape.add_block(steel.shaded_by(0.6), [-bx, bx], [by0, by1], [look.h - 0.2, look.h - 0.18]);
    for x in [-bx, bx - 0.02] {
        shape.add_block(steel, [x, x + 0.02], [by0, by1], [look.h - 0.2, look.h + 0.008]);
    }
    for y in [by0, by1 - 0.02] {
        shape.add_block(steel.shaded_by(0.85), [-bx, bx], [y, y + 0.02], [look.h - 0.2, look.h + 0.008]);
    }
    add_tap(&mut shape, Vec3::new(0.0, hd - 0.07, look.h), 0.28);
    shape
}

/// A tap that bends forward.
pub(super) fn add_tap(shape: &mut HouseShape, foot: Vec3, height: f32) {
    let steel = HouseSurface::for_metal(Colour::Silver);
    let (up, ahead) = (Vec3::Z * height, Vec3::new(0.0, -height * 0.65, 0.0));
    shape.add_rod(steel, foot, foot + up, 0.016);
    shape.add_rod(steel, foot + up, foot + up + ahead, 0.014);
    shape.add_rod(steel, foot + up + ahead, foot + up + ahead - Vec3::Z * 0.05, 0.014);
    shape.add_rod(steel, foot + Vec3::new(0.02, 0.0, 0.05), foot + Vec3::new(0.1, 0.0, 0.09), 0.01);
}

/// A stove: four burners, knobs, and an oven with a window.
pub(super) fn build_stove(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), body) = (look.half_size(), HouseSurface::for_metal(look.colour));
    let black = HouseSurface::from_rgb(BLACK_RGB);
    shape.add_block(body.shaded_by(0.9), [-hw, hw], [-hd + 0.03, hd], [0.04, look.h - 0.02]);
    shape.add_block(body, [-hw + 0.01, hw - 0.01], [-hd + 0.01, -hd + 0.03], [0.26, 0.74]);
    shape.add_block(black, [-hw + 0.1, hw - 0.1], [-hd, -hd + 0.012], [0.36, 0.64]);
    shape.add_block(
        HouseSurface::for_metal(Colour::Silver),
        [-hw + 0.06, hw - 0.06],
        [-hd - 0.04, -hd - 0.02],
        [0.69, 0.715],
    );
    shape.add_block(body.shaded_by(0.95), [-hw + 0.01, hw - 0.01], [-hd + 0.01, -hd + 0.03], [0.06, 0.24]);
    shape.add_block(black, [-hw, hw], [-hd + 0.01, hd], [look.h - 0.025, look.h]);
    for knob in 0..5 {
        let x = -hw + 0.11 + knob as f32 * (look.w - 0.22) / 4.0;
        shape.add_rod(black, Vec3::new(x, -hd + 0.03, 0.82), Vec3::new(x, -hd - 0.02, 0.82), 0.022);
        shape.add_disc(HouseSurface::for_metal(Colour::Silver), Vec3::new(x, -hd - 0.021, 0.82), -Vec3::Y, 0.02);
    }
    for (x, y, r) in [(-0.15, -0.13, 0.1), (0.15, -0.13, 0.08), (-0.15, 0.14, 0.08), (0.15, 0.14, 0.1)] {
        let coil = HouseSurface::new(SurfacePattern::Coils, [255; 3]);
        shape.add_tube(HouseSurface::for_metal(Colour::Grey), (x, y), [r + 0.015, r + 0.015], [look.h, look.h + 0.006]);
        shape.add_disc(coil, Vec3::new(x, y, look.h + 0.012), Vec3::Z, r);
    }
    shape.add_block(body, [-hw, hw], [hd - 0.04, hd], [look.h, look.h + 0.1]);
    shape
}

/// A refrigerator: a freezer door over a long one, with long handles.
pub(super) fn build_refrigerator(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), body) = (look.half_size(), HouseSurface::for_metal(look.colour));
    let handle = HouseSurface::for_metal(Colour::DarkGrey);
    shape.add_block(body.shaded_by(0.75), [-hw, hw], [-hd + 0.06, hd], [0.03, look.h - 0.01]);
    let split = look.h * 0.66;
    for (z0, z1) in [(0.05, split - 0.008), (split + 0.008, look.h)] {
        shape.add_soft_box(body, [-hw, hw], [-hd, -hd + 0.07], [z0, z1], 0.012);
    }
    shape.add_block(
        HouseSurface::from_rgb([30, 30, 32]),
        [-hw + 0.005, hw - 0.005],
        [-hd + 0.02, -hd + 0.06],
        [split - 0.01, split + 0.01],
    );
    for (z0, z1) in [(split - 0.55, split - 0.06), (split + 0.06, look.h - 0.12)] {
        let x = hw - 0.07;
        shape.add_block(handle, [x - 0.014, x + 0.014], [-hd - 0.055, -hd - 0.03], [z0, z1]);
        for z in [z0, z1 - 0.03] {
            shape.add_block(handle, [x - 0.012, x + 0.012], [-hd - 0.035, -hd], [z, z + 0.03]);
        }
    }
    shape.add_block(HouseSurface::from_rgb([240, 214, 90]), [-0.18, -0.08], [-hd - 0.004, -hd], [1.42, 1.52]);
    shape.add_block(HouseSurface::from_rgb([120, 180, 220]), [-0.05, 0.07], [-hd - 0.004, -hd], [1.36, 1.5]);
    shape
}

/// A cupboard on the wall.
pub(super) fn build_wall_cabinet(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), wood) = (look.half_size(), HouseSurface::for_wood(look.colour));
    shape.add_block(wood.shaded_by(0.8), [-hw, hw], [-hd + 0.02, hd], [0.0, look.h]);
    for (x0, x1, knob) in [(-hw, 0.0, -0.04), (0.0, hw, 0.04)] {
        shape.add_block(wood, [x0 + 0.008, x1 - 0.008], [-hd, -hd + 0.022], [0.008, look.h - 0.008]);
        shape.add_block(wood.shaded_by(0.93), [x0 + 0.05, x1 - 0.05], [-hd - 0.003, -hd], [0.06, look.h - 0.06]);
        let steel = HouseSurface::for_metal(Colour::DarkGrey);
        shape.add_block(steel, [knob - 0.008, knob + 0.008], [-hd - 0.03, -hd], [0.05, 0.17]);
    }
    shape
}

/// A steel hood that tapers to a chimney.
pub(super) fn build_range_hood(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), steel) = (look.half_size(), HouseSurface::for_metal(look.colour));
    shape.add_block(steel, [-hw, hw], [-hd, hd], [0.0, 0.07]);
    shape.add_block(steel.shaded_by(0.95), [-hw * 0.75, hw * 0.75], [-hd * 0.6, hd], [0.07, 0.15]);
    shape.add_block(steel.shaded_by(0.9), [-0.13, 0.13], [hd - 0.26, hd], [0.15, look.h]);
    shape.add_block(HouseSurface::from_rgb([255, 244, 214]).glowing(), [-0.1, 0.1], [-0.05, 0.05], [-0.006, 0.0]);
    shape
}

/// A free-standing counter with a worktop that overhangs.
pub(super) fn build_island(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let (hw, hd) = look.half_size();
    let body = FurnitureLook { w: look.w - 0.1, d: look.d - 0.16, ..*look };
    add_base(&mut shape, &body, HouseSurface::for_wood(look.colour));
    shape.add_soft_box(worktop_surface(), [-hw, hw], [-hd, hd], [look.h - 0.05, look.h], 0.012);
    let things = [ClutterItem::Cup, ClutterItem::Bottles, ClutterItem::Books, ClutterItem::Tray, ClutterItem::Laptop];
    clutter::put_item(
        &mut shape,
        things[look.variant as usize % 5],
        Vec3::new(-hw * 0.6, 0.0, look.h),
        look.variant as usize,
    );
    shape
}

pub(super) fn build_microwave(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), body) = (look.half_size(), HouseSurface::for_metal(look.colour));
    shape.add_soft_box(body, [-hw, hw], [-hd, hd], [0.0, look.h], 0.012);
    shape.add_block(
        HouseSurface::from_rgb([20, 22, 26]),
        [-hw + 0.03, hw - 0.14],
        [-hd - 0.006, -hd],
        [0.05, look.h - 0.05],
    );
    shape.add_block(
        HouseSurface::from_rgb([12, 12, 14]),
        [hw - 0.11, hw - 0.02],
        [-hd - 0.006, -hd],
        [0.03, look.h - 0.03],
    );
    shape.add_block(
        HouseSurface::from_rgb([90, 230, 130]).glowing(),
        [hw - 0.1, hw - 0.03],
        [-hd - 0.008, -hd - 0.006],
        [look.h - 0.08, look.h - 0.05],
    );
    shape.add_block(
        HouseSurface::for_metal(Colour::Silver),
        [hw - 0.135, hw - 0.12],
        [-hd - 0.035, -hd - 0.01],
        [0.04, look.h - 0.04],
    );
    shape
}

pub(super) fn build_toaster(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), body) = (look.half_size(), HouseSurface::for_metal(look.colour));
    shape.add_soft_box(body, [-hw, hw], [-hd, hd], [0.01, look.h], 0.04);
    for y in [-0.035, 0.035] {
        shape.add_block(
            HouseSurface::from_rgb([24, 22, 20]),
            [-hw + 0.05, hw - 0.05],
            [y - 0.014, y + 0.014],
            [look.h - 0.01, look.h + 0.002],
        );
    }
    shape.add_block(HouseSurface::from_rgb([30, 30, 30]), [hw, hw + 0.02], [-0.02, 0.02], [0.1, 0.13]);
    shape
}

pub(super) fn build_kettle(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let body = HouseSurface::for_metal(look.colour);
    let black = HouseSurface::from_rgb([34, 34, 36]);
    shape.add_tube(black, (0.0, 0.0), [0.085, 0.085], [0.0, 0.03]);
    shape.add_turned(body, (0.0, 0.0), 1.0, &[(0.0, 0.03), (0.08, 0.03), (0.075, 0.14), (0.05, 0.22), (0.0, 0.24)]);
    shape.add_ball(black, Vec3::new(0.0, 0.0, 0.245), 0.015);
    shape.add_rod(body, Vec3::new(0.05, 0.0, 0.14), Vec3::new(0.12, 0.0, 0.21), 0.018);
    shape.add_rod(black, Vec3::new(-0.06, 0.0, 0.2), Vec3::new(-0.11, 0.0, 0.17), 0.012);
    shape.add_rod(black, Vec3::new(-0.11, 0.0, 0.17), Vec3::new(-0.08, 0.0, 0.07), 0.012);
    shape
}

pub(super) fn build_fruit_bowl(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let (r, body) = (look.w / 2.0, HouseSurface::from_rgb(look.colour.rgb()));
    shape.add_turned(
        body,
        (0.0, 0.0),
        1.0,
        &[(0.0, 0.0), (r * 0.5, 0.0), (r, 0.09), (r * 0.92, 0.09), (r * 0.4, 0.03), (0.0, 0.03)],
    );
    let fruit = [
        (0.0, 0.0, [206, 50, 40]),
        (0.08, 0.02, [238, 150, 40]),
        (-0.07, 0.04, [226, 200, 60]),
        (0.02, -0.08, [120, 170, 60]),
        (-0.04, -0.06, [210, 60, 44]),
    ];
    for (x, y, rgb) in fruit {
        shape.add_ball(HouseSurface::from_rgb(rgb), Vec3::new(x, y, 0.105), 0.045);
    }
    shape
}
