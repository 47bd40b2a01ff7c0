//! The built-in platform: whole homes from a seed.

mod catalogue;
mod colour;
mod dice;
mod drawing;
mod furnish;
mod graph;
mod ground;
mod home;
mod labels;
mod layout;
mod light;
pub mod model;
mod names;
mod objects;
mod platform;
mod rect;
mod sample;
mod save;
mod scene;
mod shapes;
mod stairs;
mod structure;
mod surface;
mod textures;

pub use catalogue::FurnitureKind;
pub use colour::Colour;
pub use graph::{EYE_M, viewpoint_graph};
pub use ground::{Ground, NoWay, RADIUS_CM, Way};
pub use home::generate;
pub use model::House;
pub use names::{scene_name, seed_of};
pub use objects::{Object, Role};
pub use platform::{HouseOptions, HousePlatform};
pub use rect::{RectCm, SpanCm, Wall};
pub use save::{SaveError, Saved, glb, gltf_from_wayword, navigation, save, semantic_glb, semantic_txt};
pub use scene::HouseScene;
