//! The extension module of the Python package: passes calls from Python to Wayword, and the results back.
//!
//! Architecture invariant: there is no logic here. The crate `wayword` carries out the calls, and `python/wayword/` presents
//! them to Python's users.
//!
//! # Where things are
//! - `call.rs`: a command from Python: its thread, Ctrl-C, progress.
//! - `judge.rs`, `follow.rs`: trajectories and walks. `world.rs`: worlds that are objects, with `platforms/python_worlds.rs` in `wayword-run`.
//! - `raise.rs`, with `python/wayword/errors.py`: exceptions.
//! - `python/wayword/`: the functions and classes that users see; `platform.py` needs no other file.
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
