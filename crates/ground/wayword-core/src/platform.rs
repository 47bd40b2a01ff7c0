//! What a world must offer.

use crate::{
    Failure, Frame, FromAbove, Gaze, Island, ObjectId, Path, SceneId, View, ViewpointGraph, ViewpointId, Way,
    graph::GraphError,
};
use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeSet,
    io,
    ops::RangeInclusive,
    path::{Path as FilePath, PathBuf},
    sync::Arc,
};

/// A world: scenes with a viewpoint graph, paths through them, and views along these.
///
/// Blocking and object-safe; threads belong to the caller.
pub trait Platform: Send + Sync {
    /// Its name, as `--platform` takes it.
    fn name(&self) -> &'static str;

    /// The scenes it can offer, sorted.
    ///
    /// # Errors
    /// When its data cannot be read.
    fn scenes(&self) -> Result<Vec<SceneId>, PlatformError>;

    /// Looks whether scenes can be read, where that can be known before anything is made of them. One that is not there is no
    /// concern of this.
    ///
    /// # Errors
    /// When one cannot.
    fn check(&self, _scenes: &BTreeSet<&SceneId>) -> Result<(), PlatformError> {
        Ok(())
    }

    /// The viewpoint graph of a scene.
    ///
    /// # Errors
    /// When there is no such scene or its data cannot be read.
    fn graph(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError>;

    /// A random path that keeps to `request`; the same seed gives the same path. Its target, where the platform knows
    /// objects, is one that is visible at its end.
    ///
    /// # Errors
    /// When the scene holds no such path, or cannot be read.
    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError>;

    /// What is seen from a frame.
    ///
    /// # Errors
    /// When the frame is not a place of the scene, or its data cannot be read.
    fn look(&self, scene: &SceneId, from: &Frame, gaze: Gaze) -> Result<View, PlatformError>;

    /// The same for somebody who looks at no picture: a world that has to read one from a file leaves it out.
    ///
    /// # Errors
    /// When the frame is not a place of the scene, or its data cannot be read.
    fn look_without_picture(&self, scene: &SceneId, from: &Frame, gaze: Gaze) -> Result<View, PlatformError> {
        self.look(scene, from, gaze)
    }

    /// A storey (the lowest is 1) straight from above, without what lies over the heads there; `None` where the platform has no
    /// such picture, or no such storey.
    ///
    /// # Errors
    /// When there is no such scene or its data cannot be read.
    fn look_down(&self, _scene: &SceneId, _level: u32) -> Result<Option<FromAbove>, PlatformError> {
        Ok(None)
    }

    /// The name of an object that an episode gives by its id, whether or not it can be seen from the frame.
    ///
    /// # Errors
    /// When the data cannot be read.
    fn object_name(&self, scene: &SceneId, near: &Frame, object: &ObjectId) -> Result<Option<String>, PlatformError>;

    /// The viewpoints from which an object can be seen; `None` where the platform knows no objects.
    ///
    /// # Errors
    /// When the data cannot be read.
    fn visible_from(&self, scene: &SceneId, object: &ObjectId) -> Result<Option<BTreeSet<ViewpointId>>, PlatformError>;

    /// The shortest way on foot from one frame to another, over all ground and not only along viewpoints; `None` where the platform
    /// does not know the ground, or no way leads there.
    ///
    /// # Errors
    /// When there is no such scene or its data cannot be read.
    fn way(&self, _scene: &SceneId, _from: &Frame, _to: &Frame) -> Result<Option<Way>, PlatformError> {
        Ok(None)
    }

    /// The pieces of ground of a scene, the largest first; empty where the platform does not know the ground.
    ///
    /// # Errors
    /// When there is no such scene or its data cannot be read.
    fn islands(&self, _scene: &SceneId) -> Result<Vec<Island>, PlatformError> {
        Ok(Vec::new())
    }

    /// The file that a scene is read from, where Habitat reads the same one; `None` elsewhere.
    ///
    /// # Errors
    /// When there is no such scene.
    fn scene_file(&self, _scene: &SceneId) -> Result<Option<PathBuf>, PlatformError> {
        Ok(None)
    }

    /// The files that a scene is read from, sorted; empty where a world is made up or runs elsewhere. A run keeps their hash, so that it
    /// is not continued with other data.
    ///
    /// # Errors
    /// When there is no such scene, or a folder cannot be read.
    fn files(&self, _scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        Ok(Vec::new())
    }
}

impl<P: Platform + ?Sized> Platform for Box<P> {
    fn name(&self) -> &'static str {
        (**self).name()
    }

    fn scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        (**self).scenes()
    }

    fn check(&self, scenes: &BTreeSet<&SceneId>) -> Result<(), PlatformError> {
        (**self).check(scenes)
    }

    fn graph(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        (**self).graph(scene)
    }

    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        (**self).sample_path(scene, request, seed)
    }

    fn look(&self, scene: &SceneId, from: &Frame, gaze: Gaze) -> Result<View, PlatformError> {
        (**self).look(scene, from, gaze)
    }

    fn look_without_picture(&self, scene: &SceneId, from: &Frame, gaze: Gaze) -> Result<View, PlatformError> {
        (**self).look_without_picture(scene, from, gaze)
    }

    fn look_down(&self, scene: &SceneId, level: u32) -> Result<Option<FromAbove>, PlatformError> {
        (**self).look_down(scene, level)
    }

    fn object_name(&self, scene: &SceneId, near: &Frame, object: &ObjectId) -> Result<Option<String>, PlatformError> {
        (**self).object_name(scene, near, object)
    }

    fn visible_from(&self, scene: &SceneId, object: &ObjectId) -> Result<Option<BTreeSet<ViewpointId>>, PlatformError> {
        (**self).visible_from(scene, object)
    }

    fn way(&self, scene: &SceneId, from: &Frame, to: &Frame) -> Result<Option<Way>, PlatformError> {
        (**self).way(scene, from, to)
    }

    fn islands(&self, scene: &SceneId) -> Result<Vec<Island>, PlatformError> {
        (**self).islands(scene)
    }

    fn scene_file(&self, scene: &SceneId) -> Result<Option<PathBuf>, PlatformError> {
        (**self).scene_file(scene)
    }

    fn files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        (**self).files(scene)
    }
}

/// What a random path has to be like.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PathRequest {
    /// Number of hops on the viewpoint graph. A continuous platform, whose paths have none, keeps to the length alone.
    pub hops: RangeInclusive<usize>,
    /// Length of the path, metres.
    pub length_m: RangeInclusive<f64>,
}

impl Default for PathRequest {
    /// REVERIE's own range of hops, and R2R's of lengths.
    fn default() -> Self {
        Self { hops: 4..=7, length_m: 5.0..=20.0 }
    }
}

impl PathRequest {
    /// Whether a path is as long as was asked for. One whose length is unknown is not.
    #[must_use]
    pub fn allows_length_of(&self, path: &Path) -> bool {
        path.length_m().is_some_and(|length_m| self.length_m.contains(&length_m))
    }
}

/// A world cannot give what it was asked for.
#[derive(Debug, thiserror::Error)]
pub enum PlatformError {
    /// A scene that it does not have.
    #[error("there is no scene {scene}: {hint}")]
    UnknownScene {
        /// Its name.
        scene: String,
        /// What to do.
        hint: String,
    },
    /// A viewpoint that the scene does not have.
    #[error("scene {scene} has no viewpoint {viewpoint}")]
    UnknownViewpoint {
        /// The scene.
        scene: SceneId,
        /// The viewpoint.
        viewpoint: ViewpointId,
    },
    /// A frame that names no viewpoint, on a platform that has nothing between them.
    #[error("scene {scene} can only be seen from viewpoints of its graph, and this frame names none")]
    NotAViewpoint {
        /// The scene.
        scene: SceneId,
    },
    /// A graph that does not hold together.
    #[error("scene {scene}: {source}")]
    Graph {
        /// The scene.
        scene: SceneId,
        /// What is wrong with it.
        source: GraphError,
    },
    /// No path of the kind that was asked for.
    #[error("scene {scene} holds no path with {request}: widen --hops or --metres")]
    NoSuchPath {
        /// The scene.
        scene: SceneId,
        /// What was asked for, in words.
        request: String,
    },
    /// A file that is missing or cannot be read.
    #[error("{}: {reason}; {hint}", file.display())]
    File {
        /// Which file.
        file: PathBuf,
        /// What is wrong, with item, field or line.
        reason: String,
        /// What to do.
        hint: &'static str,
    },
    /// A file that is not there.
    #[error("{}: there is no such file; {hint}", file.display())]
    NoFile {
        /// Which file.
        file: PathBuf,
        /// What to do.
        hint: &'static str,
    },
    /// A world that runs beside us, or the disk that holds it, went away while it was in use.
    #[error("{world}: {reason}; {hint}")]
    Lost {
        /// Its program or address, or the file.
        world: String,
        /// What happened.
        reason: String,
        /// What to do.
        hint: &'static str,
    },
}

impl PlatformError {
    /// How it is dealt with.
    #[must_use]
    pub fn failure(&self) -> Failure {
        match self {
            Self::UnknownScene { .. }
            | Self::UnknownViewpoint { .. }
            | Self::NotAViewpoint { .. }
            | Self::NoSuchPath { .. }
            | Self::NoFile { .. } => Failure::Missing,
            Self::Graph { .. } | Self::File { .. } => Failure::Broken,
            Self::Lost { .. } => Failure::Lost,
        }
    }

    /// A file could not be read, for a reason that the system gives.
    #[must_use]
    pub fn unread(file: &FilePath, error: &io::Error, hint: &'static str) -> Self {
        match error.kind() {
            io::ErrorKind::NotFound => Self::NoFile { file: file.to_owned(), hint },
            _ if is_lost_disk(error) => {
                Self::Lost { world: file.display().to_string(), reason: error.to_string(), hint }
            }
            _ => Self::File { file: file.to_owned(), reason: error.to_string(), hint },
        }
    }

    /// There is nowhere in a scene to stand where a frame says: its viewpoint is unknown, or else its place.
    #[must_use]
    pub fn nowhere(scene: &SceneId, frame: &Frame) -> Self {
        let eye = frame.pose.position;
        let place = format!("{:.2} {:.2} {:.2}", eye.x, eye.y, eye.z);
        let named = frame.viewpoint.clone().map_or_else(|| ViewpointId::new(place), Ok);
        named.map_or_else(
            |_| Self::NotAViewpoint { scene: scene.clone() },
            |viewpoint| Self::UnknownViewpoint { scene: scene.clone(), viewpoint },
        )
    }
}

/// Whether the system says that a disk has gone away or fails: one of another machine, or a broken one.
#[must_use]
pub fn is_lost_disk(error: &io::Error) -> bool {
    use io::ErrorKind::{
        HostUnreachable, NetworkDown, NetworkUnreachable, NotConnected, StaleNetworkFileHandle, TimedOut,
    };
    /// Unix' number of "input/output error", for which the standard library has no name.
    const EIO: i32 = 5;
    let gone = [HostUnreachable, NetworkDown, NetworkUnreachable, NotConnected, StaleNetworkFileHandle, TimedOut];
    gone.contains(&error.kind()) || (cfg!(unix) && error.raw_os_error() == Some(EIO))
}
