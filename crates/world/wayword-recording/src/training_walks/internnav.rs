//! InternNav's folders: LeRobot datasets of version 2 with pictures as files, and poses as matrices.

use super::{TrainingWalk, TrainingWalks, expect_pictures, motion::WalkMotion, pose_column::PoseColumn, wrong_list};
use crate::names::{is_picture_name, sorted_entries};
use std::path::{Path, PathBuf};
use wayword_core::{PlatformError, SceneId};
use wayword_formats::training::episode_lines::{EPISODES_PER_CHUNK, internnav_scene_name, read_internnav_lines};
use wayword_world::files;

/// What a folder of colour pictures begins with; the rest names the camera.
const RGB_PREFIX: &str = "observation.images.rgb.";
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
    let lines = read_internnav_lines(&list).map_err(|error| wrong_list(&list, &error))?;
    let has_pictures = |name: &String| name.starts_with("episode_") && is_picture_name(name);
    // Another dataset of LeRobot may call its camera so, and have videos.
    if !sorted_entries(&videos.join(format!("{RGB_PREFIX}{camera}")))?.iter().any(has_pictures) {
        return Ok(None);
    }
    let mut walks = Vec::new();
    for line in lines {
        let name = internnav_scene_name(root, line.index);
        let scene = SceneId::new(name)
            .map_err(|error| files::file_error(root, error.to_string(), "give the folder another name"))?;
        let chunk = format!("chunk-{:03}", line.index / EPISODES_PER_CHUNK);
        let folder = root.join("videos").join(&chunk).join(format!("{RGB_PREFIX}{camera}"));
        let picture = |number: usize| folder.join(format!("episode_{:06}_{number}.jpg", line.index));
        let pictures: Vec<PathBuf> = (0..line.length).map(picture).take_while(|file| file.is_file()).collect();
        expect_pictures(&folder, pictures.len(), line.length)?;
        let table = root.join("data").join(&chunk).join(format!("episode_{:06}.parquet", line.index));
        let motion =
            PoseColumn::find(&table, camera, line.length as u64)?.map_or(WalkMotion::Unknown, WalkMotion::Poses);
        walks.push(TrainingWalk { scene, pictures, motion });
    }
    TrainingWalks::new(root, list, walks).map(Some)
}
