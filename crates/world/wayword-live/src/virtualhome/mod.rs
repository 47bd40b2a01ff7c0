//! VirtualHome: its HTTP protocol, and the platform on top of it.
//!
//! Each request is a POST of JSON with an action and its parameters. Each answer is JSON too, often with more JSON inside
//! it as text. Actions and fields are those of the Python client `virtualhome` 2.3.0 (`comm_unity.py`).

mod client;
mod error;
mod floor;
mod graph;
mod names;
mod platform;
#[cfg(feature = "stand-in")]
pub mod stand_in;

pub use client::{CameraMode, VirtualHomeCamera, VirtualHomeClient};
pub use error::HomeError;
pub use graph::{BoundingBox, EnvironmentGraph, EnvironmentNode};
pub use platform::{VirtualHome, VirtualHomeOptions, VirtualHomePlatform};
