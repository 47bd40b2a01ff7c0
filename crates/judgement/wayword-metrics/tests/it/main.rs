//! The integration tests of `wayword-metrics`, one program: a module for each topic.

mod atlas;
mod captions;
mod common;
mod parity;
mod parity_real;
mod study;
