//! Runs models inside this process, from their unchanged public checkpoints: MiniLM, CLIP, BLIP, BLIP-2, OWLv2, the
//! Grounding DINO family and GLIP.
//!
//! Tensors and devices come from the library candle. The models and their operators (`ops`) are this crate's own,
//! because candle's models are several times slower on a CPU, and candle lacks half of them.
//!
//! Architecture invariant: a checkpoint is untrusted. It is read tensor by tensor, the shape of each is checked against
//! the configuration, and no code in it is executed.

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
