//! Connections to PostgreSQL (15 or later), blocking.
//!
//! A database is named without a password ([`Database::named`]); the password comes from a password file or from an
//! environment variable that the user names. A [`Pool`] goes on when the server was restarted. [`prepare`] brings the
//! tables of a crate to its version.
//!
//! Statements may be sent twice: a connection can be lost after the server has carried one out. So callers write
//! statements that do nothing the second time.

mod error;
mod name;
mod password;
mod pool;
mod tables;
mod tls;

pub use error::DatabaseError;
pub use name::Database;
pub use pool::{Connection, Pool};
pub use postgres;
pub use tables::{Tables, prepare};
