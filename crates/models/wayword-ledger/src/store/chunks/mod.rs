//! A store for the calls of a shard. Each chunk has one file of JSON lines, its recording, to which requests and answers are
//! appended.
//!
//! It is meant for network file systems, where a file of SQLite is not safe. It uses no locks and no second file, and never overwrites
//! written bytes. The caller has to make sure that only one program at a time writes a file.

mod append;
mod line;
mod read;
mod tally;

use super::{
    CallOrder, CallQueries, CallStore, ClaimHolder, ClaimState, PendingRequest, RequestEnd, SentRequest, SqliteStore,
};
use crate::{
    CallAnswer, CallKey, CostGrouping, CostLine, LedgerEntry, LedgerError, LedgerFilter, LedgerLocation,
    RequestRefusedError, RunSpending,
    budget::{SpentBudget, check_limits},
};
use append::ChunkAppender;
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};
use tally::ChunkTally;

pub(crate) use line::ChunkEntry;

/// The recordings of a shard. Calls go to that of the current chunk, which `turn_to` selects.
#[derive(Debug, Default)]
pub(crate) struct ChunkStore {
    state: Mutex<ChunkStoreState>,
}

#[derive(Debug, Default)]
struct ChunkStoreState {
    /// The spending in the files of the other chunks.
    others: BTreeMap<PathBuf, ChunkTally>,
    current: Option<Arc<OpenChunk>>,
    /// The spending in the file of the current chunk.
    tally: ChunkTally,
}

/// The current chunk.
#[derive(Debug)]
struct OpenChunk {
    path: PathBuf,
    file: ChunkAppender,
    /// The answers of this chunk, to look them up.
    memory: SqliteStore,
}

impl ChunkStore {
    /// The recordings of a shard's chunks so far. A file that does not exist counts as empty.
    pub(crate) fn open(earlier: &[PathBuf]) -> Result<Self, LedgerError> {
        let mut others = BTreeMap::new();
        for path in earlier {
            let path = absolute_path(path)?;
            let tally = read_tally(&path)?;
            others.insert(path, tally);
        }
        Ok(Self { state: Mutex::new(ChunkStoreState { others, ..ChunkStoreState::default() }) })
    }

    fn lock_state(&self) -> MutexGuard<'_, ChunkStoreState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The chunk that `turn_to` has selected; an error if none was selected yet.
    fn current_chunk(&self) -> Result<Arc<OpenChunk>, LedgerError> {
        self.lock_state().current.clone().ok_or_else(no_chunk_error)
    }

    /// Reserves the money of a request, or refuses it. Returns the entry to write, and the chunk to write it to.
    fn reserve_request(
        &self,
        request: &PendingRequest<'_>,
    ) -> Result<(Arc<OpenChunk>, ChunkEntry), RequestRefusedError> {
        let mut state = self.lock_state();
        let chunk = state.current.clone().ok_or_else(no_chunk_error)?;
        check_limits(request.limits, state.spent_by_run(request.run), request.most_usd)?;
        let entry = ChunkEntry::Sent {
            number: state.tally.next_number(),
            run: request.run.to_owned(),
            key: request.key.clone(),
            most_usd: request.most_usd,
            at_unix_s: request.at_unix_s,
        };
        state.tally.count_entry(&entry);
        Ok((chunk, entry))
    }
}

impl ChunkStoreState {
    /// The sums of all files, the current one last.
    fn all_tallies(&self) -> impl Iterator<Item = &ChunkTally> {
        self.others.values().chain([&self.tally])
    }

    /// The part of a run's budget that is spent or reserved.
    fn spent_by_run(&self, run: &str) -> SpentBudget {
        self.all_tallies().map(|tally| tally.spent_by_run(run)).fold(SpentBudget::default(), |sum, file| SpentBudget {
            usd: sum.usd + file.usd,
            reserved_usd: sum.reserved_usd + file.reserved_usd,
            calls: sum.calls.saturating_add(file.calls),
        })
    }

    /// The requests and costs of a run, or of all runs, for reports.
    fn spending_by_run(&self, run: Option<&str>) -> RunSpending {
        self.all_tallies().map(|tally| tally.spending_by_run(run)).fold(RunSpending::default(), RunSpending::plus)
    }
}

impl OpenChunk {
    /// Opens a chunk's file, or makes it. An incomplete last line, which a crash can leave, is cut off.
    fn open(path: &Path) -> Result<(Self, ChunkTally), LedgerError> {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(LedgerError::io_error(folder, "make the folder"))?;
        }
        let (mut tally, memory) = (ChunkTally::default(), SqliteStore::in_memory()?);
        let intact_bytes = read::read_entries(path, |entry| {
            tally.count_entry(&entry);
            if let ChunkEntry::Answered { row, .. } = entry {
                memory.add_recorded_answer(*row);
            }
        })?;
        memory.flush()?;
        let file = ChunkAppender::start(path, intact_bytes)?;
        Ok((Self { path: path.to_owned(), file, memory }, tally))
    }
}

/// The spending of all runs in a file. A file that does not exist counts as empty.
pub(crate) fn spent_in(path: &Path) -> Result<RunSpending, LedgerError> {
    Ok(read_tally(path)?.spending_by_run(None))
}

/// Sums up the entries of a file.
fn read_tally(path: &Path) -> Result<ChunkTally, LedgerError> {
    let mut tally = ChunkTally::default();
    read::read_entries(path, |entry| tally.count_entry(&entry))?;
    Ok(tally)
}

/// The absolute path of a file, so that one file has one name.
fn absolute_path(path: &Path) -> Result<PathBuf, LedgerError> {
    std::path::absolute(path).map_err(LedgerError::io_error(path, "find the recording"))
}

fn no_chunk_error() -> LedgerError {
    LedgerError::Misuse {
        place: LedgerLocation::from_path(Path::new("recording")),
        reason: "no chunk was turned to yet",
    }
}

impl CallStore for ChunkStore {
    fn ledger_location(&self) -> LedgerLocation {
        LedgerLocation::File(
            self.current_chunk().map_or_else(|_| PathBuf::from("recording"), |chunk| chunk.path.clone()),
        )
    }

    fn turn_to(&self, path: &Path) -> Result<(), LedgerError> {
        let path = absolute_path(path)?;
        let mut state = self.lock_state();
        if let Some(chunk) = &state.current {
            if chunk.path == path {
                return Ok(());
            }
            chunk.file.flush()?;
        }
        let (chunk, tally) = OpenChunk::open(&path)?;
        // The file is counted once: as the current one.
        state.others.remove(&path);
        let tally = std::mem::replace(&mut state.tally, tally);
        if let Some(before) = state.current.replace(Arc::new(chunk)) {
            state.others.insert(before.path.clone(), tally);
        }
        Ok(())
    }

    fn find_answer(&self, key: &CallKey, run: &str) -> Result<Option<CallAnswer>, LedgerError> {
        self.current_chunk()?.memory.find_answer(key, run)
    }

    fn claim_call(&self, _: &CallKey, _: Option<&str>) -> Result<ClaimState, LedgerError> {
        // Only this program writes the recording, so no other one can be making the call.
        Ok(ClaimState::Ours)
    }

    fn release_call(&self, _: &CallKey) {}

    fn claim_holder(&self, _: &CallKey) -> Result<Option<ClaimHolder>, LedgerError> {
        Ok(None)
    }

    fn write_request(&self, request: &PendingRequest<'_>) -> Result<i64, RequestRefusedError> {
        let (chunk, entry) = self.reserve_request(request)?;
        let ChunkEntry::Sent { number, .. } = entry else { return Err(no_chunk_error().into()) };
        if let Err(error) = chunk.file.write_line(&entry) {
            let cancelled = ChunkEntry::Ended { number, outcome: RequestEnd::Cancelled, reason: String::new() };
            self.lock_state().tally.count_entry(&cancelled);
            return Err(error.into());
        }
        Ok(number)
    }

    fn write_end(&self, sent: &SentRequest, end: RequestEnd, reason: &str) {
        let entry = ChunkEntry::Ended { number: sent.number, outcome: end, reason: reason.to_owned() };
        // A request was sent, so there is a current chunk.
        if let Ok(chunk) = self.current_chunk() {
            self.lock_state().tally.count_entry(&entry);
            chunk.file.queue_line(&entry);
        }
    }

    fn write_answer(&self, sent: Option<&SentRequest>, row: LedgerEntry) -> Result<bool, LedgerError> {
        let chunk = self.current_chunk()?;
        let entry = ChunkEntry::Answered { number: sent.map(|sent| sent.number), row: Box::new(row.clone()) };
        chunk.file.write_line(&entry)?;
        self.lock_state().tally.count_entry(&entry);
        chunk.memory.write_answer(None, row)
    }

    fn flush(&self) -> Result<(), LedgerError> {
        let chunk = self.current_chunk()?;
        chunk.file.flush()?;
        chunk.memory.flush()
    }

    fn keeps_budget(&self) -> bool {
        true
    }
}

impl CallQueries for ChunkStore {
    fn spent_budget(&self, run: &str) -> Result<SpentBudget, LedgerError> {
        Ok(self.lock_state().spent_by_run(run))
    }

    fn run_spending(&self, run: &str) -> Result<RunSpending, LedgerError> {
        Ok(self.lock_state().spending_by_run(Some(run)))
    }

    fn for_each_call(
        &self,
        filter: &LedgerFilter,
        order: CallOrder,
        take: &mut dyn FnMut(LedgerEntry) -> Result<(), LedgerError>,
    ) -> Result<(), LedgerError> {
        self.current_chunk()?.memory.for_each_call(filter, order, take)
    }

    fn prune_calls(&self, _: &LedgerFilter) -> Result<usize, LedgerError> {
        Err(LedgerError::Misuse { place: self.ledger_location(), reason: "nothing can be dropped from a recording" })
    }

    fn prune_changed(&self) -> Result<usize, LedgerError> {
        self.prune_calls(&LedgerFilter::default())
    }

    fn has_answers_from(&self, model: &str, base_url: &str) -> Result<bool, LedgerError> {
        self.current_chunk()?.memory.has_answers_from(model, base_url)
    }

    fn sum_costs(&self, by: CostGrouping) -> Result<Vec<CostLine>, LedgerError> {
        self.current_chunk()?.memory.sum_costs(by)
    }

    fn count_lost_requests(&self) -> Result<u64, LedgerError> {
        Ok(self.lock_state().spending_by_run(None).lost)
    }
}
