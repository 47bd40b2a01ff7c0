//! ThreeDWorld: a controller for the live build (TDW's executable), and the platform on top of it.
//!
//! The build connects to the controller's port. From then on each list of commands gets one answer. Byte layouts are
//! those of the Python client `tdw`, versions 1.11 to 1.13.0.0.

mod commands;
mod controller;
mod error;
mod flat;
mod output;
mod pictures;
mod platform;
mod scenes;
mod session;
#[cfg(feature = "stand-in")]
pub mod stand_in;
mod zmtp;

pub use commands::{Command, Frequency, GridPoint, Quaternion, Vector3};
pub use controller::{BuildVersion, Controller, ControllerOptions, Response};
pub use error::TdwError;
pub use flat::Misread;
pub use output::{
    Avatar, Bounds, Camera, Images, NavMeshPath, Occupancy, OnNavMesh, Output, OutputError, Pass, Region, Segment,
    Sensor, Transform, Version,
};
pub use pictures::depth_m;
pub use platform::{Tdw, TdwOptions, TdwPlatform};
pub use zmtp::WireError;

#[cfg(test)]
mod tests;
