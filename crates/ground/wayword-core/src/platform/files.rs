//! The files of a platform's scenes, and the names that they go by.

use super::PlatformError;
use crate::{SceneCondition, SceneId};
use std::{collections::BTreeSet, path::PathBuf};

/// The files that a platform reads its scenes from. By default there are none.
pub trait SceneFiles: Send + Sync {
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

/// The files of a platform that has none.
pub(super) struct NoFiles;

impl SceneFiles for NoFiles {}
