//! A build that writes no video: it says how to get one.

use super::Reel;
use crate::error::Error;
use std::path::Path;

pub(super) fn check() -> Result<(), Error> {
    Err(Error::usage(
        "this build writes no video",
        "build it with `cargo build --release --features full`, or end --out in .gif or /",
    ))
}

pub(super) fn open(_: &Path, _: f64) -> Result<Box<dyn Reel>, Error> {
    Err(Error::usage("this build writes no video", "end --out in .gif or /"))
}
