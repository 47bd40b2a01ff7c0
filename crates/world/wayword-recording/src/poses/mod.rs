//! Finds and reads the poses of a folder of pictures or of a video.

mod clock;
mod colmap;
mod columns;
mod csv;
mod find;
mod frame_files;
mod json;
mod matrix;
mod orientations;
mod row_faults;
mod rows;
mod scale;
mod sensor_file;
mod unread;

#[cfg(any(feature = "video", test))]
pub(crate) use find::find_pose_file;
pub(crate) use find::{PicturePlace, PoseSource};
#[cfg(feature = "lerobot")]
pub(crate) use orientations::UnturnedUse;
pub(crate) use unread::describe_unread;

use crate::{
    axes::{PoseAxes, PoseBody, WorldUpAxis},
    describe::{DESCRIPTION_HINT, RecordingDescription},
    pose_plausibility::{self, PoseDoubt, RecordedWalk},
    pose_reading::{NumberReading, QuaternionOrder, TransformDirection},
    track::{CameraTrack, PoseTally, TrackFix},
};
use clock::{FrameCount, PictureClock};
use columns::clip_name;
use rows::{PoseFacing, PoseKey, PoseRow, PoseRows};
use std::path::Path;
use wayword_core::PlatformError;
use wayword_world::files;

/// Largest pose file that is read, bytes; a larger one is an error.
const MAX_FILE_BYTES: u64 = 256 << 20;
const POSE_FILE_HINT: &str = "docs/RECORDINGS.md shows the pose files that can be read";

/// Reads the track in a pose file, on the clock of pictures that were taken at `times_s` and have the names `name`.
///
/// # Errors
/// When it cannot be read, or has no pose for any of these pictures.
#[cfg(any(feature = "video", test))]
pub(crate) fn read_track(
    file: &Path,
    described: &RecordingDescription,
    times_s: &[f64],
    name: &dyn Fn(usize) -> String,
) -> Result<CameraTrack, PlatformError> {
    read_source(&PoseSource::File(file.to_owned()), described, times_s, name)
}

/// As [`read_track`], of any source of poses.
///
/// # Errors
/// As [`read_track`].
pub(crate) fn read_source(
    source: &PoseSource,
    described: &RecordingDescription,
    times_s: &[f64],
    name: &dyn Fn(usize) -> String,
) -> Result<CameraTrack, PlatformError> {
    let clock = PictureClock { times_s, name };
    let (origin, rows) = match source {
        PoseSource::File(file) => (file, read_rows(file)?),
        PoseSource::BodyFile { poses, sensor } => {
            let mut rows = read_rows(poses)?;
            if let Some(mounting) = sensor_file::read_mounting(sensor) {
                // With it the poses are those of the camera itself.
                rows.mounting = Some(mounting);
                rows.known.body_up = true;
                rows.usual = PoseAxes::for_body(PoseBody::Optical);
            }
            (poses, rows)
        }
        PoseSource::FrameFiles(frames) => (&frames.folder, frames.read()?),
    };
    TrackMaker { origin, described, clock, rows }.make_track()
}

/// The poses in a file, whose name and content decide the format.
fn read_rows(file: &Path) -> Result<PoseRows, PlatformError> {
    let wrong = |reason: String| files::file_error(file, reason, POSE_FILE_HINT);
    let ending = file.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    let name = file.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    if ending == "bin" {
        let hint = "COLMAP's own converter writes text: colmap model_converter --output_type TXT";
        return Err(files::file_error(file, "is not text", hint));
    }
    let text = files::text_if_there(file, MAX_FILE_BYTES, POSE_FILE_HINT)?
        .ok_or_else(|| wrong("there is no such file".into()))?;
    let mut rows = match ending {
        "json" => json::read_json(&text),
        "csv" => csv::read_csv(&text),
        "traj" => matrix::read_axis_angles(&text),
        _ if text.trim_start().starts_with(['{', '[']) => json::read_json(&text),
        _ if colmap::is_colmap_text(&text) => colmap::read_colmap(&text),
        _ => matrix::read_matrix(&text),
    }
    .map_err(wrong)?;
    if name == "traj.txt" && rows.usual.world == WorldUpAxis::YDown {
        // The rendered rooms of Replica, whose z points up.
        rows.usual.world = WorldUpAxis::ZUp;
    }
    Ok(rows)
}

/// Makes a track of the poses in a file.
struct TrackMaker<'a> {
    /// The file, or the folder of the files.
    origin: &'a Path,
    described: &'a RecordingDescription,
    clock: PictureClock<'a>,
    rows: PoseRows,
}

impl TrackMaker<'_> {
    fn make_track(mut self) -> Result<CameraTrack, PlatformError> {
        self.check_settings()?;
        let axes = self.described.axes_or_usual(self.rows.usual);
        let numbers = self.described.numbers_or_usual(self.rows.usual_numbers);
        let metres_per_unit = self.described.metres_per_unit();
        self.apply_angle_unit(axes)?;
        if self.rows.rows.is_empty() {
            return Err(self.wrong("holds no poses".into()));
        }
        let invalid = self.rows.remove_invalid(metres_per_unit);
        if let Some(reason) = row_faults::find_no_rotation(&self.rows) {
            return Err(files::file_error(self.origin, reason, row_faults::ROTATION_HINT));
        }
        let oriented = orientations::settle_orientations(&mut self.rows);
        let late = if self.frame_count() == FrameCount::Other {
            let late = row_faults::count_late_rows(&self.rows);
            late.map_err(|reason| files::file_error(self.origin, reason, row_faults::RESTART_HINT))?
        } else {
            0
        };
        if self.frame_count() == FrameCount::Other && self.described.pose_time_offset_s.is_none() {
            self.ask(clock::find_time_unit_doubt(&self.rows, self.clock.times_s))?;
        }
        if !self.rows.known.unit && self.described.unit.is_none() && metres_per_unit == 1.0 {
            self.ask(scale::find_unit_doubt(&self.rows, self.described.world.is_none()))?;
        }
        let doubt = self.find_doubt(axes, numbers, metres_per_unit);
        if !axes.world.has_yaw() && self.rows.has_facing(|facing| matches!(facing, PoseFacing::Yaw(_))) {
            return Err(self.wrong("a yaw turns about z, so `world` must be z-up, unity, unreal or ned".into()));
        }
        let unread: Vec<String> =
            self.rows.unread.take().into_iter().chain(oriented).chain(self.absent_pictures()).collect();
        let unread = (!unread.is_empty()).then(|| format!("{}: {}", self.origin.display(), unread.join("; ")));
        let track = self.place_in_time((numbers, axes, metres_per_unit))?.with_unread(unread);
        if let Some(PoseDoubt::Misread(reason)) = doubt {
            return Err(self.question(reason));
        }
        let track = track.with_tally(PoseTally { invalid, late, ..PoseTally::default() });
        Ok(match doubt {
            Some(PoseDoubt::Odd(words)) => track.in_doubt(format!("{}: {words}", self.origin.display())),
            _ => track,
        })
    }

    fn wrong(&self, reason: String) -> PlatformError {
        files::file_error(self.origin, reason, POSE_FILE_HINT)
    }

    /// The error that asks for a setting.
    fn question(&self, reason: String) -> PlatformError {
        files::file_error(self.origin, reason, DESCRIPTION_HINT)
    }

    /// Ends with a question if there is one.
    fn ask(&self, question: Option<String>) -> Result<(), PlatformError> {
        question.map_or(Ok(()), |reason| Err(self.question(reason)))
    }

    /// Refuses settings that have no meaning for this file.
    fn check_settings(&self) -> Result<(), PlatformError> {
        let has_rotation =
            self.rows.has_facing(|facing| matches!(facing, PoseFacing::Quaternion(_) | PoseFacing::Columns(_)));
        if self.described.quaternion.is_some() && self.rows.known.order {
            let reason = "names the order of its quaternions itself, so leave out `quaternion`";
            return Err(self.question(reason.into()));
        }
        if self.described.transform == Some(TransformDirection::WorldToCamera) && !has_rotation {
            let reason =
                "has no rotations, and without them a transform from world to camera does not place the camera";
            return Err(self.question(reason.into()));
        }
        Ok(())
    }

    /// Turns a yaw without a unit into radians, and asks about one with a named unit that cannot be right.
    fn apply_angle_unit(&mut self, axes: PoseAxes) -> Result<(), PlatformError> {
        if let Some(name) = self.rows.angle_name.filter(|_| self.rows.known.angle_unit) {
            return match self.described.angle_unit {
                None => self.ask(scale::find_named_angle_doubt(&self.rows, axes, name)),
                Some(unit) if name.ends_with(unit.name()) => Ok(()),
                Some(_) => Err(self.question(format!("{name} names its unit itself, so leave out `angle_unit`"))),
            };
        }
        if self.rows.known.angle_unit {
            return Ok(());
        }
        match self.described.angle_unit {
            None => self.ask(scale::find_angle_doubt(&self.rows, axes)),
            Some(unit) => {
                for row in &mut self.rows.rows {
                    if let PoseFacing::Yaw(yaw) = row.facing {
                        row.facing = PoseFacing::Yaw(unit.to_rad(yaw));
                    }
                }
                Ok(())
            }
        }
    }

    /// The doubt about the way in which the poses are read, among all ways that the file and the user leave open.
    fn find_doubt(&self, axes: PoseAxes, numbers: NumberReading, metres_per_unit: f64) -> Option<PoseDoubt> {
        let known = self.rows.known;
        let may_change_order = !known.order
            && self.described.quaternion.is_none()
            && self.rows.has_facing(|facing| matches!(facing, PoseFacing::Quaternion(_)));
        let may_change_direction = !known.direction && self.described.transform.is_none();
        let orders = [QuaternionOrder::Xyzw, QuaternionOrder::Wxyz].into_iter();
        let orders = orders.filter(|order| *order == numbers.order || may_change_order);
        let all = orders.flat_map(|order| {
            let directions = [TransformDirection::CameraToWorld, TransformDirection::WorldToCamera];
            directions.map(|direction| NumberReading { order, direction })
        });
        let others =
            all.filter(|other| *other != numbers && (other.direction == numbers.direction || may_change_direction));
        let walk = |numbers| {
            let walk = RecordedWalk::from_samples(self.rows.samples(numbers, metres_per_unit))?;
            Some((numbers, walk))
        };
        let walks: Vec<(NumberReading, RecordedWalk)> =
            std::iter::once(numbers).chain(others).filter_map(walk).collect();
        let is_positions_only = !self.rows.has_facing(|facing| *facing != PoseFacing::Unknown);
        let of_hand = || {
            let (_, walk) = walks.first().filter(|_| is_positions_only)?;
            pose_plausibility::find_hand_doubt(walk, axes.world)
        };
        pose_plausibility::find_doubt_among(&walks, axes, self.described).or_else(of_hand)
    }

    /// The track on the clock of the pictures.
    fn place_in_time(&self, reading: (NumberReading, PoseAxes, f64)) -> Result<CameraTrack, PlatformError> {
        let count = self.frame_count();
        let first = self.track_by(reading, count == FrameCount::Certain)?;
        if self.meets_pictures(&first) {
            return Ok(first);
        }
        if count == FrameCount::Likely {
            return self.track_by(reading, true);
        }
        if self.rows.rows.iter().any(|row| matches!(row.key, PoseKey::Time(_))) {
            return Err(self.question(clock::describe_clocks(first.span_s(), self.clock.times_s)));
        }
        Err(self.wrong("no picture has a pose".into()))
    }

    /// How the numbers in a column `frame` relate to the pictures. They do not count where the user places the times.
    fn frame_count(&self) -> FrameCount {
        match self.described.pose_time_offset_s {
            Some(_) => FrameCount::Other,
            None => self.clock.frame_count(&self.rows),
        }
    }

    /// A line about poses of pictures that are not here, with the first of them and a picture that is.
    fn absent_pictures(&self) -> Option<String> {
        let times = self.clock.times_of_rows(&self.rows, 0.0, false);
        let absent = self.rows.rows.iter().zip(times).filter_map(|(row, time_s)| match &row.key {
            PoseKey::Picture(picture) if time_s.is_none() => Some((self.rows.name_row(row), picture)),
            _ => None,
        });
        let absent: Vec<(String, &String)> = absent.collect();
        let (row, picture) = absent.first()?;
        let here = if self.clock.times_s.is_empty() { String::new() } else { (self.clock.name)(0) };
        Some(format!(
            "{} of {} poses are of pictures that are not here: {row} names {:?}, and the first picture here is {here:?}",
            absent.len(),
            self.rows.rows.len(),
            clip_name(picture),
        ))
    }

    fn meets_pictures(&self, track: &CameraTrack) -> bool {
        self.clock.times_s.iter().any(|time_s| track.fix_at(*time_s).is_some())
    }

    /// The track by times, or by the column `frame`. Rows of pictures that do not exist are left out.
    fn track_by(&self, reading: (NumberReading, PoseAxes, f64), by_frames: bool) -> Result<CameraTrack, PlatformError> {
        let offset_s = self.described.pose_time_offset_s.unwrap_or(0.0);
        let times = self.clock.times_of_rows(&self.rows, offset_s, by_frames);
        let rows = self.rows.rows.iter().zip(times);
        let fixes = rows.filter_map(|(row, time_s)| Some((row, self.rows.fix_at(row, time_s?, reading))));
        let fixes: Vec<(&PoseRow, TrackFix)> = fixes.collect();
        if let Some(reason) = row_faults::find_contradiction(&self.rows, &fixes, self.clock.times_s) {
            return Err(files::file_error(self.origin, reason, row_faults::LEAP_HINT));
        }
        CameraTrack::new(fixes.into_iter().map(|(_, fix)| fix).collect()).ok_or_else(|| {
            let why_none = "the pictures that it counts are not here, or its positions are not valid".to_owned();
            self.wrong(format!("has no usable pose: {}", self.absent_pictures().unwrap_or(why_none)))
        })
    }
}

#[cfg(test)]
mod convention_tests;
#[cfg(test)]
mod tests;
