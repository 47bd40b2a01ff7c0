//! Turns walks over the ground into single actions, as agents of VLN-CE take them: a step forward, or a turn on the spot.

mod actions;
mod follow;
mod line;

pub use actions::{Gait, NoGait, Stance};
pub use follow::{Astray, Walked, follow, replay};
