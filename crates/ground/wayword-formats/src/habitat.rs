//! Converts poses between the world frame and Habitat's: y up, and an agent that has not turned looks along -z.
//!
//! Habitat's Matterport3D scenes are Matterport's own with other axes: habitat (x, y, z) = Matterport (x, z, -y).

use wayword_core::{DVec3, Heading};

/// A world-frame position (z up) in Habitat's frame (y up), metres.
#[must_use]
pub fn habitat_from_wayword(position: DVec3) -> DVec3 {
    DVec3::new(position.x, position.z, -position.y)
}

/// A position in Habitat's frame (y up) in the world frame (z up), metres.
#[must_use]
pub fn wayword_from_habitat(position: DVec3) -> DVec3 {
    DVec3::new(position.x, -position.z, position.y)
}

/// The rotation (x, y, z, w) of an agent that looks along a heading. Habitat's angles grow counter-clockwise about +y,
/// headings clockwise about the same axis.
#[must_use]
pub fn habitat_from_heading(heading: Heading) -> [f64; 4] {
    let half = heading.rad() / 2.0;
    [0.0, -libm::sin(half), 0.0, libm::cos(half)]
}

/// The heading of an agent with a rotation (x, y, z, w) in Habitat's frame. `None` where the rotation's length is not
/// 1, or the agent looks straight up or down.
#[must_use]
pub fn heading_from_habitat(rotation: [f64; 4]) -> Option<Heading> {
    let [x, y, z, w] = rotation;
    let length = (x * x + y * y + z * z + w * w).sqrt();
    // Files have few digits.
    if !(0.99..1.01).contains(&length) {
        return None;
    }
    // The axis -z after the rotation.
    let forward = DVec3::new(-2.0 * (x * z + w * y), 2.0 * (w * x - y * z), 2.0 * (x * x + y * y) - length * length);
    let ahead = wayword_from_habitat(forward);
    let is_horizontal = (ahead.x * ahead.x + ahead.y * ahead.y).sqrt() > 1e-6;
    if is_horizontal { Heading::new(libm::atan2(ahead.x, ahead.y)).ok() } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

    #[test]
    fn an_agent_that_has_not_turned_looks_along_plus_y() {
        assert_eq!(heading_from_habitat([0.0, 0.0, 0.0, 1.0]), Some(Heading::NORTH));
        assert_eq!(wayword_from_habitat(DVec3::new(0.0, 0.0, -1.0)), DVec3::Y);
        assert_eq!(wayword_from_habitat(DVec3::Y), DVec3::Z);
    }

    #[test]
    fn a_quarter_turn_to_the_left_looks_west() {
        let west = heading_from_habitat([0.0, FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2]).unwrap();
        assert!((west.rad() - 1.5 * PI).abs() < 1e-9);
    }

    #[test]
    fn heading_from_habitat_refuses_what_is_no_level_rotation() {
        assert_eq!(heading_from_habitat([0.0; 4]), None);
        assert_eq!(heading_from_habitat([f64::NAN, 0.0, 0.0, 1.0]), None);
        assert_eq!(heading_from_habitat([FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2]), None);
    }

    proptest! {
        #[test]
        fn headings_come_back(rad in 0.0..TAU) {
            let heading = Heading::new(rad).unwrap();
            let back = heading_from_habitat(habitat_from_heading(heading)).unwrap();
            prop_assert!(heading.turn_to(back).abs() < 1e-9);
        }

        #[test]
        fn positions_come_back_exactly(x in -1e3..1e3f64, y in -1e3..1e3f64, z in -1e3..1e3f64) {
            let position = DVec3::new(x, y, z);
            prop_assert_eq!(wayword_from_habitat(habitat_from_wayword(position)), position);
        }
    }
}
