//! Worlds that are changed: wrappers over any platform.

mod altered;
mod space;
mod things;

pub use altered::{Alter, Altered, Look};
pub use space::{Mirror, QuarterTurn};
pub use things::{Added, Recoloured, Removed};
