//! Poses in one file for each picture: a 4 x 4 matrix that places the camera in the world (7-Scenes, ScanNet).

use super::{
    matrix::row_from_matrix,
    rows::{KnownConventions, PoseKey, PoseRow, PoseRows, RowKind, parse_number, picture_stem},
};
use crate::{
    axes::{PoseAxes, PoseBody, WorldUpAxis},
    names::sorted_entries,
};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};
use wayword_core::PlatformError;
use wayword_world::files;

/// Largest file with one pose, bytes.
const MAX_POSE_BYTES: u64 = 64 << 10;
const HINT: &str = "expected 12 or 16 numbers: a matrix that places the camera in the world, row by row";
/// Endings of the names of pictures that the names of their poses do not have: `frame-000000.color.png`.
const PICTURE_WORDS: [&str; 6] = [".color", ".rgb", "_color", "_rgb", "-color", "-rgb"];
/// Folders beside the pictures that hold such files.
const POSE_FOLDERS: [&str; 2] = ["pose", "poses"];

/// The pose file of each picture that has one.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FramePoseFiles {
    /// The folder in which they are.
    pub(super) folder: PathBuf,
    /// The world of a dataset that has files of these names.
    world: WorldUpAxis,
    /// The name of each picture and its file.
    pub(super) files: Vec<(String, PathBuf)>,
}

impl FramePoseFiles {
    /// Finds the files for pictures with these names: in one of these folders, or in a folder for poses below them. `None` unless the
    /// first picture that has one has a matrix.
    pub(super) fn find(folders: &[&Path], names: &[String]) -> Option<Self> {
        for folder in folders {
            // 7-Scenes: the world begins near the first camera.
            let beside = Self::find_in(folder, names, &[".pose.txt", "_pose.txt"], WorldUpAxis::YDown);
            let below = || {
                // ScanNet: z points up.
                let below = POSE_FOLDERS.iter().map(|name| folder.join(name)).filter(|folder| folder.is_dir());
                below
                    .into_iter()
                    .find_map(|folder| Self::find_in(&folder, names, &[".txt", ".pose.txt"], WorldUpAxis::ZUp))
            };
            if let Some(found) = beside.or_else(below) {
                return Some(found);
            }
        }
        None
    }

    /// Finds the files in one folder.
    pub(super) fn find_in(folder: &Path, names: &[String], endings: &[&str], world: WorldUpAxis) -> Option<Self> {
        let mut entries = sorted_entries(folder).ok()?;
        entries.retain(|entry| entry.ends_with(".txt"));
        let entries: BTreeSet<String> = entries.into_iter().collect();
        let file_of = |name: &String| {
            let stem = picture_stem(name);
            let stem = PICTURE_WORDS.iter().find_map(|word| stem.strip_suffix(word)).unwrap_or(&stem);
            let file = endings.iter().map(|ending| format!("{stem}{ending}")).find(|file| entries.contains(file));
            Some((name.clone(), folder.join(file?)))
        };
        let files: Vec<(String, PathBuf)> = names.iter().filter_map(file_of).collect();
        let (_, first) = files.first()?;
        // Other tools keep the boxes of objects in such files.
        let is_pose = read_numbers(first).is_ok_and(|numbers| row_from_matrix(PoseKey::Number(0), &numbers).is_some());
        is_pose.then(|| Self { folder: folder.to_owned(), world, files })
    }

    /// Reads all of them.
    pub(super) fn read(&self) -> Result<PoseRows, PlatformError> {
        let rows = self.files.iter().map(|(name, file)| -> Result<PoseRow, PlatformError> {
            let wrong = |reason: String| files::file_error(file, reason, HINT);
            let numbers = read_numbers(file)?;
            let count = numbers.len();
            let row = row_from_matrix(PoseKey::Picture(name.clone()), &numbers);
            row.ok_or_else(|| wrong(format!("holds no pose, but {count} numbers")))
        });
        let usual = PoseAxes { world: self.world, ..PoseAxes::for_body(PoseBody::Optical) };
        let rows = PoseRows::new(usual, KnownConventions::BODY_ONLY, rows.collect::<Result<_, _>>()?);
        Ok(PoseRows { kind: RowKind::File, ..rows })
    }
}

/// The numbers in a file, at most one more than a pose has.
fn read_numbers(file: &Path) -> Result<Vec<f64>, PlatformError> {
    let text = files::text_if_there(file, MAX_POSE_BYTES, HINT)?.unwrap_or_default();
    let numbers = text.split_whitespace().take(17).map(parse_number).collect::<Result<_, _>>();
    numbers.map_err(|reason| files::file_error(file, reason, HINT))
}
