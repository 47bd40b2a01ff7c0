//! Screens, and a globe.

use super::{
    super::{
        colour::Colour,
        surface::{Pattern, Surface},
    },
    Look, Shape,
};
use glam::Vec3;

/// A wide dark screen on two feet.
pub(super) fn television(look: &Look) -> Shape {
    let mut shape = Shape::default();
    let hw = look.w / 2.0;
    let case = Surface::plain([24, 24, 27]);
    shape.block(case, [-hw, hw], [-0.02, 0.03], [0.06, look.h]);
    let corner = Vec3::new(-hw + 0.015, -0.0215, 0.08);
    let screen = Surface::new(Pattern::Reflection, [44, 50, 62]).glowing();
    shape.picture(screen, corner, Vec3::X * (look.w - 0.03), Vec3::Z * (look.h - 0.1));
    for x in [-hw * 0.6, hw * 0.6] {
        shape.block(case, [x - 0.02, x + 0.02], [-0.12, 0.12], [0.0, 0.015]);
        shape.block(case, [x - 0.015, x + 0.015], [-0.01, 0.02], [0.0, 0.08]);
    }
    shape.block(Surface::plain([70, 70, 74]), [-0.04, 0.04], [-0.022, -0.02], [0.066, 0.074]);
    shape
}

/// A monitor that shows windows and text.
pub(super) fn computer(look: &Look) -> Shape {
    let mut shape = Shape::default();
    let hw = look.w / 2.0;
    let case = Surface::plain([30, 30, 33]);
    shape.block(case, [-0.12, 0.12], [-0.09, 0.09], [0.0, 0.012]);
    shape.block(case, [-0.03, 0.03], [0.02, 0.05], [0.0, 0.2]);
    shape.block(case, [-hw, hw], [-0.01, 0.03], [0.11, look.h]);
    let screen = Surface::picture(Pattern::Desktop).glowing();
    shape.picture(
        screen,
        Vec3::new(-hw + 0.012, -0.012, 0.125),
        Vec3::X * (look.w - 0.024),
        Vec3::Z * (look.h - 0.137),
    );
    shape
}

/// A globe in a half ring.
pub(super) fn globe(look: &Look) -> Shape {
    let mut shape = Shape::default();
    let brass = Surface::metal(Colour::Gold);
    let r = look.w / 2.0 - 0.015;
    let centre = Vec3::new(0.0, 0.0, look.h - r - 0.01);
    shape.ball(Surface::picture(Pattern::Map), centre, r);
    shape.hoop(brass, centre, Vec3::Y, r + 0.012, 0.006);
    shape.tube(brass, (0.0, 0.0), [0.1, 0.08], [0.0, 0.02]);
    shape.tube(brass, (0.0, 0.0), [0.015, 0.015], [0.02, centre.z - r]);
    shape
}
