//! The integration tests of `wayword-live`, one program: a module for each topic.

mod controller;
mod genuine_tdw;
mod genuine_virtualhome;
mod tdw_platform;
mod virtualhome;
