//! Platforms over simulators that run as separate programs: ThreeDWorld's build ([`tdw`]) and VirtualHome's executable
//! ([`virtualhome`]). Wayword talks to them over their own sockets. [`LivePlatform`] holds the code that both share.
//!
//! Bytes that come over a socket are not trusted. Sizes are checked before memory is allocated. Where bytes cannot be
//! read, the error names the expected content and the position.
//!
//! # Where things are
//! - `tdw/session.rs`: the commands to ThreeDWorld's build for each task; `tdw/zmtp/` is its socket, `tdw/output/` its data.
//! - `virtualhome/classes.txt`: everyday names of VirtualHome's classes; `names.rs` divides the others into words.
//! - `virtualhome/floor.rs`, `raster/`: where one can walk in a simulator that reports no graph.
//! - `tdw/platform.rs`, `virtualhome/platform.rs`: also which failures are lost.
//! - `tdw/stand_in/`, `virtualhome/stand_in/`: the stand-ins (feature `stand-in`); `houses` has the houses that they show, `bin/stand_in.rs` the
//!   program.

mod decode;
#[cfg(feature = "stand-in")]
mod houses;
mod labels;
mod live;
mod path_sampling;
mod raster;
pub mod tdw;
pub mod unity;
pub mod virtualhome;

#[cfg(feature = "stand-in")]
pub use houses::{NotShown, ShownAs, StandInHouses};
pub use live::{LivePictureOptions, LivePlatform};
