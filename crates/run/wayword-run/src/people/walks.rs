//! Reads the buildings, paths and texts of a dataset that weights are fitted on.

use crate::{episode_paths::path_for_episode, error::CommandError, pipeline::path_panoramas};
use rayon::prelude::*;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path as FilePath,
    sync::Arc,
};
use wayword_checks::{BuildingInventory, Evidence, PathSurroundings, open};
use wayword_core::{Path, Platform, SceneId, ViewpointSurvey};
use wayword_formats::Episode;
use wayword_language::{
    lexicon::normalise_name,
    reading::{TextReading, read_instruction},
};
use wayword_world::survey_scene;

/// The surveys of the scenes.
pub type SceneSurveys = BTreeMap<SceneId, ViewpointSurvey>;

/// A path with its evidence and its texts.
pub struct PeopleWalk {
    /// The path.
    pub path: Path,
    /// The evidence along its frames.
    pub evidence: Evidence,
    /// The objects that are listed around it.
    pub around: Option<PathSurroundings>,
    /// Its texts.
    pub texts: Vec<PeopleText>,
}

/// A text with its claims.
pub struct PeopleText {
    /// Its words.
    pub words: String,
    /// Its reading by the rules of the language.
    pub reading: TextReading,
    /// The places that it claims.
    pub claims: Vec<open::PlaceClaim>,
}

/// The buildings that are left out of every fit, to test it on unseen buildings: the last ten of the file by name.
#[must_use]
pub fn left_out(scenes: &BTreeSet<SceneId>) -> BTreeSet<SceneId> {
    scenes.iter().rev().take(10).cloned().collect()
}

/// Reads the episodes of a file that lie in scenes of a platform.
///
/// # Errors
/// When the file or the platform's data cannot be read.
pub fn read_episodes(platform: &dyn Platform, file: &FilePath) -> Result<Vec<Episode>, CommandError> {
    let there: BTreeSet<SceneId> = platform.list_scenes()?.into_iter().collect();
    let mut episodes = wayword_formats::read_any_format(file)?;
    episodes.retain(|episode| there.contains(&episode.scene));
    Ok(episodes)
}

/// Reads the walks of a file. Paths of scenes that the platform lacks are skipped.
///
/// # Errors
/// When the file or the platform's data cannot be read, or a path does not fit its scene.
pub fn read_people_walks(
    platform: &dyn Platform,
    file: &FilePath,
) -> Result<(Vec<PeopleWalk>, SceneSurveys), CommandError> {
    let episodes = read_episodes(platform, file)?;
    let scenes: BTreeSet<&SceneId> = episodes.iter().map(|episode| &episode.scene).collect();
    let surveys = scenes
        .into_par_iter()
        .map(|scene| Ok((scene.clone(), survey_scene(platform, scene)?)))
        .collect::<Result<SceneSurveys, CommandError>>()?;
    let buildings: BTreeMap<&SceneId, Arc<BuildingInventory>> =
        surveys.iter().map(|(scene, survey)| (scene, Arc::new(BuildingInventory::from_survey(survey)))).collect();
    let walk = |episode: &Episode| {
        let path = Path { target: None, ..path_for_episode(platform, episode)? };
        let views = path_panoramas(platform, &path)?;
        let evidence = Evidence::from_labels(&path, &views).unwrap_or_else(|| Evidence::for_path_alone(&path));
        let around = PathSurroundings::around_path(&buildings[&episode.scene], &path);
        let things =
            evidence.frames.iter().flat_map(|frame| frame.things.iter().map(|thing| normalise_name(&thing.name)));
        let known: BTreeSet<String> = things.filter(|name| !name.is_empty()).collect();
        let texts = episode.instructions.iter().map(|words| {
            let reading = read_instruction(words, &known).into_claims();
            let claims = open::read_claims(&reading);
            PeopleText { words: words.clone(), reading, claims }
        });
        let texts = texts.collect();
        Ok(PeopleWalk { path, evidence, around, texts })
    };
    let walks = episodes.par_iter().map(walk).collect::<Result<_, CommandError>>()?;
    Ok((walks, surveys))
}
