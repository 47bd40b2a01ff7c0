//! The loop of one worker: takes chunks from a board, has them made, and reports the outcome of each.

use crate::{ChunkBoard, ChunkClaim, ChunkRecord, QueueError};
use std::{thread, time::Duration};

/// How often a worker asks again while others still have chunks, which come back if they die.
const ASK_AGAIN_INTERVAL: Duration = Duration::from_secs(2);
/// How often a waiting worker checks whether it has to stop.
const STOP_CHECK_INTERVAL: Duration = Duration::from_millis(100);

/// How a worker's attempt to make a chunk ended. `S` is the reason for which a worker stops, as the caller defines it.
#[derive(Debug)]
pub enum ChunkOutcome<S> {
    /// It is finished, and its results are synced.
    Done(ChunkRecord),
    /// The worker has to stop, through no fault of the chunk.
    Stopped(S),
    /// The chunk could not be made, for the reason in the text, and the worker stops.
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
/// their chunks become open again if they die. `make` makes a chunk. `stopped` gives the reason to stop, if there is one.
///
/// # Errors
/// When the board cannot be reached, or `make` returns an error.
pub fn work_chunks<S, E: From<QueueError>>(
    board: &dyn ChunkBoard,
    mut make: impl FnMut(ChunkClaim) -> Result<ChunkOutcome<S>, E>,
    stopped: impl Fn() -> Option<S>,
) -> Result<WorkSummary<S>, E> {
    let mut summary = WorkSummary { done: Vec::new(), dropped: 0, stopped: None };
    loop {
        if let Some(why) = stopped() {
            summary.stopped = Some(why);
            return Ok(summary);
        }
        let Some(claimed) = board.take_chunk()? else {
            let remaining = board.count_remaining()?;
            if remaining.open + remaining.running == 0 {
                return Ok(summary);
            }
            wait_or_stop(&stopped);
            continue;
        };
        match make(claimed)? {
            ChunkOutcome::Done(done) => match board.complete_chunk(claimed, &done)? {
                true => summary.done.push(done),
                false => summary.dropped += 1,
            },
            ChunkOutcome::Stopped(why) => {
                board.hand_back(claimed)?;
                summary.stopped = Some(why);
                return Ok(summary);
            }
            ChunkOutcome::Failed(reason, why) => {
                board.give_up(claimed, &reason)?;
                summary.stopped = Some(why);
                return Ok(summary);
            }
        }
    }
}

/// Waits for [`ASK_AGAIN_INTERVAL`], or until the worker has to stop.
fn wait_or_stop<S>(stopped: &impl Fn() -> Option<S>) {
    let mut remaining = ASK_AGAIN_INTERVAL;
    while !remaining.is_zero() && stopped().is_none() {
        thread::sleep(STOP_CHECK_INTERVAL);
        remaining = remaining.saturating_sub(STOP_CHECK_INTERVAL);
    }
}
