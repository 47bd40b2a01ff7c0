//! The stores that the tests run with, so that all of them are held to the same.

#![allow(
    dead_code,
    unreachable_pub,
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "no test uses all of it, and a test may panic"
)]

#[cfg(feature = "postgres")]
pub mod database;

use std::path::Path;
use tempfile::TempDir;
use wayword_ledger::{CallAnswer, Ledger};

/// A place for a ledger, which is dropped with it.
pub struct Store {
    /// Names the place for another program.
    spec: String,
    _folder: Option<TempDir>,
    #[cfg(feature = "postgres")]
    _server: Option<std::sync::Arc<wayword_testkit::PostgresServer>>,
}

impl Store {
    /// Opens the ledger, as another program or the same one later.
    pub fn open(&self) -> Ledger {
        open(&self.spec)
    }

    /// The text that [`open`] takes.
    pub fn spec(&self) -> &str {
        &self.spec
    }

    /// Waits until the database has finished all statements of programs that were killed.
    pub fn settle(&self) {
        #[cfg(feature = "postgres")]
        if self.kind() == "postgres" {
            database::settle(self);
        }
    }

    /// Changes the store past the ledger, in SQL, and returns how many rows were changed.
    pub fn change(&self, sql: &str) -> usize {
        match self.kind() {
            "sqlite" => {
                let path = self.spec.split_once(':').unwrap().1;
                rusqlite::Connection::open(path).unwrap().execute(sql, []).unwrap()
            }
            #[cfg(feature = "postgres")]
            "postgres" => {
                let mut client = database::past(self);
                client.batch_execute("SET search_path = wayword_ledger").unwrap();
                usize::try_from(client.execute(sql, &[]).unwrap()).unwrap()
            }
            kind => unreachable!("{kind}"),
        }
    }

    /// How many rows a table has.
    pub fn count(&self, table: &str) -> i64 {
        match self.kind() {
            "sqlite" => {
                let path = self.spec.split_once(':').unwrap().1;
                let sql = format!("SELECT COUNT(*) FROM {table}");
                rusqlite::Connection::open(path).unwrap().query_row(&sql, [], |row| row.get(0)).unwrap()
            }
            #[cfg(feature = "postgres")]
            "postgres" => {
                let sql = format!("SELECT count(*) FROM wayword_ledger.{table}");
                database::past(self).query_one(&sql, &[]).unwrap().get(0)
            }
            kind => unreachable!("{kind}"),
        }
    }

    /// The kind of the store.
    pub fn kind(&self) -> &str {
        self.spec.split_once(':').unwrap().0
    }
}

/// All stores. Prints a note with the name `test` if one is left out.
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

/// A new place in a folder.
pub fn in_folder(kind: &str, file: &str) -> Store {
    let folder = tempfile::tempdir().unwrap();
    let spec = format!("{kind}:{}", folder.path().join(file).display());
    Store {
        spec,
        _folder: Some(folder),
        #[cfg(feature = "postgres")]
        _server: None,
    }
}

/// The ledger at a place that [`CallStore::spec`] names.
pub fn open(spec: &str) -> Ledger {
    let (kind, place) = spec.split_once(':').unwrap();
    match kind {
        "sqlite" => Ledger::open(Path::new(place)).unwrap(),
        "chunks" => {
            let ledger = Ledger::in_chunks(&[]).unwrap();
            ledger.turn_to(Path::new(place)).unwrap();
            ledger
        }
        #[cfg(feature = "postgres")]
        "postgres" => database::open(place),
        _ => unreachable!("{spec}"),
    }
}

/// A new database, if the tests may start a server.
pub fn postgres(test: &str) -> Option<Store> {
    if std::env::var("WAYWORD_TEST_POSTGRES").is_ok_and(|set| set == "1") {
        #[cfg(feature = "postgres")]
        return database::new(test);
    }
    eprintln!("{test}: skipped for PostgreSQL: set WAYWORD_TEST_POSTGRES=1 and use --features postgres");
    None
}

/// A short answer.
pub fn answer(text: &str, usd: Option<f64>) -> CallAnswer {
    CallAnswer {
        text: text.into(),
        finish: "stop".into(),
        tokens_in: 3,
        tokens_out: 2,
        usd,
        latency_ms: 7,
        attempts: 1,
    }
}
