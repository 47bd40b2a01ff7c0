//! A pool of a few connections that many threads share. Lost connections are replaced after a restart of the server.

use crate::{DatabaseError, PostgresDatabase, error::is_lost};
use postgres::{Client, Row, Statement, types::ToSql};
use std::{
    collections::BTreeMap,
    fmt,
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
    thread,
    time::{Duration, Instant},
};

/// How long work is tried again while the server cannot be reached.
const MAX_RETRY_TIME: Duration = Duration::from_secs(120);
/// Pause before the second try. Each further pause is twice the one before.
const FIRST_PAUSE: Duration = Duration::from_millis(50);
/// Longest pause between two tries.
const MAX_PAUSE: Duration = Duration::from_secs(2);

/// A connection, with the statements that it has prepared.
pub struct PooledConnection {
    client: Client,
    /// The prepared statements, by their SQL.
    prepared: BTreeMap<&'static str, Statement>,
}

impl PooledConnection {
    /// Carries out a statement and returns its rows. It is prepared once for each connection.
    ///
    /// # Errors
    /// The error of the server.
    pub fn query_rows(
        &mut self,
        sql: &'static str,
        values: &[&(dyn ToSql + Sync)],
    ) -> Result<Vec<Row>, postgres::Error> {
        let statement = self.prepare_statement(sql)?;
        self.client.query(&statement, values)
    }

    /// A statement, prepared once for each connection.
    ///
    /// # Errors
    /// The error of the server.
    pub fn prepare_statement(&mut self, sql: &'static str) -> Result<Statement, postgres::Error> {
        if let Some(statement) = self.prepared.get(sql) {
            return Ok(statement.clone());
        }
        let statement = self.client.prepare(sql)?;
        self.prepared.insert(sql, statement.clone());
        Ok(statement)
    }

    /// The connection itself, for transactions and for statements that are built at run time.
    pub fn client(&mut self) -> &mut Client {
        &mut self.client
    }
}

/// Connections to one database. Threads take them in turn.
pub struct ConnectionPool {
    database: PostgresDatabase,
    /// How many connections may be open at once. A thread waits while all are in use.
    max_connections: usize,
    state: Mutex<PoolState>,
    /// Wakes a waiting thread when a connection was put back.
    connection_returned: Condvar,
}

/// The connections of a pool at this moment.
#[derive(Default)]
struct PoolState {
    idle: Vec<PooledConnection>,
    /// How many connections are in use.
    in_use_count: usize,
}

impl ConnectionPool {
    /// A pool of at most `max_connections` connections. It connects only when work needs it.
    #[must_use]
    pub fn new(database: PostgresDatabase, max_connections: usize) -> Self {
        Self {
            database,
            max_connections: max_connections.max(1),
            state: Mutex::default(),
            connection_returned: Condvar::new(),
        }
    }

    /// The database.
    #[must_use]
    pub fn database(&self) -> &PostgresDatabase {
        &self.database
    }

    /// Does work with a connection. While the server cannot be reached, the work is tried again for two minutes, each time
    /// with a new connection. So the work must be idempotent: an earlier try may have succeeded before its answer was lost.
    ///
    /// # Errors
    /// The error of the server, or that it could not be reached.
    pub fn with_connection<T>(
        &self,
        doing: &'static str,
        mut work: impl FnMut(&mut PooledConnection) -> Result<T, postgres::Error>,
    ) -> Result<T, DatabaseError> {
        let until = Instant::now() + MAX_RETRY_TIME;
        let mut pause = FIRST_PAUSE;
        loop {
            let lost = match self.run_once(doing, &mut work) {
                Err(error) if error.is_lost() => error,
                done => return done,
            };
            if Instant::now() + pause > until {
                return Err(lost);
            }
            thread::sleep(pause);
            pause = MAX_PAUSE.min(pause * 2);
        }
    }

    /// One try of the work with one connection. Afterwards the connection goes back into the pool, unless it was lost.
    fn run_once<T>(
        &self,
        doing: &'static str,
        work: &mut impl FnMut(&mut PooledConnection) -> Result<T, postgres::Error>,
    ) -> Result<T, DatabaseError> {
        let mut connection = self.take_connection()?;
        // If the work panics, the place of this connection stays taken; the program ends in that case.
        let done = work(&mut connection);
        let mut state = self.lock_state();
        state.in_use_count -= 1;
        if connection.client.is_closed() || done.as_ref().is_err_and(is_lost) {
            // The idle connections were lost too.
            state.idle.clear();
        } else {
            state.idle.push(connection);
        }
        drop(state);
        self.connection_returned.notify_one();
        done.map_err(|error| DatabaseError::from_server(self.database.shown_name(), doing, &error))
    }

    /// An idle connection or a new one. Waits while as many as allowed are in use.
    fn take_connection(&self) -> Result<PooledConnection, DatabaseError> {
        let mut state = self.lock_state();
        while state.in_use_count >= self.max_connections {
            state = self.connection_returned.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        state.in_use_count += 1;
        let idle = state.idle.pop();
        drop(state);
        let connection = match idle {
            Some(connection) if !connection.client.is_closed() => Ok(connection),
            _ => self.database.connect().map(|client| PooledConnection { client, prepared: BTreeMap::new() }),
        };
        match connection {
            Ok(connection) => Ok(connection),
            Err(error) => {
                self.lock_state().in_use_count -= 1;
                self.connection_returned.notify_one();
                Err(error)
            }
        }
    }

    fn lock_state(&self) -> MutexGuard<'_, PoolState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl fmt::Debug for ConnectionPool {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Pool")
            .field("database", &self.database)
            .field("most", &self.max_connections)
            .finish_non_exhaustive()
    }
}
