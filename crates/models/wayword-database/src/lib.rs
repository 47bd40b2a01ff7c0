//! Connections to PostgreSQL (15 or later), blocking.
//!
//! The name of a database contains no password ([`PostgresDatabase::from_name`]); the password comes from a password file or from an
//! environment variable that the user names. A [`ConnectionPool`] survives a restart of the server. [`prepare_tables`] brings the tables of
//! a crate to its version.
//!
//! Statements may be sent twice: a connection can be lost after the server has carried one out. So callers write
//! idempotent statements: the second time, they change no row.

mod database_name;
mod error;
mod password;
mod pool;
mod tables;
mod tls;

pub use database_name::PostgresDatabase;
pub use error::DatabaseError;
pub use pool::{ConnectionPool, PooledConnection};
pub use postgres;
pub use tables::{SchemaTables, prepare_tables};
