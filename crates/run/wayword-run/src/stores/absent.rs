//! Replaces object stores in a build without the feature `cloud`: every attempt to open one is an error.

use crate::error::CommandError;
use std::{
    convert::Infallible,
    path::{Path, PathBuf},
};
use wayword_queue::{ChunkBoard, ChunkPlan, QueueError, ShardBoard};

/// The error of a build without object stores. Released programs are built without them.
fn not_built(address: &str) -> CommandError {
    CommandError::usage(
        format!("{address}: this build cannot reach object stores"),
        "build it with `cargo build --release --features full,cloud`",
    )
}

pub(super) fn fetch_data(address: &str) -> Result<PathBuf, CommandError> {
    Err(not_built(address))
}

/// Has no values: in this build no run can be in an object store.
pub(super) struct CloudRun(Infallible);

impl CloudRun {
    pub(super) fn open(address: &str, _: &Path) -> Result<Self, CommandError> {
        Err(not_built(address))
    }

    pub(super) fn check_store(&self) -> Result<(), QueueError> {
        match self.0 {}
    }

    pub(super) fn fetch_file(&self, _: &str) -> Result<(), QueueError> {
        match self.0 {}
    }

    pub(super) fn publish_file(&self, _: &str) -> Result<(), QueueError> {
        match self.0 {}
    }

    pub(super) fn fetch_marks(&self, _: &ChunkPlan) -> Result<(), QueueError> {
        match self.0 {}
    }

    pub(super) fn send_marks(&self, _: &ChunkPlan) -> Result<(), QueueError> {
        match self.0 {}
    }

    pub(super) fn reopen_chunk(&self, _: usize) -> Result<(), QueueError> {
        match self.0 {}
    }

    pub(super) fn fetch_run(&self, _: &dyn Fn(usize, usize)) -> Result<(), QueueError> {
        match self.0 {}
    }

    /// The type of the board does not matter, because this is never called.
    pub(super) fn sending_board(&self, _: &dyn ChunkBoard) -> ShardBoard<'static> {
        match self.0 {}
    }
}
