//! Builds the furniture of a garage, without the car. Lengths are metres; `hw` and `hd` are half
//! the width and half the depth of a piece, `look.h` its height.

use super::{
    super::{colour::Colour, surface::HouseSurface},
    FurnitureLook, HouseShape,
};
use glam::Vec3;

/// A heavy bench with a vice and a panel of tools.
pub(super) fn build_workbench(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), wood) = (look.half_size(), HouseSurface::for_wood(look.colour));
    shape.add_block(wood, [-hw, hw], [-hd, hd], [look.h - 0.07, look.h]);
    shape.add_legs(wood.shaded_by(0.8), (hw, hd), 0.09, look.h - 0.07);
    shape.add_block(wood.shaded_by(0.85), [-hw + 0.04, hw - 0.04], [-hd + 0.05, hd - 0.05], [0.2, 0.24]);
    shape.add_block(HouseSurface::for_metal(Colour::Red), [-0.3, 0.1], [-hd + 0.1, hd - 0.1], [0.24, 0.46]);
    shape.add_block(
        HouseSurface::for_metal(Colour::Blue),
        [hw - 0.3, hw - 0.12],
        [-hd - 0.04, -hd + 0.16],
        [look.h, look.h + 0.1],
    );
    shape.add_rod(
        HouseSurface::for_metal(Colour::Grey),
        Vec3::new(-hw + 0.2, 0.0, look.h + 0.02),
        Vec3::new(-hw + 0.5, 0.1, look.h + 0.02),
        0.015,
    );
    shape.add_block(
        HouseSurface::for_metal(Colour::DarkGrey),
        [-hw + 0.16, -hw + 0.22],
        [-0.06, 0.06],
        [look.h, look.h + 0.05],
    );
    shape
}

/// Three boxes, one on top of two.
pub(super) fn build_boxes(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), card) = (look.half_size(), HouseSurface::for_fabric(look.colour));
    let tape = HouseSurface::from_rgb([226, 206, 160]);
    let levels = [
        ([-hw, -0.02], [0.0, look.h * 0.48]),
        ([0.02, hw], [0.0, look.h * 0.42]),
        ([-hw * 0.8, hw * 0.3], [look.h * 0.48, look.h]),
    ];
    for (x, z) in levels {
        shape.add_block(card, x, [-hd, hd], z);
        let middle = (x[0] + x[1]) / 2.0;
        shape.add_block(tape, [middle - 0.025, middle + 0.025], [-hd - 0.003, hd], [z[0] + 0.1, z[1] + 0.003]);
    }
    shape
}

/// Open metal shelves with cans and crates.
pub(super) fn build_metal_shelf(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), metal) = (look.half_size(), HouseSurface::for_metal(look.colour));
    shape.add_legs(metal.shaded_by(0.8), (hw, hd), 0.04, look.h);
    let goods = [Colour::Red, Colour::Blue, Colour::White, Colour::Green, Colour::Yellow, Colour::Black];
    for level in 0..4 {
        let z = 0.1 + level as f32 * (look.h - 0.15) / 3.0;
        shape.add_block(metal, [-hw, hw], [-hd, hd], [z, z + 0.03]);
        if level == 3 {
            continue;
        }
        for item in 0..4 {
            let x = -hw + 0.16 + item as f32 * (look.w - 0.1) / 4.0;
            let colour = HouseSurface::from_rgb(goods[(item + level * 2 + look.variant as usize) % 6].rgb());
            if (item + level) % 2 == 0 {
                shape.add_tube(colour, (x, 0.0), [0.09, 0.09], [z + 0.03, z + 0.26]);
            } else {
                shape.add_block(colour, [x - 0.11, x + 0.11], [-0.14, 0.14], [z + 0.03, z + 0.22]);
            }
        }
    }
    shape
}
