//! Finds the poses of a folder of pictures or of a video: by the names that datasets and phones' apps give them.

use super::{frame_files::FramePoseFiles, sensor_file::SENSOR_FILE};
use crate::{
    axes::WorldUpAxis,
    describe::{DESCRIPTION_HINT, RecordingDescription},
    names::{is_video_name, sorted_entries},
};
use std::path::{Component, Path, PathBuf};
use wayword_core::PlatformError;
use wayword_world::files;

/// Names of a folder's pose file, in the order in which they are tried: usual names, then that of Stray Scanner, of Replica's
/// rendered rooms, and of Record3D.
const FOLDER_POSE_FILES: [&str; 9] = [
    "poses.json",
    "poses.csv",
    "poses.tum",
    "poses.txt",
    "groundtruth.txt",
    "transforms.json",
    "odometry.csv",
    "traj.txt",
    "metadata",
];
/// The pose file that Stray Scanner writes beside its video.
const SCANNER_POSE_FILE: &str = "odometry.csv";
/// Folders beside a camera's own in which EuRoC and TUM-VI keep the true poses of the body.
const BODY_POSE_FOLDERS: [&str; 2] = ["state_groundtruth_estimate0", "mocap0"];

/// The poses of a folder of pictures.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum PoseSource {
    /// One file.
    File(PathBuf),
    /// A file with the poses of a body, and one that says where the camera is on it.
    BodyFile { poses: PathBuf, sensor: PathBuf },
    /// A file for each picture.
    FrameFiles(FramePoseFiles),
}

impl PoseSource {
    /// The files that are read.
    pub(crate) fn files(&self) -> Vec<PathBuf> {
        match self {
            Self::File(file) => vec![file.clone()],
            Self::BodyFile { poses, sensor } => vec![poses.clone(), sensor.clone()],
            Self::FrameFiles(frames) => frames.files.iter().map(|(_, file)| file.clone()).collect(),
        }
    }
}

/// A folder of pictures, whose poses are looked for.
pub(crate) struct PicturePlace<'a> {
    pub(crate) root: &'a Path,
    /// The folder in which the pictures are: `root` or a folder in it.
    pub(crate) pictures: &'a Path,
    pub(crate) names: &'a [String],
}

impl PicturePlace<'_> {
    /// Finds the poses: those that the description names, else those with a usual name; `None` if there are none.
    ///
    /// # Errors
    /// When the description names a file that does not exist.
    pub(crate) fn find_poses(&self, described: &RecordingDescription) -> Result<Option<PoseSource>, PlatformError> {
        if let Some(named) = &described.poses {
            let folder = self.root.join(named);
            if is_inside(named) && folder.is_dir() {
                let endings = [".pose.txt", "_pose.txt", ".txt"];
                let frames = FramePoseFiles::find_in(&folder, self.names, &endings, WorldUpAxis::ZUp);
                return frames.map(PoseSource::FrameFiles).map(Some).ok_or_else(|| {
                    let reason = format!("poses = {named:?} is a folder without a pose file for each picture");
                    files::file_error(self.root, reason, DESCRIPTION_HINT)
                });
            }
        }
        if let Some(file) = find_pose_file(self.root, described)? {
            return Ok(Some(PoseSource::File(file)));
        }
        if let Some(file) = self.dataset_file() {
            return Ok(Some(PoseSource::File(file)));
        }
        if let Some(poses) = self.body_file() {
            return Ok(Some(PoseSource::BodyFile { poses, sensor: self.root.join(SENSOR_FILE) }));
        }
        Ok(FramePoseFiles::find(&[self.pictures, self.root], self.names).map(PoseSource::FrameFiles))
    }

    /// The pose file of a dataset whose name has that of the folder in it: `poses/05.txt` for `sequences/05` (KITTI), and
    /// `lowres_wide.traj` for `lowres_wide` (ARKitScenes).
    fn dataset_file(&self) -> Option<PathBuf> {
        let named = |folder: &Path, ending: &str| {
            Some(folder.with_file_name(format!("{}.{ending}", folder.file_name()?.to_str()?)))
        };
        let kitti = || {
            let sequences =
                self.root.parent().filter(|folder| folder.file_name().is_some_and(|name| name == "sequences"))?;
            let name = self.root.file_name()?.to_str()?;
            Some(sequences.parent()?.join("poses").join(format!("{name}.txt")))
        };
        let all = [named(self.pictures, "traj"), named(self.root, "traj"), kitti()];
        all.into_iter().flatten().find(|file| file.is_file())
    }

    /// The true poses of the body beside the folder of one of its cameras (`mav0/cam0`).
    fn body_file(&self) -> Option<PathBuf> {
        let beside = self.root.parent()?;
        BODY_POSE_FOLDERS.iter().map(|name| beside.join(name).join("data.csv")).find(|file| file.is_file())
    }
}

/// Finds the pose file: the one that the description names, else that of a folder, or of a file by its name (`walk.csv`
/// for `walk.mp4`); `None` if there is none.
///
/// # Errors
/// When the description names a file that does not exist.
pub(crate) fn find_pose_file(path: &Path, described: &RecordingDescription) -> Result<Option<PathBuf>, PlatformError> {
    let folder = if path.is_dir() { path } else { path.parent().unwrap_or(Path::new(".")) };
    if let Some(named) = &described.poses {
        let file = folder.join(named);
        return if is_inside(named) && file.is_file() {
            Ok(Some(file))
        } else {
            let reason = format!("poses = {named:?} is not a file in the recording's folder");
            Err(files::file_error(folder, reason, DESCRIPTION_HINT))
        };
    }
    if path.is_dir() {
        return Ok(FOLDER_POSE_FILES.iter().map(|name| folder.join(name)).find(|file| file.is_file()));
    }
    let own = ["tum", "csv", "json", "txt"].iter().map(|ending| path.with_extension(ending));
    if let Some(file) = own.into_iter().find(|file| file.is_file()) {
        return Ok(Some(file));
    }
    // It belongs to the only video.
    let file = folder.join(SCANNER_POSE_FILE);
    let is_only = || Ok(sorted_entries(folder)?.iter().filter(|name| is_video_name(name)).count() == 1);
    Ok(if file.is_file() && is_only()? { Some(file) } else { None })
}

/// Whether a path from a description stays in the folder.
fn is_inside(named: &str) -> bool {
    Path::new(named).components().all(|part| matches!(part, Component::Normal(_)))
}
