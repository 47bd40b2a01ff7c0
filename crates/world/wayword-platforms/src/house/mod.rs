//! The built-in platform: whole homes from a seed.

mod catalogue;
mod colour;
mod dice;
mod furnish;
mod layout;
pub mod model;
mod rect;

pub use catalogue::Kind;
pub use colour::Colour;
pub use model::House;
pub use rect::{RectCm, SpanCm, Wall};

/// The home of a seed: the same on every machine.
#[must_use]
pub fn generate(seed: u64) -> House {
    let layout = layout::lay_out(seed);
    let furniture = furnish::furnish(seed, &layout);
    let layout::Layout { storeys, rooms, openings, windows, stairs, .. } = layout;
    House { seed, storeys, rooms, openings, windows, stairs, furniture }
}
