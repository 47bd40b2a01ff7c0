//! The error of a walk: why an agent could not begin it or go on.

use wayword_core::{ModelError, PlatformError, SceneId, ViewpointId};

/// An agent could not walk.
#[derive(Debug, thiserror::Error)]
pub enum WalkError {
    /// The platform gave no view.
    #[error(transparent)]
    Platform(#[from] PlatformError),
    /// A model failed.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// An episode begins or ends at a viewpoint that its scene does not have.
    #[error("scene {scene} has no viewpoint {viewpoint}: the episodes belong to another release of the scene")]
    Unknown {
        /// The scene.
        scene: SceneId,
        /// The viewpoint.
        viewpoint: ViewpointId,
    },
    /// A grounder gave scores that cannot be compared.
    #[error("{grounder} did not give one finite score per view and phrase")]
    Unusable {
        /// The grounder's name.
        grounder: String,
    },
}

impl WalkError {
    /// Whether every further walk would fail in the same way.
    #[must_use]
    pub fn ends_run(&self) -> bool {
        matches!(self, Self::Model(error) if error.ends_run())
    }
}
