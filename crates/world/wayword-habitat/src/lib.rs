//! Reads Habitat's scenes and navmeshes, plans paths on them and draws them, without Habitat.
//!
//! Everything that this crate returns is in Wayword's frame (metres, z up, north is +y); files are in Habitat's.

pub mod axes;
pub mod bake;
mod file_error;
pub mod ground;
pub mod navmesh;
pub mod platform;
pub mod scene;
mod semantics;
mod triangle_columns;
pub mod walk;

pub use file_error::FileError;
pub use ground::{Foothold, GeodesicError, GroundStride, NavMeshGround};
pub use navmesh::{NavMesh, NavMeshError, NavMeshSettings};
pub use platform::{HabitatOptions, HabitatPlatform};
