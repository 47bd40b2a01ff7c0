//! Any world: a simulator in any language as a child process.
//!
//! Wayword writes one request a line into the child's standard input and reads one answer a line from its standard output;
//! `docs/PROCESS.md` says what stands in them, and `python/wayword_platform.py` is the other side of it in Python. The child
//! converts into Wayword's frame (z up, metres, radians clockwise from +y) and says so in its greeting.
//!
//! The child is not trusted: lines, pictures, counts and times are bounded, and one that dies, hangs, floods or sends
//! nonsense costs the request that was under way and is started anew, a bounded number of times (`keeper.rs`).

mod answer;
mod child;
mod fault;
mod graph;
mod keeper;
mod labels;
mod options;
mod path;
mod picture;
mod platform;
mod protocol;
mod stderr;
mod stop;

pub use options::ProcessOptions;
pub use platform::ProcessPlatform;
pub use protocol::{Offer, PROTOCOL, World};
