//! Reads the user's description of a recording: `recording.toml` in a folder, or `NAME.toml` for `NAME.mp4`.

use crate::{
    axes::{PoseAxes, PoseBody, WorldUpAxis},
    pose_reading::{AngleUnit, NumberReading, PositionUnit, QuaternionOrder, TransformDirection},
};
use serde::Deserialize;
use std::path::Path;
#[cfg(any(feature = "mcap", feature = "video"))]
use std::path::PathBuf;
use wayword_core::PlatformError;
use wayword_world::files;

/// Largest description that is read, bytes; a larger file is an error.
const MAX_FILE_BYTES: u64 = 1 << 20;
/// The name of the description in a recording's folder.
pub(crate) const FOLDER_FILE: &str = "recording.toml";
pub(crate) const DESCRIPTION_HINT: &str = "docs/RECORDINGS.md lists what a recording.toml can say";

/// A clock by which the messages of a recording can be placed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum RecordingClock {
    /// The stamps in the messages.
    Stamps,
    /// The times at which the recorder received them.
    Recorder,
}

/// A user's description of a recording. Everything has a default.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct RecordingDescription {
    /// Horizontal field of view of the camera, degrees.
    pub(crate) horizontal_fov_deg: Option<f64>,
    /// The camera, where there are several: a ROS topic, or a feature of a LeRobot dataset.
    pub(crate) camera: Option<String>,
    /// The source of poses: a ROS topic, a feature of a LeRobot dataset, or a file in the pictures' folder.
    pub(crate) poses: Option<String>,
    /// The axes of the world of the poses.
    pub(crate) world: Option<WorldUpAxis>,
    /// The body to which the orientation of a pose belongs.
    pub(crate) orientation: Option<PoseBody>,
    /// Angle from the direction ahead of `orientation` to the camera's view direction, clockwise, degrees.
    pub(crate) mount_deg: Option<f64>,
    /// The clock by which pictures and poses are placed, where a recording has two.
    pub(crate) clock: Option<RecordingClock>,
    /// The part of a recording that is used, from 1, where its stamps begin again.
    pub(crate) part: Option<usize>,
    /// The order of the numbers of a quaternion in a pose file that does not name its columns.
    pub(crate) quaternion: Option<QuaternionOrder>,
    /// Whether the poses of a file place the camera in the world, or are the inverse.
    pub(crate) transform: Option<TransformDirection>,
    /// The unit of the positions in a pose file.
    pub(crate) unit: Option<PositionUnit>,
    /// The unit of a yaw or a heading in a pose file whose column does not name it.
    pub(crate) angle_unit: Option<AngleUnit>,
    /// Added to the times in a pose file, to bring them onto the clock of the pictures, seconds.
    pub(crate) pose_time_offset_s: Option<f64>,
    /// Pictures per second, for pictures without times.
    pub(crate) pictures_per_s: Option<f64>,
    /// Distance between frames, metres, where there are poses.
    pub(crate) interval_m: Option<f64>,
    /// Time between frames, seconds, where there are no poses.
    pub(crate) interval_s: Option<f64>,
}

impl RecordingDescription {
    /// Reads a description; the default if the file does not exist.
    ///
    /// # Errors
    /// When it is not TOML, has an unknown key, or a number is out of range.
    pub(crate) fn read(file: &Path) -> Result<Self, PlatformError> {
        let Some(text) = files::text_if_there(file, MAX_FILE_BYTES, DESCRIPTION_HINT)? else {
            return Ok(Self::default());
        };
        let described: Self =
            toml::from_str(&text).map_err(|error| files::file_error(file, error.to_string(), DESCRIPTION_HINT))?;
        for (name, number, bounds) in [
            ("horizontal_fov_deg", described.horizontal_fov_deg, 10.0..=160.0),
            ("mount_deg", described.mount_deg, -360.0..=360.0),
            ("pictures_per_s", described.pictures_per_s, 1e-4..=1e4),
            ("interval_m", described.interval_m, 0.05..=100.0),
            ("interval_s", described.interval_s, 0.01..=3600.0),
            ("pose_time_offset_s", described.pose_time_offset_s, -1e10..=1e10),
        ] {
            if let Some(number) = number.filter(|number| !bounds.contains(number)) {
                let reason = format!("{name} = {number} is out of range ({} to {})", bounds.start(), bounds.end());
                return Err(files::file_error(file, reason, DESCRIPTION_HINT));
            }
        }
        Ok(described)
    }

    /// Reads the description of a file: `NAME.toml` for `NAME.mp4`, and `recording.toml` in the same folder for what that leaves open.
    ///
    /// # Errors
    /// As [`RecordingDescription::read`].
    #[cfg(any(feature = "mcap", feature = "video"))]
    pub(crate) fn read_beside(recording: &Path) -> Result<Self, PlatformError> {
        let [own, of_folder] = Self::files_beside(recording);
        Ok(Self::read(&own)?.filled_from(Self::read(&of_folder)?))
    }

    /// This description, with the settings of another where it has none.
    #[cfg(any(feature = "mcap", feature = "video"))]
    fn filled_from(self, other: Self) -> Self {
        Self {
            horizontal_fov_deg: self.horizontal_fov_deg.or(other.horizontal_fov_deg),
            camera: self.camera.or(other.camera),
            poses: self.poses.or(other.poses),
            world: self.world.or(other.world),
            orientation: self.orientation.or(other.orientation),
            mount_deg: self.mount_deg.or(other.mount_deg),
            clock: self.clock.or(other.clock),
            part: self.part.or(other.part),
            quaternion: self.quaternion.or(other.quaternion),
            transform: self.transform.or(other.transform),
            unit: self.unit.or(other.unit),
            angle_unit: self.angle_unit.or(other.angle_unit),
            pose_time_offset_s: self.pose_time_offset_s.or(other.pose_time_offset_s),
            pictures_per_s: self.pictures_per_s.or(other.pictures_per_s),
            interval_m: self.interval_m.or(other.interval_m),
            interval_s: self.interval_s.or(other.interval_s),
        }
    }

    /// The same description, for a recording whose poses are not in a file of their own.
    ///
    /// # Errors
    /// When it has a setting that only counts for pose files. `file` is its path.
    #[cfg(any(feature = "mcap", feature = "lerobot"))]
    pub(crate) fn refuse_pose_file_settings(self, file: &Path) -> Result<Self, PlatformError> {
        let settings = [
            ("quaternion", self.quaternion.is_some()),
            ("transform", self.transform.is_some()),
            ("unit", self.unit.is_some()),
            ("angle_unit", self.angle_unit.is_some()),
            ("pose_time_offset_s", self.pose_time_offset_s.is_some()),
        ];
        match settings.into_iter().find(|(_, is_set)| *is_set) {
            Some((name, _)) => {
                let reason = format!("{name} is for pose files, and this recording holds its poses itself");
                Err(files::file_error(file, reason, DESCRIPTION_HINT))
            }
            None => Ok(self),
        }
    }

    /// The paths of a file's descriptions: `NAME.toml` for `NAME.mp4`, and `recording.toml` in the same folder.
    #[cfg(any(feature = "mcap", feature = "video"))]
    pub(crate) fn files_beside(recording: &Path) -> [PathBuf; 2] {
        [recording.with_extension("toml"), recording.with_file_name(FOLDER_FILE)]
    }

    /// The axes of poses: the user's settings, and for the others `usual`, those of the format. A world that has a body of its own
    /// sets the body too.
    pub(crate) fn axes_or_usual(&self, usual: PoseAxes) -> PoseAxes {
        let own_body = self.world.and_then(WorldUpAxis::own_body);
        PoseAxes {
            world: self.world.unwrap_or(usual.world),
            body: self.orientation.or(own_body).unwrap_or(usual.body),
            mount_rad: self.mount_deg.map_or(usual.mount_rad, f64::to_radians),
        }
    }

    /// The order and direction of the numbers of poses: the user's settings, and for the others those of the format.
    pub(crate) fn numbers_or_usual(&self, usual: NumberReading) -> NumberReading {
        NumberReading {
            order: self.quaternion.unwrap_or(usual.order),
            direction: self.transform.unwrap_or(usual.direction),
        }
    }

    /// The length of one unit of the positions, metres. Unreal Engine counts in centimetres.
    pub(crate) fn metres_per_unit(&self) -> f64 {
        let in_unreal = self.world == Some(WorldUpAxis::Unreal);
        let usual = if in_unreal { PositionUnit::Centimetres } else { PositionUnit::Metres };
        self.unit.unwrap_or(usual).metres()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<RecordingDescription, String> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("recording.toml");
        std::fs::write(&file, text).unwrap();
        RecordingDescription::read(&file).map_err(|error| error.to_string())
    }

    #[test]
    fn described_axes_replace_the_usual_axes() {
        let described = read("world = \"y-up\"\norientation = \"open-gl\"\nmount_deg = 90").unwrap();
        let axes = described.axes_or_usual(PoseAxes::for_body(PoseBody::Robot));
        assert_eq!((axes.world, axes.body), (WorldUpAxis::YUp, PoseBody::OpenGl));
        assert!((axes.mount_rad.to_degrees() - 90.0).abs() < 1e-9);
        assert_eq!(
            RecordingDescription::default().axes_or_usual(PoseAxes::for_body(PoseBody::Optical)),
            PoseAxes::for_body(PoseBody::Optical)
        );
    }

    #[test]
    fn description_refuses_values_out_of_range_by_name() {
        assert!(read("interval_m = 0").unwrap_err().contains("interval_m = 0"));
        assert!(read("horizontal_fov_deg = nan").unwrap_err().contains("horizontal_fov_deg"));
        assert!(read("interval = 1").unwrap_err().contains("interval"));
    }

    #[cfg(any(feature = "mcap", feature = "lerobot"))]
    #[test]
    fn settings_of_pose_files_are_refused_where_there_is_none() {
        let refused = |text: &str| read(text).unwrap().refuse_pose_file_settings(Path::new("walk.toml"));
        assert!(refused("world = \"unity\"").is_ok());
        let error = refused("quaternion = \"wxyz\"").unwrap_err().to_string();
        assert!(error.contains("quaternion is for pose files"), "{error}");
    }

    #[test]
    fn a_missing_description_reads_as_the_default() {
        assert_eq!(
            RecordingDescription::read(Path::new("/nowhere/recording.toml")).unwrap(),
            RecordingDescription::default()
        );
    }

    #[cfg(any(feature = "mcap", feature = "video"))]
    #[test]
    fn settings_of_the_folder_fill_those_of_the_file() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("walk.toml"), "poses = \"walk.tum\"\ninterval_m = 2").unwrap();
        std::fs::write(folder.path().join("recording.toml"), "pose_time_offset_s = -3\ninterval_m = 1").unwrap();
        let described = RecordingDescription::read_beside(&folder.path().join("walk.mp4")).unwrap();
        assert_eq!(described.poses.as_deref(), Some("walk.tum"));
        assert_eq!((described.interval_m, described.pose_time_offset_s), (Some(2.0), Some(-3.0)));
    }
}
