//! A platform for any simulator, in any language, that runs as a child process: a world program.
//!
//! Wayword writes one request per line to the child's standard input and reads one answer per line from its standard
//! output. `docs/PROCESS.md` describes requests and answers, and `python/wayword/platform.py` implements the child's
//! side in Python. A world within this process ([`InsideWorld`]) gets the same lines. The child converts to Wayword's frame
//! (z up, metres, radians clockwise from +y) and names that frame in its greeting.
//!
//! The child is not trusted: lines, pictures, counts and times are bounded. If it dies, hangs, floods its output or
//! sends something that is not an answer, the request under way fails and the child is restarted, a bounded number of
//! times (`child_keeper.rs`).
//!
//! A child ends together with the processes that it started (`group.rs`): when its platform is dropped, after a fault,
//! and by [`end_all`]. If this program is killed, or exits without dropping the platform, only a guard can end the
//! child (`guard.rs`): see [`ProcessOptions::guard`].

#![cfg_attr(
    not(test),
    warn(
        clippy::indexing_slicing,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap
    )
)]

mod answer;
mod child;
mod child_keeper;
mod fault;
mod graph;
mod group;
mod guard;
mod label_places;
mod labels;
mod options;
mod path;
mod picture;
mod platform;
mod protocol;
mod stderr;

pub use group::{end_all, start_again};
pub use guard::{GuardProgram, set_this_program, stand_guard_if_asked, this_program};
pub use options::{InsideWorld, ProcessOptions};
pub use platform::ProcessPlatform;
pub use protocol::{PROTOCOL_VERSION, WorldOffer, WorldProgram};
