//! Agents that walk by instructions, and the agents that they are compared with.

mod baselines;
mod map_reader;
mod parameters;
mod phrases;
mod policy;
mod reader;

pub use baselines::{last_room_in, nearest_room, oracle, random, straight};
pub use map_reader::{MapReader, Surveyed};
pub use parameters::{Back, Parameters};
pub use phrases::walk_by_phrases;
pub use reader::walk_by_reading;
pub use wayword_follower::Prior;

use wayword_core::{Heading, SceneId, ViewpointId};

/// Where an agent begins.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// The scene.
    pub scene: SceneId,
    /// The node.
    pub viewpoint: ViewpointId,
    /// Which way it looks.
    pub heading: Heading,
}

/// The result of a walk.
#[derive(Debug, Clone, PartialEq)]
pub struct Walked {
    /// Every step.
    pub steps: Vec<crate::walk::Step>,
    /// Why it ended.
    pub end: crate::walk::End,
    /// The object that is taken for the target.
    pub object: Option<wayword_core::ObjectId>,
}

#[cfg(test)]
mod tests;
