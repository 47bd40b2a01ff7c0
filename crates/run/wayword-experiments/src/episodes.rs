//! Reads episodes of any format as paths over the viewpoint graph, for commands in which agents walk.

use std::{collections::BTreeMap, path::Path};
use wayword_core::{DVec3, Frame, Platform, Pose, SceneId, ViewpointGraph, ViewpointId};
use wayword_formats::{DatasetFormat, Episode, jsonl};
use wayword_run::{episode_paths::path_for_episode, error::CommandError};
use wayword_world::route_along_frames;

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

/// Reads the episodes of a file. A path whose frames lie between viewpoints is replaced by the route over the viewpoint graph that follows
/// it.
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

/// The route over the viewpoint graph that follows a path, see [`route_along_frames`]. It begins and ends at the viewpoints that are
/// nearest over the ground to the ends of the path.
///
/// # Errors
/// When its scene is unknown.
pub(crate) fn viewpoints_along_path(
    platform: &dyn Platform,
    path: &wayword_core::Path,
) -> Result<Vec<ViewpointId>, CommandError> {
    let graph = platform.graph_for_scene(&path.scene)?;
    let mut frames = path.frames.clone();
    let ends = [0, frames.len().saturating_sub(1)];
    for end in ends {
        if let Some(frame) = frames.get_mut(end).filter(|frame| frame.viewpoint.is_none()) {
            frame.viewpoint = nearest_over_ground(platform, &path.scene, &graph, frame)?;
        }
    }
    Ok(route_along_frames(&graph, &frames))
}

/// How many of the viewpoints that are nearest by straight line are compared over the ground: a nearer one may lie behind a wall.
const MAX_NEAR_VIEWPOINTS: usize = 4;

/// The viewpoint nearest to a frame over the ground, or by straight line where the platform does not know the ground.
fn nearest_over_ground(
    platform: &dyn Platform,
    scene: &SceneId,
    graph: &ViewpointGraph,
    frame: &Frame,
) -> Result<Option<ViewpointId>, CommandError> {
    let off_m = |id: &&ViewpointId| graph.position_of(id).map_or(f64::INFINITY, |at| at.distance(frame.pose.position));
    let mut near: Vec<&ViewpointId> = graph.viewpoints().collect();
    near.sort_by(|a, b| off_m(a).total_cmp(&off_m(b)));
    near.truncate(MAX_NEAR_VIEWPOINTS);
    let mut nearest: Option<(&ViewpointId, f64)> = None;
    for id in &near {
        // No way is shorter than the straight line.
        if nearest.is_some_and(|(_, least_m)| least_m <= off_m(id)) {
            break;
        }
        let Some(position) = graph.position_of(id) else { continue };
        let pose = Pose::looking_level(position, frame.pose.heading);
        let there = Frame { pose, viewpoint: Some((*id).clone()), level: graph.level_of(id) };
        let way = platform.ground().ground_route(scene, frame, &there)?;
        if let Some(way) = way.filter(|way| nearest.is_none_or(|(_, least_m)| way.length_m < least_m)) {
            nearest = Some((*id, way.length_m));
        }
    }
    Ok(nearest.map(|(id, _)| id).or(near.first().copied()).cloned())
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

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::PathRequest;
    use wayword_house::HousePlatform;
    use wayword_metrics::{GraphRoute, survey_walks};

    /// The routes of three paths in each of some houses.
    fn house_routes(platform: &HousePlatform, houses: std::ops::Range<u64>) -> Vec<GraphRoute> {
        let scenes = houses.map(|house| HousePlatform::scene_of(house).unwrap());
        let routes = scenes.flat_map(|scene| {
            (0..3).map(move |seed| {
                let path = platform.sample_path(&scene, &PathRequest::default(), seed).unwrap();
                let viewpoints = viewpoints_along_path(platform, &path).unwrap();
                GraphRoute { scene: scene.clone(), viewpoints }
            })
        });
        routes.collect()
    }

    #[test]
    fn the_graph_of_houses_stands_for_their_ground() {
        let platform = HousePlatform::default();
        // More houses take longer: HOUSES=24 made the figures of the documents.
        let houses = std::env::var("HOUSES").ok().and_then(|houses| houses.parse().ok()).unwrap_or(4);
        let survey = survey_walks(&platform, &house_routes(&platform, 300..300 + houses), 1).unwrap();
        assert_eq!(survey.edge_steps, survey.route_steps);
        assert!(100 * survey.zero_edges <= survey.edges, "{survey:?}");
        assert!(100 * survey.near_goal_arrived >= 90 * survey.near_goal, "{survey:?}");
        assert!(100 * survey.close_unjoined <= 5 * survey.close_pairs, "{survey:?}");
        assert!(survey.detour_median.is_some_and(|detour| detour < 1.1), "{survey:?}");
    }
}
