//! Finds the numbers in a dataset's rows that are the robot's pose, by the names of features and their elements.

use super::{
    info::{DatasetFeature, DatasetInfo},
    yaw_unit::judge_yaw_unit,
};
use crate::{
    axes::{PoseAxes, PoseBody, WorldUpAxis, is_rotation, rotation_columns},
    describe::RecordingDescription,
    pose_plausibility::PoseSample,
    pose_reading::AngleUnit,
    track::TrackFix,
};
use std::path::Path;
use wayword_core::{DVec3, PlatformError};
use wayword_world::files;

/// Most features that a line to the user names.
const MAX_CANDIDATES: usize = 3;
const POSE_NAMES_HINT: &str = "docs/RECORDINGS.md lists the names in meta/info.json that elements of a pose need";
/// Words in the name of an element that exclude it as a position in the world.
const NOT_A_POSITION_WORDS: [&str; 18] = [
    "vel", "velocity", "speed", "acc", "accel", "linear", "angular", "force", "torque", "effort", "current", "delta",
    "goal", "target", "cmd", "command", "action", "error",
];
/// Words in the name of a feature that does not count as the robot's pose unless the user names it.
const NOT_THE_ROBOT_WORDS: [&str; 12] =
    ["action", "actions", "eef", "ee", "effector", "tcp", "tool", "hand", "gripper", "wrist", "arm", "object"];

/// Words in the name of an element that is a speed. Speeds may stand beside the numbers of a pose.
const SPEED_WORDS: [&str; 12] =
    ["vel", "velocity", "speed", "linear", "angular", "vx", "vy", "vz", "wx", "wy", "wz", "omega"];
/// The advice where the unit of an angle is not known.
pub(super) const YAW_UNIT_HINT: &str =
    "add the unit to the element's name in meta/info.json: theta_deg or theta_rad, yaw_deg or yaw_rad";

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
    /// Index of an angle counter-clockwise from +x, and its unit if that is known.
    Yaw(usize, Option<AngleUnit>),
    /// Indices of x, y, z, w.
    Quaternion([usize; 4]),
}

/// The meaning of an element of a feature.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ElementRole {
    X,
    Y,
    Z,
    /// An angle counter-clockwise from +x, with its unit if the name has it.
    Yaw(Option<AngleUnit>),
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

    /// The pose of a feature that the user did not name. `None` unless its elements are x, y, perhaps z, a yaw, and perhaps
    /// speeds, and its name is not that of a command or of a part of the robot.
    fn unnamed_pose(key: &str, feature: &DatasetFeature) -> Option<Self> {
        let pose = Self::pose_in_feature(key, feature).ok()?;
        let elements = 3 + usize::from(pose.z.is_some());
        let is_speed = |name: &&str| name_words(name).any(|word| SPEED_WORDS.contains(&word.as_str()));
        let speeds = feature.element_names()?.iter().filter(|name| is_speed(name)).count();
        let is_pose = matches!(pose.facing, FeatureFacing::Yaw(..)) && pose.width == elements + speeds;
        (is_pose && may_be_robot(key)).then_some(pose)
    }

    /// A line for the user about the features that could hold the robot's poses, where none is taken; `None` if there are none.
    pub(super) fn describe_candidates(info: &DatasetInfo) -> Option<String> {
        let candidates = info.features.iter().filter_map(|(key, feature)| {
            let pose = Self::pose_in_feature(key, feature).ok().filter(|_| may_be_robot(key))?;
            let place = if pose.z.is_some() { "x, y, z" } else { "x, y" };
            let facing = match pose.facing {
                FeatureFacing::Unknown => "",
                FeatureFacing::Yaw(..) => " and a yaw",
                FeatureFacing::Quaternion(_) => " and a quaternion",
            };
            Some(format!("{key:?} has {place}{facing}: if these are the poses of the robot, write `poses = {key:?}`"))
        });
        let candidates: Vec<String> = candidates.take(MAX_CANDIDATES).collect();
        (!candidates.is_empty())
            .then(|| format!("{} into a recording.toml in the dataset's folder", candidates.join("; ")))
    }

    /// A line for the user about the first feature with two elements that may be its x or its y; `None` if there is none.
    pub(super) fn describe_unclear(info: &DatasetInfo) -> Option<String> {
        info.features.iter().filter(|(key, _)| may_be_robot(key)).find_map(|(key, feature)| {
            let reason = Self::pose_in_feature(key, feature).err()?;
            let names = feature.element_names()?;
            let is_double = |wanted: &ElementRole| {
                names.iter().filter(|name| element_role(name).as_ref() == Some(wanted)).count() > 1
            };
            [ElementRole::X, ElementRole::Y].iter().any(is_double).then(|| {
                format!("{key:?} is not read as poses, because {reason}: rename the wrong one in meta/info.json")
            })
        })
    }

    /// The same feature with the unit of its yaw, if that was not known: by the path of an episode, whose numbers are those of
    /// [`PoseFeature::elements`] for each row. A line tells the user if it is degrees.
    ///
    /// # Errors
    /// When the path does not show the unit.
    pub(super) fn with_yaw_unit(&self, rows: &[f64]) -> Result<(Self, Option<String>), String> {
        let FeatureFacing::Yaw(at, None) = self.facing else { return Ok((self.clone(), None)) };
        let poses = rows.chunks_exact(self.elements().len()).filter_map(|numbers| {
            let (position, facing) = self.split_numbers(numbers)?;
            Some((position, *facing.first()?))
        });
        let unit = judge_yaw_unit(&poses.collect::<Vec<_>>())?;
        let remark = (unit == AngleUnit::Degrees).then(|| {
            format!(
                "{:?}: its yaw is read in degrees, because the path follows it only so; if it is in radians, add `_rad` to the \
                 element's name in meta/info.json",
                self.feature
            )
        });
        Ok((Self { facing: FeatureFacing::Yaw(at, Some(unit)), ..self.clone() }, remark))
    }

    /// The elements of a feature that form a pose. The error gives the reason why they form none.
    fn pose_in_feature(key: &str, feature: &DatasetFeature) -> Result<Self, String> {
        let names = feature.element_names().ok_or("its elements have no names")?;
        let roles: Vec<Option<ElementRole>> = names.iter().map(|name| element_role(name)).collect();
        let at_where = |is_wanted: &dyn Fn(ElementRole) -> bool| {
            let mut found = roles.iter().zip(&names).enumerate().filter(|(_, (role, _))| role.is_some_and(is_wanted));
            match (found.next(), found.next()) {
                (Some((_, (_, first))), Some((_, (_, second)))) => {
                    Err(format!("both {first:?} and {second:?} may be the one"))
                }
                (first, _) => Ok(first.map(|(at, _)| at)),
            }
        };
        let at = |wanted: ElementRole| at_where(&|role| role == wanted);
        let (Some(x), Some(y)) = (at(ElementRole::X)?, at(ElementRole::Y)?) else {
            return Err(format!("has no elements x and y; its elements: {}", names.join(", ")));
        };
        let quaternion =
            [at(ElementRole::Q(0))?, at(ElementRole::Q(1))?, at(ElementRole::Q(2))?, at(ElementRole::Q(3))?];
        let yaw = at_where(&|role| matches!(role, ElementRole::Yaw(_)))?;
        let unit = yaw.and_then(|at| match roles.get(at) {
            Some(Some(ElementRole::Yaw(unit))) => *unit,
            _ => None,
        });
        let facing = match (yaw, quaternion) {
            (None, [Some(x), Some(y), Some(z), Some(w)]) => FeatureFacing::Quaternion([x, y, z, w]),
            (Some(yaw), [None, None, None, None]) => FeatureFacing::Yaw(yaw, unit),
            (None, [None, None, None, None]) => FeatureFacing::Unknown,
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
            (FeatureFacing::Yaw(_, unit), [yaw]) => {
                axes.heading_by_yaw(unit.unwrap_or(AngleUnit::Radians).to_rad(*yaw))
            }
            (FeatureFacing::Quaternion(_), [x, y, z, w]) => axes.heading_by_quaternion([*x, *y, *z, *w]),
            _ => None,
        };
        Some(TrackFix { time_s, position: axes.wayword_from_recorded(recorded), heading })
    }

    /// Whether the same numbers give an orientation that is none.
    pub(super) fn lacks_facing(&self, numbers: &[f64]) -> bool {
        match (self.facing, self.split_numbers(numbers)) {
            (FeatureFacing::Quaternion(_), Some((_, [x, y, z, w]))) => !is_rotation([*x, *y, *z, *w]),
            (FeatureFacing::Yaw(..), Some((_, [yaw]))) => !yaw.is_finite(),
            _ => false,
        }
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

/// Whether a feature's name is not that of a command or of a part of the robot.
fn may_be_robot(key: &str) -> bool {
    !name_words(key)
        .any(|word| NOT_THE_ROBOT_WORDS.contains(&word.as_str()) || NOT_A_POSITION_WORDS.contains(&word.as_str()))
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
            ("yaw" | "theta", _) if has(&["deg", "degree", "degrees"]) => ElementRole::Yaw(Some(AngleUnit::Degrees)),
            ("yaw" | "theta", _) if has(&["rad", "radian", "radians"]) => ElementRole::Yaw(Some(AngleUnit::Radians)),
            ("yaw" | "theta", _) => ElementRole::Yaw(None),
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
mod tests;
