//! The built-in platform: whole homes that are generated from a seed.
//!
//! The steps, in order: `layout` plans rooms, doors and windows, `furnish` fills the rooms, `structure` and `shapes` build
//! the meshes, `light` bakes light into them, and `drawing` puts everything together. `ground` and `graph` find where one
//! can walk, and `platform` offers all of it to the rest of Wayword. `save` writes a house for other programs.

mod catalogue;
mod colour;
mod dice;
mod drawing;
mod furnish;
mod graph;
mod ground;
mod labels;
mod layout;
mod leaf;
mod light;
pub mod model;
mod names;
mod objects;
mod outlook;
mod platform;
mod prepared_house;
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
pub use drawing::build_surfaces;
pub use graph::{EYE_M, viewpoint_graph};
pub use ground::{GroundRouteError, HouseGround, HouseRoute, RADIUS_CM};
pub use model::House;
pub use names::{scene_name, seed_of};
pub use objects::{NumberedObject, ObjectRole};
pub use platform::{HouseOptions, HousePlatform};
pub use prepared_house::generate_house;
pub use rect::{RectCm, SpanCm, WallSide};
pub use save::{
    HouseFiles, SaveError, encode_glb, gltf_from_wayword, navigation_json, save_house, semantic_glb, semantic_txt,
};
pub use scene::HouseScene;
