//! Replaces object stores in a build without the feature `cloud`: every attempt to open one is an error.

use crate::error::Error;
use std::{
    convert::Infallible,
    path::{Path, PathBuf},
};
use wayword_queue::{Board, Plan, QueueError, Shard};

/// The error of a build without object stores. Released programs are built without them.
fn not_built(address: &str) -> Error {
    Error::usage(
        format!("{address}: this build cannot reach object stores"),
        "build it with `cargo build --release --features full,cloud`",
    )
}

pub(super) fn fetched(address: &str) -> Result<PathBuf, Error> {
    Err(not_built(address))
}

/// Has no values: in this build no run can be in an object store.
pub(super) struct StoredRun(Infallible);

impl StoredRun {
    pub(super) fn open(address: &str, _: &Path) -> Result<Self, Error> {
        Err(not_built(address))
    }

    pub(super) fn check(&self) -> Result<(), QueueError> {
        match self.0 {}
    }

    pub(super) fn fetch_file(&self, _: &str) -> Result<(), QueueError> {
        match self.0 {}
    }

    pub(super) fn publish(&self, _: &str) -> Result<(), QueueError> {
        match self.0 {}
    }

    pub(super) fn fetch_marks(&self, _: &Plan) -> Result<(), QueueError> {
        match self.0 {}
    }

    pub(super) fn send_marks(&self, _: &Plan) -> Result<(), QueueError> {
        match self.0 {}
    }

    pub(super) fn reopen(&self, _: usize) -> Result<(), QueueError> {
        match self.0 {}
    }

    pub(super) fn fetch(&self, _: &dyn Fn(usize, usize)) -> Result<(), QueueError> {
        match self.0 {}
    }

    /// Any board would do.
    pub(super) fn sending(&self, _: &dyn Board) -> Shard<'static> {
        match self.0 {}
    }
}
