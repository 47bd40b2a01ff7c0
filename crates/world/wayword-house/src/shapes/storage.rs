//! Builds storage furniture: cabinets, shelves, racks. Lengths are metres; `hw` and `hd` are half
//! the width and half the depth of a piece, `look.h` its height.

use super::{
    super::{
        colour::Colour,
        surface::{HouseSurface, SurfacePattern},
    },
    FurnitureLook, HouseShape,
    clutter::{self, ClutterItem},
};
use glam::{Vec2, Vec3};

/// Colours of clothes, shoes and boxes.
const COAT_COLOURS: [Colour; 7] =
    [Colour::Red, Colour::Blue, Colour::White, Colour::Green, Colour::Purple, Colour::DarkGrey, Colour::Yellow];

/// Door or drawer fronts in a grid of columns and rows between the heights `z0` and `z1`, each with a handle: upright for
/// doors, level for drawers.
fn add_fronts(
    shape: &mut HouseShape,
    look: &FurnitureLook,
    columns: usize,
    rows: usize,
    (z0, z1): (f32, f32),
    upright: bool,
) {
    let ((hw, hd), wood) = (look.half_size(), HouseSurface::for_wood(look.colour));
    let (w, h) = (look.w / columns as f32, (z1 - z0) / rows as f32);
    let knob = HouseSurface::for_metal(if look.colour == Colour::White { Colour::DarkGrey } else { Colour::Gold });
    for column in 0..columns {
        for row in 0..rows {
            let (x, z) = (-hw + w * column as f32, z0 + h * row as f32);
            shape.add_block(
                wood.shaded_by(1.06),
                [x + 0.012, x + w - 0.012],
                [-hd - 0.012, -hd + 0.01],
                [z + 0.012, z + h - 0.012],
            );
            if upright {
                let x = if column % 2 == 0 { x + w - 0.06 } else { x + 0.06 };
                shape.add_block(knob, [x - 0.012, x + 0.012], [-hd - 0.045, -hd - 0.012], [z + h * 0.42, z + h * 0.58]);
            } else {
                let x = x + w / 2.0;
                shape.add_block(
                    knob,
                    [x - 0.06, x + 0.06],
                    [-hd - 0.04, -hd - 0.012],
                    [z + h * 0.5 - 0.01, z + h * 0.5 + 0.01],
                );
            }
        }
    }
}

/// A sideboard: a long low cabinet.
pub(super) fn build_sideboard(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), wood) = (look.half_size(), HouseSurface::for_wood(look.colour));
    shape.add_legs(wood.shaded_by(0.7), (hw - 0.03, hd - 0.02), 0.05, 0.12);
    shape.add_block(wood.shaded_by(0.85), [-hw, hw], [-hd, hd], [0.1, look.h - 0.025]);
    shape.add_block(wood, [-hw - 0.01, hw + 0.01], [-hd - 0.015, hd], [look.h - 0.025, look.h]);
    add_fronts(&mut shape, look, 4, 1, (0.12, look.h - 0.03), true);
    let things = [
        ClutterItem::Candles,
        ClutterItem::Bowl,
        ClutterItem::Bottles,
        ClutterItem::Photo,
        ClutterItem::Books,
        ClutterItem::Tray,
    ];
    clutter::scatter_items(&mut shape, &things, [-hw + 0.06, hw - 0.06], -hd * 0.3, look.h, look.variant);
    shape
}

/// A TV stand: doors at both ends, and open shelves with a player and films between them.
pub(super) fn build_tv_stand(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), wood) = (look.half_size(), HouseSurface::for_wood(look.colour));
    let third = hw * 0.36;
    let (low, high) = (0.1, look.h - 0.03);
    shape.add_legs(wood.shaded_by(0.7), (hw - 0.03, hd - 0.02), 0.05, 0.12);
    shape.add_block(wood, [-hw - 0.01, hw + 0.01], [-hd - 0.015, hd], [high, look.h]);
    shape.add_block(wood.shaded_by(0.9), [-hw, hw], [-hd, hd], [low, low + 0.03]);
    shape.add_block(HouseSurface::from_rgb([40, 38, 38]), [-third, third], [hd - 0.03, hd], [low, high]);
    let middle = (low + high) / 2.0;
    shape.add_block(wood.shaded_by(0.9), [-third, third], [-hd + 0.02, hd], [middle, middle + 0.02]);
    for (from, to) in [(-hw, -third), (third, hw)] {
        shape.add_block(wood.shaded_by(0.85), [from, to], [-hd, hd], [low, high]);
        shape.add_block(
            wood.shaded_by(1.06),
            [from + 0.012, to - 0.012],
            [-hd - 0.012, -hd],
            [low + 0.02, high - 0.012],
        );
        let knob = Vec3::new((from + to) / 2.0, -hd - 0.02, high - 0.08);
        shape.add_ball(HouseSurface::for_metal(Colour::DarkGrey), knob, 0.016);
    }
    let (black, light) = (HouseSurface::from_rgb([26, 26, 30]), HouseSurface::from_rgb([80, 200, 250]).glowing());
    shape.add_block(black, [-third + 0.05, third - 0.06], [-hd + 0.04, hd - 0.08], [middle + 0.02, middle + 0.08]);
    shape.add_block(light, [third - 0.14, third - 0.1], [-hd + 0.036, -hd + 0.04], [middle + 0.045, middle + 0.055]);
    clutter::put_item(
        &mut shape,
        ClutterItem::Books,
        Vec3::new(-0.08, -0.02, low + 0.03),
        look.variant as usize * 2 + 1,
    );
    clutter::put_item(&mut shape, ClutterItem::Remote, Vec3::new(hw - 0.12, -hd * 0.4, look.h), 0);
    shape
}

/// A chest of drawers.
pub(super) fn build_drawers(look: &FurnitureLook, columns: usize, rows: usize) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), wood) = (look.half_size(), HouseSurface::for_wood(look.colour));
    shape.add_legs(wood.shaded_by(0.7), (hw, hd), 0.05, 0.1);
    shape.add_block(wood.shaded_by(0.82), [-hw, hw], [-hd, hd], [0.08, look.h - 0.025]);
    shape.add_block(wood, [-hw - 0.01, hw + 0.01], [-hd - 0.015, hd], [look.h - 0.025, look.h]);
    add_fronts(&mut shape, look, columns, rows, (0.1, look.h - 0.03), false);
    if columns > 1 {
        let things =
            [ClutterItem::Box, ClutterItem::Candles, ClutterItem::Photo, ClutterItem::Books, ClutterItem::Bottles];
        clutter::scatter_items(&mut shape, &things, [-hw + 0.06, hw - 0.06], -hd * 0.3, look.h, look.variant);
    } else {
        let thing = [ClutterItem::Cup, ClutterItem::Remote, ClutterItem::Photo][look.variant as usize % 3];
        clutter::put_item(&mut shape, thing, Vec3::new(-hw + 0.1, -hd + 0.1, look.h), look.variant as usize);
    }
    shape
}

/// A metal cabinet of four drawers with label holders.
pub(super) fn build_filing_cabinet(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), metal) = (look.half_size(), HouseSurface::for_metal(look.colour));
    shape.add_block(metal.shaded_by(0.8), [-hw, hw], [-hd, hd], [0.0, look.h]);
    let h = (look.h - 0.04) / 4.0;
    for row in 0..4 {
        let z = 0.03 + h * row as f32;
        shape.add_block(metal, [-hw + 0.015, hw - 0.015], [-hd - 0.015, -hd], [z, z + h - 0.02]);
        shape.add_block(
            HouseSurface::for_metal(Colour::Silver),
            [-0.07, 0.07],
            [-hd - 0.04, -hd - 0.015],
            [z + h * 0.4, z + h * 0.48],
        );
        shape.add_block(
            HouseSurface::from_rgb([245, 245, 240]),
            [-0.05, 0.05],
            [-hd - 0.02, -hd - 0.014],
            [z + h * 0.62, z + h * 0.8],
        );
    }
    shape
}

/// Shelves full of books.
pub(super) fn build_bookshelf(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), wood) = (look.half_size(), HouseSurface::for_wood(look.colour));
    for x in [-hw, hw - 0.03] {
        shape.add_block(wood, [x, x + 0.03], [-hd, hd], [0.0, look.h]);
    }
    shape.add_block(wood.shaded_by(0.7), [-hw, hw], [hd - 0.015, hd], [0.0, look.h]);
    let shelves = 5;
    let h = (look.h - 0.08) / shelves as f32;
    for shelf in 0..=shelves {
        let z = 0.05 + h * shelf as f32;
        shape.add_block(wood, [-hw, hw], [-hd, hd], [z, z + 0.025]);
        if shelf < shelves {
            // Rows of spines of different height and start, so that no two shelves look alike.
            let filled = if (shelf as u32 + look.variant).is_multiple_of(4) { 0.62 } else { 0.97 };
            let (x0, x1) = (-hw + 0.03, -hw + 0.03 + (look.w - 0.06) * filled);
            let start = 0.37 * shelf as f32 + look.variant as f32 * 0.01;
            let (corner, u, v) = (Vec3::new(x0, -hd + 0.05, z + 0.025), Vec3::X * (x1 - x0), Vec3::Z * (h * 0.78));
            let books = HouseSurface::for_picture(SurfacePattern::Books);
            shape.add_quad(books, corner, u, v, Vec2::new(start, 0.0), Vec2::new(start + (x1 - x0) / 0.9, 1.0));
            shape.add_block(
                HouseSurface::from_rgb([214, 206, 190]),
                [x0, x1],
                [-hd + 0.055, hd - 0.02],
                [z + 0.025, z + 0.02 + h * 0.76],
            );
        }
    }
    shape
}

/// A tall cupboard with doors.
pub(super) fn build_wardrobe(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), wood) = (look.half_size(), HouseSurface::for_wood(look.colour));
    shape.add_block(wood.shaded_by(0.82), [-hw, hw], [-hd + 0.02, hd], [0.0, look.h]);
    shape.add_block(wood, [-hw - 0.02, hw + 0.02], [-hd - 0.02, hd], [look.h - 0.05, look.h]);
    add_fronts(&mut shape, look, if look.w > 1.5 { 3 } else { 2 }, 1, (0.08, look.h - 0.05), true);
    shape
}

/// The doors of a closet that is built into the wall: panels in a frame.
pub(super) fn build_closet_door(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), wood) = (look.half_size(), HouseSurface::for_wood(look.colour));
    let frame = HouseSurface::from_rgb([242, 241, 238]);
    shape.add_block(frame, [-hw, -hw + 0.05], [-hd, hd], [0.0, look.h]);
    shape.add_block(frame, [hw - 0.05, hw], [-hd, hd], [0.0, look.h]);
    shape.add_block(frame, [-hw, hw], [-hd, hd], [look.h - 0.06, look.h]);
    let leaves = if look.w > 1.5 { 4 } else { 2 };
    let wide = (look.w - 0.1) / leaves as f32;
    let knob = HouseSurface::for_metal(if look.colour == Colour::White { Colour::DarkGrey } else { Colour::Gold });
    for leaf in 0..leaves {
        let x = -hw + 0.05 + wide * leaf as f32;
        shape.add_block(wood.shaded_by(0.94), [x + 0.004, x + wide - 0.004], [-hd + 0.02, hd], [0.02, look.h - 0.06]);
        for (low, high) in [(0.14, 0.95), (1.05, look.h - 0.18)] {
            shape.add_block(wood, [x + 0.08, x + wide - 0.08], [-hd + 0.008, -hd + 0.02], [low, high]);
        }
        let at = if leaf % 2 == 0 { x + wide - 0.05 } else { x + 0.05 };
        shape.add_ball(knob, Vec3::new(at, -hd + 0.005, 1.0), 0.018);
    }
    shape
}

/// An open rack with shoes on it.
pub(super) fn build_shoe_rack(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), wood) = (look.half_size(), HouseSurface::for_wood(look.colour));
    for x in [-hw, hw - 0.03] {
        shape.add_block(wood, [x, x + 0.03], [-hd, hd], [0.0, look.h]);
    }
    for (shelf, z) in [0.05, 0.27, look.h - 0.03].into_iter().enumerate() {
        shape.add_block(wood, [-hw, hw], [-hd, hd], [z, z + 0.03]);
        if shelf < 2 {
            for pair in 0..3 {
                let x = -hw + 0.14 + pair as f32 * (look.w - 0.1) / 3.0;
                let colour = HouseSurface::from_rgb(COAT_COLOURS[(pair + shelf * 3 + look.variant as usize) % 7].rgb());
                for side in [-0.05, 0.05] {
                    shape.add_soft_box(
                        colour,
                        [x + side - 0.04, x + side + 0.04],
                        [-hd + 0.02, hd - 0.06],
                        [z + 0.03, z + 0.1],
                        0.035,
                    );
                    shape.add_soft_box(
                        colour,
                        [x + side - 0.04, x + side + 0.04],
                        [hd - 0.16, hd - 0.06],
                        [z + 0.03, z + 0.15],
                        0.035,
                    );
                }
            }
        }
    }
    shape
}

/// Two boards on the wall with bottles and boxes.
pub(super) fn build_wall_shelf(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), wood) = (look.half_size(), HouseSurface::for_wood(look.colour));
    for z in [0.0, look.h - 0.22] {
        shape.add_block(wood, [-hw, hw], [-hd, hd], [z, z + 0.03]);
        for item in 0..5 {
            let x = -hw + 0.1 + item as f32 * (look.w - 0.1) / 5.0;
            let colour = HouseSurface::from_rgb(COAT_COLOURS[(item + look.variant as usize) % 7].rgb());
            if item % 2 == 0 {
                shape.add_tube(colour, (x, 0.0), [0.045, 0.04], [z + 0.03, z + 0.2]);
            } else {
                shape.add_block(colour, [x - 0.06, x + 0.06], [-0.05, 0.05], [z + 0.03, z + 0.17]);
            }
        }
    }
    shape
}

/// A rail with clothes on hangers.
pub(super) fn build_clothes_rack(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), metal) = (look.half_size(), HouseSurface::for_metal(look.colour));
    for x in [-hw + 0.02, hw - 0.02] {
        shape.add_rod(metal, Vec3::new(x, 0.0, 0.03), Vec3::new(x, 0.0, look.h), 0.018);
        shape.add_rod(metal, Vec3::new(x, -hd, 0.03), Vec3::new(x, hd, 0.03), 0.018);
    }
    shape.add_rod(metal, Vec3::new(-hw, 0.0, look.h - 0.03), Vec3::new(hw, 0.0, look.h - 0.03), 0.018);
    let count = (look.w / 0.1) as usize - 1;
    for item in 0..count {
        let x = -hw + 0.1 + item as f32 * 0.1;
        let cloth = HouseSurface::for_fabric(COAT_COLOURS[(item * 3 + look.variant as usize) % 7]);
        let bottom = [0.55, 0.8, 0.7][(item + look.variant as usize) % 3];
        shape.add_soft_box(cloth, [x - 0.03, x + 0.03], [-hd + 0.03, hd - 0.03], [bottom, look.h - 0.12], 0.03);
        shape.add_rod(metal, Vec3::new(x, 0.0, look.h - 0.13), Vec3::new(x, 0.0, look.h - 0.02), 0.006);
    }
    shape
}

/// A post with hooks and coats.
pub(super) fn build_coat_rack(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let wood = HouseSurface::for_wood(look.colour);
    shape.add_tube(wood, (0.0, 0.0), [look.w / 2.0, look.w / 2.2], [0.0, 0.04]);
    shape.add_tube(wood, (0.0, 0.0), [0.025, 0.025], [0.0, look.h]);
    for hook in 0..4_usize {
        let (x, y) = [(1.0, 0.0), (0.0, -1.0), (-1.0, 0.0), (0.0, 1.0)][hook];
        shape.add_rod(wood, Vec3::new(0.0, 0.0, look.h - 0.14), Vec3::new(x * 0.18, y * 0.18, look.h - 0.04), 0.014);
        if hook < 3 {
            let coat = HouseSurface::for_fabric(COAT_COLOURS[(hook * 2 + look.variant as usize) % 7]);
            let (cx, cy) = (x * 0.13, y * 0.13);
            shape.add_soft_box(coat, [cx - 0.12, cx + 0.12], [cy - 0.1, cy + 0.1], [0.75, look.h - 0.16], 0.09);
        }
    }
    shape
}
