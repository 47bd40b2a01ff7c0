//! The light on surfaces that have no material.
//!
//! Habitat gives them a white material of metalness 0.3 and roughness 0.3 (`ResourceManager.cpp`,
//! `buildDefaultMaterial`) and lights it with the image of a photo studio, `brown_photostudio_02_1k.hdr`
//! (`PbrIBLHelper.cpp`, `pbrLighting.glsl`). So a third of such a surface's colour is the mirror image of the studio,
//! only slightly blurred. That image is not available here. So the mean colours were measured from frames that Habitat
//! drew, in which such surfaces look up, east and south. The mirror image changes them by up to 13 of 255, which is left
//! out here. Everything else in a scene without lights is drawn with its stored colours.

use glam::Vec3;

/// Colour of the light on surfaces that look east and west, north and south, up and down, 0..=255. Only east, south and up
/// were measured: west and down are assumed to equal south, and north to equal east.
const LIGHT_BY_DIRECTION: [[[f32; 3]; 2]; 3] = [
    // East, west.
    [[142.0, 132.0, 104.0], [109.0, 95.0, 79.0]],
    // North, south.
    [[142.0, 132.0, 104.0], [109.0, 95.0, 79.0]],
    // Up, down.
    [[141.0, 124.0, 85.0], [109.0, 95.0, 79.0]],
];

/// The light on a surface with this normal, as factors: the mean of the axes' colours, weighted with the squares of the
/// normal's components.
pub(super) fn studio_light(normal: Vec3) -> [f32; 3] {
    let normal = normal.normalize_or(Vec3::Z);
    let mut light = [0.0; 3];
    for (along, [ahead, behind]) in normal.to_array().into_iter().zip(LIGHT_BY_DIRECTION) {
        let towards = if along < 0.0 { behind } else { ahead };
        for (sum, part) in light.iter_mut().zip(towards) {
            *sum += along * along * part / 255.0;
        }
    }
    light
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn studio_light_depends_on_the_normal() {
        assert_eq!(studio_light(Vec3::Z).map(|part| (part * 255.0).round()), [141.0, 124.0, 85.0]);
        let between = studio_light(Vec3::new(1.0, 0.0, 1.0));
        assert!((between[2] * 255.0 - 94.5).abs() < 0.1);
    }
}
