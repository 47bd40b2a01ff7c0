//! Why a platform cannot give what it was asked for.

use crate::{FailureKind, Frame, ObjectId, SceneId, ViewpointId, graph::GraphError};
use std::{
    io,
    path::{Path as FilePath, PathBuf},
};

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
    /// A target that the scene does not have.
    #[error(
        "scene {scene} has no object {object}, which the path's task is about: correct the target, or leave the item out"
    )]
    UnknownObject {
        /// The scene.
        scene: SceneId,
        /// The object.
        object: ObjectId,
    },
    /// A frame that names no viewpoint, on a platform that offers views from viewpoints only.
    #[error(
        "scene {scene} can only be seen from the viewpoints of its viewpoint graph, but this frame names no viewpoint: use paths that name viewpoints"
    )]
    NotAViewpoint {
        /// The scene.
        scene: SceneId,
    },
    /// An episode whose path is one place, as in a test split.
    #[error(
        "the path of {episode} is one place, as in a test split whose way is hidden, so there is no way to describe: give episodes with their whole path"
    )]
    OnePlace {
        /// Its id.
        episode: String,
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
            | Self::UnknownObject { .. }
            | Self::NotAViewpoint { .. }
            | Self::OnePlace { .. }
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
