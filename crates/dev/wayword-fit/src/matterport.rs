//! Opens the platform whose labels all fits use.

use std::path::Path;
use wayword_core::Platform;
use wayword_run::{
    error::CommandError,
    platforms,
    settings::{AskedPlatform, AskedSettings},
};

/// Matterport3D with REVERIE's labels, from this folder.
///
/// # Errors
/// When the data cannot be read.
pub(crate) fn open_matterport(data: &Path) -> Result<Box<dyn Platform>, CommandError> {
    let matterport =
        AskedPlatform { platform: Some("matterport".into()), data: Some(data.to_owned()), ..AskedPlatform::default() };
    platforms::open_platform(&AskedSettings::from(matterport).resolve()?)
}
