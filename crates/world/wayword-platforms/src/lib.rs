//! Where paths and views come from: Matterport3D, and any simulator as a child process.
//!
//! [`matterport`] reads Matterport3D's buildings as their dataset, simulator and REVERIE ship them. [`process`] asks another
//! program.

pub mod matterport;
pub mod process;

pub use matterport::Matterport;
pub use process::ProcessPlatform;
