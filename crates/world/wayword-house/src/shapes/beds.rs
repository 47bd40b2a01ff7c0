//! Builds the bed. Lengths are metres; `hw` and `hd` are half
//! the width and half the depth of a piece, `look.h` its height.

use super::{
    super::{colour::Colour, surface::HouseSurface},
    FurnitureLook, HouseShape,
};

/// A frame with headboard, a mattress, a blanket that hangs over, and pillows.
pub(super) fn build_bed(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let (hw, hd) = look.half_size();
    let wood = HouseSurface::for_wood(
        [Colour::Brown, Colour::Wooden, Colour::White, Colour::Black][look.variant as usize % 4],
    );
    let white = HouseSurface::for_fabric(Colour::White);
    let blanket = HouseSurface::for_fabric(if look.colour == Colour::White { Colour::Cream } else { look.colour });
    shape.add_legs(wood.shaded_by(0.8), (hw, hd), 0.08, 0.16);
    shape.add_block(wood, [-hw, hw], [-hd, hd - 0.02], [0.14, 0.3]);
    shape.add_soft_box(wood, [-hw - 0.03, hw + 0.03], [hd - 0.08, hd], [0.0, look.h], 0.03);
    shape.add_soft_box(white, [-hw + 0.02, hw - 0.02], [-hd + 0.02, hd - 0.08], [0.28, 0.5], 0.06);
    shape.add_soft_box(blanket, [-hw - 0.01, hw + 0.01], [-hd, hd - 0.62], [0.2, 0.55], 0.06);
    shape.add_soft_box(white, [-hw, hw], [hd - 0.78, hd - 0.56], [0.3, 0.565], 0.06);
    let pillows = if look.w > 1.3 { 2 } else { 1 };
    let width = look.w / pillows as f32;
    for pillow in 0..pillows {
        let x = -hw + width * (pillow as f32 + 0.5);
        let half = (width / 2.0 - 0.06).min(0.36);
        shape.add_soft_box(white, [x - half, x + half], [hd - 0.54, hd - 0.1], [0.48, 0.64], 0.075);
        shape.add_soft_box(
            blanket.shaded_by(1.1),
            [x - half * 0.6, x + half * 0.6],
            [hd - 0.6, hd - 0.4],
            [0.5, 0.74],
            0.08,
        );
    }
    shape
}
