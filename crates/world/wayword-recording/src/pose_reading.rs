//! How the numbers of a pose are read: the order of a quaternion, the direction of a transform, and the units.

use crate::axes::PoseAxes;
use serde::Deserialize;
use wayword_core::DVec3;

/// The order of the four numbers of a quaternion.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum QuaternionOrder {
    /// x, y, z, w, as in ROS and TUM's files.
    #[default]
    Xyzw,
    /// w, x, y, z, as in Eigen's constructor, EuRoC, COLMAP and Blender.
    Wxyz,
}

/// What a recorded transform does.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum TransformDirection {
    /// It places the camera in the world: its translation is the camera's position.
    #[default]
    CameraToWorld,
    /// It is the inverse (the extrinsic matrix of computer vision).
    WorldToCamera,
}

/// The unit of recorded positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub(crate) enum PositionUnit {
    #[serde(rename = "m")]
    Metres,
    #[serde(rename = "cm")]
    Centimetres,
    #[serde(rename = "mm")]
    Millimetres,
}

/// The unit of a yaw or a heading.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
pub(crate) enum AngleUnit {
    #[serde(rename = "rad")]
    Radians,
    #[serde(rename = "deg")]
    Degrees,
}

impl AngleUnit {
    /// Its name, as settings have it and as the names of columns end.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Radians => "rad",
            Self::Degrees => "deg",
        }
    }

    /// An angle in this unit, in radians.
    pub(crate) fn to_rad(self, angle: f64) -> f64 {
        match self {
            Self::Radians => angle,
            Self::Degrees => angle.to_radians(),
        }
    }
}

/// The order and the direction of the numbers of a pose.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct NumberReading {
    pub(crate) order: QuaternionOrder,
    pub(crate) direction: TransformDirection,
}

/// A way to read poses: their numbers and their axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PoseReading {
    pub(crate) numbers: NumberReading,
    pub(crate) axes: PoseAxes,
}

impl QuaternionOrder {
    /// Its name in `recording.toml`.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Xyzw => "xyzw",
            Self::Wxyz => "wxyz",
        }
    }

    /// Four recorded numbers as x, y, z, w.
    pub(crate) const fn xyzw_from_recorded(self, recorded: [f64; 4]) -> [f64; 4] {
        let [a, b, c, d] = recorded;
        match self {
            Self::Xyzw => recorded,
            Self::Wxyz => [b, c, d, a],
        }
    }
}

impl TransformDirection {
    /// Its name in `recording.toml`.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::CameraToWorld => "camera-to-world",
            Self::WorldToCamera => "world-to-camera",
        }
    }

    /// The camera's position and the columns of world_from_camera, from the recorded translation and columns.
    pub(crate) fn world_from_camera(self, translation: DVec3, columns: [DVec3; 3]) -> (DVec3, [DVec3; 3]) {
        let [x, y, z] = columns;
        match self {
            Self::CameraToWorld => (translation, columns),
            Self::WorldToCamera => {
                let position = -DVec3::new(x.dot(translation), y.dot(translation), z.dot(translation));
                (position, [DVec3::new(x.x, y.x, z.x), DVec3::new(x.y, y.y, z.y), DVec3::new(x.z, y.z, z.z)])
            }
        }
    }
}

impl PositionUnit {
    /// Metres per unit.
    pub(crate) const fn metres(self) -> f64 {
        match self {
            Self::Metres => 1.0,
            Self::Centimetres => 0.01,
            Self::Millimetres => 0.001,
        }
    }
}

impl NumberReading {
    /// The number of settings in which it differs from another.
    fn count_changes(self, from: Self) -> usize {
        usize::from(self.order != from.order) + usize::from(self.direction != from.direction)
    }
}

impl PoseReading {
    /// The lines of `recording.toml` that name both axes, and what differs from the usual order and direction of numbers.
    pub(crate) fn all_settings(self) -> String {
        let mut settings = vec![self.world_setting()];
        settings.extend((self.axes.world.own_body() != Some(self.axes.body)).then(|| self.body_setting()));
        settings.extend(self.number_settings(NumberReading::default()));
        join_settings(&settings)
    }

    /// The lines of `recording.toml` that settle this reading where others fit.
    pub(crate) fn settings_against(self, others: &[Self]) -> String {
        let mut settings = vec![self.world_setting(), self.body_setting()];
        let NumberReading { order, direction } = self.numbers;
        if others.iter().any(|other| other.numbers.order != order) {
            settings.push(format!("quaternion = \"{}\"", order.name()));
        }
        if others.iter().any(|other| other.numbers.direction != direction) {
            settings.push(format!("transform = \"{}\"", direction.name()));
        }
        join_settings(&settings)
    }

    /// The lines of `recording.toml` that turn the reading `from` into this one. `sets_body` says whether the file already has an
    /// `orientation`, so that the one that comes with a world does not count.
    pub(crate) fn settings_from(self, from: Self, sets_body: bool) -> String {
        let mut settings = Vec::new();
        if self.axes.world != from.axes.world {
            settings.push(self.world_setting());
        }
        let comes_with_world =
            !sets_body && self.axes.world != from.axes.world && self.axes.world.own_body() == Some(self.axes.body);
        if self.axes.body != from.axes.body && !comes_with_world {
            settings.push(self.body_setting());
        }
        settings.extend(self.number_settings(from.numbers));
        join_settings(&settings)
    }

    /// The number of settings in which it differs from another reading.
    pub(crate) fn count_changes(self, from: Self) -> usize {
        let changes = [self.axes.world != from.axes.world, self.axes.body != from.axes.body];
        changes.into_iter().filter(|is_changed| *is_changed).count() + self.numbers.count_changes(from.numbers)
    }

    fn world_setting(self) -> String {
        format!("world = \"{}\"", self.axes.world.name())
    }

    fn body_setting(self) -> String {
        format!("orientation = \"{}\"", self.axes.body.name())
    }

    fn number_settings(self, from: NumberReading) -> Vec<String> {
        let NumberReading { order, direction } = self.numbers;
        let order = (order != from.order).then(|| format!("quaternion = \"{}\"", order.name()));
        let direction = (direction != from.direction).then(|| format!("transform = \"{}\"", direction.name()));
        order.into_iter().chain(direction).collect()
    }
}

/// Settings as a list in words.
fn join_settings(settings: &[String]) -> String {
    settings.join(" and ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_of_an_inverse_is_the_pose_itself() {
        let columns = [DVec3::new(0.0, 0.6, 0.8), DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.0, 0.8, -0.6)];
        let place = DVec3::new(1.0, -2.0, 3.0);
        let (t, inverse) = TransformDirection::WorldToCamera.world_from_camera(place, columns);
        let (back, same) = TransformDirection::WorldToCamera.world_from_camera(t, inverse);
        assert!(back.distance(place) < 1e-12 && same == columns, "{back} {same:?}");
    }
}
