//! Ends a child's group where this program is killed and can do nothing any more.
//!
//! A guard is a small process that leads the group and reads from a pipe that only this program can write into. When the
//! pipe ends, the program is gone, and the guard kills its own group, itself included. The number of the group cannot be
//! another's then, because the guard is in it. A child that is just being started holds the pipe too until it is in the
//! group and runs, so no moment is without a guard.

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

/// A guard that stands. Dropped, it is ended.
pub(crate) struct Guard(Child);

impl Guard {
    /// Starts a program that calls [`stand_guard_if_asked`] as the leader of a group of its own.
    #[cfg(unix)]
    pub(crate) fn start(program: &Path) -> io::Result<Self> {
        let mut command = Command::new(program);
        // Somebody may wait for the end of our outputs, so the guard has none.
        command.arg(ROLE).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        command.spawn().map(Self)
    }

    #[cfg(not(unix))]
    pub(crate) fn start(_: &Path) -> io::Result<Self> {
        Err(io::ErrorKind::Unsupported.into())
    }

    /// Its number, and that of its group.
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

/// This program, to be named as the guard of its children (`ProcessOptions::guard`). `None` where no guard can be.
#[must_use]
pub fn this_program() -> Option<PathBuf> {
    // Linux finds it by this name also after it was replaced or deleted.
    let own = Path::new("/proc/self/exe");
    match cfg!(unix) {
        true if own.exists() => Some(own.to_owned()),
        true => env::current_exe().ok(),
        false => None,
    }
}

/// Has to stand at the very start of `main` in a program that is named as a guard. Where this process was started as one,
/// it serves as one and does not return.
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
    // Nobody writes: this waits for the end of the pipe.
    let _ = io::copy(&mut io::stdin().lock(), &mut io::sink());
    std::thread::sleep(FAREWELL);
    let _ = rustix::process::kill_current_process_group(rustix::process::Signal::KILL);
    // Not reached, unless the system refuses.
    std::process::exit(1);
}
