//! Reads people's texts with their walks and buildings.

use rayon::prelude::*;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
    sync::Arc,
};
use wayword_core::{ObjectId, SceneId, Survey, Surveyed, ViewpointGraph};
use wayword_follower::{Building, Guide};
use wayword_formats::Episode;
use wayword_run::{
    error::Error,
    people::episodes,
    platforms,
    settings::{Asked, AskedPlatform},
};
use wayword_world::{path_of, survey};

/// A building as the follower and the platform know it.
pub struct Scene {
    pub name: SceneId,
    pub(super) survey: Survey,
    pub building: Building,
    graph: Arc<ViewpointGraph>,
}

/// A text with its walk.
pub struct Text {
    /// Its building's place in the list.
    pub scene: usize,
    /// Its file's place in the list.
    pub(super) file: usize,
    /// Its words.
    pub words: String,
    pub guide: Guide,
    pub walk: Vec<usize>,
    pub heading_rad: f64,
    /// For each viewpoint, its distance over the graph from the goal, metres.
    pub to_goal_m: Vec<f64>,
    /// For each viewpoint, whether a walk that ends there succeeds: with an object, if the viewpoint sees it (REVERIE's rule), else if it
    /// is near the goal (R2R's rule).
    pub(super) succeeds: Vec<bool>,
}

/// A walk that ends nearer than this to the goal succeeds where there is no object, metres.
pub const SUCCESS_M: f64 = 3.0;

/// Reads the texts of files, one list for each, and surveys their buildings. Paths of buildings that the platform lacks are
/// skipped.
pub fn texts(data: &Path, files: &[PathBuf]) -> Result<(Vec<Scene>, Vec<Vec<Text>>), Error> {
    let matterport =
        AskedPlatform { platform: Some("matterport".into()), data: Some(data.to_owned()), ..AskedPlatform::default() };
    let platform = platforms::open(&Asked::from(matterport).resolve()?)?;
    let platform = platform.as_ref();
    let episodes = files.iter().map(|file| episodes(platform, file)).collect::<Result<Vec<_>, Error>>()?;
    let names: BTreeSet<&SceneId> = episodes.iter().flatten().map(|episode| &episode.scene).collect();
    let scene = |name: &SceneId| {
        let survey = survey(platform, name)?;
        Ok(Scene { name: name.clone(), building: Building::of(&survey), survey, graph: platform.graph(name)? })
    };
    let scenes = names.into_par_iter().map(scene).collect::<Result<Vec<Scene>, Error>>()?;
    let numbers: BTreeMap<&SceneId, usize> = scenes.iter().map(|scene| &scene.name).zip(0..).collect();
    let of_episode = |episode: &Episode| {
        let number = numbers[&episode.scene];
        let object = episode.target_object.as_ref();
        let heading = episode.start_heading;
        let path = path_of(platform, &episode.id, &episode.scene, &episode.viewpoints, heading, None)?;
        let heading_rad = path.frames.first().map_or(0.0, |frame| frame.pose.heading.rad());
        Ok(scenes[number].texts(number, episode, heading_rad, object))
    };
    let of_file = |episodes: &Vec<Episode>| {
        let texts = episodes.par_iter().map(of_episode).collect::<Result<Vec<Vec<Text>>, Error>>()?;
        Ok(texts.into_iter().flatten().collect())
    };
    let texts = episodes.iter().map(of_file).collect::<Result<Vec<Vec<Text>>, Error>>()?;
    drop(numbers);
    Ok((scenes, texts))
}

impl Scene {
    /// The texts of an episode; none where its walk has no hop.
    fn texts(&self, number: usize, episode: &Episode, heading_rad: f64, object: Option<&ObjectId>) -> Vec<Text> {
        let viewpoints = self.survey.viewpoints();
        let walk = episode.viewpoints.iter().map(|id| self.survey.place(id)).collect::<Option<Vec<usize>>>();
        let (Some(walk), Some(goal)) = (walk.filter(|walk| walk.len() > 1), episode.viewpoints.last()) else {
            return Vec::new();
        };
        let far_m = self.graph.distances_from(goal).unwrap_or_default();
        let far_m = |viewpoint: &Surveyed| far_m.get(&viewpoint.id).copied().unwrap_or(f64::INFINITY);
        let to_goal_m: Vec<f64> = viewpoints.iter().map(far_m).collect();
        let sees = |viewpoint: &Surveyed, object: &ObjectId| {
            viewpoint.known.things.iter().flatten().any(|label| label.object == *object)
        };
        let succeeds: Vec<bool> = match object {
            Some(object) => viewpoints.iter().map(|viewpoint| sees(viewpoint, object)).collect(),
            None => to_goal_m.iter().map(|far_m| *far_m < SUCCESS_M).collect(),
        };
        let text = |words: &String| Text {
            scene: number,
            file: 0,
            words: words.clone(),
            guide: Guide::read(words),
            walk: walk.clone(),
            heading_rad,
            to_goal_m: to_goal_m.clone(),
            succeeds: succeeds.clone(),
        };
        episode.instructions.iter().map(text).collect()
    }
}

impl Text {
    /// Success, and success weighted by path length, of a walk.
    pub(super) fn score(&self, scene: &Scene, walked: &[usize]) -> [f64; 2] {
        let end = walked.last().copied().unwrap_or(self.walk[0]);
        if !self.succeeds[end] {
            return [0.0; 2];
        }
        let length_m: f64 = walked.windows(2).map(|pair| scene.building.distance(pair[0], pair[1])).sum();
        let shortest_m = self.to_goal_m[self.walk[0]];
        [1.0, if length_m > 0.0 { shortest_m / shortest_m.max(length_m) } else { 1.0 }]
    }
}

/// The means of success and SPL, in words.
pub(super) fn mean(scores: impl IndexedParallelIterator<Item = [f64; 2]>) -> String {
    let count = scores.len().max(1) as f64;
    let [success, spl] = scores.reduce(|| [0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
    format!("SR {:.1} %, SPL {:.1} %", 100.0 * success / count, 100.0 * spl / count)
}
