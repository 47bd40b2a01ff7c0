//! Two platforms: Matterport3D, and any simulator as a child process.
//!
//! [`matterport`] reads Matterport3D's buildings from the files of the dataset, its simulator and REVERIE. [`guard_process`]
//! gets paths and views from another program, over its standard input and output.

pub mod matterport;
pub mod process;

pub use matterport::MatterportPlatform;
pub use process::ProcessPlatform;
