//! A PostgreSQL server that a test starts for itself, with the programs that are installed on this machine. Tests skip
//! themselves where none are installed.

#![allow(clippy::expect_used, clippy::panic, reason = "a test whose server cannot be started fails")]

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::{Command, Output},
    sync::{
        Arc, Mutex, PoisonError, Weak,
        atomic::{AtomicU64, Ordering},
    },
};
use tempfile::TempDir;

/// The user of the server.
const SERVER_USER: &str = "postgres";

/// A running server. It listens only on a socket in its own temporary folder, asks for no password, and stops when this
/// value is dropped.
#[derive(Debug)]
pub struct PostgresServer {
    /// The folder of PostgreSQL's programs.
    programs: PathBuf,
    /// The user that the server runs as if this program runs as root. PostgreSQL refuses to run as root.
    as_user: Option<String>,
    /// The folder of the server's data, socket and log.
    folder: TempDir,
}

impl PostgresServer {
    /// Starts a server with no data; `None` if PostgreSQL is not installed.
    ///
    /// # Panics
    /// When it is installed and cannot be started.
    #[must_use]
    pub fn start() -> Option<Self> {
        let programs = find_programs()?;
        // The path of a socket must be short.
        let folder = tempfile::Builder::new().prefix("pg").tempdir().expect("a temporary folder");
        let server = Self { programs, as_user: unprivileged_user(), folder };
        if let Some(user) = &server.as_user {
            run_or_panic(Command::new("chown").arg(user).arg(server.folder.path()));
        }
        let data = server.data_folder();
        let options = ["--encoding=UTF8", "--locale=C", "--auth=trust", "--no-sync", "-U", SERVER_USER, "-D"];
        run_or_panic(server.program_command("initdb").args(options).arg(&data));
        server.start_again();
        Some(server)
    }

    /// The server that the tests of this program share. It is stopped when no test uses it any more.
    #[must_use]
    pub fn shared() -> Option<Arc<Self>> {
        static SHARED_SERVER: Mutex<Weak<PostgresServer>> = Mutex::new(Weak::new());
        let mut shared = SHARED_SERVER.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(server) = shared.upgrade() {
            return Some(server);
        }
        let server = Arc::new(Self::start()?);
        *shared = Arc::downgrade(&server);
        Some(server)
    }

    /// Makes a new, empty database and returns its URL for clients.
    ///
    /// # Panics
    /// When the server cannot make it.
    #[must_use]
    pub fn new_database(&self) -> String {
        static NEXT_DATABASE_NUMBER: AtomicU64 = AtomicU64::new(0);
        let name = format!("test{}", NEXT_DATABASE_NUMBER.fetch_add(1, Ordering::Relaxed));
        run_or_panic(
            self.program_command("createdb").args(["-U", SERVER_USER, "-h"]).arg(self.folder.path()).arg(&name),
        );
        self.database_url(SERVER_USER, &name)
    }

    /// The URL of the database `postgres`, which every server has.
    #[must_use]
    pub fn default_url(&self) -> String {
        self.database_url(SERVER_USER, "postgres")
    }

    /// The URL with which a client connects to a database as a role.
    #[must_use]
    pub fn database_url(&self, role: &str, database: &str) -> String {
        format!("postgresql://{role}@/{database}?host={}", self.folder.path().display())
    }

    /// Stops the server as a crash would, and starts it again.
    ///
    /// # Panics
    /// When it cannot be started.
    pub fn restart(&self) {
        self.stop();
        self.start_again();
    }

    /// Stops the server as a crash would.
    pub fn stop(&self) {
        let mut stop = self.program_command("pg_ctl");
        // The call fails if the server does not run, which is fine here.
        let _ = stop.args(["-m", "immediate", "-w", "stop", "-D"]).arg(self.data_folder()).output();
    }

    /// Starts the server again after [`PostgresServer::stop`].
    ///
    /// # Panics
    /// When it cannot be started.
    pub fn start_again(&self) {
        let folder = self.folder.path().display();
        let options = format!("-c listen_addresses='' -c unix_socket_directories='{folder}' -c max_connections=200");
        let mut start = self.program_command("pg_ctl");
        start.args(["-w", "-o", &options, "-l"]).arg(self.folder.path().join("log")).arg("-D").arg(self.data_folder());
        run_or_panic(start.arg("start").stdout(std::process::Stdio::null()));
    }

    fn data_folder(&self) -> PathBuf {
        self.folder.path().join("data")
    }

    /// One of PostgreSQL's programs, under the server's user.
    fn program_command(&self, name: &str) -> Command {
        let program = self.programs.join(name);
        let mut command = match &self.as_user {
            None => Command::new(program),
            Some(user) => {
                let mut command = Command::new("setpriv");
                command.args(["--reuid", user, "--regid", user, "--clear-groups", "--"]).arg(program);
                command
            }
        };
        // The server's user may not see the folder in which the tests run.
        command.current_dir(self.folder.path()).env("LC_ALL", "C").env_remove("PGDATA");
        command
    }
}

impl Drop for PostgresServer {
    fn drop(&mut self) {
        self.stop();
    }
}

/// The folder of PostgreSQL's programs: the newest version of Debian's, else one on the `PATH`.
fn find_programs() -> Option<PathBuf> {
    let path = env::var_os("PATH").unwrap_or_default();
    let mut debian: Vec<PathBuf> = fs::read_dir("/usr/lib/postgresql")
        .into_iter()
        .flatten()
        .flatten()
        .map(|version| version.path().join("bin"))
        .collect();
    // The newest first.
    debian.sort_by_key(|folder| std::cmp::Reverse(folder_version(folder)));
    let others = env::split_paths(&path).chain([PathBuf::from("/usr/local/bin")]);
    debian
        .into_iter()
        .chain(others)
        .find(|folder| ["initdb", "pg_ctl", "createdb"].iter().all(|program| folder.join(program).exists()))
}

/// The version in the path of one of Debian's folders.
fn folder_version(folder: &Path) -> u32 {
    let name = folder.parent().and_then(Path::file_name).and_then(|name| name.to_str());
    name.and_then(|name| name.parse().ok()).unwrap_or(0)
}

/// The user that the server has to run as; `None` unless this program runs as root.
fn unprivileged_user() -> Option<String> {
    let id = |args: &[&str]| Command::new("id").args(args).output().ok().filter(|output| output.status.success());
    let is_root = id(&["-u"]).is_some_and(|output| output.stdout.trim_ascii() == b"0");
    let other = if id(&["-u", SERVER_USER]).is_some() { SERVER_USER } else { "nobody" };
    is_root.then(|| other.to_owned())
}

/// Runs a command to its end, and panics if it fails.
fn run_or_panic(command: &mut Command) -> Output {
    // The server inherits the pipes and keeps them open. `pg_ctl start` therefore runs with a log file and without stdout;
    // otherwise `output` would wait until the server ends.
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {errors}");
    output
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn newest_debian_version_sorts_last() {
        let path = |version: &str| PathBuf::from(format!("/usr/lib/postgresql/{version}/bin"));
        assert!(folder_version(&path("17")) > folder_version(&path("9.6")));
        assert!(folder_version(&path("17")) > folder_version(&path("15")));
    }
}
