//! Errors of a database, and which of them are temporary.

use postgres::error::SqlState;
use std::path::PathBuf;

/// A database cannot be used. No message contains a password.
#[derive(Debug, Clone, thiserror::Error)]
pub enum DatabaseError {
    /// The text is not the name of a database.
    #[error("this names no database: {problem}\nhint: {hint}")]
    Name {
        /// The problem.
        problem: String,
        /// How to write a name.
        hint: &'static str,
    },
    /// A file that the connection needs cannot be used.
    #[error("{}: {problem}\nhint: {hint}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The problem.
        problem: String,
        /// How the user can fix it.
        hint: &'static str,
    },
    /// The server is too old.
    #[error("{database}: this server is PostgreSQL {version}\nhint: use PostgreSQL 15 or later")]
    TooOld {
        /// The database.
        database: String,
        /// The server's version.
        version: String,
    },
    /// The encoding of the database cannot store every text.
    #[error(
        "{database}: the encoding of this database is {encoding}, which cannot hold every text\nhint: make one with `createdb --encoding=UTF8 --template=template0 NAME`, and name that"
    )]
    Encoding {
        /// The database.
        database: String,
        /// The encoding of the database, by PostgreSQL's name.
        encoding: String,
    },
    /// A newer version of the program made the tables.
    #[error(
        "{database}: a newer version of this program made the tables of {schema} (version {version})\nhint: use that version, or another database"
    )]
    Newer {
        /// The database.
        database: String,
        /// The schema of the tables.
        schema: &'static str,
        /// The version of the tables.
        version: i32,
    },
    /// The tables have to be made, and this role may not.
    #[error(
        "{database}: the tables of {schema} are missing or old, and this role may not make them ({reason})\nhint: let the owner of the database run `wayword runs database DATABASE --sql` and apply what it prints"
    )]
    Rights {
        /// The database.
        database: String,
        /// The schema of the tables.
        schema: &'static str,
        /// The server's message.
        reason: String,
    },
    /// The server does not answer, or refuses.
    #[error("{database}: cannot {doing}: {reason}\nhint: {hint}")]
    Server {
        /// The database.
        database: String,
        /// The operation that failed, as a verb after "cannot".
        doing: &'static str,
        /// The message of the server or the system.
        reason: String,
        /// How the user can fix it.
        hint: &'static str,
        /// Whether the server or the connection failed, so that the same may work later.
        is_lost: bool,
    },
}

impl DatabaseError {
    /// Whether the server or the connection failed, so that the same may work later.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        matches!(self, Self::Server { is_lost: true, .. })
    }

    /// The error that a server or its connection gave during the operation `doing`.
    pub(crate) fn from_server(database: &str, doing: &'static str, error: &postgres::Error) -> Self {
        let is_lost = is_lost(error);
        let server_message =
            error.as_db_error().map(|db_error| format!("{} ({})", db_error.message(), db_error.code().code()));
        let reason = server_message.unwrap_or_else(|| message_with_causes(error));
        Self::Server { database: database.to_owned(), doing, reason, hint: error_hint(error, is_lost), is_lost }
    }
}

/// Whether the server or the connection failed, and not the statement. Conflicts with other programs count too: the same
/// statement works when it is sent again.
pub(crate) fn is_lost(error: &postgres::Error) -> bool {
    let Some(code) = error.code() else {
        // An error without a code comes from the connection, unless a value could not be converted.
        return error.is_closed() || std::error::Error::source(error).is_some_and(|cause| cause.is::<std::io::Error>());
    };
    let temporary_codes = [
        SqlState::ADMIN_SHUTDOWN,
        SqlState::CRASH_SHUTDOWN,
        SqlState::CANNOT_CONNECT_NOW,
        SqlState::TOO_MANY_CONNECTIONS,
        SqlState::T_R_SERIALIZATION_FAILURE,
        SqlState::T_R_DEADLOCK_DETECTED,
        SqlState::DISK_FULL,
        SqlState::QUERY_CANCELED,
        SqlState::IDLE_IN_TRANSACTION_SESSION_TIMEOUT,
    ];
    // Codes that begin with 08 report a failed connection.
    temporary_codes.contains(code) || code.code().starts_with("08")
}

/// The message of an error, and the messages of its causes as far as they add something.
fn message_with_causes(error: &postgres::Error) -> String {
    let mut message = error.to_string();
    let mut cause = std::error::Error::source(error);
    while let Some(next) = cause {
        let text = next.to_string();
        if !message.contains(&text) {
            message.push_str(": ");
            message.push_str(&text);
        }
        cause = next.source();
    }
    message
}

/// How the user can fix an error of the server.
fn error_hint(error: &postgres::Error, is_lost: bool) -> &'static str {
    match error.code() {
        Some(code) if *code == SqlState::INVALID_PASSWORD || *code == SqlState::INVALID_AUTHORIZATION_SPECIFICATION => {
            "check the user's name, and the password in PGPASSFILE or in the variable of --password-env"
        }
        Some(code) if *code == SqlState::UNDEFINED_DATABASE => "make it with `createdb`, or name another one",
        Some(code) if *code == SqlState::INSUFFICIENT_PRIVILEGE => {
            "give the role the rights that `wayword runs database DATABASE --sql` prints"
        }
        Some(code) if *code == SqlState::TOO_MANY_CONNECTIONS => {
            "raise max_connections of the server, or start fewer workers"
        }
        Some(code) if *code == SqlState::DISK_FULL => "make room on the server's disk, and give the same command again",
        _ if is_lost => "check that the server runs and can be reached from here, and give the same command again",
        _ => "check the database's name, and that this program's tables were not changed by hand",
    }
}
