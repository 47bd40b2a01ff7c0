//! Ends a child's group if this program is killed and can no longer do so itself.
//!
//! A guard is a small process that leads the group and reads from a pipe that only this program can write into. When
//! the pipe ends, this program has ended, and the guard kills its own group, itself included. No other group can have
//! the group's number then, because the guard is in the group. While a child is being started, it holds the pipe too,
//! until it is in the group and runs. So the child is guarded at every moment.

use std::{
    env,
    ffi::OsString,
    io,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::OnceLock,
    time::Duration,
};

/// Time for a child to end by itself after its input was closed.
pub(crate) const FAREWELL_WAIT: Duration = Duration::from_millis(500);
/// The only argument of a guard.
const GUARD_ROLE_ARGUMENT: &str = "guard-children";

/// The command that starts this program again, if it is no executable of its own.
static THIS_PROGRAM: OnceLock<GuardProgram> = OnceLock::new();

/// A program that can be a guard: started with `guard-children` as its last argument, it calls [`stand_guard_if_asked`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GuardProgram {
    /// The executable.
    pub program: PathBuf,
    /// The arguments before the role.
    pub arguments: Vec<OsString>,
}

impl From<PathBuf> for GuardProgram {
    /// An executable that needs only one argument, the role.
    fn from(program: PathBuf) -> Self {
        Self { program, arguments: Vec::new() }
    }
}

/// A running guard. When it is dropped, it is killed.
pub(crate) struct GroupGuard(Child);

impl GroupGuard {
    /// Starts a program that calls [`stand_guard_if_asked`], as the leader of a group of its own.
    #[cfg(unix)]
    pub(crate) fn start(guardian: &GuardProgram) -> io::Result<Self> {
        let mut command = Command::new(&guardian.program);
        // Another program may wait for the end of our outputs, so the guard must not hold them open.
        command
            .args(&guardian.arguments)
            .arg(GUARD_ROLE_ARGUMENT)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        command.spawn().map(Self)
    }

    #[cfg(not(unix))]
    pub(crate) fn start(_: &GuardProgram) -> io::Result<Self> {
        Err(io::ErrorKind::Unsupported.into())
    }

    /// Its process id, the same as the id of its group.
    #[cfg(unix)]
    pub(crate) fn process_id(&self) -> u32 {
        self.0.id()
    }

    #[cfg(unix)]
    pub(crate) fn guard_process(&mut self) -> &mut Child {
        &mut self.0
    }
}

impl Drop for GroupGuard {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// This program, for use as the guard of its children (`ProcessOptions::guard`). `None` on systems without guards.
#[must_use]
pub fn this_program() -> Option<GuardProgram> {
    // On Linux this path works even after the program was replaced or deleted.
    let own = Path::new("/proc/self/exe");
    match (cfg!(unix), THIS_PROGRAM.get()) {
        (true, Some(known)) => Some(known.clone()),
        (true, None) if own.exists() => Some(own.to_owned().into()),
        (true, None) => env::current_exe().ok().map(GuardProgram::from),
        (false, _) => None,
    }
}

/// Sets the command that starts this program again, for a program that runs as a module of an interpreter, so that its
/// executable is the interpreter. Only the first call counts.
pub fn set_this_program(guardian: GuardProgram) {
    // A second call would set the same command, because a process has one interpreter.
    let _ = THIS_PROGRAM.set(guardian);
}

/// Must be called at the very start of a program that is used as a guard, with its arguments (without its own name). If this
/// process was started as a guard, the function serves as one and does not return.
pub fn stand_guard_if_asked(arguments: &[OsString]) {
    let is_asked = matches!(arguments, [only] if only == GUARD_ROLE_ARGUMENT);
    #[cfg(unix)]
    if is_asked && rustix::process::getpgrp() == rustix::process::getpid() {
        stand_guard();
    }
    #[cfg(not(unix))]
    let _ = is_asked;
}

/// Waits for the end of the guarded program, and kills the group.
#[cfg(unix)]
fn stand_guard() -> ! {
    // The pipe stays empty: this waits for its end.
    let _ = io::copy(&mut io::stdin().lock(), &mut io::sink());
    std::thread::sleep(FAREWELL_WAIT);
    let _ = rustix::process::kill_current_process_group(rustix::process::Signal::KILL);
    // Reached only if the system refuses the kill.
    std::process::exit(1);
}
