//! The items of a run: episodes of a dataset, or random paths, which are drawn only when their turn comes.

use crate::{
    episode_paths::{missing_object, path_for_episode},
    error::CommandError,
    settings::{RunSettings, houses},
};
use std::{collections::BTreeSet, path::Path as FilePath, sync::Arc};
use wayword_core::{ObjectId, Path, Platform, PlatformError, SceneId, ViewpointId, seed};
use wayword_formats::Episode;

/// A path to write instructions for.
#[derive(Debug, Clone)]
pub enum RunItem {
    /// An episode of a dataset.
    Episode(Box<Episode>),
    /// A path that is known already.
    Walk(Box<Path>),
    /// A random path.
    Random {
        /// Its name.
        id: String,
        /// All scenes of the run.
        scenes: Arc<[SceneId]>,
        /// Index of its scene. If that scene has no path of the requested length, the next scenes are tried.
        first: usize,
        /// Its own seed.
        seed: u64,
    },
}

/// The items of a run, in their order.
///
/// # Errors
/// When the episodes or their scenes cannot be read, or no item is left.
pub fn run_items(settings: &RunSettings, platform: &dyn Platform) -> Result<Vec<RunItem>, CommandError> {
    let mut items = match &settings.episodes {
        Some(file) => episode_items(file, settings, platform)?,
        None => random_items(settings, platform)?,
    };
    items.truncate(settings.limit.unwrap_or(usize::MAX));
    if items.is_empty() {
        let problem = match settings.scan.is_empty() {
            true => "there are no episodes",
            false => "no episode is in the scenes that --scan names",
        };
        return Err(CommandError::usage(problem, "check --episodes and --scan"));
    }
    platform.files().check_scenes(&items.iter().map(RunItem::scene).collect())?;
    Ok(items)
}

/// The number of items that a run is to have, from its settings alone; `None` where its episodes cannot be read any more, or only
/// the opened platform tells how many of its paths differ.
#[must_use]
pub fn planned_item_count(settings: &RunSettings) -> Option<usize> {
    let number = match &settings.episodes {
        Some(file) => {
            let episodes = wayword_formats::read_any_format(file).ok()?;
            let is_wanted = |scene: &str| settings.scan.is_empty() || settings.scan.iter().any(|scan| scan == scene);
            episodes.iter().filter(|episode| is_wanted(episode.scene.as_str())).count()
        }
        None if settings.platform == RECORDING_PLATFORM && settings.paths > 1 => return None,
        None => settings.paths,
    };
    Some(number.min(settings.limit.unwrap_or(usize::MAX)))
}

fn episode_items(
    file: &FilePath,
    settings: &RunSettings,
    platform: &dyn Platform,
) -> Result<Vec<RunItem>, CommandError> {
    let episodes = wayword_formats::read_any_format(file)?;
    let has_places = |episode: &Episode| {
        !episode.viewpoints.is_empty() || !episode.floor_positions.is_empty() || episode.is_whole_recording
    };
    if let Some(without_places) = episodes.iter().find(|episode| !has_places(episode)) {
        let problem = format!(
            "{}: episode {} names neither viewpoints nor positions, but paths need them",
            file.display(),
            without_places.id
        );
        return Err(CommandError::usage(
            problem,
            "give an R2R, REVERIE, RxR or VLN-CE file, or a Wayword file whose paths name viewpoints (of matterport, say)",
        ));
    }
    if !episodes.is_empty() && !episodes.iter().any(Episode::goes_anywhere) {
        let problem = format!("{}: every path is one place, as in a test split, whose way is hidden", file.display());
        return Err(CommandError::usage(problem, "give a split whose items have their whole path"));
    }
    let wanted =
        |episode: &Episode| settings.scan.is_empty() || settings.scan.iter().any(|scan| scan == episode.scene.as_str());
    // Every scene gets its one official name, because under two names it could come into two splits.
    let with_official_name = |mut episode: Episode| {
        episode.scene = platform.files().canonical_scene(&episode.scene);
        episode
    };
    Ok(episodes
        .into_iter()
        .filter(wanted)
        .map(with_official_name)
        .map(|episode| RunItem::Episode(Box::new(episode)))
        .collect())
}

fn random_items(settings: &RunSettings, platform: &dyn Platform) -> Result<Vec<RunItem>, CommandError> {
    let named = settings.scan.iter().filter(|name| !settings.left_out.contains_key(*name)).map(|name| {
        SceneId::new(name.as_str())
            .map_err(|error| CommandError::usage(format!("--scan {name}: {error}"), "give the name of a scene"))
    });
    let named = named.collect::<Result<Vec<SceneId>, _>>()?;
    // All scenes that cannot be read are told together.
    platform.files().check_scenes(&named.iter().collect())?;
    let mut scenes = Vec::new();
    for scene in &named {
        platform.graph_for_scene(scene)?;
        scenes.push(platform.files().canonical_scene(scene));
    }
    if settings.scan.is_empty() {
        scenes = match houses::asked_houses(settings)? {
            Some(houses) => houses,
            None => platform.list_scenes()?,
        };
    }
    scenes.retain(|scene| !settings.left_out.contains_key(scene.as_str()));
    if scenes.is_empty() {
        return Err(CommandError::usage("the platform has no scene", "check --data"));
    }
    // A single scene without walkable ground is refused here; otherwise every item of the run would fail.
    if let [scene] = &scenes[..] {
        platform.ground().ground_islands(scene)?;
    }
    let scenes: Arc<[SceneId]> = scenes.into();
    let item = |number: usize| RunItem::Random {
        id: format!("random-{}-{number}", settings.seed),
        scenes: Arc::clone(&scenes),
        first: first_scene(number, settings, scenes.len()),
        seed: seed::derive_seed(settings.seed, &["path", &number.to_string()]),
    };
    let number_of_scenes = scenes.len();
    let items: Vec<RunItem> = (0..settings.paths).map(item).collect();
    if platform.name() == RECORDING_PLATFORM && number_of_scenes <= MAX_COMPARED_RECORDINGS {
        return Ok(without_repeats(items, settings, platform));
    }
    Ok(items)
}

/// The platform with random paths that may all be equal: of a short recording, each path is the whole.
pub const RECORDING_PLATFORM: &str = "recording";
/// With more recordings than this, equal paths are not searched for, because all recordings would have to be opened.
const MAX_COMPARED_RECORDINGS: usize = 8;

/// Removes items with the same path as an earlier item. Items without a path stay, so that the run reports the reason.
fn without_repeats(items: Vec<RunItem>, settings: &RunSettings, platform: &dyn Platform) -> Vec<RunItem> {
    let mut taken: BTreeSet<(SceneId, Vec<Option<ViewpointId>>)> = BTreeSet::new();
    let mut is_new = |item: &RunItem| {
        let Ok(path) = item.find_path(settings, platform) else { return true };
        taken.insert((path.scene, path.frames.into_iter().map(|frame| frame.viewpoint).collect()))
    };
    items.into_iter().filter(|item| is_new(item)).collect()
}

/// The index of the scene of a random path. Paths go scene by scene, because a platform keeps only the last few scenes
/// loaded: of 8 paths through 4 scenes, 0 and 1 are in the first. Paths that a later command adds go through the scenes
/// again from the first, so that earlier paths stay in their scenes.
fn first_scene(number: usize, settings: &RunSettings, scenes: usize) -> usize {
    let steps = settings.raised_from.iter().copied().chain([settings.paths]);
    let mut start = 0;
    for end in steps {
        if number < end {
            return (number - start) * scenes / (end - start);
        }
        start = end;
    }
    0
}

impl RunItem {
    /// Its name, unique within the run; known before its path is.
    #[must_use]
    pub fn id(&self) -> String {
        match self {
            Self::Episode(episode) => episode.id.clone(),
            Self::Walk(path) => path.id.clone(),
            Self::Random { id, .. } => id.clone(),
        }
    }

    /// The scene that is tried first.
    pub(crate) fn scene(&self) -> &SceneId {
        match self {
            Self::Episode(episode) => &episode.scene,
            Self::Walk(path) => &path.scene,
            Self::Random { scenes, first, .. } => &scenes[*first],
        }
    }

    /// Its path.
    ///
    /// # Errors
    /// When an episode does not fit its scene, or no scene has a random path of the length asked for.
    pub fn find_path(&self, settings: &RunSettings, platform: &dyn Platform) -> Result<Path, PlatformError> {
        match self {
            Self::Episode(episode) if !episode.goes_anywhere() => {
                Err(PlatformError::OnePlace { episode: episode.id.clone() })
            }
            Self::Episode(episode) => {
                let path = path_for_episode(platform, episode)?;
                match missing_object(platform, &path, episode.target_object.as_ref())? {
                    Some(object) => Err(PlatformError::UnknownObject { scene: path.scene, object }),
                    None => Ok(path),
                }
            }
            Self::Walk(path) => Ok((**path).clone()),
            Self::Random { id, scenes, first: start, seed } => {
                let sample = |scene: &SceneId| platform.sample_path(scene, &settings.request, *seed);
                let mut sampled = (0..scenes.len()).map(|off| sample(&scenes[(start + off) % scenes.len()]));
                let fits = |path: &Result<Path, PlatformError>| !matches!(path, Err(PlatformError::NoSuchPath { .. }));
                let first = sampled.next();
                let path = match first.filter(fits).or_else(|| sampled.find(fits)) {
                    Some(path) => path?,
                    None => sample(&scenes[*start])?,
                };
                Ok(Path { id: id.clone(), ..path })
            }
        }
    }

    /// The instructions that the dataset has for it.
    #[must_use]
    pub fn original_texts(&self) -> &[String] {
        match self {
            Self::Episode(episode) => &episode.instructions,
            Self::Walk(_) | Self::Random { .. } => &[],
        }
    }

    /// The name of its path in its dataset. Several items may share it.
    #[must_use]
    pub fn path_id(&self) -> String {
        match self {
            Self::Episode(episode) => episode.path_id.clone(),
            Self::Walk(path) => path.id.clone(),
            Self::Random { id, .. } => id.clone(),
        }
    }
}

/// Refuses ids that the run folder cannot use, because items are found by them and files are named after them.
///
/// # Errors
/// When two items share an id, or one cannot be part of a file name.
pub fn check_names(items: &[RunItem]) -> Result<(), CommandError> {
    let mut seen = BTreeSet::new();
    for id in items.iter().map(RunItem::id) {
        ObjectId::new(id.as_str()).map_err(|error| {
            CommandError::usage(format!("an item's id cannot be used: {error}"), "change its id in the episodes file")
        })?;
        if !seen.insert(id.clone()) {
            return Err(CommandError::usage(
                format!("item {id} occurs twice"),
                "give each item of the episodes file its own id",
            ));
        }
    }
    Ok(())
}
