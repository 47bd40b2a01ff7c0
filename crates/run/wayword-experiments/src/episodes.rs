//! Reads episodes of any format as paths over the viewpoint graph, for commands in which agents walk.

use std::{collections::BTreeMap, path::Path};
use wayword_core::{Platform, SceneId, ViewpointGraph, ViewpointId};
use wayword_formats::{DatasetFormat, Episode, jsonl};
use wayword_run::error::CommandError;

/// Reads the episodes of a file. A path whose frames lie between viewpoints is replaced by the viewpoints nearest to its frames, by
/// straight line. Two of these in a row need not be joined by an edge, and one may lie behind a wall.
///
/// # Errors
/// When the file cannot be read, a scene is unknown, or an episode has neither viewpoints nor frames.
pub fn read_episodes(file: &Path, platform: &dyn Platform) -> Result<Vec<Episode>, CommandError> {
    let episodes = match wayword_formats::detect_format(file)? {
        DatasetFormat::Wayword => {
            let records = jsonl::read_records(file)?;
            let mut episodes = jsonl::episodes_from_records(&records);
            let paths: BTreeMap<&str, &wayword_core::Path> =
                records.iter().map(|record| (record.path.id.as_str(), &record.path)).collect();
            for episode in episodes.iter_mut().filter(|episode| episode.viewpoints.is_empty()) {
                if let Some(path) = paths.get(episode.id.as_str()).filter(|path| path.motion.is_known()) {
                    episode.viewpoints = viewpoints_along_path(platform, path)?;
                }
            }
            episodes
        }
        format => format.read_file(file)?,
    };
    match episodes.iter().find(|episode| episode.viewpoints.is_empty()) {
        Some(without_viewpoints) => Err(CommandError::usage(
            format!("{}: episode {} names no viewpoints, but agents need them", file.display(), without_viewpoints.id),
            "give an R2R, REVERIE, RxR or Wayword file whose paths name viewpoints or have poses",
        )),
        None => Ok(episodes),
    }
}

/// The name of an episode's path. Intervals are clustered by it, because items on one path are not independent.
pub fn episode_path_name(episode: &Episode) -> String {
    path_name(&episode.scene, &episode.path_id)
}

/// The name of a path, unique over all scenes.
pub fn path_name(scene: &SceneId, path_id: &str) -> String {
    format!("{scene}/{path_id}")
}

/// The viewpoints nearest to the frames of a path, without repeats in a row.
///
/// # Errors
/// When its scene is unknown.
pub(crate) fn viewpoints_along_path(
    platform: &dyn Platform,
    path: &wayword_core::Path,
) -> Result<Vec<ViewpointId>, CommandError> {
    let graph = platform.graph_for_scene(&path.scene)?;
    let mut viewpoints: Vec<ViewpointId> =
        path.frames.iter().filter_map(|frame| nearest_viewpoint(&graph, frame.pose.position)).collect();
    viewpoints.dedup();
    Ok(viewpoints)
}

fn nearest_viewpoint(graph: &ViewpointGraph, to: wayword_core::DVec3) -> Option<ViewpointId> {
    let off_m = |id: &&ViewpointId| graph.position_of(id).map_or(f64::INFINITY, |position| position.distance(to));
    graph.viewpoints().min_by(|a, b| off_m(a).total_cmp(&off_m(b))).cloned()
}
