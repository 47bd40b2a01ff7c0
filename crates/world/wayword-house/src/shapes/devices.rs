//! Builds screens, and a globe. Lengths are metres; `hw` is half the width of a piece, `look.h` its height.

use super::{
    super::{
        colour::Colour,
        surface::{HouseSurface, SurfacePattern},
    },
    FurnitureLook, HouseShape,
};
use glam::Vec3;

/// A wide dark screen on two feet.
pub(super) fn build_television(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let hw = look.w / 2.0;
    let case = HouseSurface::from_rgb([24, 24, 27]);
    shape.add_block(case, [-hw, hw], [-0.02, 0.03], [0.06, look.h]);
    let corner = Vec3::new(-hw + 0.015, -0.0215, 0.08);
    let screen = HouseSurface::new(SurfacePattern::Reflection, [44, 50, 62]).glowing();
    shape.add_picture(screen, corner, Vec3::X * (look.w - 0.03), Vec3::Z * (look.h - 0.1));
    for x in [-hw * 0.6, hw * 0.6] {
        shape.add_block(case, [x - 0.02, x + 0.02], [-0.12, 0.12], [0.0, 0.015]);
        shape.add_block(case, [x - 0.015, x + 0.015], [-0.01, 0.02], [0.0, 0.08]);
    }
    shape.add_block(HouseSurface::from_rgb([70, 70, 74]), [-0.04, 0.04], [-0.022, -0.02], [0.066, 0.074]);
    shape
}

/// A monitor that shows windows and text.
pub(super) fn build_computer(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let hw = look.w / 2.0;
    let case = HouseSurface::from_rgb([30, 30, 33]);
    shape.add_block(case, [-0.12, 0.12], [-0.09, 0.09], [0.0, 0.012]);
    shape.add_block(case, [-0.03, 0.03], [0.02, 0.05], [0.0, 0.2]);
    shape.add_block(case, [-hw, hw], [-0.01, 0.03], [0.11, look.h]);
    let screen = HouseSurface::for_picture(SurfacePattern::Desktop).glowing();
    shape.add_picture(
        screen,
        Vec3::new(-hw + 0.012, -0.012, 0.125),
        Vec3::X * (look.w - 0.024),
        Vec3::Z * (look.h - 0.137),
    );
    shape
}

/// A globe in a half ring.
pub(super) fn build_globe(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let brass = HouseSurface::for_metal(Colour::Gold);
    let r = look.w / 2.0 - 0.015;
    let centre = Vec3::new(0.0, 0.0, look.h - r - 0.01);
    shape.add_ball(HouseSurface::for_picture(SurfacePattern::Map), centre, r);
    shape.add_hoop(brass, centre, Vec3::Y, r + 0.012, 0.006);
    shape.add_tube(brass, (0.0, 0.0), [0.1, 0.08], [0.0, 0.02]);
    shape.add_tube(brass, (0.0, 0.0), [0.015, 0.015], [0.02, centre.z - r]);
    shape
}
