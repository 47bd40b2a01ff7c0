//! Parses the name of a database, adds the settings that the name leaves out, and connects.

use crate::{DatabaseError, error::is_lost, password, tls};
use postgres::{
    Client, Config, NoTls,
    config::{Host, SslMode},
};
use std::{env, fmt, path::Path, str::FromStr, time::Duration};

/// A database, as a user names it.
#[derive(Clone)]
pub struct PostgresDatabase {
    /// All settings of the connection except the password, which `connect` adds.
    config: Box<Config>,
    /// User, host, port and database, for messages.
    shown: String,
    /// The environment variable with the password, if the user names one.
    password_env: Option<String>,
}

/// Folders in which a server on this machine may have its socket.
const SOCKET_FOLDERS: [&str; 2] = ["/var/run/postgresql", "/tmp"];
/// PostgreSQL's own port.
const DEFAULT_PORT: u16 = 5432;
/// How long one attempt to connect may take. A slower one fails.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(10);

/// Options of every connection: a statement or a transaction that hangs is ended, so that it does not block other workers.
const SERVER_OPTIONS: &str = "-c statement_timeout=60s -c idle_in_transaction_session_timeout=60s -c lock_timeout=60s";

const NAME_HINT: &str = "write the name of a database, or postgresql://USER@HOST:PORT/DATABASE";
const NO_PASSWORD: &str = "leave the password out: put it into a file (PGPASSFILE, by default ~/.pgpass), or into an environment variable that you name with --password-env";

impl PostgresDatabase {
    /// A database by its name: `wayword_db`, `postgresql://user@host:5432/wayword_db` or `host=... dbname=...`. Parts that
    /// the text leaves out come from PGHOST, PGPORT, PGUSER and PGSSLMODE, as with PostgreSQL's own programs.
    ///
    /// The certificate of a server on another machine is always checked (PGSSLROOTCERT names its authority), unless
    /// `sslmode=disable` is asked for. On this machine there is no TLS unless it is asked for.
    ///
    /// # Errors
    /// When the text names no database, or contains a password.
    pub fn from_name(text: &str, password_env: Option<&str>) -> Result<Self, DatabaseError> {
        let wrong = |problem: &str, hint| Err(DatabaseError::Name { problem: problem.to_owned(), hint });
        if text.trim().is_empty() {
            return wrong("it is empty", NAME_HINT);
        }
        let mut config = if text.contains("://") || text.contains('=') {
            // The parser of the library does not know these two modes. This program always checks the certificate and the
            // server's name, so "require" means the same here.
            let text = ["verify-full", "verify-ca"]
                .iter()
                .fold(text.to_owned(), |text, mode| text.replace(&format!("sslmode={mode}"), "sslmode=require"));
            match Config::from_str(&text) {
                Ok(config) => config,
                // The parser's message quotes the part that it cannot read, which may be a password.
                Err(_) => return wrong("it cannot be read", NAME_HINT),
            }
        } else {
            let mut config = Config::new();
            config.dbname(text);
            config
        };
        if config.get_password().is_some() {
            return wrong("it holds a password, which lists of processes and logs would show", NO_PASSWORD);
        }
        if config.get_dbname().is_none() {
            return wrong("it has no name of a database", NAME_HINT);
        }
        complete_config(&mut config, text)?;
        let shown = describe_config(&config);
        Ok(Self { config: Box::new(config), shown, password_env: password_env.map(str::to_owned) })
    }

    /// Its name for messages: user, host, port and database.
    #[must_use]
    pub fn shown_name(&self) -> &str {
        &self.shown
    }

    /// Connects.
    ///
    /// # Errors
    /// When the password cannot be found out, the server does not answer or refuses, or its certificate is not trusted.
    pub fn connect(&self) -> Result<Client, DatabaseError> {
        let mut config = (*self.config).clone();
        if let Some(password) = password::find_password(&config, self.password_env.as_deref())? {
            config.password(password);
        }
        let connected = match config.get_ssl_mode() {
            SslMode::Disable => config.connect(NoTls),
            _ => config.connect(tls::tls_connector()?),
        };
        connected.map_err(|error| {
            let connect_error = DatabaseError::from_server(&self.shown, "connect", &error);
            // No statement was sent yet, so an error without a code comes from the connection.
            match connect_error {
                DatabaseError::Server { database, doing, reason, hint, .. } => DatabaseError::Server {
                    database,
                    doing,
                    reason,
                    hint,
                    is_lost: error.code().is_none() || is_lost(&error),
                },
                other => other,
            }
        })
    }
}

impl PartialEq for PostgresDatabase {
    fn eq(&self, other: &Self) -> bool {
        (&self.shown, &self.password_env) == (&other.shown, &other.password_env)
    }
}

impl fmt::Debug for PostgresDatabase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Database").field(&self.shown).finish()
    }
}

/// Adds the settings that `text`, the name of the database, leaves out: from PostgreSQL's environment variables, else defaults.
fn complete_config(config: &mut Config, text: &str) -> Result<(), DatabaseError> {
    let env_value = |name: &str| env::var(name).ok().filter(|value| !value.is_empty());
    if config.get_hosts().is_empty() && config.get_hostaddrs().is_empty() {
        let socket =
            SOCKET_FOLDERS.iter().find(|folder| Path::new(folder).join(format!(".s.PGSQL.{DEFAULT_PORT}")).exists());
        config.host(env_value("PGHOST").as_deref().or(socket.copied()).unwrap_or("localhost"));
    }
    if config.get_ports().is_empty()
        && let Some(port) = env_value("PGPORT")
    {
        let port = port.parse().map_err(|_| DatabaseError::Name {
            problem: format!("PGPORT is {port}"),
            hint: "give a number, or unset the variable",
        })?;
        config.port(port);
    }
    if config.get_user().is_none()
        && let Some(user) = env_value("PGUSER")
    {
        config.user(&user);
    }
    if !text.contains("sslmode=") {
        let asked_mode = env_value("PGSSLMODE");
        config.ssl_mode(match asked_mode.as_deref() {
            Some("disable" | "allow") => SslMode::Disable,
            Some(_) => SslMode::Require,
            None if is_on_this_machine(config) => SslMode::Disable,
            None => SslMode::Require,
        });
    }
    config.application_name("wayword").connect_timeout(CONNECT_TIMEOUT).keepalives_idle(Duration::from_secs(30));
    let options =
        config.get_options().map_or_else(|| SERVER_OPTIONS.to_owned(), |asked| format!("{SERVER_OPTIONS} {asked}"));
    config.options(&options);
    Ok(())
}

/// Whether all hosts of the connection are this machine, so that TLS is not needed.
fn is_on_this_machine(config: &Config) -> bool {
    config.get_hosts().iter().all(|host| match host {
        Host::Tcp(name) => ["localhost", "127.0.0.1", "::1"].contains(&name.as_str()),
        #[cfg(unix)]
        Host::Unix(_) => true,
    })
}

/// The connection in one line, as `me@far:5432/wayword_db`.
fn describe_config(config: &Config) -> String {
    let user = config.get_user().map_or(String::new(), |user| format!("{user}@"));
    let host = match config.get_hosts().first() {
        Some(Host::Tcp(name)) => name.clone(),
        #[cfg(unix)]
        Some(Host::Unix(folder)) => folder.display().to_string(),
        None => String::new(),
    };
    let port = config.get_ports().first().map_or(DEFAULT_PORT, |port| *port);
    format!("{user}{host}:{port}/{}", config.get_dbname().unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_password_in_the_name_is_refused_and_not_repeated() {
        for text in [
            "postgresql://me:geheim@host/db",
            "postgresql://me@host/db?password=geheim",
            "host=h dbname=db password=geheim",
            "host=h dbname=db passwrd=geheim",
        ] {
            let told = PostgresDatabase::from_name(text, None).unwrap_err().to_string();
            assert!(!told.contains("geheim"), "{told}");
        }
    }

    #[test]
    fn a_word_is_the_name_of_a_database() {
        let database = PostgresDatabase::from_name("wayword_db", None).unwrap();
        assert!(database.shown_name().ends_with("/wayword_db"), "{}", database.shown_name());
        assert_eq!(
            PostgresDatabase::from_name("postgresql://me@far:99/db", None).unwrap().shown_name(),
            "me@far:99/db"
        );
        for bad in ["", " ", "postgresql://me@host", "host=h"] {
            assert!(PostgresDatabase::from_name(bad, None).is_err(), "{bad:?}");
        }
    }

    #[test]
    fn another_machine_is_reached_by_tls_alone() {
        let mode = |text: &str| PostgresDatabase::from_name(text, None).unwrap().config.get_ssl_mode();
        assert_eq!(mode("postgresql://me@far/db"), SslMode::Require);
        assert_eq!(mode("postgresql://me@far/db?sslmode=verify-full"), SslMode::Require);
        assert_eq!(mode("postgresql://me@far/db?sslmode=disable"), SslMode::Disable);
        assert_eq!(mode("postgresql://me@localhost/db"), SslMode::Disable);
        assert_eq!(mode("postgresql:///db?host=/tmp"), SslMode::Disable);
    }
}
