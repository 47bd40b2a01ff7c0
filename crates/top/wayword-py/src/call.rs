//! Runs commands inside a Python interpreter.
//!
//! A command runs in its own thread, with the interpreter released, so that Python can go on. The calling thread looks every 50 ms
//! for Ctrl-C and passes messages and progress to Python.

use crate::raise::{exception_for, exception_of_kind};
use clap::Parser;
use pyo3::prelude::*;
use std::{
    any::Any,
    ffi::OsString,
    path::PathBuf,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc::{RecvTimeoutError, channel},
    },
    thread,
    time::{Duration, Instant},
};
use wayword::{cli::WaywordCli, commands};
use wayword_platforms::process;
use wayword_run::{
    error::CommandError,
    interrupt,
    output::{CommandOutput, CommandOutputListener, ProgressBar},
};

/// How often a call checks for Ctrl-C and reports its progress.
const LOOK_INTERVAL: Duration = Duration::from_millis(50);
/// How long the end of the interpreter waits for a command of another thread. Then it ends without it.
const FINISH_LIMIT: Duration = Duration::from_secs(20);
/// Stack of the thread that runs a command, bytes: as much as the main thread of a program has.
const THREAD_STACK_BYTES: usize = 8 << 20;

/// Whether a command runs. Commands run one at a time, because an interrupt applies to the whole process.
static IS_COMMAND_RUNNING: AtomicBool = AtomicBool::new(false);

/// The turn of a command: while this value exists, no other command runs.
struct CommandTurn;

impl CommandTurn {
    /// Waits for other commands to end. A signal that Python received is raised here.
    fn wait_for_turn(py: Python<'_>) -> PyResult<Self> {
        while IS_COMMAND_RUNNING.swap(true, Ordering::Acquire) {
            py.detach(|| thread::sleep(LOOK_INTERVAL));
            py.check_signals()?;
        }
        Ok(Self)
    }
}

impl Drop for CommandTurn {
    fn drop(&mut self) {
        IS_COMMAND_RUNNING.store(false, Ordering::Release);
    }
}

/// Runs the program with its name and arguments. Returns the exit code.
#[pyfunction]
pub(crate) fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| wayword::main(arguments))
}

/// Runs a command inside the interpreter. `arguments` begin with the name of the command. `hears` is a Python object with the
/// methods `say(text)` and `progress(done, total, text)`. Returns the exit code and the result as JSON.
#[pyfunction]
pub(crate) fn call(py: Python<'_>, arguments: Vec<OsString>, hears: Py<PyAny>) -> PyResult<(u8, String)> {
    let name = arguments.first().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let typed = std::iter::once(OsString::from("wayword")).chain(arguments);
    let cli = WaywordCli::try_parse_from(typed)
        .map_err(|error| exception_of_kind(py, "input", parser_error_parts(&name, &error.to_string())))?;
    let heard = Arc::new(CommandListener::default());
    let output = CommandOutput::heard_by(Arc::clone(&heard) as Arc<dyn CommandOutputListener>);
    let exit = run_in_turn(py, &heard, &hears, || commands::run_command(cli.command, &output))?
        .map_err(|error| exception_for(py, error))?;
    Ok((exit as u8, lock_mutex(&heard.result_json).take().unwrap_or_default()))
}

/// An error of the command line's parser as problem, place and hint. The usage is cut off, because Python's users type
/// no command line.
fn parser_error_parts(command: &str, message: &str) -> (String, Option<String>, Option<String>) {
    let message = message.trim_start_matches("error: ");
    let what = ["\n\nUsage:", "\n\nFor more"].iter().fold(message, |text, end| text.split(end).next().unwrap_or(text));
    (what.trim().to_owned(), None, Some(format!("arguments are the flags of `wayword {command} --help`")))
}

/// Sets the program that guards the children of this process, with its arguments. It starts the interpreter with this module.
#[pyfunction]
pub(crate) fn guarded_by(program: PathBuf, arguments: Vec<OsString>) {
    process::set_this_program(process::GuardProgram { program, arguments });
}

/// Collects the messages, the progress and the result of a command.
#[derive(Default)]
struct CommandListener {
    /// The result, as JSON.
    result_json: Mutex<Option<String>>,
    /// Messages that Python did not get yet.
    messages: Mutex<Vec<String>>,
    /// The progress bar that was begun last.
    bar: Mutex<Option<ProgressBar>>,
}

impl CommandOutputListener for CommandListener {
    fn take_result(&self, json: String) {
        *lock_mutex(&self.result_json) = Some(json);
    }

    fn take_message(&self, text: String) {
        lock_mutex(&self.messages).push(text);
    }

    fn take_bar(&self, bar: &ProgressBar) {
        *lock_mutex(&self.bar) = Some(bar.clone());
    }
}

/// How a call of the Python object `hears` ended.
enum PythonOutcome {
    /// It returned.
    Well,
    /// Python received a signal.
    Signal(PyErr),
    /// The object raised an exception.
    Raised(PyErr),
    /// The interpreter ends.
    Ended,
}

impl CommandListener {
    /// Passes the messages since the last call, and the progress, to Python.
    fn pass_to_python(&self, hears: Option<&Py<PyAny>>) -> PythonOutcome {
        let messages = std::mem::take(&mut *lock_mutex(&self.messages));
        let bar = lock_mutex(&self.bar).clone();
        let outcome = Python::try_attach(|py| {
            if let Err(error) = py.check_signals() {
                return PythonOutcome::Signal(error);
            }
            let Some(hears) = hears else { return PythonOutcome::Well };
            let pass_all = || -> PyResult<()> {
                for text in messages {
                    hears.call_method1(py, "say", (text,))?;
                }
                if let Some(bar) = bar {
                    let text = [bar.prefix(), bar.message()].join(" ").trim().to_owned();
                    hears.call_method1(py, "progress", (bar.position(), bar.length().unwrap_or_default(), text))?;
                }
                Ok(())
            };
            pass_all().map_or_else(PythonOutcome::Raised, |()| PythonOutcome::Well)
        });
        outcome.unwrap_or(PythonOutcome::Ended)
    }
}

/// Runs a command in its turn.
fn run_in_turn<T: Send>(
    py: Python<'_>,
    heard: &CommandListener,
    hears: &Py<PyAny>,
    work: impl FnOnce() -> Result<T, CommandError> + Send,
) -> PyResult<Result<T, CommandError>> {
    let _turn = CommandTurn::wait_for_turn(py)?;
    interrupt::forget_interrupt();
    let done = in_thread(py, heard, Some(hears), work);
    // Otherwise the children of other objects would not start again.
    interrupt::forget_interrupt();
    done
}

/// Does work that leaves no result behind, for example opening a world. Ctrl-C ends the children that the work waits for.
pub(crate) fn run_patiently<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<T, CommandError> + Send,
) -> PyResult<Result<T, CommandError>> {
    in_thread(py, &CommandListener::default(), None, work)
}

/// Does work in a thread, with the interpreter released. The first Ctrl-C interrupts a command, which comes to its end; the next
/// one, or the first where there is no command, ends the children that the work waits for. Then the exception is raised.
fn in_thread<T: Send>(
    py: Python<'_>,
    heard: &CommandListener,
    hears: Option<&Py<PyAny>>,
    work: impl FnOnce() -> Result<T, CommandError> + Send,
) -> PyResult<Result<T, CommandError>> {
    let (done, raised) = py.detach(|| {
        thread::scope(|scope| {
            // Nothing is sent: the channel closes when the work ends.
            let (ends, ended) = channel::<()>();
            let worker = thread::Builder::new().stack_size(THREAD_STACK_BYTES).spawn_scoped(scope, move || {
                let result = work();
                drop(ends);
                result
            });
            let Ok(worker) = worker else { return (None, None) };
            let mut raised: Option<PyErr> = None;
            let mut is_ended = false;
            while ended.recv_timeout(LOOK_INTERVAL) == Err(RecvTimeoutError::Timeout) {
                // After an exception no more messages are passed on.
                match heard.pass_to_python(hears.filter(|_| raised.is_none())) {
                    PythonOutcome::Well => {}
                    PythonOutcome::Signal(error) => {
                        is_ended |= raised.is_some() || hears.is_none();
                        raised.get_or_insert(error);
                    }
                    PythonOutcome::Raised(error) => raised = Some(error),
                    PythonOutcome::Ended => is_ended = true,
                }
                if hears.is_some() && (raised.is_some() || is_ended) {
                    interrupt::ask_to_stop();
                }
                if is_ended {
                    process::end_all();
                }
            }
            let done = worker.join();
            if raised.is_none()
                && let PythonOutcome::Signal(error) | PythonOutcome::Raised(error) = heard.pass_to_python(hears)
            {
                raised = Some(error);
            }
            if is_ended {
                process::start_again();
            }
            (Some(done), raised)
        })
    });
    match (done, raised) {
        (_, Some(error)) => Err(error),
        (Some(Ok(result)), None) => Ok(result),
        (Some(Err(panic)), None) => Err(exception_of_kind(py, "internal", (panic_text(&*panic), None, None))),
        (None, None) => Err(exception_of_kind(py, "internal", ("no thread can be started".to_owned(), None, None))),
    }
}

/// Ends a command that another thread runs, before the interpreter ends: it comes to its end, or is left after some seconds.
#[pyfunction]
pub(crate) fn finish(py: Python<'_>) {
    let begun = Instant::now();
    while IS_COMMAND_RUNNING.load(Ordering::Acquire) && begun.elapsed() < FINISH_LIMIT {
        interrupt::ask_to_stop();
        py.detach(|| thread::sleep(LOOK_INTERVAL));
    }
    py.detach(process::end_all);
}

/// The settings of a run folder, as JSON.
#[pyfunction]
pub(crate) fn settings(py: Python<'_>, folder: PathBuf) -> PyResult<String> {
    let settings = wayword_run::run_folder::read_run_settings(&folder).map_err(|error| exception_for(py, error))?;
    serde_json::to_string(&settings).map_err(|error| exception_of_kind(py, "internal", (error.to_string(), None, None)))
}

/// The message of a panic.
fn panic_text(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().cloned();
    text.or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned())).unwrap_or_default()
}

fn lock_mutex<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
