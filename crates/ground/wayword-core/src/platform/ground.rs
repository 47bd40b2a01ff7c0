//! The ground of a platform's scenes, and the shapes over it.

use super::PlatformError;
use crate::{DepthImage, Frame, FromAbove, GroundIsland, GroundRoute, SceneId, ViewGaze};

/// Where one can walk in the scenes of a platform, how far things are, and what a storey looks like from above. By default a platform
/// knows none of it.
pub trait Ground: Send + Sync {
    /// The shortest way on foot from one frame to another, over all ground and not only along viewpoints; `None` where
    /// the platform does not know the ground, or there is no way.
    ///
    /// # Errors
    /// When the scene does not exist or its data cannot be read.
    fn ground_route(&self, _scene: &SceneId, _from: &Frame, _to: &Frame) -> Result<Option<GroundRoute>, PlatformError> {
        Ok(None)
    }

    /// The islands of a scene, the largest first; empty where the platform does not know the ground.
    ///
    /// # Errors
    /// When the scene does not exist or its data cannot be read.
    fn ground_islands(&self, _scene: &SceneId) -> Result<Vec<GroundIsland>, PlatformError> {
        Ok(Vec::new())
    }

    /// A storey (the lowest is 1) straight from above, without its ceiling and all that is over it; `None` where the
    /// platform has no picture of it, or the scene has no storey of this number.
    ///
    /// # Errors
    /// When the scene does not exist or its data cannot be read.
    fn look_down(&self, _scene: &SceneId, _level: u32) -> Result<Option<FromAbove>, PlatformError> {
        Ok(None)
    }

    /// The depth image of the view that [`look_from`](super::Platform::look_from) shows for the same frame and gaze; `None`
    /// where the platform does not know distances. The view does not contain it, so that only callers that want it pay for
    /// it.
    ///
    /// # Errors
    /// When the frame is not a place of the scene, or its data cannot be read.
    fn view_depth(
        &self,
        _scene: &SceneId,
        _from: &Frame,
        _gaze: ViewGaze,
    ) -> Result<Option<DepthImage>, PlatformError> {
        Ok(None)
    }
}

/// The ground of a platform that does not know it.
pub(super) struct NoGround;

impl Ground for NoGround {}
