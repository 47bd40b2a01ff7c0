//! CLIP: turns pictures and texts into vectors that can be compared (ViT-B/32, B/16, L/14 and similar models). OWLv2
//! uses the same two networks, which are called towers.

mod config;
mod grounder;
mod layers;
mod model;
mod text;
mod vision;

pub(crate) use config::{ClipConfig as TowersConfig, TowerFamily};
pub use grounder::ClipGrounder;
pub use model::ClipModel;
pub(crate) use text::TextTower;
pub(crate) use vision::VisionTower;
