//! The rules by which chunks change hands, as pure functions. The queue in PostgreSQL follows them in SQL. One test
//! compares the two (`tests/parity.rs`), and a model of many workers checks the consequences (`tests/model.rs`).

use serde::{Deserialize, Serialize};

/// How often a chunk is begun without success before it is given up.
pub const MAX_CHUNK_TRIES: i32 = 3;

/// The state of a chunk.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChunkState {
    /// The next worker that asks gets it.
    Open,
    /// A worker has it.
    Running,
    /// Finished.
    Done,
    /// Given up after [`MAX_CHUNK_TRIES`] tries.
    Dead,
}

/// A chunk on a board. `W` names workers.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct ChunkRow<W> {
    /// Its state.
    pub state: ChunkState,
    /// The number of the latest claim. It only goes up.
    pub epoch: i64,
    /// Claims that ended without a report, or in a failure.
    pub tries: i32,
    /// The worker that has or had it.
    pub worker: Option<W>,
}

impl<W> Default for ChunkRow<W> {
    fn default() -> Self {
        Self { state: ChunkState::Open, epoch: 0, tries: 0, worker: None }
    }
}

impl<W: Clone + PartialEq> ChunkRow<W> {
    /// Gives the chunk to a worker, and returns its epoch. A chunk that runs is taken from a worker that is gone; after too
    /// many tries it is given up instead.
    pub fn claim_chunk(&mut self, by: &W, is_gone: impl Fn(&W) -> bool) -> Option<i64> {
        let abandoned = self.state == ChunkState::Running && self.worker.as_ref().is_none_or(is_gone);
        if abandoned && self.tries >= MAX_CHUNK_TRIES {
            self.state = ChunkState::Dead;
        }
        if self.state != ChunkState::Open && !(self.state == ChunkState::Running && abandoned) {
            return None;
        }
        self.state = ChunkState::Running;
        self.epoch += 1;
        self.tries += 1;
        self.worker = Some(by.clone());
        Some(self.epoch)
    }

    /// Records a result if it belongs to the latest claim, and returns whether it does. A result of any other claim is dropped.
    pub fn complete_claim(&mut self, epoch: i64) -> bool {
        let holds = self.state == ChunkState::Running && self.epoch == epoch;
        if holds {
            self.state = ChunkState::Done;
        }
        holds
    }

    /// Gives the chunk back, unfinished and through no fault of the chunk. This does not count as a try. Returns whether the claim
    /// was the latest; otherwise nothing changes.
    pub fn hand_back(&mut self, epoch: i64) -> bool {
        let holds = self.state == ChunkState::Running && self.epoch == epoch;
        if holds {
            self.state = ChunkState::Open;
            self.tries -= 1;
        }
        holds
    }

    /// Records that a worker could not make the chunk: it is open again or, after too many tries, given up. Returns whether the claim
    /// was the latest; otherwise nothing changes.
    pub fn give_up(&mut self, epoch: i64) -> bool {
        let holds = self.state == ChunkState::Running && self.epoch == epoch;
        if holds {
            self.state = if self.tries >= MAX_CHUNK_TRIES { ChunkState::Dead } else { ChunkState::Open };
        }
        holds
    }
}
