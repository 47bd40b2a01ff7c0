//! A build without Habitat's scenes: it says how to get one.

use crate::error::Error;
use std::path::Path;
use wayword_core::Platform;

pub(super) fn open(_: &Path) -> Result<Box<dyn Platform>, Error> {
    Err(Error::usage("this build reads no Habitat scenes", "build it with `cargo build --release --features full`"))
}
