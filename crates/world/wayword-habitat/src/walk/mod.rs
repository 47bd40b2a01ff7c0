//! Turns walks over the ground into single actions, as agents of VLN-CE take them: a step forward, or a turn on the spot.

mod actions;
mod follow;
mod line;

pub use actions::{AgentGait, AgentStance, GaitError};
pub use follow::{ActionWalk, WalkFollowError, follow_places, replay_actions};
