//! A folder with several recordings, as one source.

use crate::{
    names::unknown_scene,
    reel::{Recording, RecordingSource},
};
use std::path::PathBuf;
use wayword_core::{PlatformError, SceneId};

/// Several sources in one folder.
pub(crate) struct RecordingShelf {
    pub(crate) sources: Vec<Box<dyn RecordingSource>>,
}

impl RecordingShelf {
    fn find_source(&self, scene: &SceneId) -> Result<&dyn RecordingSource, PlatformError> {
        let source = self.sources.iter().find(|source| source.scenes().contains(scene));
        source.map(|source| &**source).ok_or_else(|| unknown_scene(scene, &self.scenes()))
    }
}

impl RecordingSource for RecordingShelf {
    fn scenes(&self) -> Vec<SceneId> {
        let mut scenes: Vec<SceneId> = self.sources.iter().flat_map(|source| source.scenes()).collect();
        scenes.sort();
        scenes
    }

    fn open(&self, scene: &SceneId) -> Result<Recording, PlatformError> {
        self.find_source(scene)?.open(scene)
    }

    fn files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        self.find_source(scene)?.files(scene)
    }
}
