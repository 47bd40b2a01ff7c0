//! The stores that the tests run with, so that all of them are held to the same.

#![allow(dead_code, unreachable_pub, clippy::unwrap_used, reason = "no test uses all of it, and a test may panic")]

use std::path::Path;
use tempfile::TempDir;
use wayword_ledger::{Answer, Ledger};

/// A place for a ledger, which is dropped with it.
pub struct Store {
    /// What names the place, for another program.
    spec: String,
    _folder: TempDir,
}

impl Store {
    /// Opens the ledger, as another program or the same one later.
    pub fn open(&self) -> Ledger {
        open(&self.spec)
    }

    /// What [`open`] takes.
    pub fn spec(&self) -> &str {
        &self.spec
    }

    /// The kind of the store.
    pub fn kind(&self) -> &str {
        self.spec.split_once(':').unwrap().0
    }
}

/// All stores. `test` is told if one is left out.
pub fn stores(test: &str) -> Vec<Store> {
    let mut all = vec![in_folder("sqlite", "deep/ledger.db"), in_folder("chunks", "deep/chunk.jsonl")];
    all.extend(postgres(test));
    all
}

/// The stores that several programs may use at once.
pub fn shared_stores(test: &str) -> Vec<Store> {
    let mut all = vec![in_folder("sqlite", "ledger.db")];
    all.extend(postgres(test));
    all
}

fn in_folder(kind: &str, file: &str) -> Store {
    let folder = tempfile::tempdir().unwrap();
    Store { spec: format!("{kind}:{}", folder.path().join(file).display()), _folder: folder }
}

/// The ledger at a place that [`Store::spec`] names.
pub fn open(spec: &str) -> Ledger {
    let (kind, place) = spec.split_once(':').unwrap();
    match kind {
        "sqlite" => Ledger::open(Path::new(place)).unwrap(),
        "chunks" => {
            let ledger = Ledger::in_chunks(&[]).unwrap();
            ledger.turn_to(Path::new(place)).unwrap();
            ledger
        }
        _ => unreachable!("{spec}"),
    }
}

fn postgres(_: &str) -> Option<Store> {
    None
}

/// A short answer.
pub fn answer(text: &str, usd: Option<f64>) -> Answer {
    Answer { text: text.into(), finish: "stop".into(), tokens_in: 3, tokens_out: 2, usd, latency_ms: 7, attempts: 1 }
}
