//! Builds plants and vases. Lengths are metres.

use super::{
    super::{
        colour::Colour,
        surface::{HouseSurface, SurfacePattern},
    },
    FurnitureLook, HouseShape,
};
use glam::Vec3;

/// Directions that turn by the golden angle, so that no leaf hides another.
fn spiral_direction(step: usize) -> (f32, f32) {
    let angle = 2.399_963 * step as f32;
    (libm::cosf(angle), libm::sinf(angle))
}

/// A pot with long leaves on stems.
pub(super) fn build_plant(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let pot = [Colour::White, Colour::Orange, Colour::DarkGrey, Colour::Beige][look.variant as usize % 4];
    let pot = HouseSurface::from_rgb(pot.rgb());
    shape.add_turned(
        pot,
        (0.0, 0.0),
        1.0,
        &[(0.0, 0.0), (0.12, 0.0), (0.17, 0.32), (0.15, 0.32), (0.14, 0.29), (0.0, 0.29)],
    );
    shape.add_tube(HouseSurface::from_rgb([70, 50, 38]), (0.0, 0.0), [0.145, 0.145], [0.285, 0.3]);
    let leaf = HouseSurface::new(SurfacePattern::Leaves, [255; 3]);
    let reach = look.w / 2.0;
    for step in 0..26 {
        let ((cos, sin), level) = (spiral_direction(step), step as f32 / 26.0);
        let top = 0.45 + level * (look.h - 0.62);
        let stem = Vec3::new(cos * 0.05, sin * 0.05, top);
        let spread = reach * (1.0 - 0.45 * level);
        let tip = Vec3::new(cos * spread, sin * spread, top + 0.12 - 0.1 * (1.0 - level));
        shape.add_leaf(if step % 3 == 0 { leaf.shaded_by(0.8) } else { leaf }, stem, tip, 0.13);
        if step % 4 == 0 {
            shape.add_rod(HouseSurface::from_rgb([70, 96, 50]), Vec3::new(0.0, 0.0, 0.28), stem, 0.008);
        }
    }
    shape.add_leaf(leaf, Vec3::new(0.0, 0.0, look.h - 0.3), Vec3::new(0.06, 0.0, look.h), 0.12);
    shape
}

/// A vase with flowers.
pub(super) fn build_vase(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let body = HouseSurface::from_rgb(look.colour.rgb());
    let height = look.h * 0.5;
    let profile =
        [(0.0, 0.0), (0.05, 0.0), (0.09, height * 0.4), (0.045, height * 0.85), (0.06, height), (0.0, height * 0.96)];
    shape.add_turned(body, (0.0, 0.0), 1.0, &profile);
    let petals = [[214, 60, 84], [240, 190, 60], [240, 236, 226], [170, 90, 180]][look.variant as usize % 4];
    for step in 0..7 {
        let (cos, sin) = spiral_direction(step);
        let top = Vec3::new(cos * 0.085, sin * 0.085, look.h * (0.8 + 0.025 * step as f32));
        shape.add_rod(HouseSurface::from_rgb([74, 116, 60]), Vec3::new(0.0, 0.0, height * 0.9), top, 0.005);
        shape.add_ball(HouseSurface::from_rgb(petals), top, 0.032);
    }
    shape
}
