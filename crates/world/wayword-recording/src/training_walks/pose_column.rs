//! The poses of InternNav's tables: a column of matrices.

use crate::lerobot::ParquetTable;
use std::path::{Path, PathBuf};
use wayword_core::{DVec3, Heading, PlatformError};

/// Numbers of a pose.
const POSE_NUMBERS: usize = 16;
/// The pitches of InternNav's cameras, as they stand in names.
const PITCHES: [&str; 4] = ["0deg", "15deg", "30deg", "45deg"];

/// A column of poses, which take points of a camera (x right, y down, z ahead) into a world with z up.
pub(super) struct PoseColumn {
    pub(super) table: PathBuf,
    name: String,
    rows: u64,
}

impl PoseColumn {
    /// The column of a camera, or of another at its height, which has the same places and headings; `None` if there is neither.
    ///
    /// # Errors
    /// When the table cannot be read.
    pub(super) fn find(file: &Path, camera: &str, rows: u64) -> Result<Option<Self>, PlatformError> {
        let height = camera.split('_').next().unwrap_or(camera);
        let table = ParquetTable::open(file)?;
        let others = PITCHES.map(|pitch| format!("pose.{height}_{pitch}"));
        let mut names = std::iter::once(format!("pose.{camera}")).chain(others);
        let name = names.find(|name| table.has_column(name));
        Ok(name.map(|name| Self { table: file.to_owned(), name, rows }))
    }

    /// Where the camera is and looks in each row.
    ///
    /// # Errors
    /// When the table has no such column of matrices.
    pub(super) fn read_stances(&self) -> Result<Vec<(DVec3, Option<Heading>)>, PlatformError> {
        let table = ParquetTable::open(&self.table)?;
        let kept: Vec<usize> = (0..POSE_NUMBERS).collect();
        let numbers = table.read_lists(&self.name, 0..self.rows, POSE_NUMBERS, &kept)?;
        let stance = |pose: &[f64; POSE_NUMBERS]| {
            // Rows of the matrix: the third column is the direction ahead, the fourth the place.
            let ahead = DVec3::new(pose[2], pose[6], 0.0);
            (DVec3::new(pose[3], pose[7], pose[11]), Heading::towards(DVec3::ZERO, ahead))
        };
        Ok(numbers.as_chunks::<POSE_NUMBERS>().0.iter().map(stance).collect())
    }
}
