//! The integration tests of `wayword-platforms`, one program: a module for each topic.

mod matterport;
mod matterport_mutations;
mod matterport_pictures;
mod matterport_real;
mod process;
mod process_python;
