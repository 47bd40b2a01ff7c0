//! People's texts with their walks.

use rayon::prelude::*;
use std::{collections::BTreeMap, path::Path};
use wayword::{
    error::Error,
    people::walks,
    platforms,
    settings::{Asked, AskedPlatform},
};
use wayword_core::{SceneId, Survey, Surveyed};
use wayword_follower::{Building, Guide};

/// A building.
pub(crate) struct Scene {
    pub(crate) name: SceneId,
    pub(super) survey: Survey,
    pub(crate) building: Building,
}

/// A text with its walk.
pub(crate) struct Text {
    /// Its building's place in the list.
    pub(crate) scene: usize,
    /// Its words.
    pub(crate) words: String,
    pub(crate) guide: Guide,
    pub(crate) walk: Vec<usize>,
    pub(crate) heading_rad: f64,
    /// For each viewpoint, its distance over the graph from the goal, metres.
    pub(crate) to_goal_m: Vec<f64>,
}

/// A walk that ends nearer than this to the goal succeeds, metres (R2R's evaluator).
const SUCCESS_M: f64 = 3.0;

/// Reads the texts of a file, and surveys their buildings.
pub(crate) fn texts(data: &Path, episodes: &Path) -> Result<(Vec<Scene>, Vec<Text>), Error> {
    let matterport =
        AskedPlatform { platform: Some("matterport".into()), data: Some(data.to_owned()), ..AskedPlatform::default() };
    let platform = platforms::open(&Asked::from(matterport).resolve()?)?;
    let (walks, surveys) = walks(platform.as_ref(), episodes)?;
    let numbers: BTreeMap<SceneId, usize> = surveys.keys().cloned().zip(0..).collect();
    let scenes: Vec<Scene> =
        surveys.into_iter().map(|(name, survey)| Scene { name, building: Building::of(&survey), survey }).collect();
    let texts = walks.par_iter().map(|walk| {
        let scene = numbers[&walk.path.scene];
        let place = |frame: &wayword_core::Frame| scenes[scene].survey.place(frame.viewpoint.as_ref()?);
        let Some(known) = walk.path.frames.iter().map(place).collect::<Option<Vec<usize>>>() else {
            return Ok(Vec::new());
        };
        let viewpoints = scenes[scene].survey.viewpoints();
        let graph = platform.graph(&walk.path.scene)?;
        let far_m = known.last().and_then(|goal| graph.distances_from(&viewpoints[*goal].id).ok()).unwrap_or_default();
        let far_m = |viewpoint: &Surveyed| far_m.get(&viewpoint.id).copied().unwrap_or(f64::INFINITY);
        let to_goal_m: Vec<f64> = viewpoints.iter().map(far_m).collect();
        let heading_rad = walk.path.frames[0].pose.heading.rad();
        let text = |text: &wayword::people::Text| Text {
            scene,
            words: text.words.clone(),
            guide: Guide::read(&text.words),
            walk: known.clone(),
            heading_rad,
            to_goal_m: to_goal_m.clone(),
        };
        Ok(walk.texts.iter().map(text).collect())
    });
    let texts = texts.collect::<Result<Vec<Vec<Text>>, Error>>()?;
    Ok((scenes, texts.into_iter().flatten().filter(|text| text.walk.len() > 1).collect()))
}

impl Text {
    /// Success, and success weighted by path length, of a walk.
    pub(super) fn score(&self, scene: &Scene, walked: &[usize]) -> [f64; 2] {
        let end = walked.last().copied().unwrap_or(self.walk[0]);
        if self.to_goal_m[end] >= SUCCESS_M {
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
