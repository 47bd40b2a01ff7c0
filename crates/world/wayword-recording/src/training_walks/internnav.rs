//! InternNav's folders: a LeRobot dataset of version 2 whose pictures are files, and whose poses are matrices.

use super::{TrainingWalk, TrainingWalks, expect_pictures, motion::WalkMotion, wrong_list};
use crate::{lerobot::ParquetTable, names::sorted_entries};
use std::path::{Path, PathBuf};
use wayword_core::{DVec3, Heading, PlatformError, SceneId};
use wayword_formats::training::episode_lines::{internnav_scene_name, read_internnav_lines};
use wayword_world::files;

/// Episodes in one folder of files.
const EPISODES_PER_CHUNK: usize = 1000;
/// What a folder of colour pictures begins with; the rest names the camera.
const RGB_PREFIX: &str = "observation.images.rgb.";
/// Numbers of a pose.
const POSE_NUMBERS: usize = 16;

/// A column of poses, which take points of a camera (x right, y down, z ahead) into a world with z up.
pub(crate) struct PoseColumn {
    pub(super) table: PathBuf,
    name: String,
    rows: u64,
}

impl PoseColumn {
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

/// Opens a scene's folder of InternNav's layout; `None` if the folder is another LeRobot dataset.
///
/// # Errors
/// When its list of episodes breaks a rule, or pictures are missing.
pub(crate) fn open_internnav(root: &Path) -> Result<Option<TrainingWalks>, PlatformError> {
    let (list, videos) = (root.join("meta/episodes.jsonl"), root.join("videos/chunk-000"));
    if !list.is_file() || !videos.is_dir() {
        return Ok(None);
    }
    let cameras = sorted_entries(&videos)?;
    // The level camera comes first by name: 125cm_0deg before 125cm_30deg.
    let Some(camera) = cameras.iter().find_map(|name| name.strip_prefix(RGB_PREFIX)) else { return Ok(None) };
    let mut walks = Vec::new();
    for line in read_internnav_lines(&list).map_err(|error| wrong_list(&list, &error))? {
        let name = internnav_scene_name(root, line.index);
        let scene = SceneId::new(name)
            .map_err(|error| files::file_error(root, error.to_string(), "give the folder another name"))?;
        let chunk = format!("chunk-{:03}", line.index / EPISODES_PER_CHUNK);
        let folder = root.join("videos").join(&chunk).join(format!("{RGB_PREFIX}{camera}"));
        let picture = |number: usize| folder.join(format!("episode_{:06}_{number}.jpg", line.index));
        let pictures: Vec<PathBuf> = (0..line.length).map(picture).take_while(|file| file.is_file()).collect();
        expect_pictures(&folder, pictures.len(), line.length)?;
        let table = root.join("data").join(&chunk).join(format!("episode_{:06}.parquet", line.index));
        let name = pose_column(&table, camera)?;
        let motion = name.map_or(WalkMotion::Unknown, |name| {
            WalkMotion::Poses(PoseColumn { table, name, rows: line.length as u64 })
        });
        walks.push(TrainingWalk { scene, pictures, motion });
    }
    TrainingWalks::new(root, list, walks).map(Some)
}

/// The column with the poses of a camera, or of another at its height: their places and headings are the same.
fn pose_column(table: &Path, camera: &str) -> Result<Option<String>, PlatformError> {
    let height = camera.split('_').next().unwrap_or(camera);
    let table = ParquetTable::open(table)?;
    let own = format!("pose.{camera}");
    if table.has_column(&own) {
        return Ok(Some(own));
    }
    let others = ["0deg", "15deg", "30deg", "45deg"].map(|pitch| format!("pose.{height}_{pitch}"));
    Ok(others.into_iter().find(|name| table.has_column(name)))
}
