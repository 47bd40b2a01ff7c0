//! Finds out what kind of recording lies under a path.

#[cfg(any(feature = "lerobot", feature = "mcap", feature = "video"))]
use crate::describe::Description;
use crate::{
    folder::Folder,
    names::{entries, unknown},
    reel::{Recording, Source},
};
use std::{collections::BTreeSet, path::Path};
use wayword_core::{PlatformError, SceneId};
use wayword_world::files;

const HINT: &str = "give a folder of pictures, a folder of recordings, a LeRobot dataset, or a .mp4 or .mcap file; \
                    of another video, ffmpeg -i IN -c copy OUT.mp4 may make one";
/// Opens what lies under a path: one recording, or a folder that holds several.
pub(crate) fn open(path: &Path) -> Result<Box<dyn Source>, PlatformError> {
    if let Some(source) = one(path)? {
        return Ok(source);
    }
    if !path.is_dir() {
        let reason =
            if path.exists() { "is no recording that is known here" } else { "there is no such file or folder" };
        return Err(files::wrong(path, reason, HINT));
    }
    let mut sources = Vec::new();
    // macOS leaves "._x.mp4" beside "x.mp4" on foreign disks, and file managers leave folders of small pictures.
    for entry in entries(path)?.iter().filter(|name| !name.starts_with('.')) {
        sources.extend(one(&path.join(entry))?);
    }
    if sources.is_empty() {
        return Err(files::wrong(path, "holds no pictures and no recordings", HINT));
    }
    let mut scenes = BTreeSet::new();
    if let Some(twice) = sources.iter().flat_map(|source| source.scenes()).find(|scene| !scenes.insert(scene.clone())) {
        let reason = format!("holds two recordings that are called {twice}");
        return Err(files::wrong(path, reason, "give one of them another name, or name the file itself"));
    }
    Ok(Box::new(Shelf { sources }))
}

/// The source that a path is, if it is one.
fn one(path: &Path) -> Result<Option<Box<dyn Source>>, PlatformError> {
    if path.is_dir() {
        if path.join("meta").join("info.json").is_file() {
            return lerobot(path).map(Some);
        }
        let Some(folder) = Folder::open(path)? else { return Ok(None) };
        // Whoever keeps a picture beside her videos means these.
        if let Some(file) = folder.beside_pictures(is_file_of_ours)? {
            let reason = format!("holds pictures, and recordings as {file} too");
            return Err(files::wrong(path, reason, "give the recording's own path, or move the pictures away"));
        }
        return Ok(Some(Box::new(folder)));
    }
    if !path.is_file() {
        return Ok(None);
    }
    match ending(path).as_str() {
        "mp4" | "m4v" | "mov" => video(path).map(Some),
        "mcap" => mcap(path).map(Some),
        _ => Ok(None),
    }
}

fn ending(path: &Path) -> String {
    path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase()
}

fn is_file_of_ours(name: &str) -> bool {
    !name.starts_with('.') && matches!(ending(Path::new(name)).as_str(), "mp4" | "m4v" | "mov" | "mcap")
}

#[cfg(feature = "lerobot")]
fn lerobot(path: &Path) -> Result<Box<dyn Source>, PlatformError> {
    let described = Description::read(&path.join("recording.toml"))?;
    Ok(Box::new(crate::lerobot::Dataset::open(path, described)?))
}

#[cfg(not(feature = "lerobot"))]
fn lerobot(path: &Path) -> Result<Box<dyn Source>, PlatformError> {
    Err(absent(path, "LeRobot datasets"))
}

#[cfg(feature = "video")]
fn video(path: &Path) -> Result<Box<dyn Source>, PlatformError> {
    Ok(Box::new(crate::video::FilmFile::open(path, Description::beside(path)?)?))
}

#[cfg(not(feature = "video"))]
fn video(path: &Path) -> Result<Box<dyn Source>, PlatformError> {
    Err(absent(path, "MP4 files"))
}

#[cfg(feature = "mcap")]
fn mcap(path: &Path) -> Result<Box<dyn Source>, PlatformError> {
    Ok(Box::new(crate::mcap::McapFile::open(path, Description::beside(path)?)?))
}

#[cfg(not(feature = "mcap"))]
fn mcap(path: &Path) -> Result<Box<dyn Source>, PlatformError> {
    Err(absent(path, "MCAP files"))
}

#[cfg(not(all(feature = "lerobot", feature = "mcap", feature = "video")))]
fn absent(path: &Path, what: &str) -> PlatformError {
    let hint = "build it with `cargo build --release --features full`";
    files::wrong(path, format!("this build reads no {what}"), hint)
}

/// Several sources in one folder.
struct Shelf {
    sources: Vec<Box<dyn Source>>,
}

impl Source for Shelf {
    fn scenes(&self) -> Vec<SceneId> {
        let mut scenes: Vec<SceneId> = self.sources.iter().flat_map(|source| source.scenes()).collect();
        scenes.sort();
        scenes
    }

    fn open(&self, scene: &SceneId) -> Result<Recording, PlatformError> {
        let source = self.sources.iter().find(|source| source.scenes().contains(scene));
        source.map_or_else(|| Err(unknown(scene, &self.scenes())), |source| source.open(scene))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder of recordings, each with one picture.
    fn shelf(pictures: &[&str]) -> tempfile::TempDir {
        let shelf = tempfile::tempdir().unwrap();
        for picture in pictures {
            let file = shelf.path().join(picture);
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(file, "").unwrap();
        }
        shelf
    }

    #[test]
    fn each_recording_of_a_folder_is_a_scene_and_what_is_hidden_is_none() {
        let shelf = shelf(&["b/1.png", "a/rgb/1.png", ".small/1.png", "notes/1.txt"]);
        std::fs::write(shelf.path().join("._a.mp4"), "").unwrap();
        let scenes = open(shelf.path()).map(|source| source.scenes()).unwrap();
        assert_eq!(scenes.iter().map(SceneId::as_str).collect::<Vec<_>>(), ["a", "b"]);
    }

    #[test]
    fn pictures_beside_recordings_are_not_taken_for_what_is_meant() {
        let shelf = shelf(&["map.png"]);
        std::fs::write(shelf.path().join("walk.mp4"), "").unwrap();
        let error = open(shelf.path()).err().unwrap().to_string();
        assert!(error.contains("holds pictures, and recordings as walk.mp4 too"), "{error}");
    }

    #[test]
    fn who_asks_for_another_recording_is_told_which_there_are() {
        let shelf = shelf(&["b/1.png", "a/1.png"]);
        let source = open(shelf.path()).unwrap();
        let error = source.open(&SceneId::new("c").unwrap()).err().unwrap().to_string();
        assert!(error.contains("--data holds a, b"), "{error}");
    }

    #[cfg(feature = "video")]
    #[test]
    fn no_recording_is_passed_over_because_another_has_its_name() {
        let shelf = shelf(&["walk/1.png"]);
        std::fs::write(shelf.path().join("walk.mp4"), "").unwrap();
        let error = open(shelf.path()).err().unwrap().to_string();
        assert!(error.contains("two recordings that are called walk"), "{error}");
    }
}
