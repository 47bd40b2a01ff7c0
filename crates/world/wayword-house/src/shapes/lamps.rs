//! Builds lamps. Their shades and bulbs shine in the picture too. Lengths are metres; `r` is a radius.

use super::{
    super::{colour::Colour, surface::HouseSurface},
    FurnitureLook, HouseShape,
};
use glam::Vec3;

fn shade_surface() -> HouseSurface {
    HouseSurface::from_rgb([255, 240, 206]).glowing()
}

pub(super) fn build_floor_lamp(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let (r, metal) = (look.w / 2.0, HouseSurface::for_metal(look.colour));
    shape.add_tube(metal, (0.0, 0.0), [0.15, 0.14], [0.0, 0.03]);
    shape.add_tube(metal, (0.0, 0.0), [0.014, 0.014], [0.03, look.h - 0.1]);
    shape.add_tube(shade_surface(), (0.0, 0.0), [r, r * 0.7], [look.h - 0.32, look.h]);
    shape
}

pub(super) fn build_table_lamp(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let (r, body) = (look.w / 2.0, HouseSurface::from_rgb(look.colour.rgb()));
    let foot = [
        (0.0, 0.0),
        (0.07, 0.0),
        (0.085, 0.08),
        (0.05, 0.2),
        (0.015, 0.24),
        (0.015, look.h - 0.18),
        (0.0, look.h - 0.18),
    ];
    shape.add_turned(body, (0.0, 0.0), 1.0, &foot);
    shape.add_tube(shade_surface(), (0.0, 0.0), [r, r * 0.66], [look.h - 0.24, look.h]);
    shape
}

/// A flat bowl of white glass.
pub(super) fn build_ceiling_light(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let r = look.w / 2.0;
    shape.add_tube(HouseSurface::for_metal(Colour::Silver), (0.0, 0.0), [r * 0.6, r * 0.6], [look.h - 0.03, look.h]);
    let glass = HouseSurface::from_rgb([255, 250, 234]).glowing();
    shape.add_turned(glass, (0.0, 0.0), 1.0, &[(0.0, 0.0), (r * 0.6, 0.02), (r, 0.1), (r, 0.13), (0.0, 0.13)]);
    shape
}

/// Six arms with candles, on a chain.
pub(super) fn build_chandelier(look: &FurnitureLook) -> HouseShape {
    let mut shape = HouseShape::default();
    let (r, metal) = (look.w / 2.0 - 0.04, HouseSurface::for_metal(look.colour));
    shape.add_rod(metal, Vec3::new(0.0, 0.0, 0.1), Vec3::new(0.0, 0.0, look.h), 0.012);
    shape.add_ball(metal, Vec3::new(0.0, 0.0, 0.08), 0.055);
    shape.add_tube(metal, (0.0, 0.0), [0.06, 0.06], [look.h - 0.03, look.h]);
    for arm in 0..6 {
        let angle = std::f32::consts::TAU * arm as f32 / 6.0;
        let out = Vec3::new(libm::cosf(angle) * r, libm::sinf(angle) * r, 0.0);
        shape.add_rod(metal, Vec3::new(0.0, 0.0, 0.08), out * 0.6 + Vec3::Z * 0.02, 0.012);
        shape.add_rod(metal, out * 0.6 + Vec3::Z * 0.02, out + Vec3::Z * 0.1, 0.012);
        shape.add_tube(metal, (out.x, out.y), [0.035, 0.035], [0.09, 0.105]);
        shape.add_tube(HouseSurface::from_rgb([250, 246, 236]), (out.x, out.y), [0.014, 0.014], [0.105, 0.19]);
        shape.add_ball(shade_surface(), out + Vec3::Z * 0.215, 0.032);
    }
    shape
}
