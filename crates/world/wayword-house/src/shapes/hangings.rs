//! Builds things on walls other than paintings and mirrors: photographs, cloths, coats, boards. Lengths are metres; `hw`
//! and `hd` are half the width and half the depth of a piece, `look.h` its height. Colours and sizes vary with a `seed`.

use super::{
    super::{
        colour::Colour,
        surface::{ART_COUNT, HouseSurface, SurfacePattern},
    },
    FurnitureLook, HouseShape,
};
use glam::{Vec2, Vec3};

const FRAME_COLOURS: [Colour; 5] = [Colour::Black, Colour::Wooden, Colour::White, Colour::Brown, Colour::Gold];
const CLOTHES_COLOURS: [Colour; 8] = [
    Colour::Red,
    Colour::Blue,
    Colour::Beige,
    Colour::Green,
    Colour::DarkGrey,
    Colour::Yellow,
    Colour::Teal,
    Colour::Brown,
];

/// A dense wall of framed photographs.
pub(super) fn build_photos(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let (hw, hd) = look.half_size();
    let rows = if look.h > 1.3 {
        3
    } else if look.h > 0.75 {
        2
    } else {
        1
    };
    let columns = ((look.w / 0.42) as usize).max(1);
    let (w, h) = (look.w / columns as f32, look.h / rows as f32);
    let mats = HouseSurface::from_rgb([250, 249, 244]);
    for cell in 0..rows * columns {
        let (column, row) = (cell % columns, cell / columns);
        let seed = cell * 7 + look.variant as usize;
        let frame = HouseSurface::for_wood(FRAME_COLOURS[(seed / 3) % FRAME_COLOURS.len()]);
        // Every second frame is a little smaller, as on a wall that was filled over the years.
        let (inset, bar) = (if seed.is_multiple_of(2) { 0.012 } else { 0.024 }, 0.022);
        let (x0, z0) = (-hw + w * column as f32 + inset, h * row as f32 + inset);
        let (x1, z1) = (x0 + w - 2.0 * inset, z0 + h - 2.0 * inset);
        shape.add_block(frame, [x0, x1], [-hd, hd], [z0, z1]);
        let rim = bar + 0.03;
        let (corner, u, v) = (Vec3::new(x0 + bar, -hd - 0.002, z0 + bar), x1 - x0 - 2.0 * bar, z1 - z0 - 2.0 * bar);
        shape.add_picture(mats, corner, Vec3::X * u, Vec3::Z * v);
        let corner = Vec3::new(x0 + rim, -hd - 0.004, z0 + rim);
        let art = HouseSurface::for_picture(SurfacePattern::Art((seed % usize::from(ART_COUNT)) as u8)).shaded_by(0.94);
        shape.add_picture(art, corner, Vec3::X * (x1 - x0 - 2.0 * rim), Vec3::Z * (z1 - z0 - 2.0 * rim));
    }
    shape
}

/// A patterned cloth with a fringe, on a rod.
pub(super) fn build_tapestry(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let (hw, hd) = look.half_size();
    let cloth = HouseSurface::new(SurfacePattern::Ornament, look.colour.rgb());
    let rod = HouseSurface::for_wood(Colour::Brown);
    shape.add_rod(rod, Vec3::new(-hw, 0.0, look.h - 0.02), Vec3::new(hw, 0.0, look.h - 0.02), 0.016);
    for x in [-hw, hw] {
        shape.add_ball(rod, Vec3::new(x, 0.0, look.h - 0.02), 0.024);
    }
    let (from, to) = (-hw + 0.03, hw - 0.03);
    shape.add_block(
        HouseSurface::for_fabric(look.colour).shaded_by(0.8),
        [from, to],
        [-hd + 0.012, hd],
        [0.08, look.h - 0.02],
    );
    shape.add_picture(cloth, Vec3::new(from, -hd, 0.08), Vec3::X * (to - from), Vec3::Z * (look.h - 0.1));
    let threads = ((to - from) / 0.05) as usize;
    let fringe = HouseSurface::for_fabric(Colour::Cream);
    for thread in 0..threads {
        let x = from + 0.012 + (to - from) * thread as f32 / threads as f32;
        let (corner, across) = (Vec3::new(x, -hd + 0.004, 0.0), Vec3::X * 0.026);
        shape.add_quad(fringe, corner, across, Vec3::Z * 0.085, Vec2::ZERO, Vec2::new(0.1, 0.3));
    }
    shape
}

/// A board with pegs, full of coats, bags and a hat.
pub(super) fn build_coat_hooks(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let ((hw, hd), wood) = (look.half_size(), HouseSurface::for_wood(look.colour));
    let steel = HouseSurface::for_metal(Colour::DarkGrey);
    shape.add_block(wood, [-hw, hw], [hd - 0.03, hd], [look.h - 0.26, look.h - 0.12]);
    shape.add_block(wood, [-hw, hw], [-hd, hd], [look.h - 0.1, look.h - 0.07]);
    let hooks = ((look.w / 0.27) as usize).max(2);
    let width = look.w / hooks as f32;
    for hook in 0..hooks {
        let x = -hw + width * (hook as f32 + 0.5);
        let peg = Vec3::new(x, hd - 0.03, look.h - 0.18);
        shape.add_rod(steel, peg, peg + Vec3::new(0.0, -0.06, 0.02), 0.012);
        let seed = hook * 3 + look.variant as usize;
        let cloth = HouseSurface::for_fabric(CLOTHES_COLOURS[seed % CLOTHES_COLOURS.len()]);
        // Coats reach further down than jackets.
        let bottom = [0.0, 0.22, 0.1, 0.36][seed % 4] * look.h;
        add_coat(&mut shape, cloth, [x, width * 0.46], [bottom, look.h - 0.17]);
    }
    let hat = HouseSurface::for_fabric(CLOTHES_COLOURS[(look.variant as usize + 4) % CLOTHES_COLOURS.len()]);
    shape.add_turned(
        hat,
        (-hw * 0.5, 0.0),
        0.5,
        &[
            (0.0, look.h - 0.07),
            (0.15, look.h - 0.07),
            (0.15, look.h - 0.06),
            (0.08, look.h - 0.05),
            (0.07, look.h),
            (0.0, look.h),
        ],
    );
    shape
}

/// A coat that hangs by its collar: wide at the hem, with shoulders, sleeves and an open front.
fn add_coat(shape: &mut HouseShape, cloth: HouseSurface, [x, half]: [f32; 2], [bottom, top]: [f32; 2]) {
    let shoulder = top - 0.09;
    let cut =
        [(half * 0.9, bottom), (half * 0.74, shoulder - 0.3), (half * 0.72, shoulder), (half * 0.3, top), (0.0, top)];
    shape.add_turned(cloth, (x, 0.0), 0.42, &cut);
    let dark = cloth.shaded_by(0.78);
    for side in [-1.0, 1.0] {
        let from = Vec3::new(x + side * half * 0.66, 0.0, shoulder - 0.01);
        let to = Vec3::new(x + side * half * 0.92, -0.01, (shoulder - 0.58).max(bottom + 0.06));
        shape.add_rod(cloth.shaded_by(0.9), from, to, 0.042);
        shape.add_ball(cloth.shaded_by(0.9), from, 0.042);
        shape.add_rod(
            dark,
            Vec3::new(x, -half * 0.31, shoulder - 0.05),
            Vec3::new(x + side * half * 0.22, -half * 0.14, top),
            0.012,
        );
    }
    shape.add_rod(
        dark,
        Vec3::new(x, -half * 0.385, bottom + 0.02),
        Vec3::new(x, -half * 0.305, shoulder - 0.05),
        0.007,
    );
}

/// Cork in a frame, full of notes.
pub(super) fn build_bulletin_board(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let (hw, hd) = look.half_size();
    shape.add_block(HouseSurface::for_wood(Colour::Wooden), [-hw, hw], [-hd, hd], [0.0, look.h]);
    let cork = HouseSurface::new(SurfacePattern::Carpet, [204, 158, 104]);
    let corner = Vec3::new(-hw + 0.03, -hd - 0.002, 0.03);
    shape.add_quad(cork, corner, Vec3::X * (look.w - 0.06), Vec3::Z * (look.h - 0.06), Vec2::ZERO, Vec2::new(2.0, 2.0));
    let papers = [[250, 250, 246], [250, 232, 120], [190, 224, 246], [246, 190, 190], [214, 240, 196]];
    let (columns, rows) = (((look.w / 0.22) as usize).max(2), ((look.h / 0.28) as usize).max(2));
    for note in 0..columns * rows {
        let seed = note * 5 + look.variant as usize;
        if seed.is_multiple_of(4) {
            continue;
        }
        let (column, row) = ((note % columns) as f32, (note / columns) as f32);
        let (w, h) = ((look.w - 0.1) / columns as f32, (look.h - 0.1) / rows as f32);
        let (x, z) = (-hw + 0.05 + w * column, 0.05 + h * row + 0.02 * (seed % 3) as f32);
        let (wide, high) = (w * [0.62, 0.8, 0.7][seed % 3], h * [0.7, 0.55, 0.8][(seed / 2) % 3]);
        let paper = HouseSurface::from_rgb(papers[seed % papers.len()]);
        shape.add_picture(paper, Vec3::new(x, -hd - 0.004, z), Vec3::X * wide, Vec3::Z * high);
        for line in 0..3 {
            let z = z + high * (0.3 + 0.2 * line as f32);
            let text = HouseSurface::from_rgb([110, 112, 118]);
            shape.add_picture(
                text,
                Vec3::new(x + wide * 0.15, -hd - 0.005, z),
                Vec3::X * (wide * 0.65),
                Vec3::Z * 0.008,
            );
        }
        let pin = Vec3::new(x + wide / 2.0, -hd - 0.008, z + high - 0.015);
        shape.add_ball(HouseSurface::from_rgb([206, 40, 40]), pin, 0.009);
    }
    shape
}

/// A pegboard with a saw, hammers, spanners and a coil of hose.
pub(super) fn build_tool_board(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let (hw, hd) = look.half_size();
    shape.add_block(HouseSurface::for_wood(Colour::LightBrown), [-hw, hw], [-hd + 0.02, hd], [0.0, look.h]);
    let (steel, wood) = (HouseSurface::for_metal(Colour::Grey), HouseSurface::for_wood(Colour::Brown));
    let grips = [
        HouseSurface::from_rgb([200, 44, 36]),
        HouseSurface::from_rgb([236, 178, 40]),
        HouseSurface::from_rgb([40, 90, 170]),
    ];
    let places = ((look.w / 0.2) as usize).max(3);
    for place in 0..places {
        let x = -hw + look.w * (place as f32 + 0.5) / places as f32;
        let y = [-hd, -hd + 0.02];
        let seed = place + look.variant as usize;
        let (high, low) = (look.h * 0.62, look.h * 0.12);
        if seed.is_multiple_of(2) {
            shape.add_block(wood, [x - 0.016, x + 0.016], y, [high, high + 0.28]);
            shape.add_block(steel, [x - 0.07, x + 0.07], y, [high + 0.26, high + 0.32]);
        } else {
            shape.add_block(grips[seed % 3], [x - 0.02, x + 0.02], y, [high, high + 0.12]);
            shape.add_block(steel, [x - 0.01, x + 0.01], y, [high + 0.12, high + 0.32]);
        }
        if seed.is_multiple_of(3) {
            let centre = Vec3::new(x, -hd, low + 0.16);
            shape.add_hoop(HouseSurface::from_rgb([50, 120, 70]), centre, Vec3::Y, 0.08, 0.02);
        } else {
            shape.add_block(steel, [x - 0.025, x + 0.025], y, [low, low + 0.26]);
            shape.add_block(grips[(seed + 1) % 3], [x - 0.04, x + 0.04], y, [low + 0.24, low + 0.36]);
        }
    }
    shape
}
