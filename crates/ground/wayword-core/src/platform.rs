//! The trait that every platform implements: scenes, their graphs, views, labels and ground.

use crate::{
    DepthImage, FailureKind, Frame, FromAbove, GroundIsland, GroundRoute, ObjectId, Path, PlacedObject, SceneCondition,
    SceneId, View, ViewGaze, ViewpointGraph, ViewpointId, graph::GraphError,
};
use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeSet,
    io,
    ops::RangeInclusive,
    path::{Path as FilePath, PathBuf},
    sync::Arc,
};

/// A platform: scenes with a viewpoint graph, paths through them, and views along the paths.
///
/// Blocking and object-safe; threads belong to the caller.
pub trait Platform: Send + Sync {
    /// Its name, as `--platform` takes it.
    fn name(&self) -> &'static str;

    /// The scenes it can offer, sorted.
    ///
    /// # Errors
    /// When its data cannot be read.
    fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError>;

    /// Checks that scenes can be read, where the platform can find out before a run begins. It skips scenes that it
    /// does not have.
    ///
    /// # Errors
    /// When a scene cannot be read.
    fn check_scenes(&self, _scenes: &BTreeSet<&SceneId>) -> Result<(), PlatformError> {
        Ok(())
    }

    /// The platform's own name for a scene that it knows by several names; else the same name.
    fn canonical_scene(&self, scene: &SceneId) -> SceneId {
        scene.clone()
    }

    /// The scenes of its data that [`examine_scene`](Self::examine_scene) knows, sorted: those that it can offer, and those that
    /// something is wrong with. Empty where it cannot know before it is asked for views.
    ///
    /// # Errors
    /// When its data cannot be read.
    fn candidate_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        Ok(Vec::new())
    }

    /// Reads the files of one of its [`candidate_scenes`](Self::candidate_scenes), and reports what they offer. A scene that
    /// cannot be used is no error here. `None` where the platform cannot find out.
    ///
    /// # Errors
    /// When the disk that holds the data has gone away.
    fn examine_scene(&self, _scene: &SceneId) -> Result<Option<SceneCondition>, PlatformError> {
        Ok(None)
    }

    /// The viewpoint graph of a scene.
    ///
    /// # Errors
    /// When the scene does not exist or its data cannot be read.
    fn graph_for_scene(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError>;

    /// A random path that keeps to `request`; the same seed gives the same path. Where the platform knows objects, the
    /// path's target is visible at its end.
    ///
    /// # Errors
    /// When the scene has no path that fits, or cannot be read.
    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError>;

    /// The view from a frame in one direction.
    ///
    /// # Errors
    /// When the frame is not a place of the scene, or its data cannot be read.
    fn look_from(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError>;

    /// The same for a caller that needs no picture: a platform that would have to read one from a file leaves it out.
    ///
    /// # Errors
    /// When the frame is not a place of the scene, or its data cannot be read.
    fn look_without_picture(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        self.look_from(scene, from, gaze)
    }

    /// The distances of what [`look_from`](Self::look_from) shows from a frame, level and for the same gaze; `None` where the
    /// platform does not know them. It is separate from the view, so that only callers that want it pay for it.
    ///
    /// # Errors
    /// When the frame is not a place of the scene, or its data cannot be read.
    fn view_depth(
        &self,
        _scene: &SceneId,
        _from: &Frame,
        _gaze: ViewGaze,
    ) -> Result<Option<DepthImage>, PlatformError> {
        Ok(None)
    }

    /// A storey (the lowest is 1) straight from above, without its ceiling and all that is over it; `None` where the
    /// platform has no picture of it, or the scene has no storey of this number.
    ///
    /// # Errors
    /// When the scene does not exist or its data cannot be read.
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

    /// The shortest way on foot from one frame to another, over all ground and not only along viewpoints; `None` where
    /// the platform does not know the ground, or there is no way.
    ///
    /// # Errors
    /// When the scene does not exist or its data cannot be read.
    fn ground_route(&self, _scene: &SceneId, _from: &Frame, _to: &Frame) -> Result<Option<GroundRoute>, PlatformError> {
        Ok(None)
    }

    /// The islands of a scene, the largest first; empty where the platform does not know the ground.
    ///
    /// # Errors
    /// When the scene does not exist or its data cannot be read.
    fn ground_islands(&self, _scene: &SceneId) -> Result<Vec<GroundIsland>, PlatformError> {
        Ok(Vec::new())
    }

    /// All objects that the platform lists in a scene with their places, also those that no viewpoint shows; empty where
    /// it knows no more than the labels of its views.
    ///
    /// # Errors
    /// When the scene does not exist or its data cannot be read.
    fn listed_objects(&self, _scene: &SceneId) -> Result<Vec<PlacedObject>, PlatformError> {
        Ok(Vec::new())
    }

    /// Whether the labels of its views list everything that is visible. If not, a thing may be there that no label
    /// names.
    fn lists_everything(&self) -> bool {
        true
    }

    /// The file that a scene is read from, where Habitat reads the same file; `None` elsewhere.
    ///
    /// # Errors
    /// When the scene does not exist.
    fn scene_file(&self, _scene: &SceneId) -> Result<Option<PathBuf>, PlatformError> {
        Ok(None)
    }

    /// The files that a scene is read from, sorted; empty where the scene is generated or comes from another program. A
    /// run keeps their hash, so that it is not continued with other data.
    ///
    /// # Errors
    /// When the scene does not exist, or a folder cannot be read.
    fn source_files(&self, _scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        Ok(Vec::new())
    }
}

/// Implements [`Platform`] for a pointer to a platform.
macro_rules! platform_behind {
    ($pointer:ty) => {
        impl<P: Platform + ?Sized> Platform for $pointer {
            fn name(&self) -> &'static str {
                (**self).name()
            }

            fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
                (**self).list_scenes()
            }

            fn check_scenes(&self, scenes: &BTreeSet<&SceneId>) -> Result<(), PlatformError> {
                (**self).check_scenes(scenes)
            }

            fn canonical_scene(&self, scene: &SceneId) -> SceneId {
                (**self).canonical_scene(scene)
            }

            fn candidate_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
                (**self).candidate_scenes()
            }

            fn examine_scene(&self, scene: &SceneId) -> Result<Option<SceneCondition>, PlatformError> {
                (**self).examine_scene(scene)
            }

            fn graph_for_scene(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
                (**self).graph_for_scene(scene)
            }

            fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
                (**self).sample_path(scene, request, seed)
            }

            fn look_from(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
                (**self).look_from(scene, from, gaze)
            }

            fn look_without_picture(
                &self,
                scene: &SceneId,
                from: &Frame,
                gaze: ViewGaze,
            ) -> Result<View, PlatformError> {
                (**self).look_without_picture(scene, from, gaze)
            }

            fn view_depth(
                &self,
                scene: &SceneId,
                from: &Frame,
                gaze: ViewGaze,
            ) -> Result<Option<DepthImage>, PlatformError> {
                (**self).view_depth(scene, from, gaze)
            }

            fn look_down(&self, scene: &SceneId, level: u32) -> Result<Option<FromAbove>, PlatformError> {
                (**self).look_down(scene, level)
            }

            fn object_name(
                &self,
                scene: &SceneId,
                near: &Frame,
                object: &ObjectId,
            ) -> Result<Option<String>, PlatformError> {
                (**self).object_name(scene, near, object)
            }

            fn visible_from(
                &self,
                scene: &SceneId,
                object: &ObjectId,
            ) -> Result<Option<BTreeSet<ViewpointId>>, PlatformError> {
                (**self).visible_from(scene, object)
            }

            fn ground_route(
                &self,
                scene: &SceneId,
                from: &Frame,
                to: &Frame,
            ) -> Result<Option<GroundRoute>, PlatformError> {
                (**self).ground_route(scene, from, to)
            }

            fn ground_islands(&self, scene: &SceneId) -> Result<Vec<GroundIsland>, PlatformError> {
                (**self).ground_islands(scene)
            }

            fn listed_objects(&self, scene: &SceneId) -> Result<Vec<PlacedObject>, PlatformError> {
                (**self).listed_objects(scene)
            }

            fn lists_everything(&self) -> bool {
                (**self).lists_everything()
            }

            fn scene_file(&self, scene: &SceneId) -> Result<Option<PathBuf>, PlatformError> {
                (**self).scene_file(scene)
            }

            fn source_files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
                (**self).source_files(scene)
            }
        }
    };
}

platform_behind!(Box<P>);
platform_behind!(&P);

/// The lengths that a random path may have.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PathRequest {
    /// Number of hops on the viewpoint graph. Paths of a continuous platform have no hops: there only the length
    /// counts.
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
    /// Whether a path's length is in the range. An unknown length is not.
    #[must_use]
    pub fn allows_length_of(&self, path: &Path) -> bool {
        path.length_m().is_some_and(|length_m| self.length_m.contains(&length_m))
    }
}

/// Why a platform cannot give what it was asked for.
#[derive(Debug, thiserror::Error)]
pub enum PlatformError {
    /// A scene that it does not have.
    #[error("there is no scene {scene}: {hint}")]
    UnknownScene {
        /// Its name.
        scene: String,
        /// Advice for the user.
        hint: String,
    },
    /// A scene that cannot be drawn.
    #[error("scene {scene} cannot be drawn: {reason}")]
    NotDrawn {
        /// The scene.
        scene: SceneId,
        /// Why.
        reason: String,
    },
    /// A viewpoint that the scene does not have.
    #[error("scene {scene} has no viewpoint {viewpoint}")]
    UnknownViewpoint {
        /// The scene.
        scene: SceneId,
        /// The viewpoint.
        viewpoint: ViewpointId,
    },
    /// A frame that names no viewpoint, on a platform that offers views from viewpoints only.
    #[error(
        "scene {scene} can only be seen from the viewpoints of its viewpoint graph, but this frame names no viewpoint: use paths that name viewpoints"
    )]
    NotAViewpoint {
        /// The scene.
        scene: SceneId,
    },
    /// A viewpoint graph with a mistake.
    #[error("scene {scene}: {source}")]
    Graph {
        /// The scene.
        scene: SceneId,
        /// The mistake.
        source: GraphError,
    },
    /// No path of the kind that was asked for.
    #[error("scene {scene} has no path with {request}: {hint}")]
    NoSuchPath {
        /// The scene.
        scene: SceneId,
        /// The request, in words.
        request: String,
        /// Advice for the user.
        hint: &'static str,
    },
    /// A file that cannot be read or used.
    #[error("{}: {reason}; {hint}", file.display())]
    File {
        /// Which file.
        file: PathBuf,
        /// The mistake, with item, field or line.
        reason: String,
        /// Advice for the user.
        hint: &'static str,
    },
    /// A file that is not there.
    #[error("{}: there is no such file; {hint}", file.display())]
    NoFile {
        /// Which file.
        file: PathBuf,
        /// Advice for the user.
        hint: &'static str,
    },
    /// A platform that is another program, or the disk that holds its data, went away while it was in use.
    #[error("{world}: {reason}; {hint}")]
    Lost {
        /// Its program or address, or the file.
        world: String,
        /// The reason.
        reason: String,
        /// Advice for the user.
        hint: &'static str,
    },
}

impl PlatformError {
    /// Its kind of failure.
    #[must_use]
    pub fn failure_kind(&self) -> FailureKind {
        match self {
            Self::UnknownScene { .. }
            | Self::UnknownViewpoint { .. }
            | Self::NotAViewpoint { .. }
            | Self::NoSuchPath { .. }
            | Self::NoFile { .. } => FailureKind::Missing,
            Self::NotDrawn { .. } | Self::Graph { .. } | Self::File { .. } => FailureKind::Broken,
            Self::Lost { .. } => FailureKind::Lost,
        }
    }

    /// The error for a file that could not be read, with the system's reason.
    #[must_use]
    pub fn for_unread_file(file: &FilePath, error: &io::Error, hint: &'static str) -> Self {
        match error.kind() {
            io::ErrorKind::NotFound => Self::NoFile { file: file.to_owned(), hint },
            _ if is_lost_disk(error) => {
                Self::Lost { world: file.display().to_string(), reason: error.to_string(), hint }
            }
            _ => Self::File { file: file.to_owned(), reason: error.to_string(), hint },
        }
    }

    /// The error for a frame at a place where an agent cannot be. It names the frame's viewpoint, or its position
    /// where it has none.
    #[must_use]
    pub fn for_unknown_place(scene: &SceneId, frame: &Frame) -> Self {
        let eye = frame.pose.position;
        let place = format!("{:.2} {:.2} {:.2}", eye.x, eye.y, eye.z);
        let named = frame.viewpoint.clone().map_or_else(|| ViewpointId::new(place), Ok);
        named.map_or_else(
            |_| Self::NotAViewpoint { scene: scene.clone() },
            |viewpoint| Self::UnknownViewpoint { scene: scene.clone(), viewpoint },
        )
    }
}

/// Whether the system reports that a disk has gone away or fails: a network disk, or a broken one.
#[must_use]
pub fn is_lost_disk(error: &io::Error) -> bool {
    use io::ErrorKind::{
        HostUnreachable, NetworkDown, NetworkUnreachable, NotConnected, StaleNetworkFileHandle, TimedOut,
    };
    /// Unix's number of "input/output error", for which the standard library has no name.
    const EIO: i32 = 5;
    let gone = [HostUnreachable, NetworkDown, NetworkUnreachable, NotConnected, StaleNetworkFileHandle, TimedOut];
    gone.contains(&error.kind()) || (cfg!(unix) && error.raw_os_error() == Some(EIO))
}
