//! The loop of one worker: takes chunks from a board, has them made, and reports the outcome of each.

use crate::{ChunkBoard, ChunkClaim, ChunkRecord, QueueError};
use std::{thread, time::Duration};

/// How often a worker asks again while others still have chunks, which come back if they die.
const ASK_AGAIN: Duration = Duration::from_secs(2);
/// How often it checks meanwhile whether it has to stop.
const LOOK_UP: Duration = Duration::from_millis(100);

/// How a worker's attempt to make a chunk ended.
#[derive(Debug)]
pub enum ChunkOutcome<S> {
    /// It is finished, and its results are synced.
    Done(ChunkRecord),
    /// The worker has to stop, through no fault of the chunk.
    Stopped(S),
    /// The chunk could not be made, for this reason, and the worker stops.
    Failed(String, S),
}

/// The work of one worker, as it ended.
#[derive(Debug)]
pub struct WorkSummary<S> {
    /// The chunks that it finished.
    pub done: Vec<ChunkRecord>,
    /// How many of its results were dropped, because another worker had taken over.
    pub dropped: usize,
    /// Why it stopped while chunks were left; `None` if all were finished.
    pub stopped: Option<S>,
}

/// Takes chunks from a board until no chunk is left, or the worker has to stop. While other workers have chunks it waits:
/// their chunks become open again if they die.
///
/// # Errors
/// When the board cannot be reached, or `make` returns an error.
pub fn work_chunks<S, E: From<QueueError>>(
    board: &dyn ChunkBoard,
    mut make: impl FnMut(ChunkClaim) -> Result<ChunkOutcome<S>, E>,
    stopped: impl Fn() -> Option<S>,
) -> Result<WorkSummary<S>, E> {
    let mut finished = WorkSummary { done: Vec::new(), dropped: 0, stopped: None };
    loop {
        if let Some(why) = stopped() {
            finished.stopped = Some(why);
            return Ok(finished);
        }
        let Some(claimed) = board.take_chunk()? else {
            let left = board.count_remaining()?;
            if left.open + left.running == 0 {
                return Ok(finished);
            }
            wait_or_stop(&stopped);
            continue;
        };
        match make(claimed)? {
            ChunkOutcome::Done(done) => match board.complete_chunk(claimed, &done)? {
                true => finished.done.push(done),
                false => finished.dropped += 1,
            },
            ChunkOutcome::Stopped(why) => {
                board.hand_back(claimed)?;
                finished.stopped = Some(why);
                return Ok(finished);
            }
            ChunkOutcome::Failed(reason, why) => {
                board.give_up(claimed, &reason)?;
                finished.stopped = Some(why);
                return Ok(finished);
            }
        }
    }
}

fn wait_or_stop<S>(stopped: &impl Fn() -> Option<S>) {
    let mut left = ASK_AGAIN;
    while !left.is_zero() && stopped().is_none() {
        thread::sleep(LOOK_UP);
        left = left.saturating_sub(LOOK_UP);
    }
}
