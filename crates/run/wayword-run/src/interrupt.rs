//! Handles Ctrl-C, SIGTERM, SIGHUP (the terminal is gone) and SIGUSR1 (which Slurm sends shortly before the time limit): a
//! command finishes the items that it works on, or ends at once, with exit code 6.
//!
//! Inside another program, the host catches the signals and calls [`ask_to_stop`].
//!
//! On systems other than Unix the system ends the process, with its own exit code. No result is lost there either, because a
//! kill leaves every file whole.

use crate::{calls::ModelCalls, error::CommandError, output::CommandOutput};
#[cfg(unix)]
use signal_hook::{
    consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGXFSZ},
    iterator::Signals,
};
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

/// Whether the user or a scheduler has interrupted.
static INTERRUPT_ASKED: AtomicBool = AtomicBool::new(false);
/// How the running command comes to an end; `None` if it can be ended at any point.
static COMMAND_ENDING: Mutex<Option<CommandEnding>> = Mutex::new(None);
/// Files that mark this process as running. They are removed however it ends.
static PROCESS_MARKS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// How long a child process may take to answer a request from before the interrupt.
const CHILD_GRACE: Duration = Duration::from_secs(10);
/// How long after `CHILD_GRACE` a command without models may still take, because a simulator may keep it waiting. Then
/// it is ended at any point. A command with models is not ended, because the calls in flight are paid for.
const LAST_GRACE: Duration = Duration::from_secs(5);

/// How a command comes to an end.
struct CommandEnding {
    /// Stops the sending of calls to models.
    stop: Box<dyn Fn() + Send>,
    /// Whether the command makes calls to models.
    has_calls: bool,
    /// What the command does until then, for the user.
    words: &'static str,
}

/// Until this is dropped, the command checks for interrupts by itself, and the signal handler does not end it at once.
#[must_use]
pub struct GracefulEnding(());

/// Makes the command finish its items after an interrupt, until the returned value is dropped: the interrupt stops the
/// sending of `calls`, and the command calls [`check_interrupt`] between two items. A second interrupt ends the
/// process.
pub fn finish_items_first(calls: Option<&ModelCalls>) -> GracefulEnding {
    let stop: Box<dyn Fn() + Send> = match calls.map(ModelCalls::sending_stopper) {
        Some(ending) => Box::new(ending),
        None => Box::new(|| ()),
    };
    *lock_ending() = Some(CommandEnding { stop, has_calls: calls.is_some(), words: "finishing the items in progress" });
    GracefulEnding(())
}

/// As [`finish_items_first`], for a command that answers requests.
pub fn finish_answers_first() -> GracefulEnding {
    let words = "sending the answers in progress, then stopping";
    *lock_ending() = Some(CommandEnding { stop: Box::new(|| ()), has_calls: false, words });
    GracefulEnding(())
}

impl Drop for GracefulEnding {
    fn drop(&mut self) {
        *lock_ending() = None;
    }
}

/// Registers a file that is removed if an interrupt ends the process at once.
pub(crate) fn remove_on_exit(mark: &Path) {
    PROCESS_MARKS.lock().unwrap_or_else(PoisonError::into_inner).push(mark.to_owned());
}

/// Whether the user or a scheduler has interrupted.
#[must_use]
pub fn is_interrupted() -> bool {
    INTERRUPT_ASKED.load(Ordering::Relaxed)
}

/// Refuses to begin more work after an interrupt.
///
/// # Errors
/// [`CommandError::Interrupted`].
pub fn check_interrupt() -> Result<(), CommandError> {
    if is_interrupted() { Err(CommandError::Interrupted) } else { Ok(()) }
}

/// Interrupts the running command as a first Ctrl-C does: it comes to its end. For a program that this one runs in.
pub fn ask_to_stop() {
    INTERRUPT_ASKED.store(true, Ordering::Relaxed);
    if let Some(ending) = lock_ending().as_ref() {
        (ending.stop)();
    }
}

/// Forgets an interrupt, before the next command in the same process.
pub fn forget_interrupt() {
    INTERRUPT_ASKED.store(false, Ordering::Relaxed);
    process::start_again();
}

/// Interrupts that are not handled yet.
pub struct PendingSignals(#[cfg(unix)] Option<Signals>);

/// Catches SIGINT, SIGTERM, SIGUSR1 and SIGHUP from now on. SIGHUP stays ignored where `nohup` or a parent has the process ignore it.
/// SIGXFSZ is caught so that a file beyond the user's limit is an error of its write, and does not end the process without a word.
#[cfg(unix)]
#[must_use]
pub fn catch_signals() -> PendingSignals {
    // Without a handler the signals end the process, as usual.
    let signals = [SIGINT, SIGTERM, SIGUSR1, SIGXFSZ].into_iter().chain((!ignores_hangup()).then_some(SIGHUP));
    PendingSignals(Signals::new(signals).ok())
}

/// Whether this process was started with SIGHUP ignored. True where the system does not say so.
#[cfg(unix)]
fn ignores_hangup() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(u64::MAX);
    mask & (1 << (SIGHUP - 1)) != 0
}

/// Handles interrupts until the process ends, those since [`catch_signals`] among them.
#[cfg(unix)]
pub fn listen_for_signals(pending: PendingSignals, output: &CommandOutput) {
    let output = output.clone();
    let Some(mut signals) = pending.0 else { return };
    thread::spawn(move || {
        for signal in signals.forever() {
            if signal == SIGXFSZ {
                continue;
            }
            let is_second = INTERRUPT_ASKED.swap(true, Ordering::Relaxed);
            match lock_ending().as_ref() {
                Some(ending) if !is_second => finish_items(ending, output.clone()),
                _ => end_at_once(&output),
            }
        }
    });
}

/// Lets the command come to its end, and ends it if that takes too long.
#[cfg(unix)]
fn finish_items(ending: &CommandEnding, output: CommandOutput) {
    output.say(format_args!("{}; interrupt again to stop at once", ending.words));
    (ending.stop)();
    let has_calls = ending.has_calls;
    thread::spawn(move || {
        // A hanging platform would delay the end. The next command tries its item again.
        thread::sleep(CHILD_GRACE);
        process::end_all();
        if !has_calls {
            thread::sleep(LAST_GRACE);
            end_at_once(&output);
        }
    });
}

/// Catches no signals: the system ends the process.
#[cfg(not(unix))]
#[must_use]
pub fn catch_signals() -> PendingSignals {
    PendingSignals()
}

/// Has no signals to handle.
#[cfg(not(unix))]
pub fn listen_for_signals(_: PendingSignals, _: &CommandOutput) {}

/// Ends the process and its children, without waiting for the command.
#[cfg(unix)]
fn end_at_once(output: &CommandOutput) {
    output.print_error(&CommandError::Interrupted);
    process::end_all();
    for mark in PROCESS_MARKS.lock().unwrap_or_else(PoisonError::into_inner).drain(..) {
        // A file that stays is found by the next command.
        let _ = std::fs::remove_file(mark);
    }
    std::process::exit(crate::error::Exit::Interrupted as i32);
}

fn lock_ending() -> MutexGuard<'static, Option<CommandEnding>> {
    COMMAND_ENDING.lock().unwrap_or_else(PoisonError::into_inner)
}
