//! Datasets of LeRobot (Hugging Face's library for robot learning), versions 2.0, 2.1 and 3.0. A dataset has episodes, which
//! are single recordings: rows of numbers in Parquet files, with pictures in the rows or in videos. Each episode is a scene.
//!
//! The format follows huggingface/lerobot, `lerobot/datasets/lerobot_dataset.py` and `utils.py` (0.3.3 writes version
//! 2.1, 0.4.4 version 3.0).

mod camera;
mod episodes;
mod info;
mod parquet;
mod pictures;
mod pose_feature;
mod template;
mod yaw_unit;

use crate::{
    axes::{PoseAxes, PoseBody},
    describe::{self, RecordingDescription},
    names::{plain_files, scene_id_for_path, sorted_entries, unknown_scene},
    pose_plausibility::find_doubt,
    poses::UnturnedUse,
    reel::{PictureReel, Recording, RecordingSource},
    track::{CameraTrack, TrackFix},
};
use camera::DatasetCamera;
use episodes::DatasetEpisode;
use info::{DatasetInfo, DatasetLayout};
pub(crate) use parquet::ParquetTable;
use pictures::{RowReel, VideoStretch};
use pose_feature::{PoseFeature, YAW_UNIT_HINT};
use std::{
    ops::Range,
    path::{Path, PathBuf},
};
use wayword_core::{PlatformError, SceneId};
use wayword_world::files;

const DATASET_HINT: &str = "download the dataset again, or write it again with LeRobot's library";

/// Depth of the folders below `meta` that hold its files: `meta/episodes/chunk-000`.
const META_DEPTH: usize = 2;

/// A LeRobot dataset, of which each episode is a recording.
pub(crate) struct LeRobotDataset {
    root: PathBuf,
    described: RecordingDescription,
    info: DatasetInfo,
    camera: DatasetCamera,
    pose_feature: Option<PoseFeature>,
    /// What the user has to be told about the dataset.
    remarks: Vec<String>,
    /// Sorted by name, which is also the order of their numbers.
    episodes: Vec<(SceneId, DatasetEpisode)>,
}

impl LeRobotDataset {
    /// Opens the dataset in a folder; reads its description and the list of its episodes.
    ///
    /// # Errors
    /// When its folder `meta` cannot be read, or it has several cameras and the user named none.
    pub(crate) fn open(root: &Path, described: RecordingDescription) -> Result<Self, PlatformError> {
        let info = DatasetInfo::read(root)?;
        let camera = camera::choose_camera(root, &info, described.camera.as_deref())?;
        let pose_feature = PoseFeature::find_feature(root, &info, &described)?;
        let is_unclear = pose_feature.is_none() && described.poses.is_none();
        let remark = PoseFeature::describe_candidates(&info)
            .or_else(|| PoseFeature::describe_unclear(&info))
            .filter(|_| is_unclear);
        let name = scene_id_for_path(root)?;
        let named = |episode: DatasetEpisode| {
            let scene = SceneId::new(format!("{name}_{:06}", episode.number));
            let scene =
                scene.map_err(|error| files::file_error(root, error.to_string(), "give the folder a shorter name"))?;
            Ok((scene, episode))
        };
        let episodes = episodes::read_episodes(root, &info, &camera)?
            .into_iter()
            .map(named)
            .collect::<Result<Vec<_>, PlatformError>>()?;
        if episodes.is_empty() {
            return Err(files::file_error(&root.join("meta"), "lists no episodes", DATASET_HINT));
        }
        let rows = episodes.iter().map(|(_, episode)| episode.length).fold(0, u64::saturating_add);
        let totals = info.describe_other_totals(episodes.len() as u64, rows);
        let remarks = remark.into_iter().chain(totals).map(|remark| format!("{}: {remark}", root.display())).collect();
        Ok(Self { root: root.to_owned(), described, info, camera, pose_feature, remarks, episodes })
    }

    fn find_episode(&self, scene: &SceneId) -> Result<&DatasetEpisode, PlatformError> {
        let known = self.episodes.iter().find(|(known, _)| known == scene);
        known.map(|(_, episode)| episode).ok_or_else(|| unknown_scene(scene, &self.scenes()))
    }

    /// The poses of the robot in each row; adds what the user has to be told. `None` if the dataset has no feature with poses.
    fn read_track(
        &self,
        table: &ParquetTable,
        rows: Range<u64>,
        times_s: &[f64],
        remarks: &mut Vec<String>,
    ) -> Result<Option<CameraTrack>, PlatformError> {
        let Some(feature) = &self.pose_feature else { return Ok(None) };
        let elements = feature.elements();
        let numbers = table.read_lists(&feature.feature, rows, feature.width, &elements)?;
        let (feature, remark) = feature.with_yaw_unit(&numbers).map_err(|reason| {
            files::file_error(table.path(), format!("column {:?}: its yaw {reason}", feature.feature), YAW_UNIT_HINT)
        })?;
        remarks.extend(remark.map(|remark| format!("{}: {remark}", table.path().display())));
        let mut posed: Vec<(f64, &[f64])> = times_s.iter().copied().zip(numbers.chunks_exact(elements.len())).collect();
        remarks.extend(
            leave_out_unturned(&feature, &mut posed).map(|remark| format!("{}: {remark}", table.path().display())),
        );
        let fixes = posed.iter();
        let fixes: Vec<TrackFix> =
            fixes.filter_map(|(time_s, numbers)| feature.fix_from_numbers(*time_s, numbers, &self.described)).collect();
        let samples = posed.iter().filter_map(|(_, numbers)| feature.sample_from_numbers(numbers));
        let doubt = find_doubt(
            &samples.collect::<Vec<_>>(),
            self.described.axes_or_usual(PoseAxes::for_body(PoseBody::Robot)),
            &self.described,
        );
        let in_doubt = |track: CameraTrack| match doubt {
            Some(doubt) => track.in_doubt(format!("{}: {}", table.path().display(), doubt.into_words())),
            None => track,
        };
        CameraTrack::new(fixes).map(in_doubt).map(Some).ok_or_else(|| {
            let reason = format!("column {:?}: no row holds a valid position in metres", feature.feature);
            files::file_error(
                table.path(),
                reason,
                "name another feature: poses = \"NAME\" in a recording.toml (docs/RECORDINGS.md)",
            )
        })
    }
}

impl RecordingSource for LeRobotDataset {
    fn scenes(&self) -> Vec<SceneId> {
        self.episodes.iter().map(|(scene, _)| scene.clone()).collect()
    }

    fn open(&self, scene: &SceneId) -> Result<Recording, PlatformError> {
        let episode = self.find_episode(scene)?;
        let table = ParquetTable::open(&episode.data)?;
        let rows = find_episode_rows(&table, episode, self.info.layout())?;
        let mut times_s = read_times_s(&table, rows.clone())?;
        let mut remarks = self.remarks.clone();
        let mut video = None;
        if let Some(clip) = &episode.clip {
            let step_s = self.info.step_s();
            let first_s = times_s.first().copied().unwrap_or(0.0);
            let opened = VideoStretch::open(clip, &times_s, step_s).or_else(|error| {
                // Some programs write the time of day.
                let from_first: Vec<f64> = times_s.iter().map(|time_s| time_s - first_s).collect();
                let opened = VideoStretch::open(clip, &from_first, step_s).map_err(|_| error)?;
                remarks.push(format!(
                    "{}: the column \"timestamp\" begins with {first_s:.1} s, where the video has no picture, so times are \
                     counted from the first row",
                    table.path().display()
                ));
                times_s = from_first;
                Ok::<_, PlatformError>(opened)
            })?;
            video = Some(opened);
        }
        let track = self.read_track(&table, rows.clone(), &times_s, &mut remarks)?;
        let reel: Box<dyn PictureReel> = match video {
            Some(mut video) => {
                let key = &self.camera.key;
                let other_size =
                    self.info.features.get(key).and_then(|feature| feature.describe_other_size(key, video.size_px()));
                remarks.extend(other_size.map(|remark| format!("{}: {remark}", self.root.display())));
                remarks.append(&mut video.remarks);
                video.remarks = remarks;
                Box::new(video)
            }
            None => Box::new(RowReel::new(table, self.camera.key.clone(), rows.start, times_s, remarks)),
        };
        Ok(Recording { reel, track, horizontal_fov_rad: None, described: self.described.clone() })
    }

    fn files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        let episode = self.find_episode(scene)?;
        let mut files = files_below(&self.root.join("meta"), META_DEPTH)?;
        files.extend([self.root.join(describe::FOLDER_FILE), episode.data.clone()]);
        files.extend(episode.clip.iter().map(|clip| clip.file.clone()));
        Ok(plain_files(files))
    }
}

/// The files in a folder and in the folders below it, without hidden ones.
fn files_below(folder: &Path, depth: usize) -> Result<Vec<PathBuf>, PlatformError> {
    let mut files = Vec::new();
    for name in sorted_entries(folder)?.iter().filter(|name| !name.starts_with('.')) {
        let path = folder.join(name);
        if !path.is_dir() {
            files.push(path);
        } else if depth > 0 {
            files.extend(files_below(&path, depth - 1)?);
        }
    }
    Ok(files)
}

/// Leaves out the poses without a valid orientation, if they are few. Returns what the user is told of them.
fn leave_out_unturned(feature: &PoseFeature, posed: &mut Vec<(f64, &[f64])>) -> Option<String> {
    let all = posed.len();
    let unturned = posed.iter().filter(|(_, numbers)| feature.lacks_facing(numbers)).count();
    let becomes = UnturnedUse::for_counts(unturned, all);
    if becomes == UnturnedUse::LeftOut {
        posed.retain(|(_, numbers)| !feature.lacks_facing(numbers));
    }
    (unturned > 0).then(|| {
        format!(
            "{unturned} of {all} poses have an orientation that is none, such as 0 0 0 0 or nan: {}",
            becomes.words()
        )
    })
}

/// The rows of an episode in its file; they must be contiguous.
fn find_episode_rows(
    table: &ParquetTable,
    episode: &DatasetEpisode,
    layout: Option<DatasetLayout>,
) -> Result<Range<u64>, PlatformError> {
    const EPISODE_COLUMN: &str = "episode_index";
    let mut rows: Option<Range<u64>> = None;
    if layout == Some(DatasetLayout::Episodes) && !table.has_column(EPISODE_COLUMN) {
        rows = Some(0..table.row_count());
    } else {
        table.read_numbers(EPISODE_COLUMN, 0..table.row_count(), &mut |row, number| {
            if number != episode.number as f64 {
                return Ok(());
            }
            let rows = rows.get_or_insert(row..row);
            if rows.end != row {
                return Err(format!("row {row}: the rows of episode {} are not contiguous", episode.number));
            }
            rows.end = row + 1;
            Ok(())
        })?;
    }
    let rows = rows.unwrap_or(0..0);
    if rows.end - rows.start != episode.length || rows.is_empty() {
        let count = rows.end - rows.start;
        let reason = format!("the number of rows of episode {} is {count}, not {}", episode.number, episode.length);
        return Err(files::file_error(table.path(), reason, DATASET_HINT));
    }
    Ok(rows)
}

/// The times of the rows, seconds from the beginning of the episode.
fn read_times_s(table: &ParquetTable, rows: Range<u64>) -> Result<Vec<f64>, PlatformError> {
    let mut times_s: Vec<f64> = Vec::new();
    table.read_numbers("timestamp", rows, &mut |row, time_s| {
        let last_s = times_s.last().copied().unwrap_or(f64::MIN);
        if !time_s.is_finite() || time_s < last_s {
            return Err(format!("row {row}: the time {time_s} s follows {last_s} s; times must not decrease"));
        }
        times_s.push(time_s);
        Ok(())
    })?;
    Ok(times_s)
}

#[cfg(test)]
mod tests;
