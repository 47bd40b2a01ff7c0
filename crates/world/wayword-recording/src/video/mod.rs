//! Reads videos: MP4 files with H.264 or AV1.

mod av1;
mod boxes;
mod codec;
mod colour;
mod decoder;
mod edits;
mod entry;
mod film;
mod fragments;
mod h264;
mod movie;
mod sps;
mod tables;
#[cfg(test)]
mod tests;
mod turn;

pub(crate) use film::Film;

use crate::{
    describe::Description,
    names::{plain, scene_of, unknown},
    poses,
    reel::{Recording, Reel, Source, Take},
};
use std::path::{Path, PathBuf};
use wayword_core::{PlatformError, SceneId};

/// A video as a recording, with poses in a file of the same folder or without any.
pub(crate) struct FilmFile {
    path: PathBuf,
    scene: SceneId,
    described: Description,
}

impl FilmFile {
    /// The recording in an MP4 file.
    ///
    /// # Errors
    /// When its name cannot be the name of a scene.
    pub(crate) fn open(path: &Path, described: Description) -> Result<Self, PlatformError> {
        Ok(Self { path: path.to_owned(), scene: scene_of(path)?, described })
    }
}

impl Source for FilmFile {
    fn scenes(&self) -> Vec<SceneId> {
        vec![self.scene.clone()]
    }

    fn open(&self, scene: &SceneId) -> Result<Recording, PlatformError> {
        if *scene != self.scene {
            return Err(unknown(scene, &self.scenes()));
        }
        let described = self.described.clone();
        let reel = Film::open(&self.path, described.camera.as_deref())?;
        let poses = poses::beside(&self.path, &described)?;
        let track = poses.map(|file| poses::track(&file, &described, reel.times_s(), &|number| reel.name(number)));
        Ok(Recording { track: track.transpose()?, reel: Box::new(reel), horizontal_fov_rad: None, described })
    }

    fn files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        if *scene != self.scene {
            return Err(unknown(scene, &self.scenes()));
        }
        let own = [self.path.clone(), Description::file_beside(&self.path)];
        Ok(plain(own.into_iter().chain(poses::beside(&self.path, &self.described)?)))
    }
}

impl Reel for Film {
    fn times_s(&self) -> &[f64] {
        self.times_s()
    }

    fn name(&self, number: usize) -> String {
        number.to_string()
    }

    fn pictures(&self, wanted: &[usize], take: &mut Take<'_>) -> Result<(), PlatformError> {
        self.pictures(wanted, take)
    }
}
