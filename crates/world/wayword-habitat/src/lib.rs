//! Reads Habitat's scenes and navmeshes, plans paths on them and draws them, without Habitat.
//!
//! Everything that this crate returns is in Wayword's frame (metres, z up, north is +y); files are in Habitat's.
//!
//! # Where things are
//! - [`scene`], [`navmesh`], [`bake`]: the files of scenes and navmeshes, and baking where there is none.
//! - [`ground`]: shortest ways, storeys and viewpoints; `ground/stride.rs` for single steps.
//! - [`walk`]: walks as an agent's actions.
//! - `semantics/`: labels and rooms; `semantics/rooms/rooms.txt` has the rules by which HM3D's rooms get names, `hallway.rs` those for hallways.
//! - `platform/islands.rs`: the island of a navmesh on which paths lie.
//! - `placement/`: which direction of a scene is up, and how long its unit is, judged by its floors.
//! - `platform/graph_pairing.rs`, `graph_fit.rs`: which viewpoint graph belongs to a scene, and whether it lies in it.
//! - `platform/examine.rs`: the report about a scene before a run.
//! - [`axes`]: the conversion of frames.

pub mod axes;
pub mod bake;
mod file_error;
pub mod ground;
pub mod navmesh;
mod placement;
pub mod platform;
pub mod scene;
mod semantics;
mod triangle_columns;
pub mod walk;

pub use file_error::FileError;
pub use ground::{Foothold, GeodesicError, GroundStride, NavMeshGround};
pub use navmesh::{NavMesh, NavMeshError, NavMeshSettings};
pub use platform::{HabitatOptions, HabitatPlatform};
