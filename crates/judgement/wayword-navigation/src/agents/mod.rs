//! Agents that walk by instructions, and what stands beside them.

mod floors;
mod mind;
mod parameters;
mod phrases;

pub use floors::{last_room_in, nearest_room, oracle, random, straight};
pub use parameters::{Back, Parameters};
pub use phrases::walk_by_phrases;

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

/// What a walk came to.
#[derive(Debug, Clone, PartialEq)]
pub struct Walked {
    /// Every stand.
    pub steps: Vec<crate::walk::Step>,
    /// Why it ended.
    pub end: crate::walk::End,
    /// The object that is taken for the target.
    pub object: Option<wayword_core::ObjectId>,
}

#[cfg(test)]
mod tests;
