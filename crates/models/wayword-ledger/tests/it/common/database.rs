//! Ledgers in a server of PostgreSQL that the tests start.

use super::Store;
use std::{sync::Arc, time::Duration};
use wayword_database::{PostgresDatabase, postgres::Client};
use wayword_ledger::Ledger;
use wayword_testkit::PostgresServer;

/// A program without a sign of life for this long has ended. The tests do not wait a minute.
const GONE: Duration = Duration::from_millis(1500);

/// A new database; `None` where PostgreSQL is not installed.
pub fn new(test: &str) -> Option<Store> {
    let server = PostgresServer::shared();
    if server.is_none() {
        eprintln!("{test}: skipped for PostgreSQL: it is not installed");
    }
    server.map(on)
}

/// A new database of a server.
pub fn on(server: Arc<PostgresServer>) -> Store {
    Store { spec: format!("postgres:{}", server.new_database()), _folder: None, _server: Some(server) }
}

pub fn named(url: &str) -> PostgresDatabase {
    PostgresDatabase::from_name(url, None).unwrap()
}

pub fn open(url: &str) -> Ledger {
    Ledger::postgres_with_lease(&named(url), GONE).unwrap()
}

/// A connection past the ledger.
pub fn past(store: &Store) -> Client {
    named(store.spec().split_once(':').unwrap().1).connect().unwrap()
}

/// Waits until the server has noticed that the other clients are gone, and has ended their statements.
pub fn settle(store: &Store) {
    let mut client = past(store);
    let others = "SELECT count(*) FROM pg_stat_activity WHERE datname = current_database() AND pid <> pg_backend_pid()";
    while client.query_one(others, &[]).unwrap().get::<_, i64>(0) > 0 {
        std::thread::sleep(Duration::from_millis(10));
    }
}
