//! What hands chunks to workers.

use crate::{Done, QueueError};

/// A chunk that a worker has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Claimed {
    /// Its number.
    pub chunk: usize,
    /// The claim: part of every completion. 0 in a shard, where each chunk has one writer.
    pub epoch: i64,
}

/// What is left to do.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Left {
    /// Chunks that nobody has.
    pub open: usize,
    /// Chunks that workers have.
    pub running: usize,
}

/// Hands chunks to one worker.
pub trait Board {
    /// A chunk to make; `None` if none is open.
    ///
    /// # Errors
    /// When the board cannot be reached.
    fn take(&self) -> Result<Option<Claimed>, QueueError>;

    /// Records a finished chunk, whose results are synced. `false` if the claim does not hold any more: the results are
    /// then another worker's to make, and these are dropped.
    ///
    /// # Errors
    /// When the board cannot be reached.
    fn complete(&self, claimed: Claimed, done: &Done) -> Result<bool, QueueError>;

    /// Gives a chunk back that was not finished because the worker has to stop.
    ///
    /// # Errors
    /// When the board cannot be reached.
    fn hand_back(&self, claimed: Claimed) -> Result<(), QueueError>;

    /// Says that a chunk could not be made. It is tried again, and given up after [`crate::TRIES`] tries.
    ///
    /// # Errors
    /// When the board cannot be reached.
    fn give_up(&self, claimed: Claimed, reason: &str) -> Result<(), QueueError>;

    /// What is left to do, for this worker or for others.
    ///
    /// # Errors
    /// When the board cannot be reached.
    fn left(&self) -> Result<Left, QueueError>;
}
