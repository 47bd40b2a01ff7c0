//! The integration tests of `wayword-ledger`, one program: a module for each topic.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod calls_made_once;
mod changed_answers;
mod chunks;
mod common;
mod damaged_ledger;
mod killed_process;
mod money;
mod shared_ledger;
mod workers;
