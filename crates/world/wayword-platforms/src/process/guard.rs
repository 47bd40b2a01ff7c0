//! Ends a child's group if this program is killed and can no longer do so itself.
//!
//! A guard is a small process that leads the group and reads from a pipe that only this program can write into. When
//! the pipe ends, this program has ended, and the guard kills its own group, itself included. No other group can have
//! the group's number then, because the guard is in the group. While a child is being started, it holds the pipe too,
//! until it is in the group and runs. So the child is guarded at every moment.

use std::{
    env,
    ffi::OsStr,
    io,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    time::Duration,
};

/// How long a child whose input was closed may take to end by itself.
pub(crate) const FAREWELL: Duration = Duration::from_millis(500);
/// The only argument of a guard.
const ROLE: &str = "guard-children";

/// A running guard. When it is dropped, it is killed.
pub(crate) struct Guard(Child);

impl Guard {
    /// Starts a program that calls [`stand_guard_if_asked`], as the leader of a group of its own.
    #[cfg(unix)]
    pub(crate) fn start(program: &Path) -> io::Result<Self> {
        let mut command = Command::new(program);
        // Another program may wait for the end of our outputs, so the guard must not hold them open.
        command.arg(ROLE).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        command.spawn().map(Self)
    }

    #[cfg(not(unix))]
    pub(crate) fn start(_: &Path) -> io::Result<Self> {
        Err(io::ErrorKind::Unsupported.into())
    }

    /// Its process id, which is also the id of its group.
    #[cfg(unix)]
    pub(crate) fn id(&self) -> u32 {
        self.0.id()
    }

    #[cfg(unix)]
    pub(crate) fn process(&mut self) -> &mut Child {
        &mut self.0
    }
}

impl Drop for Guard {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// This program, for use as the guard of its children (`ProcessOptions::guard`). `None` on systems without guards.
#[must_use]
pub fn this_program() -> Option<PathBuf> {
    // On Linux this path works even after the program was replaced or deleted.
    let own = Path::new("/proc/self/exe");
    match cfg!(unix) {
        true if own.exists() => Some(own.to_owned()),
        true => env::current_exe().ok(),
        false => None,
    }
}

/// Must be called at the very start of `main` in a program that is used as a guard. If this process was started as a
/// guard, the function serves as one and does not return.
pub fn stand_guard_if_asked() {
    let mut arguments = env::args_os().skip(1);
    let is_asked = arguments.next().is_some_and(|first| first == OsStr::new(ROLE)) && arguments.next().is_none();
    #[cfg(unix)]
    if is_asked && rustix::process::getpgrp() == rustix::process::getpid() {
        stand();
    }
    #[cfg(not(unix))]
    let _ = is_asked;
}

#[cfg(unix)]
fn stand() -> ! {
    // Nothing is written into the pipe: this waits for its end.
    let _ = io::copy(&mut io::stdin().lock(), &mut io::sink());
    std::thread::sleep(FAREWELL);
    let _ = rustix::process::kill_current_process_group(rustix::process::Signal::KILL);
    // Reached only if the system refuses the kill.
    std::process::exit(1);
}
