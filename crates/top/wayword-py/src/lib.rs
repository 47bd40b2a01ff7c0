//! The extension module of the Python package: passes calls from Python to Wayword, and the results back.
//!
//! Architecture invariant: there is no logic here. The crate `wayword` carries out the calls, and `python/wayword/` presents
//! them to Python's users.
#![allow(
    clippy::needless_pass_by_value,
    reason = "functions of a Python module own the values that were made for them"
)]

mod call;
mod follow;
mod judge;
mod raise;
mod world;

use pyo3::prelude::*;

/// The extension module.
#[pymodule]
mod _wayword {
    #[pymodule_export]
    use crate::{
        call::{call, finish, guarded_by, main, settings},
        follow::Map,
        judge::{Judge, Scores},
        world::{forget_world, put_world},
    };
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        wayword::leave_contained_panics_to_errors();
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
