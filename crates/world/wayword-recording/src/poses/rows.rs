//! The common form of a line of a pose file, in every format.

use crate::{
    axes::{PoseAxes, rotation_columns},
    pose_plausibility::PoseSample,
    pose_reading::{NumberReading, TransformDirection},
    track::{TrackFix, is_valid_place},
};
use std::path::Path;
use wayword_core::{DVec3, Heading};

/// The poses of a file, and the conventions that its format usually has.
#[derive(Debug)]
pub(super) struct PoseRows {
    pub(super) usual: PoseAxes,
    pub(super) usual_numbers: NumberReading,
    pub(super) known: KnownConventions,
    pub(super) kind: RowKind,
    pub(super) rows: Vec<PoseRow>,
    /// The number in a column `frame` for each row, if there is such a column.
    pub(super) frames: Option<Vec<usize>>,
    /// Where the camera is on the body to which the poses belong, if that is known.
    pub(super) mounting: Option<CameraMounting>,
    /// The columns that are not read, for the user, if there are any.
    pub(super) unread: Option<String>,
    /// The name of the column or field that gives the direction as an angle with its unit: `yaw_rad`.
    pub(super) angle_name: Option<&'static str>,
}

/// What the rows of a file are, for messages that name one of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RowKind {
    /// Lines, counted from 1.
    Line,
    /// Items of a list of poses, counted from 0.
    Pose,
    /// Items of a list of frames, counted from 0.
    Frame,
    /// Files, one for each picture.
    File,
}

/// What a file or its format says itself, so that it is not questioned.
#[derive(Debug, Clone, Copy)]
pub(super) struct KnownConventions {
    /// The body's up direction. For EuRoC's sensor only the direction ahead is known.
    pub(super) body_up: bool,
    /// The order of the numbers of a quaternion.
    pub(super) order: bool,
    /// The direction of the transforms.
    pub(super) direction: bool,
    /// The unit of the positions.
    pub(super) unit: bool,
    /// The unit of a yaw.
    pub(super) angle_unit: bool,
}

/// body_from_camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CameraMounting {
    pub(super) position: DVec3,
    pub(super) columns: [DVec3; 3],
}

/// A pose as it was recorded.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PoseRow {
    /// Its number, counted as its [`RowKind`] is.
    pub(super) at: usize,
    pub(super) key: PoseKey,
    pub(super) position: DVec3,
    pub(super) facing: PoseFacing,
}

/// The time or the picture that a pose belongs to.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum PoseKey {
    /// A time, seconds.
    Time(f64),
    /// A picture, by the name of its file.
    Picture(String),
    /// A picture, by its number from 0.
    Number(usize),
}

/// The direction in which the body looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum PoseFacing {
    Unknown,
    /// A quaternion, in the file's order.
    Quaternion([f64; 4]),
    /// recorded_from_body by its columns.
    Columns([DVec3; 3]),
    /// Radians; [`PoseAxes::heading_by_yaw`] says from where.
    Yaw(f64),
    /// Radians clockwise from Wayword's +y.
    Heading(f64),
}

impl KnownConventions {
    /// Nothing but the body's up direction.
    pub(super) const BODY_ONLY: Self =
        Self { body_up: true, order: false, direction: false, unit: false, angle_unit: false };
    /// All that a format defines.
    pub(super) const ALL: Self = Self { body_up: true, order: true, direction: true, unit: true, angle_unit: true };
}

impl PoseFacing {
    /// recorded_from_body by its columns, for an order of quaternions; `None` without an orientation.
    fn columns(self, numbers: NumberReading) -> Option<[DVec3; 3]> {
        match self {
            Self::Quaternion(quaternion) => rotation_columns(numbers.order.xyzw_from_recorded(quaternion)),
            Self::Columns(columns) => Some(columns),
            Self::Unknown | Self::Yaw(_) | Self::Heading(_) => None,
        }
    }
}

impl PoseRow {
    /// The position of the camera and its orientation, in metres in the frame of the recording.
    fn place(&self, numbers: NumberReading, metres_per_unit: f64, mounting: Option<CameraMounting>) -> PoseSample {
        let Some(columns) = self.facing.columns(numbers) else {
            // Without a rotation the inverse of a transform is not known.
            let is_known = numbers.direction == TransformDirection::CameraToWorld;
            let position = if is_known { self.position * metres_per_unit } else { DVec3::NAN };
            return PoseSample { position, recorded_from_body: None };
        };
        let (position, columns) = numbers.direction.world_from_camera(self.position * metres_per_unit, columns);
        let [x, y, z] = columns;
        let turn = |vector: DVec3| x * vector.x + y * vector.y + z * vector.z;
        match mounting {
            Some(mounting) => PoseSample {
                position: position + turn(mounting.position),
                recorded_from_body: Some(mounting.columns.map(turn)),
            },
            None => PoseSample { position, recorded_from_body: Some(columns) },
        }
    }
}

impl PoseRows {
    /// Rows of a format with usual axes and nothing else to say.
    pub(super) fn new(usual: PoseAxes, known: KnownConventions, rows: Vec<PoseRow>) -> Self {
        let (usual_numbers, kind) = (NumberReading::default(), RowKind::Line);
        Self { usual, usual_numbers, known, kind, rows, frames: None, mounting: None, unread: None, angle_name: None }
    }

    /// A row in words: `line 5`.
    pub(super) fn name_row(&self, row: &PoseRow) -> String {
        match (self.kind, &row.key) {
            (RowKind::Line, _) => format!("line {}", row.at),
            (RowKind::Frame, _) => format!("frame {}", row.at),
            (RowKind::File, PoseKey::Picture(picture)) => format!("the file for {picture}"),
            (RowKind::Pose | RowKind::File, _) => format!("pose {}", row.at),
        }
    }

    /// Removes the rows without a valid place or time, and returns how many these are.
    pub(super) fn remove_invalid(&mut self, metres_per_unit: f64) -> usize {
        self.retain_rows(|row| {
            let is_time = !matches!(row.key, PoseKey::Time(time_s) if !time_s.is_finite());
            is_time && is_valid_place(row.position * metres_per_unit)
        })
    }

    /// Removes the rows that are not wanted, and returns how many these are.
    pub(super) fn retain_rows(&mut self, is_wanted: impl Fn(&PoseRow) -> bool) -> usize {
        let all = self.rows.len();
        let mut wanted = self.rows.iter().map(&is_wanted);
        if let Some(frames) = &mut self.frames {
            frames.retain(|_| wanted.next().unwrap_or(false));
        }
        self.rows.retain(is_wanted);
        all - self.rows.len()
    }

    /// The positions of the camera and its orientations, in metres in the frame of the recording.
    pub(super) fn samples(&self, numbers: NumberReading, metres_per_unit: f64) -> impl Iterator<Item = PoseSample> {
        self.rows.iter().map(move |row| {
            let sample = row.place(numbers, metres_per_unit, self.mounting);
            PoseSample { recorded_from_body: sample.recorded_from_body.filter(|_| self.known.body_up), ..sample }
        })
    }

    /// The fix for a row at a time, in Wayword's frame.
    pub(super) fn fix_at(
        &self,
        row: &PoseRow,
        time_s: f64,
        (numbers, axes, metres_per_unit): (NumberReading, PoseAxes, f64),
    ) -> TrackFix {
        let sample = row.place(numbers, metres_per_unit, self.mounting);
        let heading = match row.facing {
            PoseFacing::Unknown => None,
            PoseFacing::Quaternion(_) | PoseFacing::Columns(_) => {
                sample.recorded_from_body.and_then(|columns| axes.heading_by_columns(columns))
            }
            PoseFacing::Yaw(yaw_rad) => axes.heading_by_yaw(yaw_rad),
            PoseFacing::Heading(rad) => Heading::new(rad + axes.mount_rad).ok(),
        };
        TrackFix { time_s, position: axes.wayword_from_recorded(sample.position), heading }
    }

    /// Whether any row has a facing for which `is_wanted` is true.
    pub(super) fn has_facing(&self, is_wanted: fn(&PoseFacing) -> bool) -> bool {
        self.rows.iter().any(|row| is_wanted(&row.facing))
    }
}

/// A 3 x 4 matrix row by row, as a position and columns.
pub(super) fn pose_from_matrix(matrix: [f64; 12]) -> (DVec3, [DVec3; 3]) {
    let [a, b, c, x, d, e, f, y, g, h, i, z] = matrix;
    (DVec3::new(x, y, z), [DVec3::new(a, d, g), DVec3::new(b, e, h), DVec3::new(c, f, i)])
}

/// The part of a picture's name that is compared. A pose file may add a folder and an ending to it.
pub(super) fn picture_stem(name: &str) -> String {
    let path = Path::new(name);
    let known = path
        .extension()
        .and_then(|ending| ending.to_str())
        .is_some_and(|ending| ["png", "jpg", "jpeg"].iter().any(|known| ending.eq_ignore_ascii_case(known)));
    let stem = if known { path.file_stem() } else { path.file_name() };
    stem.map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Parses a number; the error is in words. `nan` is accepted, because trackers write it while they are lost; such rows are
/// dropped later.
pub(super) fn parse_number(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| format!("{:?} is not a number", text.chars().take(40).collect::<String>()))
}

/// A number that counts frames from 0; `None` if it is not a whole number.
pub(super) fn whole_number(number: f64) -> Option<usize> {
    const MOST: f64 = 1e9;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is whole and within bounds")]
    ((0.0..=MOST).contains(&number) && number.fract() == 0.0).then_some(number as usize)
}

/// A time in seconds from a number and the unit in its column's name. Without a unit the number is in seconds, unless
/// it is so large that it can only be a time since 1970 in milliseconds, microseconds or nanoseconds.
pub(super) fn seconds_in_unit(number: f64, unit: Option<&str>) -> f64 {
    let per_s = match unit {
        Some("ns") => 1e9,
        Some("us") => 1e6,
        Some("ms") => 1e3,
        Some(_) => 1.0,
        // Seconds since 1970 have ten digits until the year 2286.
        None => match number.abs() {
            n if n >= 1e17 => 1e9,
            n if n >= 1e14 => 1e6,
            n if n >= 1e11 => 1e3,
            _ => 1.0,
        },
    };
    number / per_s
}
