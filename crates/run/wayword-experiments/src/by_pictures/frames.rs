//! The pictures ahead of a path's frames. They come from the folder of a run that stored them, or a platform draws them anew.

use crate::{by_pictures::args::PictureCriticArgs, episodes};
use serde::Deserialize;
use std::{
    collections::BTreeMap,
    path::{Path as FilePath, PathBuf},
    sync::Arc,
};
use wayword_core::{Path, Platform, SceneId, View, ViewGaze};
use wayword_formats::{DatasetFormat, Episode, jsonl};
use wayword_run::{
    error::CommandError,
    pictures, platforms,
    run_folder::{file, read_lines, refuse_other_format},
    settings::RunSettings,
};
use wayword_world::path_over_viewpoints;

/// Gives the pictures ahead of the frames of any item's path.
pub struct PathPictures {
    source: FramePictureSource,
    /// The path of each item, by the item's id.
    items: BTreeMap<String, ItemPathSource>,
    /// The id of one item on each path, by the path's name. It finds the pictures for an item of another dataset,
    /// which has another id but the same path.
    paths: BTreeMap<String, String>,
}

/// Where the pictures come from.
enum FramePictureSource {
    /// The folder in which a run stored its pictures.
    Run(PathBuf),
    /// A platform that draws the pictures when they are asked for.
    Platform(Box<dyn Platform>),
}

/// The path of an item, or the episode that it is computed from.
enum ItemPathSource {
    Known(Box<Path>),
    /// The path still has to be computed from the episode and its scene.
    Episode(Box<Episode>),
}

/// The fields that are needed from a line of `walks.jsonl`.
#[derive(Deserialize)]
struct PicturedWalkEntry {
    path: Path,
    has_pictures: bool,
}

/// The fields that are needed from a line of `instructions.jsonl`.
#[derive(Deserialize)]
struct PicturedTextEntry {
    path: WrittenPath,
    path_id: Option<String>,
}

#[derive(Deserialize)]
struct WrittenPath {
    id: String,
    scene: SceneId,
}

impl PathPictures {
    /// Opens the pictures that the flags ask for. Without such flags, the first of `runs` that has pictures supplies them.
    ///
    /// # Errors
    /// When there are none, or the files or the platform cannot be read.
    pub(super) fn open(asked: &PictureCriticArgs, runs: &[PathBuf], file: &FilePath) -> Result<Self, CommandError> {
        if let Some(run) = &asked.pictures {
            return Self::from_run(run);
        }
        let platform = &asked.platform;
        if platform.platform.is_some() || platform.data.is_some() || platform.at.is_some() {
            let opened = platforms::open_and_warn(platform.name(), platform.into())?;
            return Self::from_platform(opened, file);
        }
        match runs.iter().find(|run| run.join(file::FRAMES).is_dir()) {
            Some(run) => Self::from_run(run),
            None => Err(CommandError::usage(
                "--clip: it is not known where the pictures are",
                "give a run that has pictures with --pictures RUN, or a platform that draws them with --platform",
            )),
        }
    }

    /// The pictures that a run stored in its folder.
    ///
    /// # Errors
    /// When the folder holds no run, or the run has no pictures.
    pub fn from_run(run: &FilePath) -> Result<Self, CommandError> {
        let walks = run.join(file::WALKS);
        if !walks.is_file() {
            let problem = format!("{}: there is no run in it, so it has no pictures", run.display());
            return Err(CommandError::usage(problem, "give a folder that `wayword generate` made"));
        }
        refuse_other_format::<RunSettings>(run)?;
        let walked: Vec<PicturedWalkEntry> = read_lines(&walks)?;
        let pictured = walked.into_iter().filter(|walk| walk.has_pictures).map(|walk| walk.path);
        let items: BTreeMap<String, ItemPathSource> =
            pictured.map(|path| (path.id.clone(), ItemPathSource::Known(Box::new(path)))).collect();
        if items.is_empty() {
            let problem = format!("{}: this run has no pictures", run.display());
            return Err(CommandError::usage(
                problem,
                "`wayword platforms` says which platforms have pictures, and what they need",
            ));
        }
        let mut paths = BTreeMap::new();
        for PicturedTextEntry { path, path_id } in read_lines(&run.join(file::INSTRUCTIONS))? {
            if items.contains_key(&path.id) {
                let name = episodes::path_name(&path.scene, path_id.as_ref().unwrap_or(&path.id));
                paths.entry(name).or_insert(path.id);
            }
        }
        Ok(Self { source: FramePictureSource::Run(run.join(file::FRAMES)), items, paths })
    }

    /// The pictures that a platform draws along the paths of a file.
    ///
    /// # Errors
    /// When the file cannot be read, or its paths have neither frames nor viewpoints.
    pub fn from_platform(platform: Box<dyn Platform>, file: &FilePath) -> Result<Self, CommandError> {
        let (mut items, mut paths) = (BTreeMap::new(), BTreeMap::new());
        if wayword_formats::detect_format(file)? == DatasetFormat::Wayword {
            for record in jsonl::read_records(file)? {
                let name = episodes::path_name(&record.path.scene, &record.path_id());
                paths.entry(name).or_insert_with(|| record.path.id.clone());
                items.entry(record.path.id.clone()).or_insert_with(|| ItemPathSource::Known(Box::new(record.path)));
            }
        } else {
            for episode in episodes::read_episodes(file, &*platform)? {
                paths.entry(episodes::episode_path_name(&episode)).or_insert_with(|| episode.id.clone());
                items.entry(episode.id.clone()).or_insert_with(|| ItemPathSource::Episode(Box::new(episode)));
            }
        }
        Ok(Self { source: FramePictureSource::Platform(platform), items, paths })
    }

    /// The pictures of an item in the order of its frames. If the item is not known, those of an item on the same path
    /// ([`episodes::path_name`]). Empty if there are none.
    ///
    /// # Errors
    /// When a picture is missing or damaged, or the platform cannot draw it.
    pub fn views_for_item(&self, item: &str, path: &str) -> Result<Vec<View>, CommandError> {
        let path_source = self.items.get(item).or_else(|| self.items.get(self.paths.get(path)?));
        match (&self.source, path_source) {
            (FramePictureSource::Run(folder), Some(ItemPathSource::Known(path))) => read_kept_views(folder, path),
            (FramePictureSource::Platform(platform), Some(ItemPathSource::Known(path))) => {
                draw_views(&**platform, path)
            }
            (FramePictureSource::Platform(platform), Some(ItemPathSource::Episode(episode))) => {
                let Episode { id, scene, viewpoints, start_heading, .. } = &**episode;
                draw_views(
                    &**platform,
                    &path_over_viewpoints(&**platform, id.as_str(), scene, viewpoints, *start_heading, None)?,
                )
            }
            (FramePictureSource::Run(_), Some(ItemPathSource::Episode(_))) | (_, None) => Ok(Vec::new()),
        }
    }
}

/// Reads the pictures of a path from the folder in which a run stored them.
fn read_kept_views(folder: &FilePath, path: &Path) -> Result<Vec<View>, CommandError> {
    let view = |(number, frame): (usize, &wayword_core::Frame)| {
        let pixels = pictures::read_picture(folder, &path.id, number, pictures::MAX_PICTURE_BYTES)
            .and_then(|stored| stored.decode_pixels());
        let Some(image) = pixels else {
            let problem =
                format!("{}: it is missing or damaged", pictures::picture_file(folder, &path.id, number).display());
            return Err(CommandError::usage(
                problem,
                "give the run's command again: it makes pictures that are missing",
            ));
        };
        let gaze = ViewGaze::quarter_view(frame.pose.heading);
        Ok(View::new(frame.pose, gaze.horizontal_fov_rad, Some(Arc::new(image)), None))
    };
    path.frames.iter().enumerate().map(view).collect()
}

fn draw_views(platform: &dyn Platform, path: &Path) -> Result<Vec<View>, CommandError> {
    let mut views = Vec::new();
    for frame in &path.frames {
        let view = platform.look_from(&path.scene, frame, ViewGaze::quarter_view(frame.pose.heading))?;
        // A recording has no picture for a direction in which its camera did not look.
        if view.image.is_some() {
            views.push(view);
        }
    }
    Ok(views)
}
