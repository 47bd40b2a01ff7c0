//! Unity's coordinates, which both simulators use: left-handed, metres, +y up, +z forward, yaw clockwise from above.
//!
//! Wayword's world frame is right-handed with z up. Swapping y and z converts one to the other, because it changes the
//! up axis and mirrors. Headings stay the same, because both count them clockwise from above.

use wayword_core::{DVec3, Heading};

/// Converts a Unity position or direction to the world frame.
#[must_use]
pub fn wayword_from_unity([x, y, z]: [f64; 3]) -> DVec3 {
    DVec3::new(x, z, y)
}

/// Converts a position or direction of the world frame to Unity's.
#[must_use]
pub fn unity_from_wayword(place: DVec3) -> [f64; 3] {
    [place.x, place.z, place.y]
}

/// A heading as a rotation about Unity's up axis: x, y, z, w.
#[must_use]
pub fn unity_rotation_from_heading(heading: Heading) -> [f64; 4] {
    let (sin, cos) = libm::sincos(heading.rad() / 2.0);
    [0.0, sin, 0.0, cos]
}

/// The direction to which a Unity rotation (x, y, z, w) turns +z, in the world frame.
#[must_use]
pub fn wayword_forward_from_unity_rotation([x, y, z, w]: [f64; 4]) -> DVec3 {
    wayword_from_unity([2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn unitys_forward_is_north_and_its_right_is_east() {
        assert_eq!(wayword_from_unity([0.0, 0.0, 1.0]), DVec3::Y);
        assert_eq!(wayword_from_unity([1.0, 0.0, 0.0]), DVec3::X);
        assert_eq!(wayword_from_unity([0.0, 1.0, 0.0]), DVec3::Z);
    }

    proptest! {
        #[test]
        fn unity_conversion_round_trips(x in -1e3..1e3f64, y in -1e3..1e3f64, z in -1e3..1e3f64) {
            prop_assert_eq!(wayword_from_unity(unity_from_wayword(DVec3::new(x, y, z))), DVec3::new(x, y, z));
        }

        #[test]
        fn a_headings_rotation_looks_along_it(rad in 0.0..std::f64::consts::TAU) {
            let heading = Heading::new(rad).unwrap();
            let forward = wayword_forward_from_unity_rotation(unity_rotation_from_heading(heading));
            prop_assert!(forward.distance(heading.unit_vector()) < 1e-9);
        }
    }
}
