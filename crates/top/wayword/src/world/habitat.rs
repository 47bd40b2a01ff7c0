//! Habitat's scenes.

use crate::error::Error;
use std::path::Path;
use wayword_core::Platform;
use wayword_habitat::{HabitatOptions, HabitatPlatform};

pub(super) fn open(data: &Path) -> Result<Box<dyn Platform>, Error> {
    Ok(Box::new(HabitatPlatform::open(data, HabitatOptions::default())?))
}
