//! Detectors in process: which checkpoints are detectors, how they are loaded, and how the ledger keeps their answers.
//!
//! To add an architecture, add a variant to [`Checkpoint`], the line by which [`Checkpoint::find`] recognises it, its
//! line in [`Checkpoint::load`], and the bytes of features that it keeps in [`Checkpoint::bytes`].

mod kept;

pub use kept::LocalDetector;

use crate::{
    Device, LocalError, Precision,
    dino::{self, Dino},
    glip::{self, Glip, GlipFiles},
    hub::{Hub, ModelFolder, ModelName, Needs, Progress},
    json, memory,
    owl::{self, Owl},
};
use serde::Deserialize;
use wayword_core::Detector;

/// The files of a detector, by its kind.
#[derive(Debug)]
pub(crate) enum Checkpoint {
    Glip(GlipFiles),
    Dino(ModelFolder),
    Owl(ModelFolder),
}

/// A loaded detector.
pub(crate) struct Ready {
    pub(crate) detector: Box<dyn Detector>,
    /// The size to which pictures are resized, in words. It is part of a call's key, because it may change the boxes.
    pub(crate) size: String,
}

/// The field of `config.json` that identifies the architecture.
#[derive(Deserialize)]
struct Config {
    model_type: Option<String>,
}

impl Checkpoint {
    /// Finds the files of a detector by its name, and fetches missing ones. A file as training leaves it (`.pth`) is
    /// taken for GLIP's; the architecture of a folder is read from its `config.json`.
    pub(crate) fn find(hub: &Hub, name: &ModelName, progress: &dyn Progress) -> Result<Self, LocalError> {
        if name.is_trained() {
            return GlipFiles::find(hub, name, progress).map(Self::Glip);
        }
        let folder = hub.folder(name, &Needs::of_any(name), progress)?;
        let config: Config = json::read(&folder.path, "config.json", "the configuration")?;
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
    pub(crate) fn load(&self, name: &str, device: &Device, precision: Precision) -> Result<Ready, LocalError> {
        match self {
            Self::Glip(files) => {
                let edge_px = Glip::SHORT_EDGE_PX;
                let glip = Glip::load(name, files, edge_px, device, precision)?;
                Ok(Ready { size: format!("{edge_px} px, short edge"), detector: Box::new(glip) })
            }
            Self::Dino(folder) => {
                let dino = Dino::load(name, &folder.path, device, precision)?;
                Ok(Ready { size: "as its preprocessor says".to_owned(), detector: Box::new(dino) })
            }
            Self::Owl(folder) => {
                let owl = Owl::load(name, &folder.path, device, precision)?;
                Ok(Ready { size: format!("{} px", owl.edge_px()), detector: Box::new(owl) })
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
    pub(crate) fn bytes(&self, precision: Precision) -> Result<u64, LocalError> {
        let (weights, kept) = match self {
            Self::Glip(files) => (memory::of_file(&files.weights, precision)?, glip::FEATURES_BYTES),
            Self::Dino(folder) => (memory::of_checkpoint(&folder.path, precision)?, dino::KEPT_BYTES),
            Self::Owl(folder) => (memory::of_checkpoint(&folder.path, precision)?, owl::KEPT_BYTES),
        };
        Ok(weights.saturating_add(kept as u64))
    }
}
