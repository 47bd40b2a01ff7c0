//! Platforms over simulators that run as separate programs: ThreeDWorld's build ([`tdw`]) and VirtualHome's executable
//! ([`virtualhome`]). Wayword talks to them over their own sockets. [`LivePlatform`] holds the code that both share.
//!
//! Bytes that come over a socket are not trusted. Sizes are checked before memory is allocated. Where bytes cannot be
//! read, the error names the expected content and the position.

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
