//! Finds the numbers in a dataset's rows that are the robot's pose, by the names of features and their elements.

use super::info::{DatasetFeature, DatasetInfo};
use crate::{
    axes::{PoseAxes, PoseBody, WorldUpAxis, rotation_columns},
    describe::RecordingDescription,
    pose_plausibility::PoseSample,
    track::TrackFix,
};
use std::path::Path;
use wayword_core::{DVec3, PlatformError};
use wayword_world::files;

const POSE_NAMES_HINT: &str = "docs/RECORDINGS.md lists the names in meta/info.json that elements of a pose need";
/// Words in the name of an element that exclude it as a position in the world.
const NOT_A_POSITION_WORDS: [&str; 18] = [
    "vel", "velocity", "speed", "acc", "accel", "linear", "angular", "force", "torque", "effort", "current", "delta",
    "goal", "target", "cmd", "command", "action", "error",
];
/// Words in the name of a feature that does not count as the robot's pose unless the user names it.
const NOT_THE_ROBOT_WORDS: [&str; 12] =
    ["action", "actions", "eef", "ee", "effector", "tcp", "tool", "hand", "gripper", "wrist", "arm", "object"];

/// The feature with the robot's pose, and the indices of the elements that form it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PoseFeature {
    pub(super) feature: String,
    /// Number of its elements.
    pub(super) width: usize,
    x: usize,
    y: usize,
    z: Option<usize>,
    facing: FeatureFacing,
}

/// The elements of a feature that give the direction in which the robot looks.
#[derive(Debug, Clone, Copy, PartialEq)]
enum FeatureFacing {
    Unknown,
    /// Index of an angle counter-clockwise from +x, and the factor that turns it into radians.
    Yaw(usize, f64),
    /// Indices of x, y, z, w.
    Quaternion([usize; 4]),
}

/// The meaning of an element of a feature.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ElementRole {
    X,
    Y,
    Z,
    /// An angle counter-clockwise from +x, radians.
    Yaw,
    /// The same angle in degrees.
    YawDeg,
    /// A component of a quaternion: 0 to 3 for x, y, z, w.
    Q(usize),
}

impl PoseFeature {
    /// The feature that the user named, else the only feature that consists of x, y, a yaw and perhaps z; `None` if there is
    /// no candidate, or several.
    ///
    /// # Errors
    /// When the user names a feature that does not exist or holds no position.
    pub(super) fn find_feature(
        root: &Path,
        info: &DatasetInfo,
        described: &RecordingDescription,
    ) -> Result<Option<Self>, PlatformError> {
        let Some(named) = &described.poses else {
            let mut plain = info.features.iter().filter_map(|(key, feature)| Self::unnamed_pose(key, feature));
            let first = plain.next();
            return Ok(first.filter(|_| plain.next().is_none()));
        };
        let wrong = |reason: String| files::file_error(&DatasetInfo::info_file(root), reason, POSE_NAMES_HINT);
        let listed = || {
            let lists = info.features.iter().filter(|(_, feature)| feature.width().is_some());
            lists.map(|(key, _)| key.as_str()).collect::<Vec<_>>().join(", ")
        };
        let feature = info.features.get(named).filter(|feature| feature.width().is_some());
        let feature = feature.ok_or_else(|| {
            wrong(format!("poses = {named:?} is not a list of floating-point numbers; such lists: {}", listed()))
        })?;
        let pose =
            Self::pose_in_feature(named, feature).map_err(|reason| wrong(format!("poses = {named:?}: {reason}")))?;
        if matches!(pose.facing, FeatureFacing::Yaw(..))
            && described.world.is_some_and(|world| world != WorldUpAxis::ZUp)
        {
            return Err(wrong(format!("poses = {named:?}: a yaw turns about z, so `world` must be z-up")));
        }
        Ok(Some(pose))
    }

    /// The pose of a feature that the user did not name. `None` unless its elements are x, y, perhaps z, and a yaw, and
    /// its name is not that of a command or of a part of the robot.
    fn unnamed_pose(key: &str, feature: &DatasetFeature) -> Option<Self> {
        let pose = Self::pose_in_feature(key, feature).ok()?;
        let elements = 3 + usize::from(pose.z.is_some());
        let is_robot = !name_words(key)
            .any(|word| NOT_THE_ROBOT_WORDS.contains(&word.as_str()) || NOT_A_POSITION_WORDS.contains(&word.as_str()));
        (is_robot && matches!(pose.facing, FeatureFacing::Yaw(..)) && pose.width == elements).then_some(pose)
    }

    /// The elements of a feature that form a pose. The error gives the reason why they form none.
    fn pose_in_feature(key: &str, feature: &DatasetFeature) -> Result<Self, String> {
        let names = feature.element_names().ok_or("its elements have no names")?;
        let roles: Vec<Option<ElementRole>> = names.iter().map(|name| element_role(name)).collect();
        let at = |wanted: ElementRole| {
            let mut found = roles.iter().zip(&names).enumerate().filter(|(_, (role, _))| **role == Some(wanted));
            match (found.next(), found.next()) {
                (Some((_, (_, first))), Some((_, (_, second)))) => {
                    Err(format!("both {first:?} and {second:?} may be the one"))
                }
                (first, _) => Ok(first.map(|(at, _)| at)),
            }
        };
        let (Some(x), Some(y)) = (at(ElementRole::X)?, at(ElementRole::Y)?) else {
            return Err(format!("has no elements x and y; its elements: {}", names.join(", ")));
        };
        let quaternion =
            [at(ElementRole::Q(0))?, at(ElementRole::Q(1))?, at(ElementRole::Q(2))?, at(ElementRole::Q(3))?];
        let facing = match (at(ElementRole::Yaw)?, at(ElementRole::YawDeg)?, quaternion) {
            (None, None, [Some(x), Some(y), Some(z), Some(w)]) => FeatureFacing::Quaternion([x, y, z, w]),
            (Some(yaw), None, [None, None, None, None]) => FeatureFacing::Yaw(yaw, 1.0),
            (None, Some(yaw), [None, None, None, None]) => FeatureFacing::Yaw(yaw, 1_f64.to_radians()),
            (None, None, [None, None, None, None]) => FeatureFacing::Unknown,
            _ => return Err(format!("the direction is given twice, or only in part: {}", names.join(", "))),
        };
        Ok(Self { feature: key.to_owned(), width: names.len(), x, y, z: at(ElementRole::Z)?, facing })
    }

    /// Indices of the needed elements, in the order in which [`PoseFeature::fix_from_numbers`] takes them.
    pub(super) fn elements(&self) -> Vec<usize> {
        let facing = match self.facing {
            FeatureFacing::Unknown => Vec::new(),
            FeatureFacing::Yaw(at, _) => vec![at],
            FeatureFacing::Quaternion(at) => at.to_vec(),
        };
        // Without a z the floor is at 0.
        [self.x, self.y].into_iter().chain(self.z).chain(facing).collect()
    }

    /// The fix of the robot, from the numbers of [`PoseFeature::elements`].
    pub(super) fn fix_from_numbers(
        &self,
        time_s: f64,
        numbers: &[f64],
        described: &RecordingDescription,
    ) -> Option<TrackFix> {
        let axes = described.axes_or_usual(PoseAxes::for_body(PoseBody::Robot));
        let (recorded, facing) = self.split_numbers(numbers)?;
        let heading = match (self.facing, facing) {
            (FeatureFacing::Yaw(_, rad), [yaw]) => axes.heading_by_yaw(yaw * rad),
            (FeatureFacing::Quaternion(_), [x, y, z, w]) => axes.heading_by_quaternion([*x, *y, *z, *w]),
            _ => None,
        };
        Some(TrackFix { time_s, position: axes.wayword_from_recorded(recorded), heading })
    }

    /// The pose as it was recorded, from the same numbers.
    pub(super) fn sample_from_numbers(&self, numbers: &[f64]) -> Option<PoseSample> {
        let (position, facing) = self.split_numbers(numbers)?;
        let columns = match (self.facing, facing) {
            (FeatureFacing::Quaternion(_), [x, y, z, w]) => rotation_columns([*x, *y, *z, *w]),
            _ => None,
        };
        Some(PoseSample { position, recorded_from_body: columns })
    }

    /// The recorded position, and the numbers that give the direction.
    fn split_numbers<'a>(&self, numbers: &'a [f64]) -> Option<(DVec3, &'a [f64])> {
        let (place, facing) = numbers.split_at_checked(2 + usize::from(self.z.is_some()))?;
        Some((DVec3::new(*place.first()?, *place.get(1)?, place.get(2).copied().unwrap_or(0.0)), facing))
    }
}

/// The words of a name: `observation.base_x` has three, `robotYaw` one.
fn name_words(name: &str) -> impl Iterator<Item = String> {
    name.split(|letter: char| !letter.is_alphanumeric()).filter(|word| !word.is_empty()).map(str::to_lowercase)
}

/// The meaning of an element by its name (`x`, `base.x`, `pose_x_m`); `None` for others, such as `x.vel`.
fn element_role(name: &str) -> Option<ElementRole> {
    let words: Vec<String> = name_words(name).collect();
    if words.iter().any(|word| NOT_A_POSITION_WORDS.contains(&word.as_str())) {
        return None;
    }
    let has = |wanted: &[&str]| words.iter().any(|word| wanted.contains(&word.as_str()));
    let quaternion = has(&["q", "quat", "quaternion", "orientation", "rotation", "rot"]);
    let roles = words.iter().filter_map(|word| {
        Some(match (word.as_str(), quaternion) {
            ("x", false) => ElementRole::X,
            ("y", false) => ElementRole::Y,
            ("z", false) => ElementRole::Z,
            ("qx", _) | ("x", true) => ElementRole::Q(0),
            ("qy", _) | ("y", true) => ElementRole::Q(1),
            ("qz", _) | ("z", true) => ElementRole::Q(2),
            ("qw", _) | ("w", true) => ElementRole::Q(3),
            ("yaw" | "theta", _) if has(&["deg", "degree", "degrees"]) => ElementRole::YawDeg,
            ("yaw" | "theta", _) => ElementRole::Yaw,
            _ => return None,
        })
    });
    let roles: Vec<ElementRole> = roles.collect();
    match roles.as_slice() {
        [role] => Some(*role),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn info(features: &[(&str, &[&str])]) -> DatasetInfo {
        let features: BTreeMap<_, _> = features
            .iter()
            .map(|(key, names)| (*key, serde_json::json!({"dtype": "float32", "shape": [names.len()], "names": names})))
            .collect();
        let info = serde_json::json!({"codebase_version": "v3.0", "fps": 5, "data_path": "x", "features": features});
        serde_json::from_value(info).unwrap()
    }

    fn find(features: &[(&str, &[&str])], poses: Option<&str>) -> Result<Option<PoseFeature>, String> {
        let described = RecordingDescription { poses: poses.map(str::to_owned), ..RecordingDescription::default() };
        PoseFeature::find_feature(Path::new("d"), &info(features), &described).map_err(|error| error.to_string())
    }

    #[test]
    fn find_takes_unnamed_features_only_if_they_are_certain() {
        let found = |key, names| find(&[(key, names)], None).unwrap().map(|place| place.feature);
        assert_eq!(found("observation.state", &["x", "y", "theta"]).as_deref(), Some("observation.state"));
        assert_eq!(found("odometry", &["base.x", "base.y", "base.z", "base.yaw"]).as_deref(), Some("odometry"));
        // A command, speeds, an arm's hand, positions without a direction, other joints: in doubt there is no pose.
        assert_eq!(found("action", &["x", "y", "theta"]), None);
        assert_eq!(found("observation.state", &["x.vel", "y.vel", "theta.vel"]), None);
        assert_eq!(found("observation.state.end_effector", &["x", "y", "yaw"]), None);
        assert_eq!(found("observation.ee_pose", &["x", "y", "z", "yaw"]), None);
        assert_eq!(found("observation.state", &["x", "y", "z", "roll", "pitch", "yaw"]), None);
        assert_eq!(found("observation.state", &["x", "y"]), None);
        assert_eq!(found("observation.state", &["x", "y", "theta", "gripper"]), None);
        assert_eq!(find(&[("a", &["x", "y", "yaw"]), ("b", &["x", "y", "yaw"])], None), Ok(None));
    }

    #[test]
    fn find_takes_or_refuses_the_named_feature() {
        let state = |names| find(&[("state", names)], Some("state"));
        let place = state(&["gripper", "x", "y", "z", "qx", "qy", "qz", "qw"]).unwrap().unwrap();
        assert_eq!(place.elements(), [1, 2, 3, 4, 5, 6, 7]);
        let turned = state(&["quat.x", "quat.y", "quat.z", "quat.w", "pos.x", "pos.y"]).unwrap().unwrap();
        assert_eq!(turned.elements(), [4, 5, 0, 1, 2, 3]);
        assert_eq!(state(&["x", "y"]).unwrap().unwrap().facing, FeatureFacing::Unknown);
        assert!(state(&["left_x", "right_x", "y"]).unwrap_err().contains("left_x"));
        assert!(state(&["x", "y", "yaw", "qx"]).unwrap_err().contains("twice, or only in part"));
        assert!(state(&["a", "b"]).unwrap_err().contains("no elements x and y; its elements: a, b"));
        assert!(find(&[("state", &["x"])], Some("pose")).unwrap_err().contains("such lists: state"));
    }

    #[test]
    fn yaw_is_counter_clockwise_from_x_which_is_east() {
        let deg = |names: &[&str], yaw: f64| {
            let place = find(&[("state", names)], Some("state")).unwrap().unwrap();
            let fix = place.fix_from_numbers(0.0, &[3.0, 4.0, yaw], &RecordingDescription::default()).unwrap();
            assert_eq!(fix.position, DVec3::new(3.0, 4.0, 0.0));
            fix.heading.unwrap().deg().round()
        };
        assert_eq!(deg(&["x", "y", "theta"], 0.0), 90.0);
        assert_eq!(deg(&["x", "y", "yaw"], std::f64::consts::FRAC_PI_2) % 360.0, 0.0);
        assert_eq!(deg(&["x", "y", "yaw_deg"], -90.0), 180.0);
    }

    #[test]
    fn a_yaw_needs_a_world_with_z_up() {
        let described = RecordingDescription {
            poses: Some("state".to_owned()),
            world: Some(WorldUpAxis::YUp),
            ..RecordingDescription::default()
        };
        let info = info(&[("state", &["x", "y", "yaw"])]);
        assert!(PoseFeature::find_feature(Path::new("d"), &info, &described).unwrap_err().to_string().contains("z-up"));
    }
}
