//! The integration tests of `wayword-testkit`, one program: a module for each topic.

mod provider_dialects;
mod provider_faults;
mod read_back;
