//! Reads people's texts with their walks and buildings.

use crate::matterport::open_matterport;
use rayon::prelude::*;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
    sync::Arc,
};
use wayword_core::{
    DVec3, ObjectId, Platform, SceneId, SurveyedViewpoint, ViewpointGraph, ViewpointId, ViewpointSurvey,
};
use wayword_follower::{Guide, KnownBuilding};
use wayword_formats::Episode;
use wayword_run::{error::CommandError, people::read_episodes};
use wayword_world::{path_over_viewpoints, survey_scene};

/// A building as the follower and the platform know it.
pub struct FollowerScene {
    /// Its name.
    pub name: SceneId,
    /// The labels and positions of its viewpoints.
    pub(super) survey: ViewpointSurvey,
    /// The building as the follower knows it.
    pub building: KnownBuilding,
    /// Gives the distances to a goal.
    graph: Arc<ViewpointGraph>,
}

/// A text with its walk.
pub struct WalkedText {
    /// The index of its building in the list of scenes.
    pub scene: usize,
    /// The index of its file in the list of files.
    pub(super) file: usize,
    /// Its words.
    pub words: String,
    /// What the follower reads in the words.
    pub guide: Guide,
    /// The annotated walk: numbers of viewpoints in the survey of the building.
    pub walk: Vec<usize>,
    /// The heading at its start, radians.
    pub heading_rad: f64,
    /// For each viewpoint, its distance over the graph from the goal, metres.
    pub to_goal_m: Vec<f64>,
    /// For each viewpoint, whether a walk that ends there succeeds. If the text has a target object, the object must be visible from
    /// the viewpoint (REVERIE's rule). Otherwise the viewpoint must be near the goal (R2R's rule).
    pub(super) succeeds: Vec<bool>,
}

/// A walk that ends nearer than this to the goal succeeds where there is no object, metres.
pub const SUCCESS_M: f64 = 3.0;

/// Reads the texts of files, one list for each, and surveys their buildings. Paths of buildings that the platform lacks are
/// skipped.
///
/// # Errors
/// When the data or a file cannot be read.
pub fn read_texts(data: &Path, files: &[PathBuf]) -> Result<(Vec<FollowerScene>, Vec<Vec<WalkedText>>), CommandError> {
    let platform = open_matterport(data)?;
    let platform = platform.as_ref();
    let episodes = files.iter().map(|file| read_episodes(platform, file)).collect::<Result<Vec<_>, CommandError>>()?;
    let names: BTreeSet<&SceneId> = episodes.iter().flatten().map(|episode| &episode.scene).collect();
    let scenes = survey_scenes(platform, &names)?;
    let numbers: BTreeMap<&SceneId, usize> = scenes.iter().map(|scene| &scene.name).zip(0..).collect();
    let texts_of_episode = |episode: &Episode| {
        let number = numbers[&episode.scene];
        let object = episode.target_object.as_ref();
        let heading = episode.start_heading;
        let path = path_over_viewpoints(platform, &episode.id, &episode.scene, &episode.viewpoints, heading, None)?;
        let heading_rad = path.frames.first().map_or(0.0, |frame| frame.pose.heading.rad());
        Ok(scenes[number].episode_texts(number, episode, heading_rad, object))
    };
    let texts_of_file = |episodes: &Vec<Episode>| {
        let texts =
            episodes.par_iter().map(texts_of_episode).collect::<Result<Vec<Vec<WalkedText>>, CommandError>>()?;
        Ok(texts.into_iter().flatten().collect())
    };
    let texts = episodes.iter().map(texts_of_file).collect::<Result<Vec<Vec<WalkedText>>, CommandError>>()?;
    drop(numbers);
    Ok((scenes, texts))
}

/// Surveys buildings.
///
/// # Errors
/// When the data of a building cannot be read.
pub fn read_scenes(data: &Path, names: &BTreeSet<&SceneId>) -> Result<Vec<FollowerScene>, CommandError> {
    survey_scenes(open_matterport(data)?.as_ref(), names)
}

fn survey_scenes(platform: &dyn Platform, names: &BTreeSet<&SceneId>) -> Result<Vec<FollowerScene>, CommandError> {
    let scene = |name: &&SceneId| {
        let survey = survey_scene(platform, name)?;
        Ok(FollowerScene {
            name: (*name).clone(),
            building: KnownBuilding::from_survey(&survey),
            survey,
            graph: platform.graph_for_scene(name)?,
        })
    };
    names.par_iter().map(scene).collect()
}

impl FollowerScene {
    /// The number of a viewpoint in the building; `None` if the building lacks it.
    #[must_use]
    pub fn viewpoint_number(&self, id: &ViewpointId) -> Option<usize> {
        self.survey.viewpoint_index(id)
    }

    /// The position of a viewpoint by its number, metres.
    #[must_use]
    pub fn position(&self, viewpoint: usize) -> DVec3 {
        self.survey.viewpoints()[viewpoint].position
    }

    /// The texts of an episode; none if its walk has no hop or a viewpoint is unknown. `number` is the index of this scene.
    fn episode_texts(
        &self,
        number: usize,
        episode: &Episode,
        heading_rad: f64,
        object: Option<&ObjectId>,
    ) -> Vec<WalkedText> {
        let viewpoints = self.survey.viewpoints();
        let walk = episode.viewpoints.iter().map(|id| self.survey.viewpoint_index(id)).collect::<Option<Vec<usize>>>();
        let (Some(walk), Some(goal)) = (walk.filter(|walk| walk.len() > 1), episode.viewpoints.last()) else {
            return Vec::new();
        };
        let distances_m = self.graph.distances_from(goal).unwrap_or_default();
        let far_m = |viewpoint: &SurveyedViewpoint| distances_m.get(&viewpoint.id).copied().unwrap_or(f64::INFINITY);
        let to_goal_m: Vec<f64> = viewpoints.iter().map(far_m).collect();
        let sees = |viewpoint: &SurveyedViewpoint, object: &ObjectId| {
            viewpoint.known.things.iter().flatten().any(|label| label.object == *object)
        };
        let succeeds: Vec<bool> = match object {
            Some(object) => viewpoints.iter().map(|viewpoint| sees(viewpoint, object)).collect(),
            None => to_goal_m.iter().map(|far_m| *far_m < SUCCESS_M).collect(),
        };
        let text = |words: &String| WalkedText {
            scene: number,
            file: 0,
            words: words.clone(),
            guide: Guide::read_text(words),
            walk: walk.clone(),
            heading_rad,
            to_goal_m: to_goal_m.clone(),
            succeeds: succeeds.clone(),
        };
        episode.instructions.iter().map(text).collect()
    }
}

impl WalkedText {
    /// Success (0 or 1) and SPL, success weighted by path length, of a walk. `walked` are viewpoints by number.
    pub(super) fn score_walk(&self, scene: &FollowerScene, walked: &[usize]) -> [f64; 2] {
        let end = walked.last().copied().unwrap_or(self.walk[0]);
        if !self.succeeds[end] {
            return [0.0; 2];
        }
        let length_m: f64 = walked.windows(2).map(|pair| scene.building.distance_m(pair[0], pair[1])).sum();
        let shortest_m = self.to_goal_m[self.walk[0]];
        [1.0, if length_m > 0.0 { shortest_m / shortest_m.max(length_m) } else { 1.0 }]
    }
}

/// The means of success and SPL over all scores, as `SR 50.0 %, SPL 40.0 %`.
pub(super) fn mean_scores(scores: impl IndexedParallelIterator<Item = [f64; 2]>) -> String {
    let count = scores.len().max(1) as f64;
    let [success, spl] = scores.reduce(|| [0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
    format!("SR {:.1} %, SPL {:.1} %", 100.0 * success / count, 100.0 * spl / count)
}
