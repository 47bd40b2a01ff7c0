//! Detectors in process: which kinds of checkpoints detect, and how their calls are kept.
//!
//! To add an architecture: a kind in [`Kind`], the line by which [`Kind::read`] knows it, and its line in
//! [`Kind::load`].

mod kept;

pub use kept::LocalDetector;

use crate::{
    Device, LocalError, Precision,
    hub::ModelFolder,
    json,
    owl::{self, Owl},
};
use serde::Deserialize;
use wayword_core::Detector;

/// The kind of a checkpoint that detects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Owl,
}

/// A loaded detector.
pub(crate) struct Ready {
    pub(crate) detector: Box<dyn Detector>,
    /// How large pictures are for the network, in words: beside weights, picture and phrases it could change what is
    /// found.
    pub(crate) size: String,
}

/// The part of `config.json` that gives the kind.
#[derive(Deserialize)]
struct Config {
    model_type: Option<String>,
}

impl Kind {
    /// The kind of a model's files.
    pub(crate) fn read(folder: &ModelFolder) -> Result<Self, LocalError> {
        let config: Config = json::read(&folder.path, "config.json", "the configuration")?;
        match config.model_type.as_deref() {
            Some("owlv2") => Ok(Self::Owl),
            other => Err(LocalError::File {
                file: folder.path.join("config.json"),
                problem: format!("model_type {}: such a model cannot detect in process", other.unwrap_or("(none)")),
                hint: "choose a detector, such as hf/google/owlv2-base-patch16-ensemble",
            }),
        }
    }

    /// Loads a detector. `name` is its name, `hf/ORG/NAME`.
    pub(crate) fn load(
        self,
        name: &str,
        folder: &ModelFolder,
        device: &Device,
        precision: Precision,
    ) -> Result<Ready, LocalError> {
        match self {
            Self::Owl => {
                let owl = Owl::load(name, &folder.path, device, precision)?;
                Ok(Ready { size: format!("{} px", owl.edge_px()), detector: Box::new(owl) })
            }
        }
    }

    /// The bytes of pictures' features that such a detector keeps beside its weights.
    pub(crate) fn kept_bytes(self) -> u64 {
        match self {
            Self::Owl => owl::KEPT_BYTES as u64,
        }
    }
}
