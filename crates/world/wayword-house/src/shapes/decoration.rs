//! Decoration: things that hang on walls or lie on floors, and showpieces.

use super::{
    super::{
        colour::Colour,
        surface::{ART_COUNT, Pattern, Surface},
    },
    Look, Shape,
};
use glam::{Vec2, Vec3};

/// Four bars around a picture that looks forward.
fn framed(shape: &mut Shape, look: &Look, frame: Surface, bar: f32, inside: Surface) {
    let (hw, hd) = look.half();
    shape.block(frame, [-hw, hw], [-hd, hd], [0.0, bar]);
    shape.block(frame, [-hw, hw], [-hd, hd], [look.h - bar, look.h]);
    shape.block(frame, [-hw, -hw + bar], [-hd, hd], [bar, look.h - bar]);
    shape.block(frame, [hw - bar, hw], [-hd, hd], [bar, look.h - bar]);
    let corner = Vec3::new(-hw + bar, -hd + 0.012, bar);
    shape.picture(inside, corner, Vec3::X * (look.w - 2.0 * bar), Vec3::Z * (look.h - 2.0 * bar));
}

pub(super) fn painting(look: &Look) -> Shape {
    let mut shape = Shape::default();
    let frame = Surface::wood([Colour::Gold, Colour::Black, Colour::Brown, Colour::White][look.variant as usize % 4]);
    framed(&mut shape, look, frame, 0.05, Surface::picture(Pattern::Art(art_of(look.colour))));
    shape
}

/// A woven hanging on a rod.
pub(super) fn tapestry(look: &Look) -> Shape {
    let mut shape = Shape::default();
    let (hw, hd) = look.half();
    let rod = Surface::wood(Colour::DarkBrown);
    shape.rod(rod, Vec3::new(-hw, 0.0, look.h - 0.02), Vec3::new(hw, 0.0, look.h - 0.02), 0.016);
    let cloth = Surface::new(Pattern::Ornament, look.colour.rgb());
    let (x, low) = ([-hw + 0.04, hw - 0.04], 0.07);
    shape.block(cloth.shade(0.9), x, [-hd + 0.012, hd], [low, look.h - 0.02]);
    let size = (Vec3::X * (x[1] - x[0]), Vec3::Z * (look.h - 0.02 - low));
    shape.picture(cloth, Vec3::new(x[0], -hd + 0.008, low), size.0, size.1);
    let tassels = ((x[1] - x[0]) / 0.06) as usize;
    for tassel in 0..tassels {
        let at = x[0] + 0.06 * tassel as f32 + 0.02;
        shape.block(cloth.shade(0.8), [at, at + 0.02], [-hd + 0.008, hd], [0.0, low]);
    }
    shape
}

/// Ribs between two pipes.
pub(super) fn radiator(look: &Look) -> Shape {
    let mut shape = Shape::default();
    let ((hw, hd), white) = (look.half(), Surface::metal(look.colour));
    for z in [0.03, look.h - 0.07] {
        shape.block(white.shade(0.9), [-hw, hw], [-hd + 0.02, hd], [z, z + 0.04]);
    }
    let ribs = (look.w / 0.06) as usize;
    for rib in 0..ribs {
        let x = -hw + look.w * (rib as f32 + 0.5) / ribs as f32;
        shape.soft(white, [x - 0.021, x + 0.021], [-hd, hd], [0.0, look.h], 0.015);
    }
    shape
}

/// The painting whose main colour is the piece's colour.
fn art_of(colour: Colour) -> u8 {
    let order = [Colour::Blue, Colour::Orange, Colour::Green, Colour::Red, Colour::Yellow, Colour::Purple];
    order.iter().position(|each| *each == colour).unwrap_or(0) as u8 % ART_COUNT
}

/// A framed surface with the bluish sheen of glass. It does not reflect the room.
pub(super) fn mirror(look: &Look) -> Shape {
    let mut shape = Shape::default();
    let frame = Surface::wood([Colour::Gold, Colour::White, Colour::DarkBrown][look.variant as usize % 3]);
    framed(&mut shape, look, frame, 0.045, Surface::picture(Pattern::Reflection).glowing());
    shape
}

pub(super) fn whiteboard(look: &Look) -> Shape {
    let mut shape = Shape::default();
    framed(&mut shape, look, Surface::metal(Colour::Silver), 0.02, Surface::plain([248, 249, 250]));
    let (hw, hd) = look.half();
    let pens = [[30, 60, 160], [180, 40, 40], [40, 130, 60]];
    for (line, rgb) in pens.into_iter().enumerate() {
        let z = look.h * (0.78 - 0.2 * line as f32);
        let corner = Vec3::new(-hw * 0.8, -hd + 0.009, z);
        shape.picture(Surface::plain(rgb), corner, Vec3::X * (look.w * (0.55 - 0.1 * line as f32)), Vec3::Z * 0.02);
    }
    shape.block(Surface::metal(Colour::Silver), [-hw * 0.5, hw * 0.5], [-hd - 0.04, hd], [0.0, 0.015]);
    shape
}

/// A round dial whose hands stand at ten past ten.
pub(super) fn clock(look: &Look) -> Shape {
    let mut shape = Shape::default();
    let (_, hd) = look.half();
    let (r, centre) = (look.w / 2.0, Vec3::new(0.0, 0.0, look.h / 2.0));
    let rim = Surface::plain(look.colour.rgb()).shade(0.75);
    shape.rod(rim, centre + Vec3::Y * hd, centre - Vec3::Y * hd, r);
    shape.disc(rim, centre - Vec3::Y * hd, -Vec3::Y, r);
    shape.disc(Surface::picture(Pattern::Dial), centre - Vec3::Y * (hd + 0.004), -Vec3::Y, r * 0.9);
    shape
}

pub(super) fn rug(look: &Look) -> Shape {
    let mut shape = Shape::default();
    let (hw, hd) = look.half();
    let surface = Surface::new(Pattern::Ornament, look.colour.rgb());
    shape.block(Surface::fabric(look.colour).shade(0.8), [-hw, hw], [-hd, hd], [0.0, 0.008]);
    tiles(&mut shape, surface, look, 0.01);
    shape
}

/// A flat picture in several pieces, so that light and shadow can vary over it.
fn tiles(shape: &mut Shape, surface: Surface, look: &Look, z: f32) {
    let (hw, hd) = look.half();
    let (columns, rows) = (((look.w / 0.4) as usize).max(1), ((look.d / 0.4) as usize).max(1));
    let step = Vec2::new(look.w / columns as f32, look.d / rows as f32);
    for row in 0..rows {
        for column in 0..columns {
            let from = Vec2::new(column as f32, row as f32);
            let corner = Vec3::new(-hw + step.x * from.x, -hd + step.y * from.y, z);
            let (uv0, uv1) =
                (from / Vec2::new(columns as f32, rows as f32), (from + 1.0) / Vec2::new(columns as f32, rows as f32));
            let (top, bottom) = (Vec2::new(uv0.x, 1.0 - uv1.y), Vec2::new(uv1.x, 1.0 - uv0.y));
            shape.quad(surface, corner, Vec3::X * step.x, Vec3::Y * step.y, top, bottom);
        }
    }
}

/// A bath mat or doormat with a border.
pub(super) fn mat(look: &Look) -> Shape {
    let mut shape = Shape::default();
    let (hw, hd) = look.half();
    let cloth = Surface::fabric(look.colour);
    shape.soft(cloth, [-hw, hw], [-hd, hd], [0.0, 0.016], 0.008);
    shape.block(cloth.shade(0.75), [-hw + 0.06, hw - 0.06], [-hd + 0.06, hd - 0.06], [0.016, 0.02]);
    shape
}

/// Folds of cloth under a rod.
pub(super) fn curtain(look: &Look) -> Shape {
    let mut shape = Shape::default();
    let ((hw, _), cloth) = (look.half(), Surface::fabric(look.colour));
    let folds = 6;
    let width = look.w / folds as f32;
    for fold in 0..folds {
        let x = -hw + width * (fold as f32 + 0.5);
        let tone = if fold % 2 == 0 { 1.0 } else { 0.88 };
        shape.turned(cloth.shade(tone), (x, 0.0), 0.7, &[(width * 0.6, 0.0), (width * 0.5, look.h - 0.04)]);
    }
    let (from, to) = (Vec3::new(-hw - 0.06, 0.0, look.h - 0.03), Vec3::new(hw + 0.06, 0.0, look.h - 0.03));
    shape.rod(Surface::metal(Colour::DarkGrey), from, to, 0.014);
    shape
}

/// A surround with a mantel, and a fire behind it.
pub(super) fn fireplace(look: &Look) -> Shape {
    let mut shape = Shape::default();
    let (hw, hd) = look.half();
    let stone = match look.colour {
        Colour::Red => Surface::new(Pattern::Brick, [255; 3]),
        colour => Surface::new(Pattern::Marble, colour.rgb()),
    };
    let (open_w, open_h) = (hw * 0.58, look.h * 0.66);
    shape.block(stone, [-hw, -open_w], [-hd + 0.04, hd], [0.0, look.h - 0.08]);
    shape.block(stone, [open_w, hw], [-hd + 0.04, hd], [0.0, look.h - 0.08]);
    shape.block(stone, [-open_w, open_w], [-hd + 0.04, hd], [open_h, look.h - 0.08]);
    shape.block(stone.shade(1.04), [-hw - 0.06, hw + 0.06], [-hd, hd], [look.h - 0.08, look.h]);
    let soot = Surface::plain([30, 26, 24]);
    shape.block(soot, [-open_w, open_w], [hd - 0.04, hd - 0.02], [0.0, open_h]);
    shape.block(soot, [-open_w, open_w], [-hd + 0.06, hd], [0.0, 0.03]);
    let wood = Surface::wood(Colour::DarkBrown);
    for (x, z) in [(-0.16, 0.08), (0.14, 0.08), (0.0, 0.15)] {
        shape.rod(wood, Vec3::new(x - 0.2, -0.04, z), Vec3::new(x + 0.2, 0.04, z + 0.02), 0.05);
    }
    let fire = Surface::picture(Pattern::Fire).glowing();
    shape.picture(fire, Vec3::new(-open_w * 0.8, hd - 0.05, 0.04), Vec3::X * open_w * 1.6, Vec3::Z * open_h * 0.85);
    shape
}

/// An upright piano with its keys, and a score on the stand.
pub(super) fn piano(look: &Look) -> Shape {
    let mut shape = Shape::default();
    let ((hw, hd), wood) = (look.half(), Surface::wood(look.colour));
    shape.block(wood, [-hw, hw], [hd - 0.32, hd], [0.0, look.h]);
    shape.block(wood.shade(1.15), [-hw - 0.01, hw + 0.01], [hd - 0.34, hd], [look.h - 0.03, look.h]);
    shape.block(wood.shade(0.9), [-hw, hw], [-hd + 0.02, hd - 0.3], [0.62, 0.7]);
    for x in [-hw, hw - 0.06] {
        shape.block(wood, [x, x + 0.06], [-hd + 0.02, hd], [0.0, 0.78]);
    }
    shape.block(Surface::plain([250, 249, 244]), [-hw + 0.08, hw - 0.08], [-hd + 0.03, hd - 0.34], [0.7, 0.722]);
    let key = (look.w - 0.16) / 36.0;
    for at in 1..36 {
        let x = -hw + 0.08 + key * at as f32;
        let line = Surface::plain([120, 120, 118]);
        shape.block(line, [x - 0.0015, x + 0.0015], [-hd + 0.03, hd - 0.34], [0.722, 0.7225]);
        if ![3, 0].contains(&(at % 7)) {
            shape.block(Surface::plain([20, 20, 22]), [x - 0.009, x + 0.009], [-hd + 0.1, hd - 0.34], [0.722, 0.735]);
        }
    }
    shape.block(Surface::plain([244, 240, 228]), [-0.2, 0.2], [hd - 0.36, hd - 0.345], [0.82, 1.08]);
    shape.block(Surface::plain([120, 120, 118]), [-0.003, 0.003], [hd - 0.362, hd - 0.36], [0.82, 1.08]);
    shape
}
