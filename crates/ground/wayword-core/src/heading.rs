//! Directions in the horizontal plane.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A number that had to be finite and was not.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{0} is not a finite number")]
pub struct NotFinite(pub f64);

/// A direction in the horizontal plane: radians in [0, 2π), 0 along +y, clockwise seen from above.
///
/// The convention is Matterport3DSimulator's (README, "heading").
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(try_from = "f64", into = "f64")]
pub struct Heading(f64);

/// A side of the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Within 45 degrees of the heading.
    Ahead,
    /// Between 45 and 135 degrees clockwise of it.
    Right,
    /// Within 45 degrees of its opposite.
    Behind,
    /// Between 45 and 135 degrees counter-clockwise of it.
    Left,
}

/// The four directions of a panorama by the compass; north is +y.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CompassPoint {
    /// +y, heading 0.
    North,
    /// +x, heading π/2.
    East,
    /// -y, heading π.
    South,
    /// -x, heading 3π/2.
    West,
}

impl Heading {
    /// Along +y.
    pub const NORTH: Self = Self(0.0);

    /// A heading from any finite angle in radians.
    ///
    /// # Errors
    /// When `rad` is NaN or infinite.
    pub fn new(rad: f64) -> Result<Self, NotFinite> {
        if rad.is_finite() { Ok(Self::wrap_angle(rad)) } else { Err(NotFinite(rad)) }
    }

    fn wrap_angle(rad: f64) -> Self {
        let rad = rad.rem_euclid(TAU);
        // rem_euclid rounds up to TAU itself for tiny negative angles.
        Self(if rad >= TAU { 0.0 } else { rad })
    }

    /// The direction from one position to another, or `None` where one lies (nearly) above the other.
    #[must_use]
    pub fn towards(from: DVec3, to: DVec3) -> Option<Self> {
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        let far_enough = libm::hypot(dx, dy) > 1e-6;
        far_enough.then(|| Self::wrap_angle(libm::atan2(dx, dy)))
    }

    /// Radians in [0, 2π).
    #[must_use]
    pub fn rad(self) -> f64 {
        self.0
    }

    /// Degrees in [0, 360).
    #[must_use]
    pub fn deg(self) -> f64 {
        self.0.to_degrees()
    }

    /// This heading after a turn; positive is clockwise (right).
    #[must_use]
    pub fn turned_by(self, rad: f64) -> Self {
        Self::wrap_angle(self.0 + rad)
    }

    /// The smallest turn that leads from `self` to `other`: in (-π, π], positive is right.
    #[must_use]
    pub fn turn_to(self, other: Self) -> f64 {
        let turn = (other.0 - self.0).rem_euclid(TAU);
        if turn > PI { turn - TAU } else { turn }
    }

    /// The side on which `other` lies for someone who looks along `self`.
    #[must_use]
    pub fn side_of(self, other: Self) -> Side {
        let quarter = ((self.turn_to(other) + FRAC_PI_2 / 2.0) / FRAC_PI_2).floor();
        match quarter.rem_euclid(4.0) as u8 {
            0 => Side::Ahead,
            1 => Side::Right,
            2 => Side::Behind,
            _ => Side::Left,
        }
    }

    /// The unit vector along this heading, horizontal.
    #[must_use]
    pub fn unit_vector(self) -> DVec3 {
        DVec3::new(libm::sin(self.0), libm::cos(self.0), 0.0)
    }

    /// The unit vector along this heading, raised by an elevation, radians.
    #[must_use]
    pub fn raised_vector(self, elevation_rad: f64) -> DVec3 {
        let (up, along) = libm::sincos(elevation_rad);
        self.unit_vector() * along + DVec3::Z * up
    }
}

impl TryFrom<f64> for Heading {
    type Error = NotFinite;
    fn try_from(rad: f64) -> Result<Self, NotFinite> {
        Self::new(rad)
    }
}

impl From<Heading> for f64 {
    fn from(heading: Heading) -> f64 {
        heading.0
    }
}

impl Side {
    /// All four, in the order of a panorama relative to the heading.
    pub const ALL: [Self; 4] = [Self::Ahead, Self::Right, Self::Behind, Self::Left];

    /// How far to turn from the heading to look there, radians, positive right.
    #[must_use]
    pub fn turn_rad(self) -> f64 {
        match self {
            Self::Ahead => 0.0,
            Self::Right => FRAC_PI_2,
            Self::Behind => PI,
            Self::Left => -FRAC_PI_2,
        }
    }
}

impl CompassPoint {
    /// All four, clockwise from north.
    pub const ALL: [Self; 4] = [Self::North, Self::East, Self::South, Self::West];

    /// The heading that looks there.
    #[must_use]
    pub fn to_heading(self) -> Heading {
        Heading(FRAC_PI_2 * f64::from(self as u8))
    }

    /// The word for it.
    #[must_use]
    pub fn word(self) -> &'static str {
        ["north", "east", "south", "west"][self as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn zero_looks_along_y_and_grows_clockwise() {
        let east = Heading::towards(DVec3::ZERO, DVec3::X).unwrap();
        assert!((east.deg() - 90.0).abs() < 1e-12);
        assert_eq!(Heading::towards(DVec3::ZERO, DVec3::Z), None);
        assert_eq!(Heading::NORTH.side_of(east), Side::Right);
        assert_eq!(east.side_of(Heading::NORTH), Side::Left);
    }

    #[test]
    fn non_finite_angles_are_refused() {
        assert!(Heading::new(f64::NAN).is_err());
        assert!(serde_json::from_str::<Heading>("1e999").is_err());
    }

    proptest! {
        #[test]
        fn a_heading_is_always_in_one_turn(rad in -1e6..1e6f64) {
            let heading = Heading::new(rad).unwrap();
            prop_assert!((0.0..TAU).contains(&heading.rad()));
            prop_assert!((heading.rad().sin() - rad.sin()).abs() < 1e-6);
        }

        #[test]
        fn turning_there_arrives_there(a in 0.0..TAU, b in 0.0..TAU) {
            let (a, b) = (Heading::new(a).unwrap(), Heading::new(b).unwrap());
            let turn = a.turn_to(b);
            prop_assert!(turn > -PI - 1e-12 && turn <= PI);
            prop_assert!(a.turned_by(turn).turn_to(b).abs() < 1e-9);
        }

        #[test]
        fn direction_and_heading_are_inverse(rad in 0.0..TAU) {
            let heading = Heading::new(rad).unwrap();
            let back = Heading::towards(DVec3::ZERO, heading.unit_vector()).unwrap();
            prop_assert!(heading.turn_to(back).abs() < 1e-9);
        }

        #[test]
        fn every_direction_lies_on_the_side_whose_turn_is_nearest(a in 0.0..TAU, b in 0.0..TAU) {
            let (a, b) = (Heading::new(a).unwrap(), Heading::new(b).unwrap());
            let side = a.side_of(b);
            prop_assert!(a.turned_by(side.turn_rad()).turn_to(b).abs() <= PI / 4.0 + 1e-9);
        }
    }
}
