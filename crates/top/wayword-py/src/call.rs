//! Runs commands inside a Python interpreter.
//!
//! A command runs in its own thread, with the interpreter released, so that Python can go on. The calling thread looks every 50 ms
//! for Ctrl-C and passes messages and progress to Python.

use crate::raise::{raised, raised_of};
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
use wayword::{cli::Cli, commands};
use wayword_platforms::process;
use wayword_run::{
    error::Error,
    interrupt,
    output::{Listener, Output, ProgressBar},
};

/// How often a call checks for Ctrl-C and reports its progress.
const LOOK_EVERY: Duration = Duration::from_millis(50);
/// How long the end of the interpreter waits for a command of another thread.
const FINISHED_WITHIN: Duration = Duration::from_secs(20);
/// Stack of the thread that runs a command, bytes: as much as the main thread of a program has.
const STACK: usize = 8 << 20;

/// Whether a command runs. Commands run one at a time, because an interrupt applies to the whole process.
static RUNS: AtomicBool = AtomicBool::new(false);

/// The turn of a command: while this value exists, no other command runs.
struct Turn;

impl Turn {
    /// Waits for other commands to end. A signal that Python received is raised here.
    fn wait(py: Python<'_>) -> PyResult<Self> {
        while RUNS.swap(true, Ordering::Acquire) {
            py.detach(|| thread::sleep(LOOK_EVERY));
            py.check_signals()?;
        }
        Ok(Self)
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        RUNS.store(false, Ordering::Release);
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
    let cli = Cli::try_parse_from(typed).map_err(|told| raised_of(py, "input", in_parts(&name, &told.to_string())))?;
    let heard = Arc::new(Heard::default());
    let output = Output::heard_by(Arc::clone(&heard) as Arc<dyn Listener>);
    let exit =
        waited(py, &heard, &hears, || commands::run(cli.command, &output))?.map_err(|error| raised(py, error))?;
    Ok((exit as u8, lock(&heard.data).take().unwrap_or_default()))
}

/// The message of the command line's parser, without its usage, and with a hint.
fn in_parts(command: &str, told: &str) -> (String, Option<String>, Option<String>) {
    let told = told.trim_start_matches("error: ");
    let what = ["\n\nUsage:", "\n\nFor more"].iter().fold(told, |told, end| told.split(end).next().unwrap_or(told));
    (what.trim().to_owned(), None, Some(format!("arguments are the flags of `wayword {command} --help`")))
}

/// Sets the program that guards the children of this process, with its arguments. It starts the interpreter with this module.
#[pyfunction]
pub(crate) fn guarded_by(program: PathBuf, arguments: Vec<OsString>) {
    process::this_program_is(process::Guardian { program, arguments });
}

/// Collects the messages, the progress and the result of a command.
#[derive(Default)]
struct Heard {
    data: Mutex<Option<String>>,
    said: Mutex<Vec<String>>,
    bar: Mutex<Option<ProgressBar>>,
}

impl Listener for Heard {
    fn data(&self, json: String) {
        *lock(&self.data) = Some(json);
    }

    fn say(&self, text: String) {
        lock(&self.said).push(text);
    }

    fn bar(&self, bar: &ProgressBar) {
        *lock(&self.bar) = Some(bar.clone());
    }
}

/// How a call of the Python object `hears` ended.
enum Told {
    Well,
    /// Python received a signal.
    Signal(PyErr),
    /// The object raised an exception.
    Raised(PyErr),
    /// The interpreter ends.
    Ended,
}

impl Heard {
    /// Passes the messages since the last call, and the progress, to Python.
    fn tell(&self, hears: Option<&Py<PyAny>>) -> Told {
        let said = std::mem::take(&mut *lock(&self.said));
        let bar = lock(&self.bar).clone();
        let told = Python::try_attach(|py| {
            if let Err(error) = py.check_signals() {
                return Told::Signal(error);
            }
            let Some(hears) = hears else { return Told::Well };
            let tell = || -> PyResult<()> {
                for text in said {
                    hears.call_method1(py, "say", (text,))?;
                }
                if let Some(bar) = bar {
                    let text = [bar.prefix(), bar.message()].join(" ").trim().to_owned();
                    hears.call_method1(py, "progress", (bar.position(), bar.length().unwrap_or_default(), text))?;
                }
                Ok(())
            };
            tell().map_or_else(Told::Raised, |()| Told::Well)
        });
        told.unwrap_or(Told::Ended)
    }
}

/// Runs a command in its turn.
fn waited<T: Send>(
    py: Python<'_>,
    heard: &Heard,
    hears: &Py<PyAny>,
    work: impl FnOnce() -> Result<T, Error> + Send,
) -> PyResult<Result<T, Error>> {
    let _turn = Turn::wait(py)?;
    interrupt::forget();
    let done = in_thread(py, heard, Some(hears), work);
    // Otherwise the children of other objects would not start again.
    interrupt::forget();
    done
}

/// Does work that leaves no result behind, for example opening a world. Ctrl-C ends the children that the work waits for.
pub(crate) fn patiently<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<T, Error> + Send,
) -> PyResult<Result<T, Error>> {
    in_thread(py, &Heard::default(), None, work)
}

/// Does work in a thread, with the interpreter released. The first Ctrl-C interrupts a command, which comes to its end; the next
/// one, or the first where there is no command, ends the children that the work waits for. Then the exception is raised.
fn in_thread<T: Send>(
    py: Python<'_>,
    heard: &Heard,
    hears: Option<&Py<PyAny>>,
    work: impl FnOnce() -> Result<T, Error> + Send,
) -> PyResult<Result<T, Error>> {
    let (done, raised) = py.detach(|| {
        thread::scope(|scope| {
            let (ends, ended) = channel::<()>();
            let worker = thread::Builder::new().stack_size(STACK).spawn_scoped(scope, move || {
                let result = work();
                drop(ends);
                result
            });
            let Ok(worker) = worker else { return (None, None) };
            let mut raised: Option<PyErr> = None;
            let mut is_ended = false;
            while ended.recv_timeout(LOOK_EVERY) == Err(RecvTimeoutError::Timeout) {
                // After an exception no more messages are passed on.
                match heard.tell(hears.filter(|_| raised.is_none())) {
                    Told::Well => {}
                    Told::Signal(error) => {
                        is_ended |= raised.is_some() || hears.is_none();
                        raised.get_or_insert(error);
                    }
                    Told::Raised(error) => raised = Some(error),
                    Told::Ended => is_ended = true,
                }
                if hears.is_some() && (raised.is_some() || is_ended) {
                    interrupt::ask();
                }
                if is_ended {
                    process::end_all();
                }
            }
            let done = worker.join();
            if raised.is_none()
                && let Told::Signal(error) | Told::Raised(error) = heard.tell(hears)
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
        (Some(Err(panic)), None) => Err(raised_of(py, "internal", (words(&*panic), None, None))),
        (None, None) => Err(raised_of(py, "internal", ("no thread can be started".to_owned(), None, None))),
    }
}

/// Ends a command that another thread runs, before the interpreter ends: it comes to its end, or is left after some seconds.
#[pyfunction]
pub(crate) fn finish(py: Python<'_>) {
    let begun = Instant::now();
    while RUNS.load(Ordering::Acquire) && begun.elapsed() < FINISHED_WITHIN {
        interrupt::ask();
        py.detach(|| thread::sleep(LOOK_EVERY));
    }
    py.detach(process::end_all);
}

/// The settings of a run folder, as JSON.
#[pyfunction]
pub(crate) fn settings(py: Python<'_>, folder: PathBuf) -> PyResult<String> {
    let settings = wayword_run::run_folder::settings_of(&folder).map_err(|error| raised(py, error))?;
    serde_json::to_string(&settings).map_err(|error| raised_of(py, "internal", (error.to_string(), None, None)))
}

/// The message of a panic.
fn words(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().cloned();
    text.or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned())).unwrap_or_default()
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
