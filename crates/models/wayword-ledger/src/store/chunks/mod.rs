//! A store of recordings: each chunk of a shard has one file of JSON lines, to which requests and answers are appended.
//!
//! It is meant for network file systems, where a file of SQLite is not safe. It uses no locks and no second file, and never overwrites
//! written bytes. The caller has to make sure that only one program at a time writes a file.

mod append;
mod line;
mod read;
mod tally;

use super::{Claimed, End, Holder, Order, Queries, Request, Sqlite, Store};
use crate::{
    Answer, By, CostLine, Filter, Key, LedgerError, Place, Refused, Row, Spending,
    budget::{Spent, fits},
    run::Sent,
};
use append::Appender;
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};
use tally::Tally;

pub(crate) use line::Entry;

/// The recordings of a shard. One of its chunks is current.
#[derive(Debug, Default)]
pub(crate) struct Chunks {
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    /// The spending in the files of the other chunks.
    others: BTreeMap<PathBuf, Tally>,
    current: Option<Arc<Chunk>>,
    /// The spending in the file of the current chunk.
    tally: Tally,
}

/// The current chunk.
#[derive(Debug)]
struct Chunk {
    path: PathBuf,
    file: Appender,
    /// The answers of this chunk.
    memory: Sqlite,
}

impl Chunks {
    /// The recordings of a shard's chunks so far. A file that does not exist counts as empty.
    pub(crate) fn open(earlier: &[PathBuf]) -> Result<Self, LedgerError> {
        let mut others = BTreeMap::new();
        for path in earlier {
            let path = whole(path)?;
            let tally = tally_of(&path)?;
            others.insert(path, tally);
        }
        Ok(Self { state: Mutex::new(State { others, ..State::default() }) })
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn current(&self) -> Result<Arc<Chunk>, LedgerError> {
        self.state().current.clone().ok_or_else(none)
    }

    /// Reserves the money of a request.
    fn reserve(&self, request: &Request<'_>) -> Result<(Arc<Chunk>, Entry), Refused> {
        let mut state = self.state();
        let chunk = state.current.clone().ok_or_else(none)?;
        fits(request.limits, state.spent(request.run), request.most_usd)?;
        let entry = Entry::Sent {
            number: state.tally.next(),
            run: request.run.to_owned(),
            key: request.key.clone(),
            most_usd: request.most_usd,
            at_unix_s: request.at_unix_s,
        };
        state.tally.take(&entry);
        Ok((chunk, entry))
    }
}

impl State {
    fn tallies(&self) -> impl Iterator<Item = &Tally> {
        self.others.values().chain([&self.tally])
    }

    fn spent(&self, run: &str) -> Spent {
        self.tallies().map(|tally| tally.spent(run)).fold(Spent::default(), |all, one| Spent {
            usd: all.usd + one.usd,
            reserved_usd: all.reserved_usd + one.reserved_usd,
            calls: all.calls.saturating_add(one.calls),
        })
    }

    fn spending(&self, run: Option<&str>) -> Spending {
        self.tallies().map(|tally| tally.spending(run)).fold(Spending::default(), Spending::plus)
    }
}

impl Chunk {
    /// Opens a chunk's file, or makes it. An incomplete last line, which a crash can leave, is cut off.
    fn open(path: &Path) -> Result<(Self, Tally), LedgerError> {
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(LedgerError::io(folder, "make the folder"))?;
        }
        let (mut tally, memory) = (Tally::default(), Sqlite::in_memory()?);
        let sound = read::read(path, |entry| {
            tally.take(&entry);
            if let Entry::Answered { row, .. } = entry {
                memory.fill(*row);
            }
        })?;
        memory.flush()?;
        let file = Appender::start(path, sound)?;
        Ok((Self { path: path.to_owned(), file, memory }, tally))
    }
}

/// The spending of all runs in a file. A file that does not exist counts as empty.
pub(crate) fn spent_in(path: &Path) -> Result<Spending, LedgerError> {
    Ok(tally_of(path)?.spending(None))
}

fn tally_of(path: &Path) -> Result<Tally, LedgerError> {
    let mut tally = Tally::default();
    read::read(path, |entry| tally.take(&entry))?;
    Ok(tally)
}

/// The absolute path of a file, so that one file has one name.
fn whole(path: &Path) -> Result<PathBuf, LedgerError> {
    std::path::absolute(path).map_err(LedgerError::io(path, "find the recording"))
}

fn none() -> LedgerError {
    LedgerError::Misuse { place: Place::file(Path::new("recording")), reason: "no chunk was turned to yet" }
}

impl Store for Chunks {
    fn place(&self) -> Place {
        Place::File(self.current().map_or_else(|_| PathBuf::from("recording"), |chunk| chunk.path.clone()))
    }

    fn turn_to(&self, path: &Path) -> Result<(), LedgerError> {
        let path = whole(path)?;
        let mut state = self.state();
        if let Some(chunk) = &state.current {
            if chunk.path == path {
                return Ok(());
            }
            chunk.file.flush()?;
        }
        let (chunk, tally) = Chunk::open(&path)?;
        // The file is counted once: as the current one.
        state.others.remove(&path);
        let tally = std::mem::replace(&mut state.tally, tally);
        if let Some(before) = state.current.replace(Arc::new(chunk)) {
            state.others.insert(before.path.clone(), tally);
        }
        Ok(())
    }

    fn answer(&self, key: &Key, run: &str) -> Result<Option<Answer>, LedgerError> {
        self.current()?.memory.answer(key, run)
    }

    fn claim(&self, _: &Key, _: Option<&str>) -> Result<Claimed, LedgerError> {
        Ok(Claimed::Ours)
    }

    fn release(&self, _: &Key) {}

    fn holder(&self, _: &Key) -> Result<Option<Holder>, LedgerError> {
        Ok(None)
    }

    fn sent(&self, request: &Request<'_>) -> Result<i64, Refused> {
        let (chunk, entry) = self.reserve(request)?;
        let Entry::Sent { number, .. } = entry else { return Err(none().into()) };
        if let Err(error) = chunk.file.keep(&entry) {
            let cancelled = Entry::Ended { number, outcome: End::Cancelled, reason: String::new() };
            self.state().tally.take(&cancelled);
            return Err(error.into());
        }
        Ok(number)
    }

    fn ended(&self, sent: &Sent, end: End, reason: &str) {
        let entry = Entry::Ended { number: sent.number, outcome: end, reason: reason.to_owned() };
        if let Ok(chunk) = self.current() {
            self.state().tally.take(&entry);
            chunk.file.note(&entry);
        }
    }

    fn answered(&self, sent: Option<&Sent>, row: Row) -> Result<bool, LedgerError> {
        let chunk = self.current()?;
        let entry = Entry::Answered { number: sent.map(|sent| sent.number), row: Box::new(row.clone()) };
        chunk.file.keep(&entry)?;
        self.state().tally.take(&entry);
        chunk.memory.answered(None, row)
    }

    fn flush(&self) -> Result<(), LedgerError> {
        let chunk = self.current()?;
        chunk.file.flush()?;
        chunk.memory.flush()
    }

    fn keeps_budget(&self) -> bool {
        true
    }
}

impl Queries for Chunks {
    fn spent(&self, run: &str) -> Result<Spent, LedgerError> {
        Ok(self.state().spent(run))
    }

    fn spending(&self, run: &str) -> Result<Spending, LedgerError> {
        Ok(self.state().spending(Some(run)))
    }

    fn each(
        &self,
        filter: &Filter,
        order: Order,
        take: &mut dyn FnMut(Row) -> Result<(), LedgerError>,
    ) -> Result<(), LedgerError> {
        self.current()?.memory.each(filter, order, take)
    }

    fn prune(&self, _: &Filter) -> Result<usize, LedgerError> {
        Err(LedgerError::Misuse { place: self.place(), reason: "nothing can be dropped from a recording" })
    }

    fn prune_changed(&self) -> Result<usize, LedgerError> {
        self.prune(&Filter::default())
    }

    fn has_answers_of(&self, model: &str, base_url: &str) -> Result<bool, LedgerError> {
        self.current()?.memory.has_answers_of(model, base_url)
    }

    fn costs(&self, by: By) -> Result<Vec<CostLine>, LedgerError> {
        self.current()?.memory.costs(by)
    }

    fn lost(&self) -> Result<u64, LedgerError> {
        Ok(self.state().spending(None).lost)
    }
}
