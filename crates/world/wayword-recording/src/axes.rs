//! Conventions of recorded poses, and their conversion into Wayword's: metres, z up, north is +y.

use serde::Deserialize;
use std::f64::consts::FRAC_PI_2;
use wayword_core::{DVec3, Heading};

/// The axes of the world of a recording's poses: which of them points up, and whether the world is left-handed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum WorldUpAxis {
    /// z up, as in ROS (REP 103) and most trackers.
    ZUp,
    /// y up, as in ARKit and OpenGL.
    YUp,
    /// y down, as in worlds that begin as the first camera's frame (ORB-SLAM, COLMAP).
    YDown,
    /// Unity's: left-handed, x right, y up, z ahead.
    Unity,
    /// Unreal Engine's: left-handed, x ahead, y right, z up; usually in centimetres.
    Unreal,
    /// North-east-down, of aircraft and AirSim: x north, y east, z down.
    Ned,
}

/// The body to which the orientation of a pose belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum PoseBody {
    /// A robot: x ahead, y left, z up (REP 103).
    Robot,
    /// A camera's optical frame: z ahead, x right, y down (REP 103; TUM RGB-D).
    Optical,
    /// An OpenGL camera: -z ahead, x right, y up (NeRF's `transforms.json`).
    OpenGl,
    /// A camera of Unity: z ahead, x right, y up.
    Unity,
    /// The body in a north-east-down world: x ahead (forward), y right, z down.
    Frd,
}

/// The conventions by which the poses of a recording are read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PoseAxes {
    pub(crate) world: WorldUpAxis,
    pub(crate) body: PoseBody,
    /// Angle from the direction ahead of `body` to the camera's view direction, clockwise, radians.
    pub(crate) mount_rad: f64,
}

impl PoseAxes {
    /// The axes of a body in a world with z up.
    pub(crate) const fn for_body(body: PoseBody) -> Self {
        Self { world: WorldUpAxis::ZUp, body, mount_rad: 0.0 }
    }

    /// Turns a recorded position or direction into Wayword's frame.
    pub(crate) fn wayword_from_recorded(self, recorded: DVec3) -> DVec3 {
        let DVec3 { x, y, z } = recorded;
        match self.world {
            WorldUpAxis::ZUp => recorded,
            WorldUpAxis::YUp => DVec3::new(x, -z, y),
            WorldUpAxis::YDown => DVec3::new(x, z, -y),
            // These two are mirrored, because Wayword's frame is right-handed.
            WorldUpAxis::Unity => DVec3::new(x, z, y),
            WorldUpAxis::Unreal => DVec3::new(y, x, z),
            WorldUpAxis::Ned => DVec3::new(y, x, -z),
        }
    }

    /// The camera's heading in Wayword's frame by a quaternion (x, y, z, w); `None` if the camera looks straight up or down,
    /// or the quaternion is invalid.
    #[cfg(any(feature = "lerobot", feature = "mcap", test))]
    pub(crate) fn heading_by_quaternion(self, recorded_from_body: [f64; 4]) -> Option<Heading> {
        self.heading_along(rotate_vector(recorded_from_body, self.body_ahead())?)
    }

    /// As [`PoseAxes::heading_by_quaternion`], by a rotation's columns.
    pub(crate) fn heading_by_columns(self, recorded_from_body: [DVec3; 3]) -> Option<Heading> {
        let [x, y, z] = recorded_from_body;
        let ahead = self.body_ahead();
        self.heading_along(x * ahead.x + y * ahead.y + z * ahead.z)
    }

    /// As [`PoseAxes::heading_by_quaternion`], by a yaw in radians: counter-clockwise from the recorded +x, as in ROS; in
    /// left-handed worlds, and where z points down, clockwise from the world's axis that points ahead.
    pub(crate) fn heading_by_yaw(self, yaw_rad: f64) -> Option<Heading> {
        let clockwise_rad = if self.world.has_clockwise_yaw() { yaw_rad } else { FRAC_PI_2 - yaw_rad };
        Heading::new(clockwise_rad + self.mount_rad).ok()
    }

    /// The body's up direction, in its own frame.
    pub(crate) fn body_up(self) -> DVec3 {
        match self.body {
            PoseBody::Robot => DVec3::Z,
            PoseBody::Frd => DVec3::NEG_Z,
            PoseBody::Optical => DVec3::NEG_Y,
            PoseBody::OpenGl | PoseBody::Unity => DVec3::Y,
        }
    }

    /// The body's direction ahead, in its own frame.
    pub(crate) fn body_ahead(self) -> DVec3 {
        match self.body {
            PoseBody::Robot | PoseBody::Frd => DVec3::X,
            PoseBody::Optical | PoseBody::Unity => DVec3::Z,
            PoseBody::OpenGl => DVec3::NEG_Z,
        }
    }

    /// The camera's heading if its body's direction ahead is `recorded`, in the recording's frame; `None` if that direction is
    /// vertical.
    fn heading_along(self, recorded: DVec3) -> Option<Heading> {
        let heading = Heading::towards(DVec3::ZERO, self.wayword_from_recorded(recorded))?;
        Some(heading.turned_by(self.mount_rad))
    }
}

impl WorldUpAxis {
    /// Its name in `recording.toml`.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::ZUp => "z-up",
            Self::YUp => "y-up",
            Self::YDown => "y-down",
            Self::Unity => "unity",
            Self::Unreal => "unreal",
            Self::Ned => "ned",
        }
    }

    /// The direction that is up in it.
    pub(crate) const fn up(self) -> DVec3 {
        match self {
            Self::ZUp | Self::Unreal => DVec3::Z,
            Self::YUp | Self::Unity => DVec3::Y,
            Self::YDown => DVec3::NEG_Y,
            Self::Ned => DVec3::NEG_Z,
        }
    }

    /// Whether it is the mirror image of a right-handed world.
    pub(crate) const fn is_left_handed(self) -> bool {
        matches!(self, Self::Unity | Self::Unreal)
    }

    /// Whether a yaw in it grows clockwise, seen from above.
    const fn has_clockwise_yaw(self) -> bool {
        self.is_left_handed() || matches!(self, Self::Ned)
    }

    /// Whether a turn about its vertical axis can be given as a yaw.
    pub(crate) const fn has_yaw(self) -> bool {
        matches!(self, Self::ZUp | Self::Unity | Self::Unreal | Self::Ned)
    }

    /// The body that poses of such a world have, if the world decides it. Of a body only the directions ahead and up count, so a
    /// robot's is also that of a camera of Unreal Engine.
    pub(crate) const fn own_body(self) -> Option<PoseBody> {
        match self {
            Self::Unity => Some(PoseBody::Unity),
            Self::Unreal => Some(PoseBody::Robot),
            Self::Ned => Some(PoseBody::Frd),
            Self::ZUp | Self::YUp | Self::YDown => None,
        }
    }
}

impl PoseBody {
    /// Its name in `recording.toml`.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Robot => "robot",
            Self::Optical => "optical",
            Self::OpenGl => "open-gl",
            Self::Unity => "unity",
            Self::Frd => "frd",
        }
    }
}

/// The length of a quaternion. That of a rotation is 1; without a length above zero it is none.
pub(crate) fn quaternion_length([x, y, z, w]: [f64; 4]) -> f64 {
    libm::sqrt(x * x + y * y + z * z + w * w)
}

/// Whether a quaternion gives a rotation: its length is finite, and not too small.
pub(crate) fn is_rotation(quaternion: [f64; 4]) -> bool {
    let length = quaternion_length(quaternion);
    length.is_finite() && length > 1e-6
}

/// The columns of the rotation that a quaternion (x, y, z, w) describes; `None` where the quaternion is invalid.
pub(crate) fn rotation_columns(quaternion: [f64; 4]) -> Option<[DVec3; 3]> {
    Some([
        rotate_vector(quaternion, DVec3::X)?,
        rotate_vector(quaternion, DVec3::Y)?,
        rotate_vector(quaternion, DVec3::Z)?,
    ])
}

/// A vector turned by a quaternion (x, y, z, w), which need not have length 1. `None` if the quaternion's length is
/// not finite, or too small to give a rotation.
fn rotate_vector([x, y, z, w]: [f64; 4], vector: DVec3) -> Option<DVec3> {
    if !is_rotation([x, y, z, w]) {
        return None;
    }
    let length = quaternion_length([x, y, z, w]);
    let (axis, w) = (DVec3::new(x, y, z) / length, w / length);
    let cross = 2.0 * axis.cross(vector);
    Some(vector + w * cross + axis.cross(cross))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_1_SQRT_2;

    fn deg(axes: PoseAxes, quaternion: [f64; 4]) -> f64 {
        axes.heading_by_quaternion(quaternion).unwrap().deg().round()
    }

    #[test]
    fn a_robot_without_rotation_looks_along_x_which_is_east() {
        assert_eq!(deg(PoseAxes::for_body(PoseBody::Robot), [0.0, 0.0, 0.0, 1.0]), 90.0);
        // A quarter counter-clockwise about z: along y, which is north.
        let left = [0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2];
        assert_eq!(deg(PoseAxes::for_body(PoseBody::Robot), left) % 360.0, 0.0);
        let sideways = PoseAxes { mount_rad: 90_f64.to_radians(), ..PoseAxes::for_body(PoseBody::Robot) };
        assert_eq!(deg(sideways, left), 90.0);
    }

    #[test]
    fn an_optical_frame_that_lies_like_the_robot_looks_the_same_way() {
        // optical from robot: x right = -y, y down = -z, z ahead = x.
        let optical = [-0.5, 0.5, -0.5, 0.5];
        assert_eq!(deg(PoseAxes::for_body(PoseBody::Optical), optical), 90.0);
    }

    #[test]
    fn a_camera_of_a_world_with_y_up_looks_north_without_rotation() {
        let axes = PoseAxes { world: WorldUpAxis::YUp, ..PoseAxes::for_body(PoseBody::OpenGl) };
        assert_eq!(deg(axes, [0.0, 0.0, 0.0, 1.0]) % 360.0, 0.0);
        assert_eq!(axes.wayword_from_recorded(DVec3::new(1.0, 2.0, -3.0)), DVec3::new(1.0, 3.0, 2.0));
        let axes = PoseAxes { world: WorldUpAxis::YDown, ..PoseAxes::for_body(PoseBody::Optical) };
        assert_eq!(deg(axes, [0.0, 0.0, 0.0, 1.0]) % 360.0, 0.0);
        assert_eq!(axes.wayword_from_recorded(DVec3::new(1.0, -2.0, 3.0)), DVec3::new(1.0, 3.0, 2.0));
    }

    #[test]
    fn left_handed_worlds_are_mirrored() {
        let unity = PoseAxes { world: WorldUpAxis::Unity, ..PoseAxes::for_body(PoseBody::Unity) };
        // x right, y up, z ahead; a quarter about y turns to the right.
        assert_eq!(unity.wayword_from_recorded(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(1.0, 3.0, 2.0));
        assert_eq!(deg(unity, [0.0, 0.0, 0.0, 1.0]) % 360.0, 0.0);
        assert_eq!(deg(unity, [0.0, FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2]), 90.0);
        assert_eq!(unity.heading_by_yaw(1.0).unwrap().rad(), 1.0);
        let unreal = PoseAxes { world: WorldUpAxis::Unreal, ..PoseAxes::for_body(PoseBody::Robot) };
        // x ahead, y right, z up; a quarter about z turns to the right.
        assert_eq!(unreal.wayword_from_recorded(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(2.0, 1.0, 3.0));
        assert_eq!(deg(unreal, [0.0, 0.0, 0.0, 1.0]) % 360.0, 0.0);
        assert_eq!(deg(unreal, [0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2]), 90.0);
    }

    #[test]
    fn heading_by_yaw_is_clockwise_from_north_where_z_points_down() {
        let axes = PoseAxes { world: WorldUpAxis::Ned, ..PoseAxes::for_body(PoseBody::Frd) };
        // x north, y east, z down; a quarter about z turns to the right.
        assert_eq!(axes.wayword_from_recorded(DVec3::new(1.0, 2.0, -3.0)), DVec3::new(2.0, 1.0, 3.0));
        assert_eq!(deg(axes, [0.0, 0.0, 0.0, 1.0]) % 360.0, 0.0);
        assert_eq!(deg(axes, [0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2]), 90.0);
        assert_eq!(axes.heading_by_yaw(1.0).unwrap().rad(), 1.0);
        assert_eq!(axes.world.up().dot(axes.body_up()), 1.0);
    }

    #[test]
    fn straight_up_is_no_heading() {
        let up = [0.0, -FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2];
        assert_eq!(PoseAxes::for_body(PoseBody::Robot).heading_by_quaternion(up), None);
        assert_eq!(PoseAxes::for_body(PoseBody::Robot).heading_by_quaternion([0.0; 4]), None);
    }
}
