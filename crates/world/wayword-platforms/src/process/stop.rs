//! Ends a child, and whatever it has started.

use std::{
    process::{Child, Command},
    thread,
    time::{Duration, Instant},
};

/// How often an end that is waited for is looked for.
const LOOK_EVERY: Duration = Duration::from_millis(5);

/// Makes a command's process the first of a group of its own: a script that starts the simulator (`xvfb-run`, say) has to
/// end together with it, and Ctrl-C in the terminal is for Wayword, which then closes the child's input.
pub(crate) fn in_a_group_of_its_own(command: &mut Command) {
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    #[cfg(not(unix))]
    let _ = command;
}

/// Whether the child ends within a time; it is reaped if it does.
pub(crate) fn ends_within(child: &mut Child, within: Duration) -> bool {
    let deadline = Instant::now() + within;
    loop {
        match child.try_wait() {
            Ok(Some(_)) | Err(_) => return true,
            Ok(None) if Instant::now() >= deadline => return false,
            Ok(None) => thread::sleep(LOOK_EVERY),
        }
    }
}

/// Kills a child with its group, and reaps it. One that has been reaped is left alone: its number may be another's by now.
pub(crate) fn kill(child: &mut Child) {
    if !matches!(child.try_wait(), Ok(None)) {
        return;
    }
    #[cfg(unix)]
    // It can only fail where nobody is left.
    let _ = rustix::process::kill_process_group(rustix::process::Pid::from_child(child), rustix::process::Signal::KILL);
    let _ = child.kill();
    let _ = child.wait();
}
