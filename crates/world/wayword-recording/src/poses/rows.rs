//! The common form of a line of a pose file, in every format.

use crate::{
    axes::{PoseAxes, rotation_columns},
    pose_plausibility::PoseSample,
    track::TrackFix,
};
use std::path::Path;
use wayword_core::{DVec3, Heading};

/// The poses of a file, and the axes that its format usually has.
#[derive(Debug)]
pub(super) struct PoseRows {
    pub(super) usual: PoseAxes,
    /// Whether the body's up direction is known. For EuRoC's sensor only the direction ahead is.
    pub(super) knows_body_up: bool,
    pub(super) rows: Vec<PoseRow>,
}

/// A pose as it was recorded.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PoseRow {
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
    /// recorded_from_body as x, y, z, w.
    Quaternion([f64; 4]),
    /// recorded_from_body by its columns.
    Columns([DVec3; 3]),
    /// Radians counter-clockwise from the recorded +x.
    Yaw(f64),
    /// Radians clockwise from Wayword's +y.
    Heading(f64),
}

impl PoseRow {
    /// The fix for this pose at a time, in Wayword's frame.
    pub(super) fn fix_at(&self, time_s: f64, axes: PoseAxes) -> TrackFix {
        let heading = match self.facing {
            PoseFacing::Unknown => None,
            PoseFacing::Quaternion(quaternion) => axes.heading_by_quaternion(quaternion),
            PoseFacing::Columns(columns) => axes.heading_by_columns(columns),
            PoseFacing::Yaw(yaw_rad) => axes.heading_by_yaw(yaw_rad),
            PoseFacing::Heading(rad) => Heading::new(rad + axes.mount_rad).ok(),
        };
        TrackFix { time_s, position: axes.wayword_from_recorded(self.position), heading }
    }
}

impl PoseRows {
    /// The poses as they were recorded.
    pub(super) fn samples(&self) -> Vec<PoseSample> {
        let orientation = |facing: PoseFacing| match facing {
            PoseFacing::Quaternion(quaternion) => rotation_columns(quaternion),
            PoseFacing::Columns(columns) => Some(columns),
            PoseFacing::Unknown | PoseFacing::Yaw(_) | PoseFacing::Heading(_) => None,
        };
        let sample = |row: &PoseRow| PoseSample {
            position: row.position,
            recorded_from_body: orientation(row.facing).filter(|_| self.knows_body_up),
        };
        self.rows.iter().map(sample).collect()
    }
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
