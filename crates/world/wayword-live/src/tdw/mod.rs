//! ThreeDWorld: a controller for the live build (TDW's executable), and the platform on top of it.
//!
//! The build connects to the controller's port. From then on each list of commands gets one answer. Byte layouts are
//! those of the Python client `tdw`, versions 1.11 to 1.13.0.0.

mod commands;
mod controller;
mod error;
mod flatbuffer_reader;
mod output;
mod pictures;
mod platform;
mod scenes;
mod session;
#[cfg(feature = "stand-in")]
pub mod stand_in;
mod zmtp;

pub use commands::{BuildCommand, GridPoint, SendFrequency, TdwQuaternion, TdwVector3};
pub use controller::{BuildResponse, BuildVersion, ControllerOptions, TdwController};
pub use error::TdwError;
pub use flatbuffer_reader::FlatBufferError;
pub use output::{
    AvatarImages, AvatarPose, AvatarSensor, BuildOutput, NavMeshPath, OnNavMesh, OutputError, PicturePass,
    SegmentedObject, TdwCameraMatrices, TdwObjectBounds, TdwObjectTransform, TdwOccupancyMap, TdwRegion, VersionOutput,
};
pub use pictures::depth_m;
pub use platform::{TdwOptions, TdwPlatform, TdwSimulator};
pub use zmtp::WireError;

#[cfg(test)]
mod tests;
