//! Turns an episode of a dataset into a path, by its viewpoints or by its positions on the floor.

use crate::error::CommandError;
use std::path::Path as FilePath;
use wayword_core::{ObjectId, Path, PathMotion, Platform, PlatformError};
use wayword_formats::Episode;
use wayword_world::{episode_path::target_for_object, frames_over_floor, path_over_viewpoints};

/// The path of an episode: over its viewpoints, all of its recording, or else over its positions on the floor (VLN-CE). Without any of
/// these it has no frames.
///
/// # Errors
/// When the scene or a viewpoint is unknown, two viewpoints in a row have no edge, or data cannot be read.
pub fn path_for_episode(platform: &dyn Platform, episode: &Episode) -> Result<Path, PlatformError> {
    let (scene, heading, object) = (&episode.scene, episode.start_heading, episode.target_object.as_ref());
    if !episode.viewpoints.is_empty() {
        return path_over_viewpoints(platform, &*episode.id, scene, &episode.viewpoints, heading, object);
    }
    if episode.is_whole_recording
        && let Some(path) = platform.whole_path(scene)?
    {
        return Ok(Path { id: episode.id.clone(), ..path });
    }
    let frames = frames_over_floor(platform, scene, &episode.floor_positions, heading)?;
    let target = match (object, frames.last()) {
        (Some(object), Some(last)) => target_for_object(platform, scene, last, object)?,
        _ => None,
    };
    Ok(Path { id: episode.id.clone(), scene: scene.clone(), frames, motion: PathMotion::Known, target })
}

/// The object of an episode that its scene lacks, where the scene lists objects. `object` is what the file gives for `path`.
///
/// # Errors
/// When the platform's data cannot be read.
pub(crate) fn missing_object(
    platform: &dyn Platform,
    path: &Path,
    object: Option<&ObjectId>,
) -> Result<Option<ObjectId>, PlatformError> {
    let Some(object) = object.filter(|_| path.target.is_none()) else { return Ok(None) };
    let listed = platform.catalogue().listed_objects(&path.scene)?;
    // Where no object is listed, none can be missing.
    let is_missing = !listed.is_empty() && listed.iter().all(|placed| placed.object != *object);
    Ok(is_missing.then(|| object.clone()))
}

/// The error of a path that does not fit its scene, with its file and its item. Other errors stay as they are.
pub fn unusable_path(file: &FilePath, item: &str) -> impl FnOnce(PlatformError) -> CommandError {
    move |error| match error {
        PlatformError::Graph { .. } | PlatformError::UnknownViewpoint { .. } => CommandError::usage(
            format!("{}: item {item}: {error}", file.display()),
            "correct the path of this item, or leave the item out; check that --data holds the scene that the file is about",
        ),
        error => error.into(),
    }
}
