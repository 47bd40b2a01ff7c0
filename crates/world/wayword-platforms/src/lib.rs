//! Where paths and views come from: Matterport3D, and any simulator as a child process.
//!
//! [`matterport`] reads Matterport3D's buildings as the dataset, its simulator and REVERIE provide them. [`process`]
//! asks another program.

pub mod matterport;
pub mod process;

pub use matterport::Matterport;
pub use process::ProcessPlatform;
