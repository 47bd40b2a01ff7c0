//! The common form of all kinds of recordings: pictures in the order of their times, and the track of the camera.

use crate::{describe::RecordingDescription, track::CameraTrack};
use std::path::PathBuf;
use wayword_core::{Image, PlatformError, SceneId};

/// A file or folder that holds recordings.
pub(crate) trait RecordingSource: Send + Sync {
    /// The recordings, sorted.
    fn scenes(&self) -> Vec<SceneId>;

    /// Opens one of [`RecordingSource::scenes`]. Reads its times and poses, but no pictures.
    ///
    /// # Errors
    /// When its files cannot be read.
    fn open(&self, scene: &SceneId) -> Result<Recording, PlatformError>;

    /// The plain files that one of [`RecordingSource::scenes`] is read from, sorted: pictures, poses and its description.
    ///
    /// # Errors
    /// When the program cannot determine these files.
    fn files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError>;
}

/// One recording of one camera.
pub(crate) struct Recording {
    pub(crate) reel: Box<dyn PictureReel>,
    /// The poses of the camera; `None` if the recording has none.
    pub(crate) track: Option<CameraTrack>,
    /// Horizontal field of view of its pictures, radians, if the recording itself gives it.
    pub(crate) horizontal_fov_rad: Option<f64>,
    /// The user's description of it.
    pub(crate) described: RecordingDescription,
}

/// Receives a picture with its number.
pub(crate) type TakePicture<'a> = dyn FnMut(usize, Image) -> Result<(), PlatformError> + 'a;

/// The pictures of a recording, in the order of their times.
pub(crate) trait PictureReel: Send + Sync {
    /// Times at which the pictures were taken, seconds on the clock of the recording's track, in ascending order. Equal times
    /// may follow each other.
    fn times_s(&self) -> &[f64];

    /// The name of a picture, unique within the recording.
    fn picture_name(&self, number: usize) -> String;

    /// Hands out the wanted pictures, in order, one at a time: a picture need not stay in memory while the next is
    /// read. `wanted` ascends without repetition; its numbers are below the length of [`PictureReel::read_times_s`].
    ///
    /// # Errors
    /// When one cannot be read, or `take` fails.
    fn hand_out_pictures(&self, wanted: &[usize], take: &mut TakePicture<'_>) -> Result<(), PlatformError>;

    /// What the user has to be told about the recording, one line each.
    fn remarks(&self) -> &[String] {
        &[]
    }

    /// Checks whether the wanted files are pictures, if that is cheap.
    ///
    /// # Errors
    /// When one is not a picture.
    fn glance_at(&self, _wanted: &[usize]) -> Result<(), PlatformError> {
        Ok(())
    }
}
