//! The texts of a file with the films that they are about.

use crate::{
    check::path_texts::{PathTexts, read_path_texts},
    error::CommandError,
};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path as FilePath, PathBuf},
};
use wayword_core::{Path, Platform, PlatformError, SceneId};
use wayword_formats::{DatasetFormat, submission::instr_id};

/// The texts about one film.
pub(super) struct FilmTexts {
    /// Their path.
    pub(super) path: FilmPath,
    /// The texts.
    pub(super) texts: Vec<NamedText>,
}

/// The path of a film: known already, or all of a recording, which is opened only when its turn comes.
pub(super) enum FilmPath {
    Known(Path),
    Recording(SceneId),
}

/// A text with its name.
pub(super) struct NamedText {
    pub(super) name: String,
    pub(super) words: String,
    pub(super) tag: Option<String>,
}

impl FilmTexts {
    /// The scene of its film.
    pub(super) fn scene(&self) -> &SceneId {
        match &self.path {
            FilmPath::Known(path) => &path.scene,
            FilmPath::Recording(scene) => scene,
        }
    }

    /// Its path.
    ///
    /// # Errors
    /// When its recording cannot be read, or has gaps.
    pub(super) fn find_path(&self, platform: &dyn Platform) -> Result<Path, PlatformError> {
        match &self.path {
            FilmPath::Known(path) => Ok(path.clone()),
            FilmPath::Recording(scene) => {
                let unknown = || PlatformError::UnknownScene {
                    scene: scene.to_string(),
                    hint: "its recording is gone".to_owned(),
                };
                platform.whole_path(scene)?.ok_or_else(unknown)
            }
        }
    }
}

/// The recordings that the texts of a file are about, if no other place is named: the folder itself, or that of the list.
pub(super) fn place_of_films(file: &FilePath) -> PathBuf {
    if file.is_dir() { file.to_owned() } else { file.parent().unwrap_or(FilePath::new(".")).to_owned() }
}

/// The films of a file with their texts, in the order of the file. On recordings, an episode of any dataset is the recording that has the
/// name of the episode, of its path or of its scene.
///
/// # Errors
/// When the file cannot be read, has no text, or a path does not fit its scene.
pub(super) fn read_film_texts(file: &FilePath, platform: &dyn Platform) -> Result<Vec<FilmTexts>, CommandError> {
    let is_own = wayword_formats::detect_format(file)? == DatasetFormat::Wayword;
    if platform.name() != "recording" || is_own {
        return Ok(read_path_texts(file, platform)?.into_iter().map(FilmTexts::from).collect());
    }
    let known: BTreeSet<SceneId> = platform.list_scenes()?.into_iter().collect();
    let mut films: Vec<FilmTexts> = Vec::new();
    let mut places: BTreeMap<SceneId, usize> = BTreeMap::new();
    for episode in wayword_formats::read_any_format(file)? {
        let named = [episode.scene.as_str(), episode.id.as_str(), episode.path_id.as_str()];
        let scene = named.iter().find_map(|name| known.iter().find(|scene| scene.as_str() == *name)).cloned();
        let scene = scene.ok_or_else(|| {
            let problem = format!(
                "{}: no recording has the name of episode {}, of its path or of its scene",
                file.display(),
                episode.id
            );
            CommandError::usage(
                problem,
                "give the folder with the recordings as --data, one for each episode, with its name",
            )
        })?;
        let texts = episode.instructions.iter().enumerate().map(|(at, words)| NamedText {
            name: instr_id(&episode, at),
            words: words.clone(),
            tag: episode.language_of(at).map(str::to_owned),
        });
        let texts: Vec<NamedText> = texts.collect();
        match places.get(&scene) {
            Some(place) => films[*place].texts.extend(texts),
            None => {
                places.insert(scene.clone(), films.len());
                films.push(FilmTexts { path: FilmPath::Recording(scene), texts });
            }
        }
    }
    films.retain(|film| !film.texts.is_empty());
    if films.is_empty() {
        let problem = format!("{}: there is no instruction in it", file.display());
        return Err(CommandError::usage(problem, "give pairs of recordings and texts"));
    }
    Ok(films)
}

impl From<PathTexts> for FilmTexts {
    fn from(walk: PathTexts) -> Self {
        let texts = walk.texts.into_iter().map(|text| NamedText { name: text.name, words: text.words, tag: text.tag });
        Self { texts: texts.collect(), path: FilmPath::Known(walk.path) }
    }
}
