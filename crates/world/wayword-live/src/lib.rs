//! Simulators that run beside Wayword, over their own sockets: ThreeDWorld's build and VirtualHome's executable.
//!
//! Everything that comes over a socket is untrusted: sizes are bounded before memory is taken, and what cannot be read is an
//! error that says what was expected, and where.

mod decode;
mod live;
mod raster;
mod sight;
pub mod tdw;
pub mod unity;
pub mod virtualhome;
mod walk;

pub use live::{Live, Pictures};
