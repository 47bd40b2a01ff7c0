//! Converts between Habitat's frame and Wayword's.
//!
//! Habitat: right-handed, metres, y up, an agent looks along -z. Wayword: z up, heading 0 along +y and clockwise. So
//! north is Habitat's -z.

use wayword_core::DVec3;

/// Height of the eye above the ground, metres (as for the sensors in Habitat's VLN tasks).
pub const EYE_M: f64 = 1.5;

/// Converts a position or direction from Habitat's frame to Wayword's.
#[must_use]
pub fn wayword_from_habitat(place: DVec3) -> DVec3 {
    DVec3::new(place.x, -place.z, place.y)
}

/// Converts a position or direction from Wayword's frame to Habitat's.
#[must_use]
pub fn habitat_from_wayword(place: DVec3) -> DVec3 {
    DVec3::new(place.x, place.z, -place.y)
}

/// The quaternion (w, x, y, z) of a Habitat agent that looks along a heading, with elevation 0.
#[must_use]
pub fn habitat_rotation_from_heading(heading_rad: f64) -> [f64; 4] {
    // Yaw is counter-clockwise about +y, and 0 looks along -z, which is north.
    let (sin, cos) = libm::sincos(-heading_rad / 2.0);
    [cos, 0.0, sin, 0.0]
}

/// The direction in which a Habitat agent looks, in Wayword's frame: its rotation (w, x, y, z) applied to -z. The
/// rotation need not have length 1. If its length is 0 or it is not finite, the result has no direction.
#[must_use]
pub fn forward_from_habitat_rotation([w, x, y, z]: [f64; 4]) -> DVec3 {
    let rotation = glam::DQuat::from_xyzw(x, y, z, w).normalize();
    wayword_from_habitat(rotation * DVec3::NEG_Z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use wayword_core::Heading;

    #[test]
    fn up_is_up_and_forward_is_north() {
        assert_eq!(wayword_from_habitat(DVec3::Y), DVec3::Z);
        assert_eq!(wayword_from_habitat(DVec3::NEG_Z), DVec3::Y);
        assert_eq!(wayword_from_habitat(DVec3::X), DVec3::X);
    }

    proptest! {
        #[test]
        fn axes_round_trip_returns_the_place(x in -1e3..1e3, y in -1e3..1e3, z in -1e3..1e3) {
            let place = DVec3::new(x, y, z);
            prop_assert_eq!(habitat_from_wayword(wayword_from_habitat(place)), place);
        }

        #[test]
        fn habitat_rotation_looks_along_its_heading(heading_rad in -7.0..7.0f64) {
            let forward = forward_from_habitat_rotation(habitat_rotation_from_heading(heading_rad));
            prop_assert!((forward - Heading::new(heading_rad).unwrap().unit_vector()).length() < 1e-9);
        }
    }
}
