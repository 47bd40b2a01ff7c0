//! What every kind of recording gives: pictures in the order of their times, and where the camera was.

use crate::{choose::wanted, describe::Description, track::Track};
use std::path::PathBuf;
use wayword_core::{Image, PlatformError, SceneId};

/// A file or folder that holds recordings.
pub(crate) trait Source: Send + Sync {
    /// The recordings, sorted.
    fn scenes(&self) -> Vec<SceneId>;

    /// Opens one of [`Source::scenes`]. Reads what is needed to know times and poses, but no pictures.
    ///
    /// # Errors
    /// When its files cannot be read.
    fn open(&self, scene: &SceneId) -> Result<Recording, PlatformError>;

    /// The plain files that one of [`Source::scenes`] is read from, sorted: pictures, poses and what describes it.
    ///
    /// # Errors
    /// When the program cannot find out which files these are.
    fn files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError>;

    /// Checks whether one of [`Source::scenes`] can be read: its index, and its first picture.
    ///
    /// # Errors
    /// When it cannot.
    fn check(&self, scene: &SceneId) -> Result<(), PlatformError> {
        let recording = self.open(scene)?;
        let wanted = wanted(&recording);
        recording.reel.glance(&wanted)?;
        recording.reel.pictures(&wanted[..wanted.len().min(1)], &mut |_, _| Ok(()))
    }
}

/// One recording of one camera.
pub(crate) struct Recording {
    pub(crate) reel: Box<dyn Reel>,
    /// Where the camera was; `None` where the recording does not say.
    pub(crate) track: Option<Track>,
    /// Horizontal field of view of its pictures, radians, where the recording itself says it.
    pub(crate) horizontal_fov_rad: Option<f64>,
    /// What the user says about it.
    pub(crate) described: Description,
}

/// Takes a picture: its number, and the picture.
pub(crate) type Take<'a> = dyn FnMut(usize, Image) -> Result<(), PlatformError> + 'a;

/// The pictures of a recording, in the order of their times.
pub(crate) trait Reel: Send + Sync {
    /// When each picture was taken, seconds on the clock of the recording's track, in ascending order (equal times may
    /// follow).
    fn times_s(&self) -> &[f64];

    /// The name of a picture, unique within the recording.
    fn name(&self, number: usize) -> String;

    /// Hands out the wanted pictures, in order, one at a time: a picture need not stay in memory while the next is
    /// read. `wanted` ascends without repetition; its numbers are below the length of [`Reel::times_s`].
    ///
    /// # Errors
    /// When one cannot be read, or `take` fails.
    fn pictures(&self, wanted: &[usize], take: &mut Take<'_>) -> Result<(), PlatformError>;

    /// Checks whether the wanted files are pictures, where that costs little.
    ///
    /// # Errors
    /// When one is not a picture.
    fn glance(&self, _wanted: &[usize]) -> Result<(), PlatformError> {
        Ok(())
    }
}
