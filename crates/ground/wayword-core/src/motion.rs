//! The moves between two frames of a path, and the words for them: how large a "left" is, and how high a climb.

use crate::{Pose, heading::Side};
use serde::{Deserialize, Serialize};

/// Whether a path's frames have poses.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PathMotion {
    /// The frames' poses are those of the path.
    #[default]
    Known,
    /// Only the order of the frames is known, and their poses are fillers. The program states no turn, distance,
    /// length or storey of such a path and draws no map of it.
    Unknown,
}

impl PathMotion {
    /// Whether the frames' poses mean something.
    #[must_use]
    pub fn is_known(&self) -> bool {
        *self == Self::Known
    }

    /// Whether a path with this number of frames goes anywhere. Without poses the program knows only the number of
    /// frames: one alone is both start and end.
    #[must_use]
    pub fn goes_anywhere(self, moves: &[PathMove], frames: usize) -> bool {
        match self {
            Self::Known => moves.iter().any(|step| step.distance_m > 0.0),
            Self::Unknown => frames > 1,
        }
    }
}

/// From one frame to the next: first a turn on the spot, then a straight walk.
///
/// The first move of a path holds the opening turn, from the episode's heading to the first hop.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PathMove {
    /// Turn before walking, radians in (-π, π], positive right.
    pub turn_rad: f64,
    /// Straight-line distance walked, metres.
    pub distance_m: f64,
    /// Height gained (positive) or lost, metres.
    pub rise_m: f64,
}

/// A turn as people describe it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TurnKind {
    /// Under [`SLIGHT_DEG`]: too small to mention.
    Straight,
    /// Between [`SLIGHT_DEG`] and [`FULL_DEG`] to the left.
    SlightLeft,
    /// Between [`SLIGHT_DEG`] and [`FULL_DEG`] to the right.
    SlightRight,
    /// At least [`FULL_DEG`], to the left.
    Left,
    /// At least [`FULL_DEG`], to the right.
    Right,
    /// At least [`AROUND_DEG`], either way.
    Around,
}

/// Whether a move goes up, goes down or stays level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ClimbDirection {
    /// Less than [`MIN_CLIMB_M`] of rise.
    Level,
    /// Upwards.
    Up,
    /// Downwards.
    Down,
}

/// The smallest change of direction that an instruction mentions, degrees.
pub const SLIGHT_DEG: f64 = 30.0;
/// The smallest turn that may be told without "slightly", and that a walker has to be told of, degrees.
pub const TOLD_DEG: f64 = 40.0;
/// The widest turn that may be told as a slight one, and the smallest that may be told as a sharp one, degrees.
pub const MAX_SLIGHT_DEG: f64 = 70.0;
/// The smallest turn that is no slight one, degrees.
pub const FULL_DEG: f64 = 55.0;
/// The smallest turn that is called turning around, degrees.
pub const AROUND_DEG: f64 = 150.0;
/// The smallest rise that is stairs and not a door sill, metres.
pub const MIN_CLIMB_M: f64 = 0.5;

/// The smallest turn for which "turn around" is not a mistake in a third-party text, degrees. People say it as soon as
/// they end up looking back more than sideways. Wayword itself uses the words only from [`AROUND_DEG`] on.
pub const AROUND_AT_LEAST_DEG: f64 = 120.0;
/// The smallest bend over several moves that may be called one turn, degrees. No single move of it need be a turn, but
/// together they must be a clear one.
pub const BEND_DEG: f64 = 60.0;
/// Least turn of each move of such a bend, degrees. A smaller turn counts as walking straight, and a bend has no
/// straight stretch.
pub const BEND_STEP_DEG: f64 = 10.0;
/// Longest such bend, moves: a corner is rounded in two or three hops between viewpoints.
pub const MAX_BEND_MOVES: usize = 3;

impl PathMove {
    /// The move between two poses.
    #[must_use]
    pub fn between_poses(from: &Pose, to: &Pose) -> Self {
        Self {
            turn_rad: from.heading.turn_to(to.heading),
            distance_m: from.position.distance(to.position),
            rise_m: to.position.z - from.position.z,
        }
    }

    /// The word for its turn.
    #[must_use]
    pub fn turn(&self) -> TurnKind {
        TurnKind::from_rad(self.turn_rad)
    }

    /// Whether it climbs.
    #[must_use]
    pub fn climb(&self) -> ClimbDirection {
        ClimbDirection::from_rise(self.rise_m)
    }
}

/// Rises of less than this are unevenness of the floor, metres.
const FLAT_M: f64 = 0.05;

/// The flight of stairs that begins with the move `first`: its last move, and whether it goes up or down. The rises of
/// consecutive moves in one direction add up; `None` where they come to less than [`MIN_CLIMB_M`].
#[must_use]
pub fn flight_from(moves: &[PathMove], first: usize) -> Option<(usize, ClimbDirection)> {
    let direction = moves.get(first)?.rise_m.signum();
    let last = (first..moves.len()).take_while(|at| moves[*at].rise_m * direction > FLAT_M).last()?;
    let total_m: f64 = moves[first..=last].iter().map(|step| step.rise_m).sum();
    match ClimbDirection::from_rise(total_m) {
        ClimbDirection::Level => None,
        climb => Some((last, climb)),
    }
}

impl TurnKind {
    /// The word for a turn of `turn_rad` radians, positive right.
    #[must_use]
    pub fn from_rad(turn_rad: f64) -> Self {
        let deg = turn_rad.to_degrees();
        match (deg.abs(), deg > 0.0) {
            (size, _) if size < SLIGHT_DEG => Self::Straight,
            (size, _) if size >= AROUND_DEG => Self::Around,
            (size, true) if size < FULL_DEG => Self::SlightRight,
            (size, false) if size < FULL_DEG => Self::SlightLeft,
            (_, true) => Self::Right,
            (_, false) => Self::Left,
        }
    }

    /// Left or right, where the turn has a side.
    #[must_use]
    pub fn side(self) -> Option<Side> {
        match self {
            Self::SlightLeft | Self::Left => Some(Side::Left),
            Self::SlightRight | Self::Right => Some(Side::Right),
            Self::Straight | Self::Around => None,
        }
    }
}

impl ClimbDirection {
    /// The word for a rise of `rise_m` metres.
    #[must_use]
    pub fn from_rise(rise_m: f64) -> Self {
        if rise_m >= MIN_CLIMB_M {
            Self::Up
        } else if rise_m <= -MIN_CLIMB_M {
            Self::Down
        } else {
            Self::Level
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Heading;
    use glam::DVec3;
    use proptest::prelude::*;

    fn pose(x: f64, y: f64, z: f64, deg: f64) -> Pose {
        Pose::looking_level(DVec3::new(x, y, z), Heading::new(deg.to_radians()).unwrap())
    }

    #[test]
    fn a_quarter_clockwise_is_a_right_turn() {
        let step = PathMove::between_poses(&pose(0.0, 0.0, 0.0, 350.0), &pose(2.0, 0.0, 0.0, 80.0));
        assert_eq!(step.turn(), TurnKind::Right);
        assert_eq!(step.climb(), ClimbDirection::Level);
        assert!((step.distance_m - 2.0).abs() < 1e-12);
    }

    #[test]
    fn the_words_of_turns_change_at_their_limits() {
        let word = |deg: f64| TurnKind::from_rad(deg.to_radians());
        assert_eq!(word(29.9), TurnKind::Straight);
        assert_eq!(word(-31.0), TurnKind::SlightLeft);
        assert_eq!(word(-55.1), TurnKind::Left);
        assert_eq!(word(151.0), TurnKind::Around);
        assert_eq!(word(-180.0), TurnKind::Around);
    }

    proptest! {
        #[test]
        fn mirrored_turns_have_mirrored_words(deg in 0.1..149.0f64) {
            let (right, left) = (TurnKind::from_rad(deg.to_radians()), TurnKind::from_rad(-deg.to_radians()));
            match right.side() {
                None => prop_assert_eq!(left, right),
                Some(side) => {
                    prop_assert_eq!(side, Side::Right);
                    prop_assert_eq!(left.side(), Some(Side::Left));
                }
            }
        }
    }
}
