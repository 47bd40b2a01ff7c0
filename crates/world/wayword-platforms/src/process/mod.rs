//! Any world: a simulator in any language as a child process.
//!
//! Wayword writes one request a line into the child's standard input and reads one answer a line from its standard output;
//! `docs/PROCESS.md` says what stands in them, and `python/wayword_platform.py` is the other side of it in Python. The child
//! converts into Wayword's frame (z up, metres, radians clockwise from +y) and says so in its greeting.
//!
//! The child is not trusted: lines, pictures, counts and times are bounded, and one that dies, hangs, floods or sends
//! nonsense costs the request that was under way and is started anew, a bounded number of times (`keeper.rs`).
//!
//! A child ends with whatever it has started (`group.rs`): when its platform is dropped, after a fault, and by [`end_all`].
//! Where the program is killed, or exits without dropping the platform, only a guard can end it (`guard.rs`): see
//! [`ProcessOptions::guard`].

mod answer;
mod child;
mod fault;
mod graph;
mod group;
mod guard;
mod keeper;
mod labels;
mod options;
mod path;
mod picture;
mod platform;
mod protocol;
mod stderr;

pub use group::end_all;
pub use guard::{stand_guard_if_asked, this_program};
pub use options::ProcessOptions;
pub use platform::ProcessPlatform;
pub use protocol::{Offer, PROTOCOL, World};
