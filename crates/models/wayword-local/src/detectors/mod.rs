//! Detectors in process: which checkpoints are detectors, how they are loaded, and how the ledger keeps their answers.
//!
//! To add an architecture, add a variant to [`DetectorCheckpoint`], the line by which
//! [`DetectorCheckpoint::find_files`] recognises the architecture, its line in [`DetectorCheckpoint::load`], and the
//! bytes of features that it keeps in [`DetectorCheckpoint::memory_bytes`].

mod local_detector;

pub use local_detector::LocalDetector;

use crate::{
    LocalError, ModelDevice, WeightPrecision,
    dino::{self, GroundingDino},
    glip::{self, GlipDetector, GlipFiles},
    hub::{DownloadProgress, ModelFolder, ModelHub, ModelName, NeededFiles},
    json, memory,
    owl::{self, OwlDetector},
};
use serde::Deserialize;
use wayword_core::ObjectDetector;

/// The files of a detector, by its kind.
#[derive(Debug)]
pub(crate) enum DetectorCheckpoint {
    /// GLIP, from a `.pth` file.
    Glip(GlipFiles),
    /// Grounding DINO, MM Grounding DINO or LLMDet.
    Dino(ModelFolder),
    /// OWLv2.
    Owl(ModelFolder),
}

/// A loaded detector.
pub(crate) struct LoadedDetector {
    pub(crate) detector: Box<dyn ObjectDetector>,
    /// The size to which pictures are resized, in words. It is part of a call's key, because it may change the boxes.
    pub(crate) size: String,
}

/// The field of `config.json` that identifies the architecture.
#[derive(Deserialize)]
struct DetectorConfig {
    model_type: Option<String>,
}

impl DetectorCheckpoint {
    /// Finds the files of a detector by its name, and fetches missing ones. A file as training leaves it (`.pth`) is
    /// taken for GLIP's; the architecture of a folder is read from its `config.json`.
    pub(crate) fn find_files(
        hub: &ModelHub,
        name: &ModelName,
        progress: &dyn DownloadProgress,
    ) -> Result<Self, LocalError> {
        if name.is_trained() {
            return GlipFiles::find_files(hub, name, progress).map(Self::Glip);
        }
        let folder = hub.model_folder(name, &NeededFiles::for_any_architecture(name), progress)?;
        let config: DetectorConfig = json::read_required(&folder.path, "config.json", "the configuration")?;
        match config.model_type.as_deref() {
            Some("owlv2") => Ok(Self::Owl(folder)),
            Some("grounding-dino" | "mm-grounding-dino") => Ok(Self::Dino(folder)),
            other => Err(LocalError::File {
                file: folder.path.join("config.json"),
                problem: format!("model_type {}: such a model cannot detect in process", other.unwrap_or("(none)")),
                hint: "choose a detector, such as hf/iSEE-Laboratory/llmdet_tiny or hf/google/owlv2-base-patch16-ensemble",
            }),
        }
    }

    /// Loads a detector. `name` is its name, `hf/ORG/NAME`.
    pub(crate) fn load(
        &self,
        name: &str,
        device: &ModelDevice,
        precision: WeightPrecision,
    ) -> Result<LoadedDetector, LocalError> {
        match self {
            Self::Glip(files) => {
                let edge_px = GlipDetector::SHORT_EDGE_PX;
                let glip = GlipDetector::load(name, files, edge_px, device, precision)?;
                Ok(LoadedDetector { size: format!("{edge_px} px, short edge"), detector: Box::new(glip) })
            }
            Self::Dino(folder) => {
                let dino = GroundingDino::load(name, &folder.path, device, precision)?;
                Ok(LoadedDetector { size: "as its preprocessor says".to_owned(), detector: Box::new(dino) })
            }
            Self::Owl(folder) => {
                let owl = OwlDetector::load(name, &folder.path, device, precision)?;
                Ok(LoadedDetector { size: format!("{} px", owl.edge_px()), detector: Box::new(owl) })
            }
        }
    }

    /// Distinguishes checkpoints of the same name.
    pub(crate) fn identity(&self) -> &str {
        match self {
            Self::Glip(files) => &files.identity,
            Self::Dino(folder) | Self::Owl(folder) => &folder.identity,
        }
    }

    /// The memory that the detector takes, bytes: its weights at a precision, and the features of pictures that it
    /// keeps.
    pub(crate) fn memory_bytes(&self, precision: WeightPrecision) -> Result<u64, LocalError> {
        let (weights, feature_bytes) = match self {
            Self::Glip(files) => (memory::checkpoint_file_bytes(&files.weights, precision)?, glip::FEATURE_CACHE_BYTES),
            Self::Dino(folder) => (memory::checkpoint_bytes(&folder.path, precision)?, dino::FEATURE_CACHE_BYTES),
            Self::Owl(folder) => (memory::checkpoint_bytes(&folder.path, precision)?, owl::FEATURE_CACHE_BYTES),
        };
        Ok(weights.saturating_add(feature_bytes as u64))
    }
}
