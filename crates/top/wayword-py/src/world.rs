//! Worlds that are Python objects.

use pyo3::{prelude::*, types::PyBytes};
use std::path::PathBuf;
use wayword::platforms::{forget_inside, put_inside};
use wayword_platforms::process::{Inside, ProcessOptions};

/// Makes a world known by a name. `answer` takes a request and gives an answer, each a line of JSON as bytes. Returns what
/// `data` is for it.
#[pyfunction]
#[pyo3(signature = (name, answer, width_px=None, height_px=None, spacing_m=None))]
pub(crate) fn put_world(
    name: &str,
    answer: Py<PyAny>,
    width_px: Option<u32>,
    height_px: Option<u32>,
    spacing_m: Option<f64>,
) -> PathBuf {
    let inside = Inside::new(move |request| {
        Python::attach(|py| {
            let answered = answer.call1(py, (PyBytes::new(py, request),)).and_then(|line| line.extract::<Vec<u8>>(py));
            // An exception that the world does not turn into an answer is told like the last words of a child.
            answered.unwrap_or_else(|error| error.to_string().into_bytes())
        })
    });
    let options = ProcessOptions::inside(name, inside);
    let (width_px, height_px) = (width_px.unwrap_or(options.width_px), height_px.unwrap_or(options.height_px));
    let spacing_m = spacing_m.unwrap_or(options.spacing_m);
    put_inside(name, ProcessOptions { width_px, height_px, spacing_m, ..options })
}

/// Forgets a world.
#[pyfunction]
#[allow(clippy::needless_pass_by_value, reason = "Python's values are converted")]
pub(crate) fn forget_world(data: PathBuf) {
    forget_inside(&data);
}
