//! Small things on tables and shelves. They belong to the piece that they lie on, and its variant chooses them. So they get
//! no labels of their own: an instruction names the table and not the cup on it.

use super::{
    super::{
        colour::Colour,
        surface::{ART_COUNT, Pattern, Surface},
    },
    Shape,
};
use glam::Vec3;

const SPINES: [[u8; 3]; 6] =
    [[170, 50, 44], [44, 84, 140], [226, 196, 110], [60, 110, 74], [236, 232, 222], [96, 66, 110]];

/// A small thing on a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Thing {
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
pub(super) fn scatter(shape: &mut Shape, things: &[Thing], [from, to]: [f32; 2], y: f32, z: f32, variant: u32) {
    let mixed = variant as usize;
    let places = ((to - from) / 0.34) as usize;
    for place in 0..places {
        let x = from + (to - from) * (place as f32 + 0.5) / places as f32;
        // A third of the places stay free, and the middle: a vase or a lamp may stand there.
        if (mixed / 3 + place * 5).is_multiple_of(3) || x.abs() < 0.16 {
            continue;
        }
        let thing = things[(mixed + place) % things.len()];
        put(shape, thing, Vec3::new(x, y, z), mixed + place * 11);
    }
}

/// One thing at a place.
pub(super) fn put(shape: &mut Shape, thing: Thing, at: Vec3, mixed: usize) {
    let spine = |shift: usize| Surface::plain(SPINES[(mixed + shift) % SPINES.len()]);
    match thing {
        Thing::Books => books(shape, at, mixed),
        Thing::Cup => cup(shape, at, spine(0)),
        Thing::Bowl => bowl(shape, at, spine(2)),
        Thing::Laptop => laptop(shape, at),
        Thing::Tray => tray(shape, at, mixed),
        Thing::Towels => towels(shape, at, mixed),
        Thing::Bottles => bottles(shape, at, mixed),
        Thing::Remote => {
            slab(shape, Surface::plain([30, 30, 34]), at, [0.025, 0.085, 0.02]);
            slab(shape, Surface::plain([200, 50, 44]), at + Vec3::new(0.0, 0.07, 0.02), [0.006, 0.006, 0.004]);
        }
        Thing::Candles => candles(shape, at),
        Thing::Photo => photo(shape, at, mixed),
        Thing::Box => {
            slab(shape, Surface::new(Pattern::Wicker, [196, 156, 108]), at, [0.12, 0.09, 0.13]);
        }
        Thing::Papers => {
            for sheet in 0..3 {
                let shift = 0.012 * sheet as f32;
                slab(
                    shape,
                    Surface::plain([246 - 6 * sheet, 246 - 6 * sheet, 240]),
                    at + Vec3::new(shift, -shift, 0.004 * f32::from(sheet)),
                    [0.105, 0.148, 0.004],
                );
            }
        }
    }
}

/// A box on a surface, centred on a place; `w`, `d` and `h` are its half width, half depth and height.
fn slab(shape: &mut Shape, surface: Surface, at: Vec3, [w, d, h]: [f32; 3]) {
    shape.block(surface, [at.x - w, at.x + w], [at.y - d, at.y + d], [at.z, at.z + h]);
}

/// A pile, or a row between two ends.
fn books(shape: &mut Shape, at: Vec3, mixed: usize) {
    let paper = Surface::plain([240, 236, 222]);
    if mixed.is_multiple_of(2) {
        for book in 0..3 {
            let (z, shrink) = (0.032 * book as f32, 0.012 * book as f32);
            let cover = Surface::plain(SPINES[(mixed + book * 2) % SPINES.len()]);
            slab(shape, cover, at + Vec3::Z * z, [0.115 - shrink, 0.085 - shrink, 0.03]);
            slab(shape, paper, at + Vec3::new(0.004, 0.0, z + 0.004), [0.113 - shrink, 0.087 - shrink, 0.022]);
        }
        return;
    }
    for book in 0..6 {
        let cover = Surface::plain(SPINES[(mixed + book) % SPINES.len()]);
        let height = [0.21, 0.24, 0.19, 0.23, 0.2, 0.22][(mixed + book) % 6];
        slab(shape, cover, at + Vec3::X * (0.033 * book as f32 - 0.08), [0.015, 0.075, height]);
    }
}

fn cup(shape: &mut Shape, at: Vec3, china: Surface) {
    let profile = [
        (0.0, at.z),
        (0.032, at.z),
        (0.042, at.z + 0.09),
        (0.036, at.z + 0.09),
        (0.03, at.z + 0.02),
        (0.0, at.z + 0.02),
    ];
    shape.turned(china, (at.x, at.y), 1.0, &profile);
    shape.hoop(china, at + Vec3::new(0.045, 0.0, 0.048), Vec3::Y, 0.025, 0.006);
}

fn bowl(shape: &mut Shape, at: Vec3, china: Surface) {
    let profile = [
        (0.0, at.z),
        (0.05, at.z),
        (0.12, at.z + 0.075),
        (0.11, at.z + 0.075),
        (0.05, at.z + 0.02),
        (0.0, at.z + 0.02),
    ];
    shape.turned(china, (at.x, at.y), 1.0, &profile);
}

/// An open laptop with a bright screen.
fn laptop(shape: &mut Shape, at: Vec3) {
    let case = Surface::metal(Colour::Silver);
    slab(shape, case, at, [0.16, 0.11, 0.014]);
    slab(shape, Surface::plain([40, 40, 44]), at + Vec3::new(0.0, 0.02, 0.014), [0.14, 0.055, 0.002]);
    shape.block(case, [at.x - 0.16, at.x + 0.16], [at.y + 0.1, at.y + 0.114], [at.z + 0.01, at.z + 0.23]);
    let screen = Surface::picture(Pattern::Desktop).glowing();
    shape.picture(screen, at + Vec3::new(-0.15, 0.098, 0.022), Vec3::X * 0.3, Vec3::Z * 0.196);
}

/// A tray with a pot and two cups.
fn tray(shape: &mut Shape, at: Vec3, mixed: usize) {
    slab(shape, Surface::wood(Colour::Brown), at, [0.19, 0.13, 0.016]);
    let china = Surface::plain(SPINES[(mixed + 4) % SPINES.len()]);
    let top = at + Vec3::Z * 0.016;
    let pot = [(0.0, top.z), (0.05, top.z), (0.07, top.z + 0.06), (0.045, top.z + 0.12), (0.0, top.z + 0.14)];
    shape.turned(china, (top.x - 0.07, top.y + 0.02), 1.0, &pot);
    cup(shape, top + Vec3::new(0.07, 0.03, 0.0), china);
    cup(shape, top + Vec3::new(0.06, -0.07, 0.0), china);
}

/// Folded, one on the other.
fn towels(shape: &mut Shape, at: Vec3, mixed: usize) {
    let cloth = [Colour::White, Colour::Blue, Colour::Teal, Colour::Pink, Colour::Beige];
    for fold in 0..3 {
        let (z, surface) = (at.z + 0.06 * fold as f32, Surface::fabric(cloth[(mixed + fold) % cloth.len()]));
        shape.soft(surface, [at.x - 0.15, at.x + 0.15], [at.y - 0.1, at.y + 0.1], [z, z + 0.062], 0.028);
    }
}

fn bottles(shape: &mut Shape, at: Vec3, mixed: usize) {
    let glass = [[64, 110, 70], [150, 84, 40], [214, 226, 232], [196, 70, 90]];
    for bottle in 0..3 {
        let surface = Surface::plain(glass[(mixed + bottle) % glass.len()]);
        let (x, z, tall) = (at.x - 0.08 + 0.08 * bottle as f32, at.z, 0.17 + 0.04 * ((mixed + bottle) % 3) as f32);
        let profile = [
            (0.0, z),
            (0.032, z),
            (0.032, z + tall * 0.62),
            (0.013, z + tall * 0.76),
            (0.013, z + tall),
            (0.0, z + tall),
        ];
        shape.turned(surface, (x, at.y), 1.0, &profile);
    }
}

fn candles(shape: &mut Shape, at: Vec3) {
    let (wax, flame) = (Surface::plain([248, 240, 220]), Surface::plain([255, 214, 120]).glowing());
    for (shift, tall) in [(-0.06, 0.14), (0.0, 0.2), (0.065, 0.1)] {
        let (x, z) = (at.x + shift, at.z);
        shape.tube(Surface::metal(Colour::Gold), (x, at.y), [0.034, 0.03], [z, z + 0.012]);
        shape.tube(wax, (x, at.y), [0.022, 0.022], [z + 0.012, z + tall]);
        shape.ball(flame, Vec3::new(x, at.y, z + tall + 0.014), 0.01);
    }
}

/// A photograph in a standing frame.
fn photo(shape: &mut Shape, at: Vec3, mixed: usize) {
    let frame = Surface::wood([Colour::Black, Colour::White, Colour::Gold, Colour::Wooden][mixed % 4]);
    shape.block(frame, [at.x - 0.075, at.x + 0.075], [at.y, at.y + 0.014], [at.z, at.z + 0.2]);
    let picture = Surface::picture(Pattern::Art(mixed as u8 % ART_COUNT));
    shape.picture(picture, at + Vec3::new(-0.06, -0.002, 0.016), Vec3::X * 0.12, Vec3::Z * 0.168);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scatter_items_puts_things_on_the_surface_and_within_it() {
        let all = [
            Thing::Books,
            Thing::Cup,
            Thing::Bowl,
            Thing::Laptop,
            Thing::Tray,
            Thing::Towels,
            Thing::Bottles,
            Thing::Remote,
            Thing::Candles,
            Thing::Photo,
            Thing::Box,
            Thing::Papers,
        ];
        for variant in 0..40 {
            let mut shape = Shape::default();
            scatter(&mut shape, &all, [-0.8, 0.8], 0.0, 0.75, variant);
            let points: Vec<Vec3> = shape.parts.iter().flat_map(|part| part.positions.clone()).collect();
            assert!(!points.is_empty(), "variant {variant} has nothing on it");
            assert!(points.iter().all(|at| at.z >= 0.749 && at.z < 1.1 && at.x.abs() < 0.86 && at.y.abs() < 0.2));
        }
    }

    #[test]
    fn another_variant_has_other_things_on_it() {
        let positions = |variant: u32| {
            let mut shape = Shape::default();
            scatter(&mut shape, &[Thing::Books, Thing::Cup, Thing::Candles], [-0.8, 0.8], 0.0, 0.75, variant);
            shape.parts.iter().map(|part| part.positions.len()).sum::<usize>()
        };
        assert!((1..6).any(|variant| positions(variant) != positions(0)));
    }
}
