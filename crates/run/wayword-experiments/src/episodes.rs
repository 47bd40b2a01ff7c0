//! Reads episodes of any format as paths over the viewpoint graph, for commands in which agents walk.

use std::{collections::BTreeMap, path::Path};
use wayword_core::{DVec3, Platform, SceneId, ViewpointGraph, ViewpointId};
use wayword_formats::{DatasetFormat, Episode, jsonl};
use wayword_run::{episode_paths::path_for_episode, error::CommandError};

/// The episodes of a file, by whether their way is known.
pub struct SplitEpisodes {
    /// Those whose path goes from one place to another.
    pub known: Vec<Episode>,
    /// Those whose path is one place, as in a test split: their way is hidden, and nothing can be scored for them.
    pub hidden: Vec<Episode>,
}

impl SplitEpisodes {
    /// Refuses a file with hidden ways.
    ///
    /// # Errors
    /// Where there is one, with the first by its id, and `hint`.
    pub fn refuse_hidden(self, file: &Path, hint: &str) -> Result<Vec<Episode>, CommandError> {
        let all = self.known.len() + self.hidden.len();
        let Some(first) = self.hidden.first() else { return Ok(self.known) };
        let problem = format!(
            "{}: the path of {} of {all} items is one place, as in a test split, whose way is hidden; the first is item {}",
            file.display(),
            self.hidden.len(),
            first.id
        );
        Err(CommandError::usage(problem, hint))
    }
}

/// Reads the episodes of a file. A path whose frames lie between viewpoints is replaced by the viewpoints nearest to its frames, by
/// straight line. Two of these in a row need not be joined by an edge, and one may lie behind a wall.
///
/// # Errors
/// When the file cannot be read, a scene is unknown, an episode has neither viewpoints nor frames, or its way is hidden.
pub fn read_episodes(file: &Path, platform: &dyn Platform) -> Result<Vec<Episode>, CommandError> {
    let hint = "give a split whose items have their whole path; of a test split, only its leaderboard knows the way";
    read_split(file, platform)?.refuse_hidden(file, hint)
}

/// As [`read_episodes`], with the episodes whose way is hidden.
///
/// # Errors
/// When the file cannot be read, a scene is unknown, or an episode has neither viewpoints nor frames.
pub fn read_split(file: &Path, platform: &dyn Platform) -> Result<SplitEpisodes, CommandError> {
    let mut episodes = match wayword_formats::detect_format(file)? {
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
    for episode in episodes.iter_mut().filter(|episode| !episode.floor_positions.is_empty()) {
        let path = path_for_episode(platform, episode)?;
        refuse_far_from_graph(platform, &path)?;
        episode.viewpoints = viewpoints_along_path(platform, &path)?;
    }
    if let Some(without_viewpoints) = episodes.iter().find(|episode| episode.viewpoints.is_empty()) {
        return Err(CommandError::usage(
            format!("{}: episode {} names no viewpoints, but agents need them", file.display(), without_viewpoints.id),
            "give an R2R, REVERIE, RxR, VLN-CE or Wayword file whose paths name viewpoints or have poses",
        ));
    }
    let (known, hidden) = episodes.into_iter().partition(Episode::goes_anywhere);
    Ok(SplitEpisodes { known, hidden })
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
    let nearest = |frame: &wayword_core::Frame| nearest_viewpoint(&graph, frame.pose.position);
    let mut viewpoints: Vec<ViewpointId> =
        path.frames.iter().filter_map(nearest).map(|(viewpoint, _)| viewpoint.clone()).collect();
    viewpoints.dedup();
    Ok(viewpoints)
}

/// Refuses positions of VLN-CE that lie nowhere near the viewpoints, as those of another scene or in another frame do.
fn refuse_far_from_graph(platform: &dyn Platform, path: &wayword_core::Path) -> Result<(), CommandError> {
    let graph = platform.graph_for_scene(&path.scene)?;
    for position in path.frames.iter().map(|frame| frame.pose.position) {
        if let Some((_, off_m)) = nearest_viewpoint(&graph, position).filter(|(_, off_m)| *off_m > MAX_OFF_GRAPH_M) {
            let problem = format!(
                "path {}: its place at {:.2}, {:.2}, {:.2} (metres, z up) lies {off_m:.1} m from the nearest viewpoint of scene {}",
                path.id, position.x, position.y, position.z, path.scene
            );
            let hint = "check that the file's positions are in this scene's frame (VLN-CE: Habitat's, y up)";
            return Err(CommandError::usage(problem, hint));
        }
    }
    Ok(())
}

/// A place that lies farther than this from every viewpoint is not on the graph, metres: the radius of a goal.
const MAX_OFF_GRAPH_M: f64 = 3.0;

/// The viewpoint nearest to a position, with its distance, metres.
fn nearest_viewpoint(graph: &ViewpointGraph, to: DVec3) -> Option<(&ViewpointId, f64)> {
    let off_m = |id| graph.position_of(id).map(|position| (id, position.distance(to)));
    graph.viewpoints().filter_map(off_m).min_by(|a, b| a.1.total_cmp(&b.1))
}
