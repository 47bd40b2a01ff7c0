//! Makes the tables of a crate in its schema, and brings older ones to the newest version.

use crate::{ConnectionPool, DatabaseError, PooledConnection};
use postgres::error::SqlState;

/// The tables of a crate, in one schema.
#[derive(Debug, Clone, Copy)]
pub struct SchemaTables {
    /// The schema, which contains a table `version` too.
    pub schema: &'static str,
    /// The statements of each version: the first make version 1, the next change version 1 to 2, and so on. Published
    /// statements never change.
    pub steps: &'static [&'static str],
    /// Grants that a worker's role needs, with `ROLE` in place of its name.
    pub grants: &'static str,
}

/// The oldest server that works, PostgreSQL 15, as `server_version_num` counts.
const OLDEST_SERVER_VERSION: i32 = 150_000;

/// The number of the advisory lock ("Wayw" in ASCII) that a program holds while it makes Wayword's tables.
const TABLES_LOCK_ID: i64 = 0x5761_7977;

impl SchemaTables {
    /// Everything that makes the tables of a new database and, if one is named, gives a role the rights of a worker.
    #[must_use]
    pub fn creation_sql(&self, role: Option<&str>) -> String {
        let grants = role.map_or(String::new(), |role| self.grants_sql(role));
        format!("BEGIN;\n{}{grants}COMMIT;\n", self.upgrade_sql(0))
    }

    /// The statements that give a role the rights of a worker.
    #[must_use]
    pub fn grants_sql(&self, role: &str) -> String {
        self.grants.replace("ROLE", &format!("\"{}\"", role.replace('"', "\"\"")))
    }

    /// The statements that bring tables of version `from` to the newest. Version 0 has no tables.
    fn upgrade_sql(&self, from: usize) -> String {
        let Self { schema, steps, .. } = self;
        let begin = format!(
            "CREATE SCHEMA IF NOT EXISTS {schema};\nCREATE TABLE IF NOT EXISTS {schema}.version (version INTEGER NOT NULL);\n"
        );
        let steps: String = steps.iter().skip(from).copied().collect::<Vec<_>>().join("\n");
        let version = newest_version(self.steps);
        format!("{begin}{steps}\nDELETE FROM {schema}.version;\nINSERT INTO {schema}.version VALUES ({version});\n")
    }
}

/// The version that all steps together make: one for each step.
fn newest_version(steps: &[&str]) -> i32 {
    i32::try_from(steps.len()).unwrap_or(i32::MAX)
}

/// Makes the tables, or brings them to the newest version. A role without the right to do so can use tables that exist
/// already.
///
/// # Errors
/// When the server is too old, the tables are newer than this program, or they have to be made and the role may not.
pub fn prepare_tables(pool: &ConnectionPool, tables: &SchemaTables) -> Result<(), DatabaseError> {
    let database = pool.database().shown_name().to_owned();
    let (version_number, version_text, encoding) =
        pool.with_connection("ask for the server's version", |connection| {
            let sql =
                "SELECT current_setting('server_version_num')::int, version(), current_setting('server_encoding')";
            let row = connection.client().query_one(sql, &[])?;
            Ok((row.try_get::<_, i32>(0)?, row.try_get::<_, String>(1)?, row.try_get::<_, String>(2)?))
        })?;
    if version_number < OLDEST_SERVER_VERSION {
        let version = version_text.split_whitespace().nth(1).unwrap_or_default().to_owned();
        return Err(DatabaseError::TooOld { database, version });
    }
    // In another encoding, an answer that was paid for may have characters that cannot be stored.
    if encoding != "UTF8" {
        return Err(DatabaseError::Encoding { database, encoding });
    }
    let newest = newest_version(tables.steps);
    let version =
        pool.with_connection("ask for the version of the tables", |connection| read_version(connection, tables))?;
    if version == newest {
        return Ok(());
    }
    if version > newest {
        return Err(DatabaseError::Newer { database, schema: tables.schema, version });
    }
    // An error of missing rights gets a better hint, so its message is stored apart from the result.
    let mut refused = None;
    let made = pool.with_connection("make the tables", |connection| {
        let made = make_tables(connection, tables);
        if let Err(error) = &made
            && error.code() == Some(&SqlState::INSUFFICIENT_PRIVILEGE)
        {
            refused = error.as_db_error().map(|db_error| db_error.message().to_owned());
        }
        made
    });
    match refused {
        Some(reason) => Err(DatabaseError::Rights { database, schema: tables.schema, reason }),
        None => made,
    }
}

/// The version of the tables; 0 if there are none.
fn read_version(connection: &mut PooledConnection, tables: &SchemaTables) -> Result<i32, postgres::Error> {
    // Queries the catalog as a table. A lookup of the name (`to_regclass`) could be answered from this connection's cache,
    // which may still know that the table does not exist.
    let sql = "SELECT EXISTS (SELECT FROM pg_catalog.pg_tables WHERE schemaname = $1 AND tablename = 'version')";
    let is_there = connection.client().query_one(sql, &[&tables.schema])?;
    if !is_there.try_get::<_, bool>(0)? {
        return Ok(0);
    }
    let sql = format!("SELECT coalesce(max(version), 0) FROM {}.version", tables.schema);
    connection.client().query_one(&sql, &[])?.try_get(0)
}

/// Makes the missing tables in one transaction. A lock makes other programs that want to do the same wait for its end.
fn make_tables(connection: &mut PooledConnection, tables: &SchemaTables) -> Result<(), postgres::Error> {
    let client = connection.client();
    client.batch_execute("BEGIN")?;
    let done = client.execute("SELECT pg_advisory_xact_lock($1)", &[&TABLES_LOCK_ID]).and_then(|_| {
        // Another program may have made the tables while this one waited for the lock.
        let version = read_version(connection, tables)?;
        let from = usize::try_from(version).unwrap_or(0);
        if from < tables.steps.len() { connection.client().batch_execute(&tables.upgrade_sql(from)) } else { Ok(()) }
    });
    let end = if done.is_ok() { "COMMIT" } else { "ROLLBACK" };
    let ended = connection.client().batch_execute(end);
    done.and(ended)
}
