//! Reads the buildings, paths and texts of a dataset that weights are fitted on.

use crate::{error::Error, pipeline::panoramas};
use rayon::prelude::*;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path as FilePath,
    sync::Arc,
};
use wayword_checks::{Building, Evidence, Surroundings, open};
use wayword_core::{Path, Platform, SceneId, Survey};
use wayword_formats::Episode;
use wayword_language::{
    lexicon::normal,
    reading::{Reading, read},
};
use wayword_world::{path_of, survey};

/// The surveys of the scenes.
pub type Surveys = BTreeMap<SceneId, Survey>;

/// A path with its evidence and its texts.
pub struct Walk {
    /// The path.
    pub path: Path,
    /// The evidence along its frames.
    pub evidence: Evidence,
    /// The objects that are listed around it.
    pub around: Option<Surroundings>,
    /// Its texts.
    pub texts: Vec<Text>,
}

/// A text with its claims.
pub struct Text {
    /// Its words.
    pub words: String,
    /// Its reading by the rules of the language.
    pub reading: Reading,
    /// The places that it claims.
    pub claims: Vec<open::Claim>,
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
pub fn episodes(platform: &dyn Platform, file: &FilePath) -> Result<Vec<Episode>, Error> {
    let there: BTreeSet<SceneId> = platform.scenes()?.into_iter().collect();
    let mut episodes = wayword_formats::read(file)?;
    episodes.retain(|episode| there.contains(&episode.scene));
    Ok(episodes)
}

/// Reads the walks of a file. Paths of scenes that the platform lacks are skipped.
///
/// # Errors
/// When the file or the platform's data cannot be read, or a path does not fit its scene.
pub fn walks(platform: &dyn Platform, file: &FilePath) -> Result<(Vec<Walk>, Surveys), Error> {
    let episodes = episodes(platform, file)?;
    let scenes: BTreeSet<&SceneId> = episodes.iter().map(|episode| &episode.scene).collect();
    let surveys = scenes
        .into_par_iter()
        .map(|scene| Ok((scene.clone(), survey(platform, scene)?)))
        .collect::<Result<Surveys, Error>>()?;
    let buildings: BTreeMap<&SceneId, Arc<Building>> =
        surveys.iter().map(|(scene, survey)| (scene, Arc::new(Building::of(survey)))).collect();
    let walk = |episode: &Episode| {
        let path = path_of(platform, &episode.id, &episode.scene, &episode.viewpoints, episode.start_heading, None)?;
        let views = panoramas(platform, &path)?;
        let evidence = Evidence::from_labels(&path, &views).unwrap_or_else(|| Evidence::of_path_alone(&path));
        let around = Surroundings::of(&buildings[&episode.scene], &path);
        let things = evidence.frames.iter().flat_map(|frame| frame.things.iter().map(|thing| normal(&thing.name)));
        let known: BTreeSet<String> = things.filter(|name| !name.is_empty()).collect();
        let texts = episode.instructions.iter().map(|words| {
            let reading = read(words, &known).claims();
            let claims = open::claims(&reading);
            Text { words: words.clone(), reading, claims }
        });
        let texts = texts.collect();
        Ok(Walk { path, evidence, around, texts })
    };
    let walks = episodes.par_iter().map(walk).collect::<Result<_, Error>>()?;
    Ok((walks, surveys))
}
