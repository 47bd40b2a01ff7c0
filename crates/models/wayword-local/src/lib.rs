//! Runs models inside this process, from their unchanged public checkpoints: MiniLM, CLIP, BLIP, BLIP-2, OWLv2, the
//! Grounding DINO family and GLIP.
//!
//! Tensors and devices come from the library candle. The models and their operators (`ops`) are this crate's own,
//! because candle's models are several times slower on a CPU, and candle lacks half of them.
//!
//! Architecture invariant: a checkpoint is untrusted. It is read tensor by tensor, the shape of each is checked against
//! the configuration, and no code in it is executed.
//!
//! # Where things are
//! - `models`: the names of models that see, and how they are loaded. `detectors/mod.rs` is the same for detectors.
//! - One folder for each architecture, as `blip/`, built from `ops/`. GLIP and the Grounding DINO family share the backbone `swin/`.
//! - `scoring` in `glip/detector.rs`, `dino/detect.rs` and `owl/model.rs`: what a detector's score means, and from which score it finds.
//! - `call_ledger`, `detectors/local_detector.rs`: what the ledger keeps of a call.
//! - `hub/`: where checkpoints come from; `hub/trust.rs` has the published hashes.
//! - `weights/`: how tensors are read; `training_checkpoint.rs` and `pickle/machine.rs` read `.pth` files without executing them.
//! - `instructions`: token ids for the files of navigation agents.

mod bert;
mod blip;
mod blip2;
mod call_ledger;
mod clip;
mod detectors;
mod device;
mod dino;
mod error;
mod glip;
mod greedy;
mod hub;
mod instructions;
mod json;
mod memory;
mod models;
mod ops;
mod owl;
mod picture;
mod picture_models;
mod swin;
mod tokenizer;
mod weights;

pub use bert::SentenceEncoder;
pub use blip::{BlipCaptioner, BlipVqa};
pub use blip2::Blip2Model;
pub use call_ledger::LocalModel;
pub use clip::{ClipGrounder, ClipModel};
pub use detectors::LocalDetector;
pub use device::{ModelDevice, WeightPrecision};
pub use dino::{DinoOutputs, GroundingDino};
pub use error::LocalError;
pub use glip::{GLIP_LICENCE, GLIP_TOKENIZER, GlipDetector, GlipFiles};
pub use hub::{CachedModel, DownloadProgress, HubConfig, ModelFolder, ModelHub, ModelName, NeededFiles};
pub use instructions::{InstructionTokenizer, TokenizerKind};
pub use models::{LoadingOptions, LocalModels};
pub use owl::{OwlDetector, OwlOutputs};
pub use picture_models::EyeKind;
