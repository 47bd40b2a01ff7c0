//! Models in process, from the public checkpoints as they are: MiniLM, CLIP, BLIP and BLIP-2.
//!
//! candle holds tensors and devices; the models are files of our own on operators of our own (`ops`), because candle's stock
//! code is several times slower on a processor and lacks half of them.
//!
//! Architecture invariant: a checkpoint is untrusted. It is read tensor by tensor, each held against the shape that the
//! configuration demands, and nothing in it is executed.

mod bert;
mod blip;
mod blip2;
mod clip;
mod device;
mod error;
mod eyes;
mod greedy;
mod hub;
mod json;
mod kept;
mod memory;
mod minds;
mod ops;
mod picture;
mod text;
mod weights;

pub use bert::SentenceEncoder;
pub use blip::{BlipCaptioner, BlipVqa};
pub use blip2::Blip2;
pub use clip::{Clip, ClipGrounder};
pub use device::{Device, Precision};
pub use error::LocalError;
pub use eyes::EyeKind;
pub use hub::{CachedModel, Hub, HubConfig, ModelFolder, ModelName, Needs, Progress};
pub use kept::LocalModel;
pub use minds::{Loading, Minds};
