//! Builds decoration: things that hang on walls or lie on floors. Lengths are metres; `hw` and `hd` are half
//! the width and half the depth of a piece, `look.h` its height.

use super::{
    super::{
        colour::Colour,
        surface::{ART_COUNT, HouseSurface, SurfacePattern},
    },
    FurnitureLook, HouseShape,
};
use glam::{Vec2, Vec3};

/// Four bars around a picture that looks forward.
fn add_framed(shape: &mut HouseShape, look: &FurnitureLook, frame: HouseSurface, bar: f32, inside: HouseSurface) {
    let (hw, hd) = look.half_size();
    shape.add_block(frame, [-hw, hw], [-hd, hd], [0.0, bar]);
    shape.add_block(frame, [-hw, hw], [-hd, hd], [look.h - bar, look.h]);
    shape.add_block(frame, [-hw, -hw + bar], [-hd, hd], [bar, look.h - bar]);
    shape.add_block(frame, [hw - bar, hw], [-hd, hd], [bar, look.h - bar]);
    let corner = Vec3::new(-hw + bar, -hd + 0.012, bar);
    shape.add_picture(inside, corner, Vec3::X * (look.w - 2.0 * bar), Vec3::Z * (look.h - 2.0 * bar));
}

/// A framed painting; the piece's colour is the main colour of the painting.
pub(super) fn build_painting(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let frame =
        HouseSurface::for_wood([Colour::Gold, Colour::Black, Colour::Brown, Colour::White][look.variant as usize % 4]);
    add_framed(
        &mut shape,
        look,
        frame,
        0.05,
        HouseSurface::for_picture(SurfacePattern::Art(painting_number(look.colour))),
    );
    shape
}

/// Ribs between two pipes.
pub(super) fn build_radiator(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), white) = (look.half_size(), HouseSurface::for_metal(look.colour));
    for z in [0.03, look.h - 0.07] {
        shape.add_block(white.shaded_by(0.9), [-hw, hw], [-hd + 0.02, hd], [z, z + 0.04]);
    }
    let ribs = (look.w / 0.06) as usize;
    for rib in 0..ribs {
        let x = -hw + look.w * (rib as f32 + 0.5) / ribs as f32;
        shape.add_soft_box(white, [x - 0.021, x + 0.021], [-hd, hd], [0.0, look.h], 0.015);
    }
    shape
}

/// The number of the painting that has this main colour.
fn painting_number(colour: Colour) -> u8 {
    let order = [
        Colour::Blue,
        Colour::Orange,
        Colour::Green,
        Colour::Red,
        Colour::Yellow,
        Colour::Purple,
        Colour::Teal,
        Colour::White,
        Colour::Black,
        Colour::Pink,
    ];
    order.iter().position(|each| *each == colour).unwrap_or(0) as u8 % ART_COUNT
}

/// A framed surface with the bluish sheen of glass; the piece's colour is that of the frame. It does not reflect the room.
pub(super) fn build_mirror(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    add_framed(
        &mut shape,
        look,
        HouseSurface::for_wood(look.colour),
        0.045,
        HouseSurface::for_picture(SurfacePattern::Reflection).glowing(),
    );
    shape
}

pub(super) fn build_whiteboard(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    add_framed(
        &mut shape,
        look,
        HouseSurface::for_metal(Colour::Silver),
        0.02,
        HouseSurface::from_rgb([248, 249, 250]),
    );
    let (hw, hd) = look.half_size();
    let pens = [[30, 60, 160], [180, 40, 40], [40, 130, 60]];
    for (line, rgb) in pens.into_iter().enumerate() {
        let z = look.h * (0.78 - 0.2 * line as f32);
        let corner = Vec3::new(-hw * 0.8, -hd + 0.009, z);
        shape.add_picture(
            HouseSurface::from_rgb(rgb),
            corner,
            Vec3::X * (look.w * (0.55 - 0.1 * line as f32)),
            Vec3::Z * 0.02,
        );
    }
    shape.add_block(HouseSurface::for_metal(Colour::Silver), [-hw * 0.5, hw * 0.5], [-hd - 0.04, hd], [0.0, 0.015]);
    shape
}

/// A round dial with its hands at ten past ten.
pub(super) fn build_clock(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let (_, hd) = look.half_size();
    let (r, centre) = (look.w / 2.0, Vec3::new(0.0, 0.0, look.h / 2.0));
    let rim = HouseSurface::from_rgb(look.colour.rgb()).shaded_by(0.75);
    shape.add_rod(rim, centre + Vec3::Y * hd, centre - Vec3::Y * hd, r);
    shape.add_disc(rim, centre - Vec3::Y * hd, -Vec3::Y, r);
    shape.add_disc(HouseSurface::for_picture(SurfacePattern::Dial), centre - Vec3::Y * (hd + 0.004), -Vec3::Y, r * 0.9);
    shape
}

pub(super) fn build_rug(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let (hw, hd) = look.half_size();
    let surface = HouseSurface::new(SurfacePattern::Ornament, look.colour.rgb());
    shape.add_block(HouseSurface::for_fabric(look.colour).shaded_by(0.8), [-hw, hw], [-hd, hd], [0.0, 0.008]);
    add_tiles(&mut shape, surface, look, 0.01);
    shape
}

/// A flat picture in several pieces, so that light and shadow can vary over it.
fn add_tiles(shape: &mut HouseShape, surface: HouseSurface, look: &FurnitureLook, z: f32) {
    let (hw, hd) = look.half_size();
    let (columns, rows) = (((look.w / 0.4) as usize).max(1), ((look.d / 0.4) as usize).max(1));
    let step = Vec2::new(look.w / columns as f32, look.d / rows as f32);
    for row in 0..rows {
        for column in 0..columns {
            let from = Vec2::new(column as f32, row as f32);
            let corner = Vec3::new(-hw + step.x * from.x, -hd + step.y * from.y, z);
            let (uv0, uv1) =
                (from / Vec2::new(columns as f32, rows as f32), (from + 1.0) / Vec2::new(columns as f32, rows as f32));
            let (top, bottom) = (Vec2::new(uv0.x, 1.0 - uv1.y), Vec2::new(uv1.x, 1.0 - uv0.y));
            shape.add_quad(surface, corner, Vec3::X * step.x, Vec3::Y * step.y, top, bottom);
        }
    }
}

/// A bath mat or doormat with a border.
pub(super) fn build_mat(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let (hw, hd) = look.half_size();
    let cloth = HouseSurface::for_fabric(look.colour);
    shape.add_soft_box(cloth, [-hw, hw], [-hd, hd], [0.0, 0.016], 0.008);
    shape.add_block(cloth.shaded_by(0.75), [-hw + 0.06, hw - 0.06], [-hd + 0.06, hd - 0.06], [0.016, 0.02]);
    shape
}

/// Folds of cloth under a rod.
pub(super) fn build_curtain(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, _), cloth) = (look.half_size(), HouseSurface::for_fabric(look.colour));
    let folds = 6;
    let width = look.w / folds as f32;
    for fold in 0..folds {
        let x = -hw + width * (fold as f32 + 0.5);
        let tone = if fold % 2 == 0 { 1.0 } else { 0.88 };
        shape.add_turned(cloth.shaded_by(tone), (x, 0.0), 0.7, &[(width * 0.6, 0.0), (width * 0.5, look.h - 0.04)]);
    }
    let (from, to) = (Vec3::new(-hw - 0.06, 0.0, look.h - 0.03), Vec3::new(hw + 0.06, 0.0, look.h - 0.03));
    shape.add_rod(HouseSurface::for_metal(Colour::DarkGrey), from, to, 0.014);
    shape
}
