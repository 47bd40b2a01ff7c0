//! Turns errors into Python exceptions. Their classes are in `wayword/errors.py`.

use pyo3::prelude::*;
use wayword_run::{error::CommandError, error_parts::ErrorParts};

/// The exception of an error.
pub(crate) fn exception_for(py: Python<'_>, error: CommandError) -> PyErr {
    let ErrorParts { kind, what, place, hint } = ErrorParts::from_error(&error);
    exception_of_kind(py, kind, (what, place, hint))
}

/// The exception of a kind, with the problem, its place, and a hint.
pub(crate) fn exception_of_kind(py: Python<'_>, kind: &str, parts: (String, Option<String>, Option<String>)) -> PyErr {
    let (what, place, hint) = parts;
    let exception = py
        .import("wayword.errors")
        .and_then(|errors| errors.getattr("of_kind"))
        .and_then(|of_kind| of_kind.call1((kind, what, place, hint)));
    exception.map_or_else(|error| error, PyErr::from_value)
}
