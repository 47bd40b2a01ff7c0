//! A build that speaks to no simulator that runs beside it: it says how to get one.

use crate::error::Error;
use std::path::Path;
use wayword_core::Platform;

pub(super) fn tdw(_: Option<&Path>, _: Option<&str>) -> Result<Box<dyn Platform>, Error> {
    Err(absent())
}

pub(super) fn virtualhome(_: Option<&str>) -> Result<Box<dyn Platform>, Error> {
    Err(absent())
}

fn absent() -> Error {
    Error::usage("this build speaks to no live simulator", "build it with `cargo build --release --features full`")
}
