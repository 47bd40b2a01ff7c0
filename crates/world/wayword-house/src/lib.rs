//! The built-in platform: whole homes that are generated from a seed.
//!
//! The steps, in order: `layout` plans rooms, doors and windows, `furnish` fills the rooms, `structure` and `shapes` build
//! the meshes, `light` bakes light into them, and `drawing` puts everything together. `ground` and `graph` find where one
//! can walk, and `platform` offers all of it to the rest of Wayword. `save` writes a house for other programs.
//!
//! # Where things are
//! - `catalogue`: the kinds of furniture. A new kind also gets a shape in `shapes/`, and a room in `furnish/`.
//! - `layout/program.rs`: which rooms a storey has; `door_angles.rs` how far doors are open, `leaf` where a door's leaf then is.
//! - `furnish/`: one file for each kind of room; `finish.rs` for wood, `built_in.rs` for closets and radiators, `wall_hangings.rs` and
//!   `stairwell.rs` for bare walls.
//! - `shapes/clutter.rs`: small things on tables and shelves.
//! - `light/`: `sun.rs`, `casters.rs` for shadows, `cut.rs` for the edges of light on a surface.
//! - `outlook` and `textures/outside.rs`: what lies outside the windows.
//! - `save/`: the files of a house, for Habitat and others.
//! - `names`: the names of houses, with the version of the generator.

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
mod open_line;
mod outlook;
mod platform;
mod prepared_house;
mod rect;
mod sample;
mod save;
mod scene;
mod shapes;
mod stairs;
mod standing_places;
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
pub use scene::{HousePictureError, HouseScene};
