//! Reads videos: MP4 files with H.264 or AV1.

mod av1;
mod boxes;
mod codec;
mod colour;
mod decoder;
mod edits;
mod film;
mod fragments;
mod h264;
mod movie;
mod picture_turn;
mod sample_entry;
mod sps;
mod tables;
#[cfg(test)]
mod tests;

pub(crate) use film::Mp4Film;

use crate::{
    describe::RecordingDescription,
    names::{plain_files, scene_id_for_path, unknown_scene},
    poses,
    reel::{PictureReel, Recording, RecordingSource, TakePicture},
};
use std::path::{Path, PathBuf};
use wayword_core::{PlatformError, SceneId};

/// A video as a recording, with poses in a file of the same folder or without any.
pub(crate) struct FilmFile {
    path: PathBuf,
    scene: SceneId,
    described: RecordingDescription,
}

impl FilmFile {
    /// The recording in an MP4 file.
    ///
    /// # Errors
    /// When its name cannot be the name of a scene.
    pub(crate) fn open(path: &Path, described: RecordingDescription) -> Result<Self, PlatformError> {
        Ok(Self { path: path.to_owned(), scene: scene_id_for_path(path)?, described })
    }
}

impl RecordingSource for FilmFile {
    fn scenes(&self) -> Vec<SceneId> {
        vec![self.scene.clone()]
    }

    fn open(&self, scene: &SceneId) -> Result<Recording, PlatformError> {
        if *scene != self.scene {
            return Err(unknown_scene(scene, &self.scenes()));
        }
        let described = self.described.clone();
        let reel = Mp4Film::open(&self.path, described.camera.as_deref())?;
        let poses = poses::find_pose_file(&self.path, &described)?;
        let track =
            poses.map(|file| poses::read_track(&file, &described, reel.times_s(), &|number| reel.picture_name(number)));
        Ok(Recording { track: track.transpose()?, reel: Box::new(reel), horizontal_fov_rad: None, described })
    }

    fn files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        if *scene != self.scene {
            return Err(unknown_scene(scene, &self.scenes()));
        }
        let described = RecordingDescription::files_beside(&self.path);
        let own_files = [self.path.clone()].into_iter().chain(described);
        Ok(plain_files(own_files.chain(poses::find_pose_file(&self.path, &self.described)?)))
    }
}

impl PictureReel for Mp4Film {
    fn times_s(&self) -> &[f64] {
        self.times_s()
    }

    fn picture_name(&self, number: usize) -> String {
        number.to_string()
    }

    fn remarks(&self) -> &[String] {
        self.remarks()
    }

    fn hand_out_pictures(&self, wanted: &[usize], take: &mut TakePicture<'_>) -> Result<(), PlatformError> {
        self.decode_pictures(wanted, take)
    }
}
