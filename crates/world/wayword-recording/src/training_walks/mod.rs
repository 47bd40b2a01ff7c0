//! Walks of training data for navigation policies as recordings: StreamVLN's, NaVILA's, and InternNav's. `wayword_formats::training`
//! reads the texts about them.

#[cfg(feature = "lerobot")]
mod internnav;
mod motion;
#[cfg(feature = "lerobot")]
mod pose_column;

#[cfg(feature = "lerobot")]
pub(crate) use internnav::open_internnav;

use crate::{
    describe::{FOLDER_FILE, RecordingDescription},
    folder::FolderReel,
    names::{is_picture_name, plain_files, sorted_entries, unknown_scene},
    reel::{Recording, RecordingSource},
};
use motion::WalkMotion;
use std::path::{Path, PathBuf};
use wayword_core::{PlatformError, SceneId};
use wayword_formats::{
    DatasetFormat, FormatError, detect_format,
    training::{navila::read_navila_walks, streamvln::read_streamvln_file},
};
use wayword_world::files;

/// The file of StreamVLN's and NaVILA's walks.
const ANNOTATIONS_FILE: &str = "annotations.json";
/// Folders beside NaVILA's file in which its pictures may lie.
const NAVILA_FOLDERS: [&str; 4] = ["frames", "train", "images", "."];
const LAYOUT_HINT: &str = "docs/FORMATS.md says how this layout lies in its folder";
/// Pictures of one second, where nothing gives their times.
const PICTURES_PER_S: f64 = 1.0;

/// A folder of walks.
pub(crate) struct TrainingWalks {
    root: PathBuf,
    described: RecordingDescription,
    /// The file that lists the walks.
    list: PathBuf,
    /// Sorted by name.
    walks: Vec<TrainingWalk>,
}

/// A walk with a picture before each action.
struct TrainingWalk {
    scene: SceneId,
    pictures: Vec<PathBuf>,
    motion: WalkMotion,
}

/// Opens a folder with StreamVLN's or NaVILA's `annotations.json`; `None` if it has none.
///
/// # Errors
/// When the file is of one of these layouts and breaks a rule, or a folder of pictures cannot be read.
pub(crate) fn open_annotated(root: &Path) -> Result<Option<TrainingWalks>, PlatformError> {
    let list = root.join(ANNOTATIONS_FILE);
    if !list.is_file() {
        return Ok(None);
    }
    let walks = match detect_format(&list) {
        Ok(DatasetFormat::Streamvln) => streamvln_walks(root, &list)?,
        Ok(DatasetFormat::Navila) => navila_walks(root, &list)?,
        // Another program's notes beside pictures.
        _ => return Ok(None),
    };
    TrainingWalks::new(root, list, walks).map(Some)
}

fn streamvln_walks(root: &Path, list: &Path) -> Result<Vec<TrainingWalk>, PlatformError> {
    let walks = read_streamvln_file(list).map_err(|error| wrong_list(list, &error))?;
    let walk = |walk: wayword_formats::training::streamvln::StreamVlnWalk| {
        let folder = root.join(&walk.video).join("rgb");
        let mut names = sorted_entries(&folder)?;
        names.retain(|name| is_picture_name(name));
        let scene = scene_of(list, walk.scene_name())?;
        expect_pictures(&folder, names.len(), walk.actions.len())?;
        let pictures = names.iter().map(|name| folder.join(name)).collect();
        Ok(TrainingWalk { scene, pictures, motion: WalkMotion::Actions(walk.actions) })
    };
    walks.into_iter().map(walk).collect()
}

fn navila_walks(root: &Path, list: &Path) -> Result<Vec<TrainingWalk>, PlatformError> {
    let mut walks: Vec<TrainingWalk> = Vec::new();
    for walk in read_navila_walks(list).map_err(|error| wrong_list(list, &error))? {
        let scene = scene_of(list, &walk.video_id)?;
        if walks.iter().any(|known| known.scene == scene) {
            continue;
        }
        let place = walk.frames.first().and_then(|first| {
            NAVILA_FOLDERS.map(|folder| root.join(folder)).into_iter().find(|folder| folder.join(first).is_file())
        });
        let Some(place) = place else {
            let reason = format!("the pictures of {scene} are in none of the folders beside it: frames, train, images");
            return Err(files::file_error(list, reason, LAYOUT_HINT));
        };
        let pictures = walk.frames.iter().map(|frame| place.join(frame)).collect();
        let motion = walk.actions.map_or(WalkMotion::Unknown, WalkMotion::Actions);
        walks.push(TrainingWalk { scene, pictures, motion });
    }
    Ok(walks)
}

fn scene_of(list: &Path, name: &str) -> Result<SceneId, PlatformError> {
    SceneId::new(name).map_err(|error| files::file_error(list, error.to_string(), "give this walk another name"))
}

/// Refuses a walk with another number of pictures than of actions, because it is not known which picture belongs to which.
fn expect_pictures(folder: &Path, pictures: usize, actions: usize) -> Result<(), PlatformError> {
    if pictures == actions {
        return Ok(());
    }
    let reason =
        format!("holds {pictures} pictures, and its walk has {actions} actions: one picture is taken before each");
    Err(files::file_error(folder, reason, LAYOUT_HINT))
}

/// The error for a list of walks that breaks a rule.
fn wrong_list(list: &Path, error: &FormatError) -> PlatformError {
    files::file_error(list, error.to_string(), LAYOUT_HINT)
}

impl TrainingWalks {
    fn new(root: &Path, list: PathBuf, mut walks: Vec<TrainingWalk>) -> Result<Self, PlatformError> {
        walks.sort_by(|a, b| a.scene.cmp(&b.scene));
        if let Some([twice, _]) = walks.array_windows::<2>().find(|[one, next]| one.scene == next.scene) {
            let reason = format!("lists two walks with the name {}", twice.scene);
            return Err(files::file_error(&list, reason, "give each walk its own folder of pictures"));
        }
        let described = RecordingDescription::read(&root.join(FOLDER_FILE))?;
        Ok(Self { root: root.to_owned(), described, list, walks })
    }

    fn find_walk(&self, scene: &SceneId) -> Result<&TrainingWalk, PlatformError> {
        let walk = self.walks.iter().find(|walk| walk.scene == *scene);
        walk.ok_or_else(|| unknown_scene(scene, &self.scenes()))
    }
}

impl RecordingSource for TrainingWalks {
    fn scenes(&self) -> Vec<SceneId> {
        self.walks.iter().map(|walk| walk.scene.clone()).collect()
    }

    fn open(&self, scene: &SceneId) -> Result<Recording, PlatformError> {
        let walk = self.find_walk(scene)?;
        let per_s = self.described.pictures_per_s.unwrap_or(PICTURES_PER_S);
        let times_s: Vec<f64> = (0..walk.pictures.len()).map(|number| number as f64 / per_s).collect();
        let track = walk.motion.read_track(&times_s)?;
        let remarks = walk.motion.remark().into_iter().collect();
        let reel = FolderReel { times_s, files: walk.pictures.clone(), remarks };
        Ok(Recording { reel: Box::new(reel), track, horizontal_fov_rad: None, described: self.described.clone() })
    }

    fn files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        let walk = self.find_walk(scene)?;
        let beside = [self.list.clone(), self.root.join(FOLDER_FILE)];
        Ok(plain_files(walk.pictures.iter().cloned().chain(beside).chain(walk.motion.files())))
    }
}

#[cfg(test)]
mod tests;
