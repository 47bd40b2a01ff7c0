//! Where paths and views come from: the built-in house, Matterport3D, and any simulator as a child process.
//!
//! [`house`] makes homes from seeds. [`matterport`] reads Matterport3D's buildings as their dataset, simulator and REVERIE
//! ship them. [`process`] asks another program. [`episode_path`] turns an episode of any of these worlds into a path. [`files`],
//! [`recent`] and [`wander`] are what worlds share.

pub mod episode_path;
pub mod files;
pub mod house;
pub mod matterport;
pub mod process;
pub mod recent;
pub mod wander;

pub use episode_path::{labels_around, path_of};
pub use house::HousePlatform;
pub use matterport::Matterport;
pub use process::ProcessPlatform;
