//! Worlds that are Python objects.

use crate::raise::raised_of;
use pyo3::{prelude::*, types::PyBytes};
use std::path::PathBuf;
use wayword::platforms::{forget_inside, put_inside};
use wayword_platforms::process::{Inside, ProcessOptions};

/// Makes a world known by a name. `answer` takes a request and gives an answer, each a line of JSON as bytes. Returns what
/// `data` is for it.
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
    let inside = Inside::new(move |request| {
        let answered = Python::try_attach(|py| {
            let answered = answer.call1(py, (PyBytes::new(py, request),)).and_then(|line| line.extract::<Vec<u8>>(py));
            // An exception that the world does not turn into an answer is told like the last words of a child.
            answered.unwrap_or_else(|error| error.to_string().into_bytes())
        });
        // The interpreter ends, and the one who asked with it.
        answered.unwrap_or_default()
    });
    let options = ProcessOptions::inside(name, inside).sized(width_px, height_px, spacing_m);
    let refused = |reason| raised_of(py, "platform", (reason, Some(name.to_owned()), None));
    Ok(put_inside(name, options.map_err(refused)?))
}

/// Forgets a world.
#[pyfunction]
pub(crate) fn forget_world(data: PathBuf) {
    forget_inside(&data);
}
