//! The integration tests of `wayword-queue`, one program: a module for each topic.

mod cloud;
mod cloud_killed;
mod cloud_lost;
mod launch;
mod model;
mod parity;
