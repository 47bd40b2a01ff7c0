//! A folder with several recordings, as one source.

use crate::{
    names::unknown,
    open::recording,
    reel::{Recording, Source},
};
use std::path::PathBuf;
use wayword_core::{PlatformError, SceneId};

/// Several sources in one folder.
pub(crate) struct Shelf {
    pub(crate) sources: Vec<Box<dyn Source>>,
}

impl Shelf {
    fn source(&self, scene: &SceneId) -> Result<&dyn Source, PlatformError> {
        let source = self.sources.iter().find(|source| source.scenes().contains(scene));
        source.map(|source| &**source).ok_or_else(|| unknown(scene, &self.scenes()))
    }
}

impl Source for Shelf {
    fn scenes(&self) -> Vec<SceneId> {
        let mut scenes: Vec<SceneId> = self.sources.iter().flat_map(|source| source.scenes()).collect();
        scenes.sort();
        scenes
    }

    fn open(&self, scene: &SceneId) -> Result<Recording, PlatformError> {
        self.source(scene)?.open(scene)
    }

    fn files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        self.source(scene)?.files(scene)
    }

    fn check(&self, scene: &SceneId) -> Result<(), PlatformError> {
        self.source(scene)?.check(scene)
    }
}

/// A recording that failed to open together with its folder. Its error is reported only when somebody uses this recording.
pub(crate) struct Unopened {
    pub(crate) scene: SceneId,
    pub(crate) path: PathBuf,
}

impl Source for Unopened {
    fn scenes(&self) -> Vec<SceneId> {
        vec![self.scene.clone()]
    }

    fn open(&self, scene: &SceneId) -> Result<Recording, PlatformError> {
        recording(&self.path)?.open(scene)
    }

    fn files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        recording(&self.path)?.files(scene)
    }
}
