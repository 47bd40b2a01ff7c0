//! Ctrl-C and SIGTERM: a command finishes what it has in hand, or ends at once, with an exit code of its own.
//!
//! Other systems than Unix end the process at once, with their own code. Nothing is lost there either: every file is written so that
//! a kill leaves it whole.

use crate::{calls::Calls, error::Error, output::Output};
use std::{
    path::{Path, PathBuf},
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};
use wayword_platforms::process;

/// Whether anybody has interrupted.
static ASKED: AtomicBool = AtomicBool::new(false);
/// What the command that is at work does to come to an end; none where it can be ended anywhere.
static ENDING: Mutex<Option<Ending>> = Mutex::new(None);
/// Files that say that this process is at work, to be removed however it ends.
static MARKS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// How long a world in a child process may take over what it was asked before an interrupt.
const GRACE: Duration = Duration::from_secs(10);
/// How long after that a command without models may take to come to its end, before it is ended anywhere: a simulator may be waited
/// for. One with models is not, because what is in flight is paid for.
const LAST_GRACE: Duration = Duration::from_secs(5);

/// Ends the sending; whether there are calls to be finished.
struct Ending {
    stop: Box<dyn Fn() + Send>,
    has_calls: bool,
}

/// A command that looks for interrupts by itself, for as long as this lives.
#[must_use]
pub struct Graceful(());

/// From now on an interrupt ends the sending of `calls`, and the command looks at [`check`] between two pieces of its work. A second
/// interrupt ends the process.
pub fn finish_first(calls: Option<&Calls>) -> Graceful {
    let stop: Box<dyn Fn() + Send> = match calls.map(Calls::ending) {
        Some(ending) => Box::new(ending),
        None => Box::new(|| ()),
    };
    *lock() = Some(Ending { stop, has_calls: calls.is_some() });
    Graceful(())
}

impl Drop for Graceful {
    fn drop(&mut self) {
        *lock() = None;
    }
}

/// Has a file removed where an interrupt ends the process at once.
pub(crate) fn removes(mark: &Path) {
    MARKS.lock().unwrap_or_else(PoisonError::into_inner).push(mark.to_owned());
}

/// Whether anybody has interrupted.
#[must_use]
pub fn is_asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}

/// Refuses to begin more work once anybody has interrupted.
///
/// # Errors
/// [`Error::Interrupted`].
pub fn check() -> Result<(), Error> {
    if is_asked() { Err(Error::Interrupted) } else { Ok(()) }
}

/// Listens for SIGINT and SIGTERM until the process ends. SIGHUP is left alone, because `nohup` has to work.
#[cfg(unix)]
pub fn listen(output: &Output) {
    use signal_hook::{
        consts::{SIGINT, SIGTERM},
        iterator::Signals,
    };
    let output = *output;
    // Where signals cannot be had, they end the process as they always did.
    let Ok(mut signals) = Signals::new([SIGINT, SIGTERM]) else { return };
    thread::spawn(move || {
        for _ in signals.forever() {
            let again = ASKED.swap(true, Ordering::Relaxed);
            match lock().as_ref() {
                Some(ending) if !again => finish(ending, output),
                _ => end_at_once(&output),
            }
        }
    });
}

/// Has the command come to its end, and ends it itself where that takes too long.
#[cfg(unix)]
fn finish(ending: &Ending, output: Output) {
    output.say("finishing what is in hand; interrupt again to end at once");
    (ending.stop)();
    let has_calls = ending.has_calls;
    thread::spawn(move || {
        // A world that hangs would hold up the end. Its item is tried again by the next command.
        thread::sleep(GRACE);
        process::end_all();
        if !has_calls {
            thread::sleep(LAST_GRACE);
            end_at_once(&output);
        }
    });
}

/// See above.
#[cfg(not(unix))]
pub fn listen(_: &Output) {}

#[cfg(unix)]
fn end_at_once(output: &Output) {
    output.error(&Error::Interrupted);
    process::end_all();
    for mark in MARKS.lock().unwrap_or_else(PoisonError::into_inner).drain(..) {
        // What stays is found by whoever comes next.
        let _ = std::fs::remove_file(mark);
    }
    std::process::exit(crate::error::Exit::Interrupted as i32);
}

fn lock() -> MutexGuard<'static, Option<Ending>> {
    ENDING.lock().unwrap_or_else(PoisonError::into_inner)
}
