//! The objects of a platform's scenes.

use super::PlatformError;
use crate::{Frame, ObjectId, PlacedObject, SceneId, ViewpointId};
use std::collections::BTreeSet;

/// The objects that a platform knows in its scenes.
pub trait SceneCatalogue: Send + Sync {
    /// The name of an object that an episode gives by its id, whether or not it can be seen from the frame.
    ///
    /// # Errors
    /// When the data cannot be read.
    fn object_name(&self, scene: &SceneId, near: &Frame, object: &ObjectId) -> Result<Option<String>, PlatformError>;

    /// The viewpoints from which an object can be seen; `None` where the platform knows no objects.
    ///
    /// # Errors
    /// When the data cannot be read.
    fn visible_from(&self, scene: &SceneId, object: &ObjectId) -> Result<Option<BTreeSet<ViewpointId>>, PlatformError>;

    /// All objects that the platform lists in a scene with their places, also those that no viewpoint shows; empty where
    /// it knows no more than the labels of its views.
    ///
    /// # Errors
    /// When the scene does not exist or its data cannot be read.
    fn listed_objects(&self, _scene: &SceneId) -> Result<Vec<PlacedObject>, PlatformError> {
        Ok(Vec::new())
    }

    /// Whether the labels of the platform's views list everything that is visible. If not, a thing may be there that no
    /// label names.
    fn lists_everything(&self) -> bool {
        true
    }
}

/// The objects of a platform that knows none.
pub(super) struct NoCatalogue;

impl SceneCatalogue for NoCatalogue {
    fn object_name(&self, _: &SceneId, _: &Frame, _: &ObjectId) -> Result<Option<String>, PlatformError> {
        Ok(None)
    }

    fn visible_from(&self, _: &SceneId, _: &ObjectId) -> Result<Option<BTreeSet<ViewpointId>>, PlatformError> {
        Ok(None)
    }
}
