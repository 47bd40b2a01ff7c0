//! `wayword models`: models in process, and where their files lie.
//!
//! A build without the feature `local` has the same command, and says how to get one that can do it.

#[cfg(not(feature = "local"))]
mod absent;
#[cfg(feature = "local")]
mod present;

#[cfg(not(feature = "local"))]
pub(super) use absent::run;
#[cfg(feature = "local")]
pub(super) use present::run;
