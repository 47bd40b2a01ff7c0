//! Worlds that are Python objects: registers one under a name, so that commands can use it as a platform.

use crate::raise::exception_of_kind;
use pyo3::{prelude::*, types::PyBytes};
use std::path::PathBuf;
use wayword_platforms::process::{InsideWorld, ProcessOptions};
use wayword_run::platforms::{register_world, unregister_world};

/// Registers a world under a name. `answer` takes a request and returns an answer, each a line of JSON as bytes. Returns the
/// value that `data` has for this world.
#[pyfunction]
#[pyo3(signature = (name, answer, width_px=None, height_px=None, spacing_m=None))]
pub(crate) fn put_world(
    py: Python<'_>,
    name: &str,
    answer: Py<PyAny>,
    width_px: Option<u32>,
    height_px: Option<u32>,
    spacing_m: Option<f64>,
) -> PyResult<PathBuf> {
    let inside = InsideWorld::new(move |request| {
        let answered = Python::try_attach(|py| {
            let answered = answer.call1(py, (PyBytes::new(py, request),)).and_then(|line| line.extract::<Vec<u8>>(py));
            // An exception that the world does not turn into an answer is reported like the last words of a child process.
            answered.unwrap_or_else(|error| error.to_string().into_bytes())
        });
        // The interpreter is ending, and the thread that asked ends with it.
        answered.unwrap_or_default()
    });
    let options = ProcessOptions::for_inside_world(name, inside).with_sizes(width_px, height_px, spacing_m);
    let refused = |reason| exception_of_kind(py, "platform", (reason, Some(name.to_owned()), None));
    Ok(register_world(name, options.map_err(refused)?))
}

/// Forgets a world.
#[pyfunction]
pub(crate) fn forget_world(data: PathBuf) {
    unregister_world(&data);
}
