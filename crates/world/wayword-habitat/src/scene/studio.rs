//! What has no material.
//!
//! Habitat gives it a white one of metalness 0.3 and roughness 0.3 (`ResourceManager.cpp`, `buildDefaultMaterial`) and lights it by
//! the image of a photo studio, `brown_photostudio_02_1k.hdr` (`PbrIBLHelper.cpp`, `pbrLighting.glsl`), while everything else in a
//! scene without lights is drawn as it is stored. So a third of what such a surface shows is the studio's mirror image, hardly
//! blurred. That image is not at hand. Of the light only what frames of Habitat show is known: its mean colour on surfaces that look
//! up, east and south. The mirror image changes it by up to 13 of 255, which is left out here.

use glam::Vec3;

/// Colour of the light on surfaces that look east, west, north, south, up and down, 0..=255. West and north are taken to be like
/// what lies across, down like the sides.
const LIGHT: [[f32; 3]; 6] = [
    [142.0, 132.0, 104.0],
    [109.0, 95.0, 79.0],
    [142.0, 132.0, 104.0],
    [109.0, 95.0, 79.0],
    [141.0, 124.0, 85.0],
    [109.0, 95.0, 79.0],
];

/// The light on a surface with this normal, as factors: shares of the axes by the squares of the normal's parts.
pub(super) fn light(normal: Vec3) -> [f32; 3] {
    let normal = normal.normalize_or(Vec3::Z);
    let mut light = [0.0; 3];
    for axis in 0..3 {
        let towards = LIGHT[2 * axis + usize::from(normal[axis] < 0.0)];
        for (sum, part) in light.iter_mut().zip(towards) {
            *sum += normal[axis] * normal[axis] * part / 255.0;
        }
    }
    light
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_looks_up_is_lit_from_above() {
        assert_eq!(light(Vec3::Z).map(|part| (part * 255.0).round()), [141.0, 124.0, 85.0]);
        let between = light(Vec3::new(1.0, 0.0, 1.0));
        assert!((between[2] * 255.0 - 94.5).abs() < 0.1);
    }
}
