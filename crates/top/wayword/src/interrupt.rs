//! Ctrl-C and SIGTERM: a command finishes what it has in hand, or ends at once, with an exit code of its own.
//!
//! Other systems than Unix end the process at once, with their own code. Nothing is lost there either: every file is written so that
//! a kill leaves it whole.

use crate::{calls::Calls, error::Error, output::Output};
use std::{
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};
use wayword_platforms::process;

/// Whether anybody has interrupted.
static ASKED: AtomicBool = AtomicBool::new(false);
/// What the command that is at work does to come to an end; none where it can be ended anywhere.
static ENDING: Mutex<Option<Ending>> = Mutex::new(None);

/// How long a world in a child process may take over what it was asked before an interrupt.
const GRACE: Duration = Duration::from_secs(10);

type Ending = Box<dyn Fn() + Send>;

/// A command that looks for interrupts by itself, for as long as this lives.
#[must_use]
pub struct Graceful(());

/// From now on an interrupt ends the sending of `calls`, and the command looks at [`check`] between two pieces of its work. A second
/// interrupt ends the process.
pub fn finish_first(calls: Option<&Calls>) -> Graceful {
    let ending: Ending = match calls.map(Calls::ending) {
        Some(ending) => Box::new(ending),
        None => Box::new(|| ()),
    };
    *lock() = Some(ending);
    Graceful(())
}

impl Drop for Graceful {
    fn drop(&mut self) {
        *lock() = None;
    }
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
    std::thread::spawn(move || {
        for _ in signals.forever() {
            let again = ASKED.swap(true, Ordering::Relaxed);
            match lock().as_ref() {
                Some(ending) if !again => {
                    output.say("finishing what is in hand; interrupt again to end at once");
                    ending();
                    // A world that hangs would hold up the end. Its item is tried again by the next command.
                    std::thread::spawn(|| {
                        std::thread::sleep(GRACE);
                        process::end_all();
                    });
                }
                _ => end_at_once(&output),
            }
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
    std::process::exit(crate::error::Exit::Interrupted as i32);
}

fn lock() -> MutexGuard<'static, Option<Ending>> {
    ENDING.lock().unwrap_or_else(PoisonError::into_inner)
}
