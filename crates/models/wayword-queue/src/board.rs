//! The interface through which workers get chunks and report their outcome.

use crate::{ChunkRecord, QueueError};

/// A worker's claim of a chunk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ChunkClaim {
    /// The number of the chunk.
    pub chunk: usize,
    /// The number of the claim. Every report must name it, so that reports of an older claim are recognised. 0 in a shard,
    /// where each chunk has one writer.
    pub epoch: i64,
}

/// How many chunks are not finished.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RemainingChunks {
    /// Chunks without a worker.
    pub open: usize,
    /// Chunks that workers have.
    pub running: usize,
}

/// Hands chunks to one worker.
pub trait ChunkBoard {
    /// A chunk to make; `None` if none is open.
    ///
    /// # Errors
    /// When the board cannot be reached.
    fn take_chunk(&self) -> Result<Option<ChunkClaim>, QueueError>;

    /// Records a finished chunk. Its results must be synced before. Returns `false` if the claim is no longer valid: another
    /// worker then has the chunk, and these results are dropped.
    ///
    /// # Errors
    /// When the board cannot be reached.
    fn complete_chunk(&self, claimed: ChunkClaim, done: &ChunkRecord) -> Result<bool, QueueError>;

    /// Gives a chunk back that was not finished because the worker has to stop.
    ///
    /// # Errors
    /// When the board cannot be reached.
    fn hand_back(&self, claimed: ChunkClaim) -> Result<(), QueueError>;

    /// Reports that a chunk could not be made. It is tried again, and given up after [`crate::MAX_CHUNK_TRIES`] tries.
    ///
    /// # Errors
    /// When the board cannot be reached.
    fn give_up(&self, claimed: ChunkClaim, reason: &str) -> Result<(), QueueError>;

    /// How many chunks are not finished, for this worker or for others.
    ///
    /// # Errors
    /// When the board cannot be reached.
    fn count_remaining(&self) -> Result<RemainingChunks, QueueError>;
}
