//! Small things on tables and shelves. They belong to the piece that they lie on, and its variant chooses them. So they get
//! no labels of their own: an instruction names the table and not the cup on it.

use super::{
    super::{
        colour::Colour,
        surface::{ART_COUNT, HouseSurface, SurfacePattern},
    },
    HouseShape,
};
use glam::Vec3;

/// Colours of book covers and of china.
const SPINE_RGBS: [[u8; 3]; 6] =
    [[170, 50, 44], [44, 84, 140], [226, 196, 110], [60, 110, 74], [236, 232, 222], [96, 66, 110]];

/// A small thing on a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ClutterItem {
    Books,
    Cup,
    Bowl,
    Laptop,
    Tray,
    Towels,
    Bottles,
    Remote,
    Candles,
    Photo,
    Box,
    Papers,
}

/// Puts some of these things along a surface at height `z`, between two places across it, at depth `y`.
pub(super) fn scatter_items(
    shape: &mut HouseShape,
    things: &[ClutterItem],
    [from, to]: [f32; 2],
    y: f32,
    z: f32,
    variant: u32,
) {
    let seed = variant as usize;
    let places = ((to - from) / 0.34) as usize;
    for place in 0..places {
        let x = from + (to - from) * (place as f32 + 0.5) / places as f32;
        // A third of the places stay free, and the middle: a vase or a lamp may stand there.
        if (seed / 3 + place * 5).is_multiple_of(3) || x.abs() < 0.16 {
            continue;
        }
        let thing = things[(seed + place) % things.len()];
        put_item(shape, thing, Vec3::new(x, y, z), seed + place * 11);
    }
}

/// One thing at a place. Its colours and details follow from `seed`.
pub(super) fn put_item(shape: &mut HouseShape, thing: ClutterItem, at: Vec3, seed: usize) {
    let spine = |shift: usize| HouseSurface::from_rgb(SPINE_RGBS[(seed + shift) % SPINE_RGBS.len()]);
    match thing {
        ClutterItem::Books => add_books(shape, at, seed),
        ClutterItem::Cup => add_cup(shape, at, spine(0)),
        ClutterItem::Bowl => add_bowl(shape, at, spine(2)),
        ClutterItem::Laptop => add_laptop(shape, at),
        ClutterItem::Tray => add_tray(shape, at, seed),
        ClutterItem::Towels => add_towels(shape, at, seed),
        ClutterItem::Bottles => add_bottles(shape, at, seed),
        ClutterItem::Remote => {
            add_slab(shape, HouseSurface::from_rgb([30, 30, 34]), at, [0.025, 0.085, 0.02]);
            add_slab(
                shape,
                HouseSurface::from_rgb([200, 50, 44]),
                at + Vec3::new(0.0, 0.07, 0.02),
                [0.006, 0.006, 0.004],
            );
        }
        ClutterItem::Candles => add_candles(shape, at),
        ClutterItem::Photo => add_photo(shape, at, seed),
        ClutterItem::Box => {
            add_slab(shape, HouseSurface::new(SurfacePattern::Wicker, [196, 156, 108]), at, [0.12, 0.09, 0.13]);
        }
        ClutterItem::Papers => {
            for sheet in 0..3 {
                let shift = 0.012 * sheet as f32;
                add_slab(
                    shape,
                    HouseSurface::from_rgb([246 - 6 * sheet, 246 - 6 * sheet, 240]),
                    at + Vec3::new(shift, -shift, 0.004 * f32::from(sheet)),
                    [0.105, 0.148, 0.004],
                );
            }
        }
    }
}

/// A box on a surface, centred on a place; `w`, `d` and `h` are its half width, half depth and height.
fn add_slab(shape: &mut HouseShape, surface: HouseSurface, at: Vec3, [w, d, h]: [f32; 3]) {
    shape.add_block(surface, [at.x - w, at.x + w], [at.y - d, at.y + d], [at.z, at.z + h]);
}

/// A pile, or a row between two ends.
fn add_books(shape: &mut HouseShape, at: Vec3, seed: usize) {
    let paper = HouseSurface::from_rgb([240, 236, 222]);
    if seed.is_multiple_of(2) {
        for book in 0..3 {
            let (z, shrink) = (0.032 * book as f32, 0.012 * book as f32);
            let cover = HouseSurface::from_rgb(SPINE_RGBS[(seed + book * 2) % SPINE_RGBS.len()]);
            add_slab(shape, cover, at + Vec3::Z * z, [0.115 - shrink, 0.085 - shrink, 0.03]);
            add_slab(shape, paper, at + Vec3::new(0.004, 0.0, z + 0.004), [0.113 - shrink, 0.087 - shrink, 0.022]);
        }
        return;
    }
    for book in 0..6 {
        let cover = HouseSurface::from_rgb(SPINE_RGBS[(seed + book) % SPINE_RGBS.len()]);
        let height = [0.21, 0.24, 0.19, 0.23, 0.2, 0.22][(seed + book) % 6];
        add_slab(shape, cover, at + Vec3::X * (0.033 * book as f32 - 0.08), [0.015, 0.075, height]);
    }
}

fn add_cup(shape: &mut HouseShape, at: Vec3, china: HouseSurface) {
    let profile = [
        (0.0, at.z),
        (0.032, at.z),
        (0.042, at.z + 0.09),
        (0.036, at.z + 0.09),
        (0.03, at.z + 0.02),
        (0.0, at.z + 0.02),
    ];
    shape.add_turned(china, (at.x, at.y), 1.0, &profile);
    shape.add_hoop(china, at + Vec3::new(0.045, 0.0, 0.048), Vec3::Y, 0.025, 0.006);
}

fn add_bowl(shape: &mut HouseShape, at: Vec3, china: HouseSurface) {
    let profile = [
        (0.0, at.z),
        (0.05, at.z),
        (0.12, at.z + 0.075),
        (0.11, at.z + 0.075),
        (0.05, at.z + 0.02),
        (0.0, at.z + 0.02),
    ];
    shape.add_turned(china, (at.x, at.y), 1.0, &profile);
}

/// An open laptop with a bright screen.
fn add_laptop(shape: &mut HouseShape, at: Vec3) {
    let case = HouseSurface::for_metal(Colour::Silver);
    add_slab(shape, case, at, [0.16, 0.11, 0.014]);
    add_slab(shape, HouseSurface::from_rgb([40, 40, 44]), at + Vec3::new(0.0, 0.02, 0.014), [0.14, 0.055, 0.002]);
    shape.add_block(case, [at.x - 0.16, at.x + 0.16], [at.y + 0.1, at.y + 0.114], [at.z + 0.01, at.z + 0.23]);
    let screen = HouseSurface::for_picture(SurfacePattern::Desktop).glowing();
    shape.add_picture(screen, at + Vec3::new(-0.15, 0.098, 0.022), Vec3::X * 0.3, Vec3::Z * 0.196);
}

/// A tray with a pot and two cups.
fn add_tray(shape: &mut HouseShape, at: Vec3, seed: usize) {
    add_slab(shape, HouseSurface::for_wood(Colour::Brown), at, [0.19, 0.13, 0.016]);
    let china = HouseSurface::from_rgb(SPINE_RGBS[(seed + 4) % SPINE_RGBS.len()]);
    let top = at + Vec3::Z * 0.016;
    let pot = [(0.0, top.z), (0.05, top.z), (0.07, top.z + 0.06), (0.045, top.z + 0.12), (0.0, top.z + 0.14)];
    shape.add_turned(china, (top.x - 0.07, top.y + 0.02), 1.0, &pot);
    add_cup(shape, top + Vec3::new(0.07, 0.03, 0.0), china);
    add_cup(shape, top + Vec3::new(0.06, -0.07, 0.0), china);
}

/// Folded, one on the other.
fn add_towels(shape: &mut HouseShape, at: Vec3, seed: usize) {
    let cloth = [Colour::White, Colour::Blue, Colour::Teal, Colour::Pink, Colour::Beige];
    for fold in 0..3 {
        let (z, surface) = (at.z + 0.06 * fold as f32, HouseSurface::for_fabric(cloth[(seed + fold) % cloth.len()]));
        shape.add_soft_box(surface, [at.x - 0.15, at.x + 0.15], [at.y - 0.1, at.y + 0.1], [z, z + 0.062], 0.028);
    }
}

fn add_bottles(shape: &mut HouseShape, at: Vec3, seed: usize) {
    let glass = [[64, 110, 70], [150, 84, 40], [214, 226, 232], [196, 70, 90]];
    for bottle in 0..3 {
        let surface = HouseSurface::from_rgb(glass[(seed + bottle) % glass.len()]);
        let (x, z, tall) = (at.x - 0.08 + 0.08 * bottle as f32, at.z, 0.17 + 0.04 * ((seed + bottle) % 3) as f32);
        let profile = [
            (0.0, z),
            (0.032, z),
            (0.032, z + tall * 0.62),
            (0.013, z + tall * 0.76),
            (0.013, z + tall),
            (0.0, z + tall),
        ];
        shape.add_turned(surface, (x, at.y), 1.0, &profile);
    }
}

fn add_candles(shape: &mut HouseShape, at: Vec3) {
    let (wax, flame) = (HouseSurface::from_rgb([248, 240, 220]), HouseSurface::from_rgb([255, 214, 120]).glowing());
    for (shift, tall) in [(-0.06, 0.14), (0.0, 0.2), (0.065, 0.1)] {
        let (x, z) = (at.x + shift, at.z);
        shape.add_tube(HouseSurface::for_metal(Colour::Gold), (x, at.y), [0.034, 0.03], [z, z + 0.012]);
        shape.add_tube(wax, (x, at.y), [0.022, 0.022], [z + 0.012, z + tall]);
        shape.add_ball(flame, Vec3::new(x, at.y, z + tall + 0.014), 0.01);
    }
}

/// A photograph in a standing frame.
fn add_photo(shape: &mut HouseShape, at: Vec3, seed: usize) {
    let frame = HouseSurface::for_wood([Colour::Black, Colour::White, Colour::Gold, Colour::Wooden][seed % 4]);
    shape.add_block(frame, [at.x - 0.075, at.x + 0.075], [at.y, at.y + 0.014], [at.z, at.z + 0.2]);
    let picture = HouseSurface::for_picture(SurfacePattern::Art(seed as u8 % ART_COUNT));
    shape.add_picture(picture, at + Vec3::new(-0.06, -0.002, 0.016), Vec3::X * 0.12, Vec3::Z * 0.168);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scatter_items_puts_things_on_the_surface_and_within_it() {
        let all = [
            ClutterItem::Books,
            ClutterItem::Cup,
            ClutterItem::Bowl,
            ClutterItem::Laptop,
            ClutterItem::Tray,
            ClutterItem::Towels,
            ClutterItem::Bottles,
            ClutterItem::Remote,
            ClutterItem::Candles,
            ClutterItem::Photo,
            ClutterItem::Box,
            ClutterItem::Papers,
        ];
        for variant in 0..40 {
            let mut shape = HouseShape::default();
            scatter_items(&mut shape, &all, [-0.8, 0.8], 0.0, 0.75, variant);
            let points: Vec<Vec3> = shape.parts.iter().flat_map(|part| part.positions.clone()).collect();
            assert!(!points.is_empty(), "variant {variant} has nothing on it");
            assert!(points.iter().all(|at| at.z >= 0.749 && at.z < 1.1 && at.x.abs() < 0.86 && at.y.abs() < 0.2));
        }
    }

    #[test]
    fn another_variant_has_other_things_on_it() {
        let positions = |variant: u32| {
            let mut shape = HouseShape::default();
            scatter_items(
                &mut shape,
                &[ClutterItem::Books, ClutterItem::Cup, ClutterItem::Candles],
                [-0.8, 0.8],
                0.0,
                0.75,
                variant,
            );
            shape.parts.iter().map(|part| part.positions.len()).sum::<usize>()
        };
        assert!((1..6).any(|variant| positions(variant) != positions(0)));
    }
}
