//! Finds and reads the pose file of a folder of pictures or of a video.

mod csv;
mod json;
mod matrix;
mod rows;

use crate::{
    axes::{PoseAxes, WorldUpAxis},
    describe::RecordingDescription,
    pose_plausibility::{self, PoseDoubt},
    track::CameraTrack,
};
use rows::{PoseFacing, PoseKey};
use std::path::{Component, Path, PathBuf};
use wayword_core::PlatformError;
use wayword_world::files;

/// Largest pose file that is read, bytes; a larger one is an error.
const MAX_FILE_BYTES: u64 = 256 << 20;
const POSE_FILE_HINT: &str = "docs/RECORDINGS.md shows the pose files that can be read";
/// Names of a folder's pose file, in the order in which they are tried.
const FOLDER_POSE_FILES: [&str; 6] =
    ["poses.json", "poses.csv", "poses.tum", "poses.txt", "groundtruth.txt", "transforms.json"];

/// Finds the pose file: the one that the description names, else that of a folder, or of a file by its name (`walk.csv`
/// for `walk.mp4`); `None` if there is none.
///
/// # Errors
/// When the description names a file that does not exist.
pub(crate) fn find_pose_file(path: &Path, described: &RecordingDescription) -> Result<Option<PathBuf>, PlatformError> {
    let folder = if path.is_dir() { path } else { path.parent().unwrap_or(Path::new(".")) };
    if let Some(named) = &described.poses {
        let plain = Path::new(named).components().all(|part| matches!(part, Component::Normal(_)));
        let file = folder.join(named);
        return if plain && file.is_file() {
            Ok(Some(file))
        } else {
            let reason = format!("poses = {named:?} is not a file in the recording's folder");
            Err(files::file_error(folder, reason, crate::describe::DESCRIPTION_HINT))
        };
    }
    let candidates: Vec<PathBuf> = if path.is_dir() {
        FOLDER_POSE_FILES.iter().map(|name| folder.join(name)).collect()
    } else {
        ["tum", "csv", "json", "txt"].iter().map(|ending| path.with_extension(ending)).collect()
    };
    Ok(candidates.into_iter().find(|file| file.is_file()))
}

/// Reads the track in a pose file, on the clock of pictures that were taken at `times_s` and have the names `name`.
///
/// # Errors
/// When it cannot be read, or has no pose for any of these pictures.
pub(crate) fn read_track(
    file: &Path,
    described: &RecordingDescription,
    times_s: &[f64],
    name: &dyn Fn(usize) -> String,
) -> Result<CameraTrack, PlatformError> {
    let wrong = |reason: String| files::file_error(file, reason, POSE_FILE_HINT);
    let text = files::text_if_there(file, MAX_FILE_BYTES, POSE_FILE_HINT)?
        .ok_or_else(|| wrong("there is no such file".into()))?;
    let ending = file.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    let pose_rows = match ending {
        "json" => json::read_json(&text),
        "csv" => csv::read_csv(&text),
        _ => matrix::read_matrix(&text),
    }
    .map_err(wrong)?;
    let axes = described.axes_or_usual(pose_rows.usual);
    let doubt = pose_plausibility::find_doubt(&pose_rows.samples(), axes, described);
    let rows = pose_rows.rows;
    if axes.world != WorldUpAxis::ZUp && rows.iter().any(|row| matches!(row.facing, PoseFacing::Yaw(_))) {
        return Err(wrong("a yaw turns about z, so `world` must be z-up".into()));
    }
    if let Some(PoseDoubt::Misread(reason)) = doubt {
        return Err(files::file_error(file, reason, crate::describe::DESCRIPTION_HINT));
    }
    let why_none = if rows.is_empty() {
        "holds no poses"
    } else {
        "has no usable pose: the pictures that it names or counts are not here, or its positions are not valid"
    };
    let track = track_from_rows(rows, axes, times_s, name).ok_or_else(|| wrong(why_none.into()))?;
    if !times_s.iter().any(|time_s| track.fix_at(*time_s).is_some()) {
        let ((from, to), first, last) =
            (track.span_s(), times_s.first().unwrap_or(&0.0), times_s.last().unwrap_or(&0.0));
        return Err(wrong(format!(
            "has poses from {from} to {to} s, but the pictures were taken from {first} to {last} s: no picture has a \
             pose"
        )));
    }
    Ok(match doubt {
        Some(PoseDoubt::Odd(words)) => track.in_doubt(format!("{}: {words}", file.display())),
        _ => track,
    })
}

/// The track of rows, on the clock of the pictures. Rows of pictures that do not exist are left out; `None` if no row is left.
fn track_from_rows(
    rows: Vec<rows::PoseRow>,
    axes: PoseAxes,
    times_s: &[f64],
    name: &dyn Fn(usize) -> String,
) -> Option<CameraTrack> {
    let by_name = rows.iter().any(|row| matches!(row.key, PoseKey::Picture(_)));
    let mut named: Vec<(String, f64)> = Vec::new();
    if by_name {
        named = times_s.iter().enumerate().map(|(at, time_s)| (rows::picture_stem(&name(at)), *time_s)).collect();
        named.sort_by(|a, b| a.0.cmp(&b.0));
    }
    let fixes = rows.into_iter().filter_map(|row| {
        let time_s = match &row.key {
            PoseKey::Time(time_s) => Some(*time_s),
            PoseKey::Number(number) => times_s.get(*number).copied(),
            PoseKey::Picture(picture) => {
                let stem = rows::picture_stem(picture);
                let found = named.binary_search_by(|(other, _)| other.as_str().cmp(&stem)).ok();
                found.and_then(|at| named.get(at)).map(|(_, time_s)| *time_s)
            }
        };
        Some(row.fix_at(time_s?, axes))
    });
    CameraTrack::new(fixes.collect())
}

#[cfg(test)]
mod tests;
